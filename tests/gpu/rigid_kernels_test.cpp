// SPDX-License-Identifier: Apache-2.0
// The rigid motions of groups of nodes that precondition conjugate gradients: sums over a group and
// back, their equations by an inverse and by two levels, what they take of the device.
#include <algorithm>
#include <array>
#include <bit>
#include <numeric>
#include <random>

#include "cg_kernels.hpp"
#include "gpu/cg_route.hpp"
#include "gpu/passes/fields.hpp"
#include "gpu/passes/rigid_levels.hpp"
#include "gpu_body.hpp"

namespace sunder::test {
namespace {

class RigidKernels : public CgKernels {
 protected:
  [[nodiscard]] gpu::GroupBlocks positive_blocks(std::size_t rows);
};

TEST_P(RigidKernels, SmallProblemOfTheRigidMotions) {
  constexpr std::uint32_t kRigid = 5, kRows = 6 * kRigid, kSolves = 8, kSize = 4 * kSolves;
  Doubles inverse(std::size_t{kSize} * kSize, 0.0), y(kSize, 0.0);
  for (std::uint32_t row = 0; row < kRows; ++row) {
    y[row] = random();
    for (std::uint32_t column = 0; column < kRows; ++column)
      inverse[row * kSize + column] = random();
  }
  const auto of_inverse = buffer(inverse), of_y = buffer(y), of_w = buffer(Doubles(64 * 8, 0.0)),
             of_terms = empty(kSolves);
  shaders::CgPush push{};
  push.rigid_solves = kSolves;
  run("cg_coarse", {&of_inverse, &of_y, &of_w, &of_terms}, push, kSolves,
      factory_->summing_group());
  const Doubles w = read(of_w, 64 * 8), terms = read(of_terms, kSolves);
  const auto place = [](std::uint32_t row) {
    return 8 * (row / 6) + row % 6 + (row % 6 < 3 ? 0 : 1);
  };
  for (std::uint32_t row = 0; row < kRows; ++row) {
    double sum = 0, size = 0;
    for (std::uint32_t column = 0; column < kRows; ++column) {
      sum += inverse[row * kSize + column] * y[column];
      size += std::abs(inverse[row * kSize + column] * y[column]);
    }
    EXPECT_LE(std::abs(w[place(row)] - sum), 4 * kSolves * kEps64 * size) << "row " << row;
  }
  for (std::uint32_t k = 0; k < kSolves; ++k) {
    double sum = 0, size = 0;
    for (std::uint32_t row = 4 * k; row < 4 * k + 4; ++row) {
      sum += w[place(row)] * y[row];
      size += std::abs(w[place(row)] * y[row]);
    }
    EXPECT_LE(std::abs(terms[k] - sum), 4 * kEps64 * size) << "rows from " << 4 * k;
  }
}

/// Symmetric with a positive diagonal, each row with the next few and one far away.
gpu::GroupBlocks RigidKernels::positive_blocks(std::size_t rows) {
  gpu::GroupBlocks matrix(rows, static_cast<Index>(rows));
  const auto add = [&](std::size_t a, std::size_t b) {
    // sum = (v_a - v_b)^T m (v_a - v_b) with m positive.
    gpu::Six root;
    for (double& value : root.reshaped()) value = random();
    const gpu::Six m = root * root.transpose() + gpu::Six::Identity();
    const auto i = static_cast<Index>(a), j = static_cast<Index>(b);
    matrix.at(i, i) += m;
    matrix.at(j, j) += m;
    matrix.at(i, j) -= m;
    matrix.at(j, i) -= m;
  };
  for (std::size_t r = 0; r + 1 < rows; ++r) {
    add(r, r + 1);
    if (r % 3 == 0 && r + 7 < rows) add(r, r + 7);
  }
  matrix.at(0, 0) += gpu::Six::Identity();
  return matrix;
}

TEST_P(RigidKernels, TwoLevelsOverTheRigidMotions) {
  // More than a workgroup of groups, no whole number of these, and fewer afterwards.
  constexpr Index kMost = 150;
  gpu::RigidLevels levels(*factory_, kMost);
  const std::size_t room = 192;
  auto of_y = empty(6 * room);
  const auto of_w = empty(8 * room);
  auto of_terms = empty(room);
  levels.bind(of_y, of_w, of_terms);
  for (const std::size_t groups : {std::size_t{150}, std::size_t{70}}) {
    const gpu::GroupBlocks stiffness = positive_blocks(groups);
    const auto aggregates = static_cast<Index>(groups / 8);
    gpu::GroupBlocks motions(groups, aggregates);
    for (std::size_t g = 0; g < groups; ++g) {
      motions.at(static_cast<Index>(g), std::min(static_cast<Index>(g / 8), aggregates - 1)) =
          gpu::Six::Identity();
    }
    const gpu::SmoothedLevels of = gpu::smoothed_levels(stiffness, motions);
    levels.update(of);
    Doubles y = random_values(6 * groups);
    y.resize(6 * room, 0.0);
    of_y.write(std::span<const double>(y));
    of_terms.fill_zero();
    shaders::CgPush push{};
    levels.add_to(push);
    EXPECT_EQ(push.rigid_aggregates, static_cast<std::uint32_t>(aggregates));
    vulkan::Commands commands(*device_);
    commands.begin();
    levels.record(commands, push);
    commands.end();
    commands.submit();

    const auto size = static_cast<Eigen::Index>(6 * groups);
    const Eigen::MatrixXd s = of.smoother.dense(), q = of.prolongation.dense();
    const Eigen::Map<const Eigen::VectorXd> of_groups(y.data(), size);
    const Eigen::VectorXd coarse = of.inverse * (q.transpose() * of_groups);
    const Eigen::VectorXd expected = s * of_groups + q * coarse;
    // S and Q are rounded to fp32; A^-1 makes of what that does to Q^T y as much as of Q^T y.
    const Eigen::VectorXd sizes =
        s.cwiseAbs() * of_groups.cwiseAbs() +
        2 * q.cwiseAbs() *
            (of.inverse.cwiseAbs() * (q.transpose().cwiseAbs() * of_groups.cwiseAbs()));
    const Doubles w = read(of_w, 8 * room);
    double product = 0;
    for (Eigen::Index k = 0; k < size; ++k) {
      const auto at = static_cast<std::size_t>(8 * (k / 6) + k % 6 + (k % 6 < 3 ? 0 : 1));
      EXPECT_LE(std::abs(w[at] - expected[k]), 1.2 * kEps32 * sizes[k]) << k;
      product += w[at] * of_groups[k];
    }
    const Doubles terms = read(of_terms, push.rigid_terms);
    EXPECT_NEAR(std::accumulate(terms.begin(), terms.end(), 0.0), product,
                1e-12 * sizes.dot(of_groups.cwiseAbs()));
  }
}

TEST_P(RigidKernels, RigidMotionsHoldNoMoreThanWasPlanned) {
  for (const BoardShape& shape :
       {BoardShape{9, 9, 1, 50, 50, 2.5}, BoardShape{36, 36, 1, 50, 50, 2.5},
        BoardShape{71, 71, 1, 50, 50, 2.5}, BoardShape{16, 16, 16, 50, 50, 50},
        BoardShape{24, 24, 24, 50, 50, 50}, BoardShape{300, 4, 4, 500, 5, 5}}) {
    Scene scene;
    scene.mesh = structured_board(shape);
    scene.materials["board"] = {5, 0.4, 2.0};
    scene.supports.push_back({Box{Vec3(-1, -1, -1), Vec3(0.1, 60, 60)}, Axes{7}});
    const Problem problem(std::move(scene));
    const std::vector<std::uint8_t> destroyed(problem.mesh().tets.size(), 0);
    gpu::RigidSpace space(*factory_, problem, destroyed, 1e-3);
    space.update();
    const std::size_t planned = gpu::RigidSpace::planned_bytes(problem);
    const std::string where = std::to_string(shape.nx) + " x " + std::to_string(shape.nz);
    EXPECT_LE(space.bytes(), planned) << where;
    EXPECT_GE(5 * space.bytes(), planned) << where;
  }
}

TEST_P(RigidKernels, SumsOfTheRigidMotionsAndBack) {
  // Three groups of 1, 70 and 100 nodes in no order; the other nodes are in none.
  const Words first = {0, 1, 71, 171};
  Words order(kNodes);
  std::iota(order.begin(), order.end(), 0u);
  std::shuffle(order.begin(), order.end(), generator_);
  std::vector<std::array<std::uint32_t, 4>> members(171), modes(kNodes, {0, 0, 0, shaders::kHeld});
  std::vector<Vec3> places(kNodes, Vec3::Zero());
  Words group_of(kNodes, shaders::kHeld), held(kNodes, 0);
  for (std::uint32_t g = 0; g < 3; ++g) {
    for (std::uint32_t i = first[g]; i < first[g + 1]; ++i) {
      const std::uint32_t n = order[i];
      std::array<std::uint32_t, 4> texel{};
      for (std::size_t axis = 0; axis < 3; ++axis) {
        const auto x = static_cast<float>(random());
        places[n][static_cast<Index>(axis)] = static_cast<double>(x);
        texel[axis] = std::bit_cast<std::uint32_t>(x);
      }
      texel[3] = n;
      members[i] = texel;
      group_of[n] = g;
      held[n] = generator_() % 8;
      texel[3] = 8 * g + held[n];
      modes[n] = texel;
    }
  }
  const Doubles r = random_nodes(), z = random_nodes(), before = random_nodes();
  const auto of_first = buffer(first);
  const auto of_members = buffer(members), of_modes = buffer(modes);
  const auto of_r = buffer(r), of_y = empty(18);
  const auto node = [](const Doubles& of, std::size_t n) { return Vec3(&of[4 * n]); };
  run("cg_restrict", {&of_first, &of_members, &of_r, &of_y}, {}, 3, factory_->summing_group());
  const Doubles y = read(of_y, 18);
  for (std::uint32_t g = 0; g < 3; ++g) {
    Vec3 force = Vec3::Zero(), moment = force, force_size = force, moment_size = force;
    for (std::uint32_t i = first[g]; i < first[g + 1]; ++i) {
      const Vec3 rn = node(r, order[i]), x = places[order[i]];
      force += rn;
      force_size += rn.cwiseAbs();
      moment += x.cross(rn);
      const Vec3 a = x.cwiseAbs(), b = rn.cwiseAbs();
      moment_size +=
          Vec3(a[1] * b[2] + a[2] * b[1], a[2] * b[0] + a[0] * b[2], a[0] * b[1] + a[1] * b[0]);
    }
    const double units = static_cast<double>(first[g + 1] - first[g]) + 2;
    for (Index k = 0; k < 3; ++k) {
      const std::size_t at = 6 * g + static_cast<std::size_t>(k);
      EXPECT_LE(std::abs(y[at] - force[k]), units * kEps64 * force_size[k]);
      EXPECT_LE(std::abs(y[at + 3] - moment[k]), units * kEps64 * moment_size[k]);
    }
  }

  const Doubles w = random_values(3 * 8);
  const auto of_w = buffer(w), of_z = buffer(z), of_before = buffer(before);
  vulkan::Buffer of_state;
  const double ratio = state(of_state).ratio = 0.37;
  for (const bool starts : {true, false}) {
    const auto direction = zeros(4 * kNodes);
    shaders::CgPush push{};
    push.first = starts ? 1 : 0;
    run("cg_direction", {&of_state, &of_z, &of_w, &of_modes, &of_before, &direction}, push,
        kGroups);
    const Doubles p = read(direction, 4 * kNodes);
    for (std::size_t n = 0; n < kNodes; ++n) {
      Vec3 moved = Vec3::Zero(), size = Vec3::Zero();
      if (group_of[n] != shaders::kHeld) {
        const Vec3 shift(&w[8 * group_of[n]]), turn(&w[8 * group_of[n] + 4]);
        moved = shift + turn.cross(places[n]);
        const Vec3 a = turn.cwiseAbs(), b = places[n].cwiseAbs();
        size = shift.cwiseAbs() + Vec3(a[1] * b[2] + a[2] * b[1], a[2] * b[0] + a[0] * b[2],
                                       a[0] * b[1] + a[1] * b[0]);
      }
      for (Index axis = 0; axis < 3; ++axis) {
        if (held[n] >> axis & 1) moved[axis] = size[axis] = 0;
        double expected = node(z, n)[axis] + moved[axis];
        double most = std::abs(node(z, n)[axis]) + size[axis];
        if (!starts) {
          expected += ratio * node(before, n)[axis];
          most += std::abs(ratio * node(before, n)[axis]);
        }
        // A cross product, three sums, a product.
        EXPECT_LE(std::abs(p[4 * n + static_cast<std::size_t>(axis)] - expected),
                  6 * kEps64 * most);
      }
      EXPECT_EQ(p[4 * n + 3], 0);
    }
  }
}

/// A body of more nodes than 64 groups have has more of them. Their matrix stays as it was made as
/// long as no piece comes off: a new route of the same body takes hardly fewer iterations.
TEST_P(RigidKernels, ALargeSecondLevelOutlivesACut) {
  Scene scene;
  scene.mesh = structured_board({60, 60, 2});
  scene.materials["board"] = {5, 0.4, 2.0};
  scene.supports.push_back({Box{Vec3(-1, 9.9, -1), Vec3(11, 11, 2)}, Axes{7}});
  fem::DamagedBody body(std::make_shared<const Problem>(scene));
  const auto iterations_of = [&](gpu::CgRoute& route, gpu::Fields& fields, Index dof) {
    std::vector<double> force(fields.rows(), 0.0);
    force[static_cast<std::size_t>(dof)] = 1e-3;
    fields.set_load(force, {});
    return route.solve({}, 0, true);
  };
  gpu::Fields fields(*factory_, body.problem(), all_needs(), {0, true});
  gpu::CgRoute route(*factory_, body, fields);
  EXPECT_LT(iterations_of(route, fields, 0), 200);
  const Mesh& mesh = body.problem().mesh();
  std::vector<Index> all;
  for (int column = 0; column < 55; ++column) {  // of 60, across the middle
    std::vector<Index> gone;
    for (Index e = 0; e < mesh.tet_count(); ++e) {
      Vec3 middle = Vec3::Zero();
      for (Index n : mesh.tets[static_cast<std::size_t>(e)])
        middle += mesh.nodes[static_cast<std::size_t>(n)] / 4;
      const bool here = static_cast<int>(middle.x() * 6) == column;
      if (here && static_cast<int>(middle.y() * 6) == 30) gone.push_back(e);
    }
    ASSERT_FALSE(gone.empty());
    all.insert(all.end(), gone.begin(), gone.end());
    body.destroy(gone);
    fields.destroy(gone, body.scale());
    route.destroy(gone);
  }
  gpu::Fields anew(*factory_, body.problem(), all_needs(), {0, true});
  anew.destroy(all, body.scale());
  gpu::CgRoute fresh(*factory_, body, anew);
  EXPECT_LE(iterations_of(route, fields, 0), 1.1 * iterations_of(fresh, anew, 0));
}

INSTANTIATE_TEST_SUITE_P(All, RigidKernels,
                         testing::Values(Numbers{gpu::Variant::gpu, true},
                                         Numbers{gpu::Variant::lvp, true}),
                         [](const auto& tested) { return name_of(tested.param); });

}  // namespace
}  // namespace sunder::test
