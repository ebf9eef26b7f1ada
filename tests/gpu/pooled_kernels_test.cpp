// SPDX-License-Identifier: Apache-2.0
// The stiffness of pooled volume on the device, blocks and vectors of patches: K p, f - K u and the
// preconditioner against a dense stiffness: intact, after destroyed elements, with patches that
// these split, and with all back.
#include <Eigen/LU>
#include <map>

#include "body/element.hpp"
#include "body/pools.hpp"
#include "body/supports.hpp"
#include "kernels_fixture.hpp"
#include "stiffness_product.hpp"
#include "support/pooled_body.hpp"

namespace sunder::test {
namespace {

/// K at all nodes, three rows each, and what its terms sum up to without their signs.
class PooledStiffness {
 public:
  Eigen::MatrixXd k, terms;

  PooledStiffness(const Problem& problem, const fem::Pools& pools, std::span<const double> scale) {
    const Index size = 3 * problem.node_count();
    k = terms = Eigen::MatrixXd::Zero(size, size);
    const auto rows_of = [&](Index e) -> const std::array<Index, 4>& {
      return problem.mesh().tets[static_cast<std::size_t>(e)];
    };
    for (Index e = 0; e < problem.tet_count(); ++e) {
      const fem::ElementMatrix of =
          scale[static_cast<std::size_t>(e)] * fem::element_stiffness(problem, e);
      for (int a = 0; a < 4; ++a) {
        for (int b = 0; b < 4; ++b) {
          const Mat3 block = of.block<3, 3>(3 * a, 3 * b);
          k.block<3, 3>(3 * rows_of(e)[a], 3 * rows_of(e)[b]) += block;
          terms.block<3, 3>(3 * rows_of(e)[a], 3 * rows_of(e)[b]) += block.cwiseAbs();
        }
      }
    }
    for (Index p = 0; p < pools.count(); ++p) add_patch(problem, pools, p, scale);
  }

