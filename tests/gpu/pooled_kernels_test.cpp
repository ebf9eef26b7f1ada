// SPDX-License-Identifier: Apache-2.0
// The stiffness of pooled volume on the device, blocks and vectors of patches: K p, f - K u and the
// preconditioner against the assembled stiffness, intact, after destroyed elements and with these
// back.
#include <Eigen/LU>

#include "body/assembly.hpp"
#include "body/element.hpp"
#include "body/pools.hpp"
#include "kernels_fixture.hpp"
#include "stiffness_product.hpp"

namespace sunder::test {
namespace {

class PooledKernels : public Kernels {};

/// At all nodes, three values each: sum of |terms| of K x, those of elements and of patches each.
Eigen::VectorXd terms_of_product(const Problem& problem, std::span<const double> scale,
                                 const Eigen::VectorXd& x) {
  Eigen::VectorXd size = Eigen::VectorXd::Zero(x.size());
  for (Index e = 0; e < problem.tet_count(); ++e) {
    const auto& tet = problem.mesh().tets[static_cast<std::size_t>(e)];
    const fem::ElementMatrix k =
        scale[static_cast<std::size_t>(e)] * fem::element_stiffness(problem, e).cwiseAbs();
    Eigen::Matrix<double, 12, 1> of;
    for (int a = 0; a < 4; ++a) of.segment<3>(3 * a) = x.segment<3>(3 * tet[a]).cwiseAbs();
    for (int a = 0; a < 4; ++a) {
      size.segment<3>(3 * tet[a]) += (k * of).segment<3>(3 * a);
    }
  }
  for (Index p = 0; p < problem.pools()->count(); ++p) {
    Eigen::VectorXd b = Eigen::VectorXd::Zero(x.size());
    double volume = 0;
    for (Index e : problem.pools()->elements(p)) {
      const double own = scale[static_cast<std::size_t>(e)] * problem.shape(e).volume;
      volume += own;
      for (int a = 0; a < 4; ++a) {
        b.segment<3>(3 * problem.mesh().tets[static_cast<std::size_t>(e)][a]) +=
            own * problem.shape(e).gradient.col(a).cwiseAbs();
      }
    }
    size += problem.pools()->bulk(p) / volume * b * b.dot(x.cwiseAbs());
  }
  return size;
}

/// M K_nn = I over the axes that are free.
void expect_inverse(const Problem& problem, const Eigen::MatrixXd& k, const vulkan::Buffer& blocks,
                    Index node) {
  std::array<double, 12> packed{};
  blocks.read(std::span<double>(packed), 12 * static_cast<std::size_t>(node));
  Mat3 m = Mat3::Identity(), of_k = Mat3::Identity();
  for (int i = 0; i < 3; ++i) {
    for (int j = 0; j < 3; ++j) {
      const Index a = problem.dof(node, i), b = problem.dof(node, j);
      if (a == kNone || b == kNone) continue;
      m(i, j) = packed[static_cast<std::size_t>(4 * i + j)];
      of_k(i, j) = k(a, b);
    }
  }
  // Sums over 24 elements and as many patches, and an inverse by cofactors.
  EXPECT_LE((m * of_k - Mat3::Identity()).norm(), 64 * kEps64 * m.norm() * of_k.norm())
      << "node " << node;
}

TEST_P(PooledKernels, TheStiffnessIsTheAssembledOne) {
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
  Multiply multiply(*device_, *factory_, fields, fields.matrix());
  fields.set_load(std::vector<double>(fields.rows(), 0.0), {});
  const std::vector<Index> gone = {0, 17, 18, 19, 300, 629};
  for (const double share : {1.0, problem.scene().fracture.alpha, 1.0}) {
    std::vector<double> scale(problem.mesh().tets.size(), 1.0);
    for (Index e : gone) scale[static_cast<std::size_t>(e)] = share;
    fields.destroy(gone, scale);
    Eigen::VectorXd x(problem.dof_count()), nodal(3 * problem.node_count());
    std::vector<double> p(std::size_t{fields.matrix().groups()} * shaders::kGroup * 4, 0.0);
    for (Index i = 0; i < nodal.size(); ++i) {
      const Index d = problem.dof(i / 3, static_cast<int>(i % 3));
      nodal[i] = d == kNone ? 0 : uniform_(generator_);
      p[static_cast<std::size_t>(4 * (i / 3) + i % 3)] = nodal[i];
      if (d != kNone) x[d] = nodal[i];
    }
    const auto [q, pq] = multiply(p);
    fields.write_displacement({nodal.data(), static_cast<std::size_t>(nodal.size())});
    compute_state(fields);
    std::vector<double> residual(fields.rows());
    fields.residual().read(std::span<double>(residual));

    const Eigen::MatrixXd k =
        Eigen::MatrixXd(fem::assemble_lower(problem, scale)).selfadjointView<Eigen::Lower>();
    const Eigen::VectorXd expected = k * x, size = terms_of_product(problem, scale, nodal);
    // A row sums three products for each of some 30 neighbours, each entry 24 elements or fewer; a
    // patch three for each of 20 nodes, each number 24 elements; all from differences of two.
    const double units = 2 * (3 * 30 + 24 + 3 * 20 + 24 + 16);
    double allowed_sum = 0;
    for (Index i = 0; i < nodal.size(); ++i) {
      const Index d = problem.dof(i / 3, static_cast<int>(i % 3));
      const double value = q[static_cast<std::size_t>(4 * (i / 3) + i % 3)];
      if (d == kNone) {
        EXPECT_EQ(value, 0) << "held axis of node " << i / 3;
        continue;
      }
      const double allowed = units * kEps64 * size[i];
      EXPECT_LE(std::abs(value - expected[d]), allowed) << "node " << i / 3;
      EXPECT_LE(std::abs(residual[static_cast<std::size_t>(d)] + expected[d]), allowed)
          << "node " << i / 3;
      allowed_sum += (allowed + static_cast<double>(x.size()) * kEps64 * size[i]) * std::abs(x[d]);
    }
    EXPECT_NEAR(pq, x.dot(expected), allowed_sum);
    for (Index n = 0; n < problem.node_count(); ++n) {
      expect_inverse(problem, k, fields.matrix().preconditioner(), n);
    }
  }
}

INSTANTIATE_TEST_SUITE_P(All, PooledKernels,
                         testing::Values(Numbers{gpu::Variant::gpu, true},
                                         Numbers{gpu::Variant::lvp, true}),
                         [](const auto& tested) { return name_of(tested.param); });

}  // namespace
}  // namespace sunder::test