 private:
  void add_patch(const Problem& problem, const fem::Pools& pools, Index patch,
                 std::span<const double> scale) {
    std::map<Index, std::pair<Vec3, Vec3>> v;  // by node: b_p, and its terms without their signs
    double volume = 0;
    for (Index e : pools.elements(patch)) {
      const double own = scale[static_cast<std::size_t>(e)] * problem.shape(e).volume;
      volume += own;
      for (int a = 0; a < 4; ++a) {
        const Vec3 at = own * problem.shape(e).gradient.col(a);
        auto& [sum, of_sum] = v.try_emplace(problem.mesh().tets[static_cast<std::size_t>(e)][a],
                                            Vec3::Zero(), Vec3::Zero())
                                  .first->second;
        sum += at;
        of_sum += at.cwiseAbs();
      }
    }
    const double factor = pools.bulk(patch) / volume;
    for (const auto& [i, one] : v) {
      for (const auto& [j, two] : v) {
        k.block<3, 3>(3 * i, 3 * j) += factor * one.first * two.first.transpose();
        terms.block<3, 3>(3 * i, 3 * j) += factor * one.second * two.second.transpose();
      }
    }
  }
};

/// M K_nn = I over the axes that are free.
void expect_inverse(const Problem& problem, const Eigen::MatrixXd& k, const vulkan::Buffer& blocks,
                    Index node) {
  std::array<double, 6> packed{};
  blocks.read(std::span<double>(packed), 6 * static_cast<std::size_t>(node));
  Mat3 m = Mat3::Identity(), of_k = Mat3::Identity();
  for (int i = 0; i < 3; ++i) {
    for (int j = 0; j < 3; ++j) {
      if (problem.dof(node, i) == kNone || problem.dof(node, j) == kNone) continue;
      m(i, j) = packed[static_cast<std::size_t>(i + j + (i > 0 && j > 0 ? 1 : 0))];
      of_k(i, j) = k(3 * node + i, 3 * node + j);
    }
  }
  // Sums over 24 elements and as many patches, and an inverse by cofactors.
  EXPECT_LE((m * of_k - Mat3::Identity()).norm(), 64 * kEps64 * m.norm() * of_k.norm())
      << "node " << node;
}

class PooledKernels : public Kernels {
 protected:
  /// K p, f - K u without load and the preconditioner of the device, as damage has left them.
  void expect_stiffness(const Problem& problem, gpu::Fields& fields, const fem::Pools& pools,
                        std::span<const double> scale) {
    Eigen::VectorXd x(3 * problem.node_count());
    std::vector<double> p(std::size_t{fields.matrix().groups()} * shaders::kGroup * 4, 0.0);
    for (Index i = 0; i < x.size(); ++i) {
      const bool held = problem.dof(i / 3, static_cast<int>(i % 3)) == kNone;
      x[i] = p[static_cast<std::size_t>(4 * (i / 3) + i % 3)] = held ? 0 : uniform_(generator_);
    }
    const auto [q, pq] = Multiply(*device_, *factory_, fields, fields.matrix())(p);
    fields.write_displacement({x.data(), static_cast<std::size_t>(x.size())});
    compute_state(fields);
    std::vector<double> residual(fields.rows());
    fields.residual().read(std::span<double>(residual));

    const PooledStiffness right(problem, pools, scale);
    const Eigen::VectorXd expected = right.k * x, size = right.terms * x.cwiseAbs();
    // A row sums three products for each of some 30 neighbours, each entry 24 elements or fewer; a
    // patch three for each of 20 nodes, each number 24 elements; all from differences of two.
    const double units = 2 * (3 * 30 + 24 + 3 * 20 + 24 + 16);
    double allowed_sum = 0;
    for (Index i = 0; i < x.size(); ++i) {
      const Index d = problem.dof(i / 3, static_cast<int>(i % 3));
      const double value = q[static_cast<std::size_t>(4 * (i / 3) + i % 3)];
      if (d == kNone) {
        EXPECT_EQ(value, 0) << "held axis of node " << i / 3;
        continue;
      }
      const double allowed = units * kEps64 * size[i];
      EXPECT_LE(std::abs(value - expected[i]), allowed) << "node " << i / 3;
      EXPECT_LE(std::abs(residual[static_cast<std::size_t>(d)] + expected[i]), allowed)
          << "node " << i / 3;
      allowed_sum += (allowed + static_cast<double>(x.size()) * kEps64 * size[i]) * std::abs(x[i]);
    }
    EXPECT_NEAR(pq, x.dot(expected), allowed_sum);
    for (Index n = 0; n < problem.node_count(); ++n) {
      expect_inverse(problem, right.k, fields.matrix().preconditioner(), n);
    }
  }
};

std::vector<double> scale_with(const Problem& problem, std::span<const Index> gone) {
  std::vector<double> scale(problem.mesh().tets.size(), 1.0);
  for (Index e : gone) scale[static_cast<std::size_t>(e)] = problem.scene().fracture.alpha;
  return scale;
}

TEST_P(PooledKernels, TheStiffnessFollowsDamage) {
  Scene scene;
  scene.mesh = structured_board({7, 5, 3}, [](const Vec3& x) {
    return x.x() < 7 ? std::string("pooled") : std::string("not");
  });
  for (Vec3& x : scene.mesh.nodes) x += 0.1 * Vec3(random(), random(), random());
  scene.materials["pooled"] = scene.materials["not"] = {5, 0.49, 2.0};
  scene.materials["pooled"].volume = MaterialVolume::pooled;
  scene.supports.push_back({Box{Vec3(-1, 9.5, -1), Vec3(11, 11, 2)}, Axes{5}});
  scene.supports.push_back({Box{Vec3(-1, -1, -1), Vec3(11, 0.5, 2)}, Axes{2}});
  const Problem problem(scene);
  gpu::Fields fields(*factory_, problem, all_needs(), {0, true});
  fields.set_load(std::vector<double>(fields.rows(), 0.0), {});
  const std::vector<Index> gone = {0, 17, 18, 19, 300, 629};
  for (const bool damaged : {false, true, false}) {
    SCOPED_TRACE(damaged ? "damaged" : "whole");
    const auto scale =
        scale_with(problem, damaged ? std::span<const Index>(gone) : std::span<const Index>());
    fields.destroy(gone, scale);
    expect_stiffness(problem, fields, *problem.pools(), scale);
  }
}

// Of patches that a piece is cut off through each part has its own pressure.
TEST_P(PooledKernels, PartsOfAPatchHaveAVectorEach) {
  const Problem problem(pooled_board(0.49));
  gpu::Fields fields(*factory_, problem, all_needs(), {0, true});
  fields.set_load(std::vector<double>(fields.rows(), 0.0), {});
  const CutAcross cut = cut_through_a_patch(problem);
  std::vector<std::uint8_t> destroyed(problem.mesh().tets.size(), 0);
  for (Index e : cut.elements) destroyed[static_cast<std::size_t>(e)] = 1;
  const fem::Bodies bodies = fem::find_bodies(problem.mesh(), destroyed);
  const auto split = problem.pools()->split(
      [&](Index e) { return bodies.body_of_element[static_cast<std::size_t>(e)]; });
  ASSERT_TRUE(split);
  // The last of them completes the cut: patches that it does not lie in are split then.
  const std::span<const Index> most = std::span(cut.elements).first(cut.elements.size() - 1);
  const auto last = std::span(cut.elements).last(1);
  const auto intact = scale_with(problem, {}), loose = scale_with(problem, most),
             off = scale_with(problem, cut.elements);
  fields.destroy(most, loose);
  fields.destroy(last, off, split.get());
  {
    SCOPED_TRACE("cut off");
    expect_stiffness(problem, fields, *split, off);
  }
  fields.destroy(last, loose);
  {
    SCOPED_TRACE("hangs on one element");
    expect_stiffness(problem, fields, *problem.pools(), loose);
  }
  fields.destroy(most, intact);
  SCOPED_TRACE("whole again");
  expect_stiffness(problem, fields, *problem.pools(), intact);
}

INSTANTIATE_TEST_SUITE_P(All, PooledKernels,
                         testing::Values(Numbers{gpu::Variant::gpu, true},
                                         Numbers{gpu::Variant::lvp, true}),
                         [](const auto& tested) { return name_of(tested.param); });

}  // namespace
}  // namespace sunder::test
