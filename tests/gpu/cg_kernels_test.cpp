// SPDX-License-Identifier: Apache-2.0
// Kernels of route cg by themselves: K p by the blocked matrix, intact and with destroyed elements
// patched in place, against the assembled stiffness; the rest against plain sums, within bounds
// derived from their lengths. Those of the rigid motions: rigid_kernels_test.cpp.
#include <algorithm>
#include <array>
#include <bit>
#include <limits>
#include <numeric>
#include <random>

#include "body/assembly.hpp"
#include "cg_kernels.hpp"
#include "gpu/cg_route.hpp"
#include "gpu/passes/cg_sizes.hpp"
#include "gpu/passes/fields.hpp"
#include "gpu_body.hpp"
#include "stiffness_product.hpp"

namespace sunder::test {
namespace {

TEST_P(CgKernels, MultiplyByTheDamagedStiffness) {
  Scene scene;
  scene.mesh = structured_board({7, 5, 3});
  for (Vec3& x : scene.mesh.nodes) x += 0.1 * Vec3(random(), random(), random());
  scene.materials["board"] = {5, 0.49, 2.0};
  // Nodes held along some axes only, too.
  scene.supports.push_back({Box{Vec3(-1, 9.5, -1), Vec3(11, 11, 2)}, Axes{5}});
  scene.supports.push_back({Box{Vec3(-1, -1, -1), Vec3(11, 0.5, 2)}, Axes{2}});
  const Problem problem(scene);
  gpu::Fields fields(*factory_, problem, all_needs());
  gpu::BlockMatrix matrix(*factory_, problem);
  Multiply multiply(*device_, *factory_, fields, matrix);
  std::vector<double> scale(problem.mesh().tets.size(), 1.0);
  const std::vector<Index> gone = {0, 17, 18, 19, 300, 629};
  for (const bool damaged : {false, true}) {
    if (damaged) {
      for (Index e : gone) scale[static_cast<std::size_t>(e)] = problem.scene().fracture.alpha;
      matrix.destroy(gone, scale);
    }
    const auto padded = std::size_t{matrix.groups()} * shaders::kGroup * 4;
    std::vector<double> p(padded, 0.0);
    Eigen::VectorXd x(problem.dof_count());
    for (Index n = 0; n < problem.node_count(); ++n) {
      for (int axis = 0; axis < 3; ++axis) {
        const Index d = problem.dof(n, axis);
        if (d != kNone) p[static_cast<std::size_t>(4 * n + axis)] = x[d] = uniform_(generator_);
      }
    }
    const auto [q, pq] = multiply(p);
    const linear_algebra::SparseMatrix k = fem::assemble_lower(problem, scale);
    const Eigen::MatrixXd full = Eigen::MatrixXd(k).selfadjointView<Eigen::Lower>();
    const Eigen::VectorXd expected = full * x;
    // A row sums three products for each of some 30 neighbours, each entry 24 elements or fewer.
    const Eigen::VectorXd size = full.cwiseAbs() * x.cwiseAbs();
    const double units = 3 * 30 + 24 + 16;
    for (Index n = 0; n < problem.node_count(); ++n) {
      for (int axis = 0; axis < 3; ++axis) {
        const Index d = problem.dof(n, axis);
        const double value = q[static_cast<std::size_t>(4 * n + axis)];
        if (d == kNone) {
          EXPECT_EQ(value, 0) << "held axis of node " << n;
        } else {
          EXPECT_TRUE(std::abs(value - expected[d]) <= units * kEps64 * size[d])
              << "node " << n << ": " << value << " against " << expected[d];
        }
      }
    }
    EXPECT_NEAR(pq, x.dot(expected),
                (units + static_cast<double>(x.size())) * kEps64 * x.cwiseAbs().dot(size));
  }
}

/// Steps along solutions that are known take the place of iterations, until the body is another
/// one.
TEST_P(CgKernels, ASumOfFormerLoadsTakesNoIteration) {
  Scene scene;
  scene.mesh = structured_board({7, 5, 1});
  scene.materials["board"] = {5, 0.4, 2.0};
  scene.supports.push_back({Box{Vec3(-1, 9.9, -1), Vec3(11, 11, 2)}, Axes{7}});
  scene.live = true;
  fem::DamagedBody body(std::make_shared<const Problem>(scene));
  gpu::Fields fields(*factory_, body.problem(), all_needs(), {0, true});
  gpu::CgRoute route(*factory_, body, fields);
  const auto iterations_of = [&](double a, double b, double c) {
    std::vector<double> force(fields.rows(), 0.0);
    force[0] = a;
    force[1] = b;
    force[17] = c;
    fields.set_load(force, {});
    return route.solve({}, 0, true);
  };
  for (int time = 0; time < 2; ++time) {
    EXPECT_GT(iterations_of(1e-3, 0, 0), 12);
    EXPECT_GT(iterations_of(1e-3, 2e-3, 0), 12);
    EXPECT_GT(iterations_of(0, 1e-3, -1e-3), 12);
    for (double c : {1e-3, -3e-3, 2e-5}) {
      EXPECT_EQ(iterations_of(c, -1e-3, 2e-3 - c), 0) << c;
      EXPECT_EQ(iterations_of(0, c, 0), 0) << c;
    }
    const Index gone[] = {40};
    body.destroy(gone);
    fields.destroy(gone, body.scale());
    route.destroy(gone);
  }
}

/// The iterations recorded beyond the last one that is needed do nothing.
TEST_P(CgKernels, DispatchesBeyondConvergenceAreEmpty) {
  Scene scene;
  scene.mesh = structured_board({7, 5, 1});
  scene.materials["board"] = {5, 0.4, 2.0};
  scene.supports.push_back({Box{Vec3(-1, 9.9, -1), Vec3(11, 11, 2)}, Axes{7}});
  const fem::DamagedBody body(std::make_shared<const Problem>(scene));
  gpu::Fields fields(*factory_, body.problem(), all_needs(), {0, true});
  gpu::CgRoute route(*factory_, body, fields);
  std::vector<double> force(fields.rows(), 0.0);
  const Load load{{0}, {1e-3}, {}};
  force[0] = load.forces.front();
  fields.set_load(force, {});
  const int iterations = route.solve(load, 0, true);
  EXPECT_GT(iterations, 0);
  EXPECT_NE(iterations % 64, 0) << "the recorded iterations were all needed";

  std::array<std::uint32_t, gpu::kCgSizeWords> sizes{};
  route.dispatch_sizes().read(std::span<std::uint32_t>(sizes));
  Multiply multiply(*device_, *factory_, fields, fields.matrix());
  for (std::uint32_t kind = 0; kind < shaders::kCgSizes; ++kind) {
    EXPECT_EQ(sizes[3 * kind], 0u) << "kind " << kind;
    const auto q = multiply.of_size(route.dispatch_sizes(), gpu::size_of_dispatch(kind));
    EXPECT_EQ(std::count(q.begin(), q.end(), 1.0), std::ssize(q)) << "kind " << kind;
  }
  // The same kernel by a size that is not zero.
  vulkan::Buffer one(*device_, 12, vulkan::Placement::host);
  std::fill_n(one.mapped<std::uint32_t>(), 3, 1u);
  const auto q = multiply.of_size(one, 0);
  for (std::size_t i = 0; i < q.size(); ++i) {
    if (i % 4 == 3) continue;
    EXPECT_EQ(q[i], i < 4 * shaders::kGroup ? 0.0 : 1.0) << i;
  }
}

TEST_P(CgKernels, BeginTakesWhatIsFree) {
  // Unknowns in no order; some axes held by supports, some by grips.
  Words dofs(4 * kNodes, 0), order(3 * kNodes);
  std::iota(order.begin(), order.end(), 0u);
  std::shuffle(order.begin(), order.end(), generator_);
  for (std::size_t n = 0; n < kNodes; ++n) {
    for (std::size_t axis = 0; axis < 3; ++axis) {
      const auto kind = generator_() % 5;
      dofs[4 * n + axis] = kind == 0 ? shaders::kHeld : order[3 * n + axis];
      if (kind == 1) dofs[4 * n + 3] |= 1u << axis;
    }
  }
  const Doubles residual = random_values(3 * kNodes), u = random_nodes();
  const auto of_residual = buffer(residual), of_u = buffer(u);
  const auto of_dofs = buffer(dofs);
  for (const std::uint32_t guess : {0u, 1u}) {
    const auto r = empty(4 * kNodes), p = empty(4 * kNodes), sums = empty(kNodes);
    shaders::CgPush push{};
    push.guess = guess;
    run("cg_begin", {&of_residual, &of_dofs, &of_u, &r, &p, &sums}, push, kGroups);
    Doubles expected_r(4 * kNodes, 0), expected_p(4 * kNodes, 0);
    for (std::size_t i = 0; i < 4 * kNodes; ++i) {
      const std::size_t axis = i % 4;
      if (axis == 3 || dofs[i] == shaders::kHeld || (dofs[i - axis + 3] >> axis & 1)) continue;
      expected_r[i] = residual[dofs[i]];
      if (guess == 1) expected_p[i] = u[i];
    }
    EXPECT_EQ(read(r, 4 * kNodes), expected_r);
    EXPECT_EQ(read(p, 4 * kNodes), expected_p);
    expect_parts(sums, expected_r, expected_p);
  }
}

TEST_P(CgKernels, KnownSolutionsAreTakenWhereTheyAreFree) {
  Words dofs(4 * kNodes, 0);
  for (std::size_t i = 0; i < 4 * kNodes; ++i) {
    if (i % 4 == 3) dofs[i] = static_cast<std::uint32_t>(generator_() % 8);
    if (i % 4 != 3 && generator_() % 5 == 0) dofs[i] = shaders::kHeld;
  }
  constexpr std::uint32_t kKnown = 3;
  const Doubles known = random_values(4 * kNodes * kKnown), r = random_nodes();
  const auto of_known = buffer(known), of_r = buffer(r);
  const auto of_dofs = buffer(dofs);
  for (std::uint32_t k = 0; k < kKnown; ++k) {
    const auto p = empty(4 * kNodes), sums = empty(kNodes);
    shaders::CgPush push{};
    push.groups = kGroups;
    push.known = k;
    run("cg_known", {&of_known, &of_dofs, &of_r, &p, &sums}, push, kGroups);
    Doubles expected(4 * kNodes, 0);
    for (std::size_t i = 0; i < 4 * kNodes; ++i) {
      const std::size_t axis = i % 4;
      if (axis == 3 || dofs[i] == shaders::kHeld || (dofs[i - axis + 3] >> axis & 1)) continue;
      expected[i] = known[4 * kNodes * k + i];
    }
    EXPECT_EQ(read(p, 4 * kNodes), expected);
    expect_parts(sums, r, expected);
  }
}

TEST_P(CgKernels, StepAndItsPreconditioner) {
  vulkan::Buffer of_state;
  const double a = state(of_state).length_ = 0.7321;
  const Doubles m = random_values(6 * kNodes), p = random_nodes(), q = random_nodes(),
                x = random_nodes(), r = random_nodes();
  const auto of_m = buffer(m), of_p = buffer(p), of_q = buffer(q), of_x = buffer(x),
             of_r = buffer(r), new_x = zeros(4 * kNodes), new_r = zeros(4 * kNodes),
             of_z = zeros(4 * kNodes), sums = empty(kNodes);
  run("cg_step", {&of_state, &of_m, &of_p, &of_q, &of_x, &of_r, &new_x, &new_r, &of_z, &sums}, {},
      kGroups);
  const Doubles stepped = read(new_x, 4 * kNodes), left = read(new_r, 4 * kNodes),
                z = read(of_z, 4 * kNodes);
  for (std::size_t i = 0; i < 4 * kNodes; ++i) {
    // A product and a sum; fused or not.
    EXPECT_LE(std::abs(stepped[i] - (x[i] + a * p[i])),
              kEps64 * (std::abs(x[i]) + 2 * std::abs(a * p[i])));
    EXPECT_LE(std::abs(left[i] - (r[i] - a * q[i])),
              kEps64 * (std::abs(r[i]) + 2 * std::abs(a * q[i])));
    double sum = 0, size = 0;
    const std::size_t n = i / 4, row = i % 4;
    for (std::size_t axis = 0; axis < 3 && row < 3; ++axis) {
      const std::size_t low = std::min(row, axis), high = std::max(row, axis);
      const double term = m[6 * n + low + high + (low > 0 ? 1 : 0)] * left[4 * n + axis];
      sum += term;
      size += std::abs(term);
    }
    EXPECT_LE(std::abs(z[i] - sum), 3 * kEps64 * size);
  }
  expect_parts(sums, left, z);
}

/// Of one element's tangent, with springs at the unknowns; some axes held by supports, some by
/// grips.
TEST_P(CgKernels, InversesOfTheTangentsBlocks) {
  constexpr std::uint32_t kElementNodes = 4, kUnknowns = 12;
  Eigen::Matrix<double, 9, 9> root;
  for (double& value : root.reshaped()) value = random();
  const Eigen::Matrix<double, 9, 9> t =
      root * root.transpose() + Eigen::Matrix<double, 9, 9>::Identity();
  Doubles upper;
  for (Eigen::Index b = 0; b < 9; ++b) {
    for (Eigen::Index a = 0; a <= b; ++a) upper.push_back(t(a, b));
  }
  upper.resize(std::size_t{4} * shaders::kFiniteTangent, 0.0);
  const Doubles shape = random_values(shaders::kFiniteShape);
  Doubles target(2 * kUnknowns, 0.0);
  for (std::size_t d = kUnknowns; d < target.size(); ++d) target[d] = 1 + random();
  Words dofs(4 * shaders::kGroup, shaders::kHeld);
  for (std::uint32_t i = 0; i < 4 * kElementNodes; ++i) dofs[i] = 3 * (i / 4) + i % 4;
  for (std::uint32_t n = 0; n < kElementNodes; ++n) dofs[4 * n + 3] = n == 2 ? 4 : 0;
  dofs[4 * 3 + 1] = shaders::kHeld;
  const auto of_upper = buffer(upper), of_shape = buffer(shape), of_target = buffer(target),
             inverses = zeros(6 * shaders::kGroup);
  const auto first = buffer(Words{0, 1, 2, 3, 4}), around = buffer(Words{0, 1, 2, 3}),
             of_dofs = buffer(dofs);
  const shaders::FiniteCgPush push{1, kElementNodes, kUnknowns};
  Kernels::run(*factory_->make("finite_blocks"),
               {&of_upper, &of_shape, &first, &around, &of_dofs, &of_target, &inverses}, push, 1);
  const Doubles packed = read(inverses, 6 * kElementNodes);
  for (std::uint32_t n = 0; n < kElementNodes; ++n) {
    Vec3 g = Vec3::Zero();
    for (std::size_t c = 1; c < 4; ++c) {
      const Vec3 of(&shape[3 * (c - 1)]);
      if (n == 0) g -= of;
      if (n == c) g = of;
    }
    Mat3 block = Mat3::Zero();
    for (Index a = 0; a < 9; ++a) {
      for (Index b = 0; b < 9; ++b) block(a % 3, b % 3) += t(a, b) * g[a / 3] * g[b / 3];
    }
    for (Index axis = 0; axis < 3; ++axis) {
      const auto dof = dofs[4 * n + static_cast<std::uint32_t>(axis)];
      if (dof != shaders::kHeld) block(axis, axis) += target[kUnknowns + dof];
      if (dof != shaders::kHeld && (dofs[4 * n + 3] >> axis & 1) == 0) continue;
      block.row(axis).setZero();
      block.col(axis).setZero();
      block(axis, axis) = 1e30;  // its inverse: 0
    }
    const Mat3 inverse = block.inverse();
    for (Index i = 0, k = 0; i < 3; ++i) {
      for (Index j = i; j < 3; ++j, ++k) {
        EXPECT_NEAR(packed[6 * n + static_cast<std::size_t>(k)], inverse(i, j),
                    1e-12 * inverse.norm())
            << "node " << n << ", " << i << " " << j;
      }
    }
  }
}

TEST_P(CgKernels, LengthOfAStep) {
  constexpr std::uint32_t kPacks = 301;  // no multiple of a workgroup
  constexpr double kTerms = 4 * kPacks;
  Doubles pq = random_values(4 * kPacks);
  for (double& v : pq) v = std::abs(v);
  const Doubles rp = random_values(4 * kPacks);
  const double sum = std::accumulate(pq.begin(), pq.end(), 0.0);
  double along = 0, size = 0;
  for (double v : rp) {
    along += v;
    size += std::abs(v);
  }
  const auto length = [&](const Doubles& of_pq, bool first, std::uint32_t known = 0) {
    vulkan::Buffer of_state;
    shaders::CgState& s = state(of_state);
    s.rz = 3.25;
    s.energy = 5.5;
    s.broken = 7;
    const auto pq_sums = buffer(of_pq), rp_sums = buffer(rp);
    shaders::CgPush push{};
    push.partials = kPacks;
    push.first = first ? 1 : 0;
    push.guess = known > 0 ? 2 : 1;
    push.known = known > 0 ? known - 1 : 0;
    run("cg_length", {&pq_sums, &rp_sums, &of_state}, push, 1, factory_->closing_group());
    return s;
  };
  const shaders::CgState later = length(pq, false);
  EXPECT_EQ(later.broken, 0u);
  EXPECT_NEAR(later.length_, 3.25 / sum, (kTerms + 2) * kEps64 * 3.25 / sum);
  const shaders::CgState first = length(pq, true);
  const double a = along / sum;
  const double error = kEps64 * (kTerms * size / sum + (kTerms + 2) * std::abs(a));
  EXPECT_NEAR(first.length_, a, error);
  EXPECT_NEAR(first.energy, (1 + a) * (1 + a) * sum,
              2 * std::abs(1 + a) * sum * error + (kTerms + 4) * kEps64 * (1 + a) * (1 + a) * sum);
  // Along what is known: the first one's energy, and what a further one adds.
  const double more = a * a * sum, of_more = 2 * std::abs(a) * sum * error + 4 * kEps64 * more;
  for (const std::uint32_t known : {1u, 2u}) {
    const shaders::CgState along_known = length(pq, true, known);
    EXPECT_EQ(along_known.length_, first.length_);
    EXPECT_NEAR(along_known.energy, more + (known == 2 ? 5.5 : 0),
                of_more + kTerms * kEps64 * (more + 5.5));
  }
  EXPECT_EQ(length(Doubles(4 * kPacks, 0.0), true, 2).energy, 5.5);
  // Not positive, or no number: it ends; without a guess there is no step along it.
  for (const double bad : {-1e3, kNaN, std::numeric_limits<double>::infinity()}) {
    Doubles broken = pq;
    broken[77] = bad;
    EXPECT_EQ(length(broken, false).broken, 1u) << bad;
    EXPECT_EQ(length(broken, false).length_, 0) << bad;
    EXPECT_EQ(length(broken, true).length_, 0) << bad;
    EXPECT_EQ(length(broken, true).energy, 0) << bad;
  }
  EXPECT_EQ(length(Doubles(4 * kPacks, 0.0), true).length_, 0);
}

TEST_P(CgKernels, CheckDecidesAndSetsTheSizesOfWhatFollows) {
  constexpr std::uint32_t kPacks = 301, kSolves = 1236;
  Doubles rz = random_values(4 * kPacks), terms = random_values(kSolves);
  rz[3] += 100;  // positive in all
  double sum = 0, size = 0;
  for (const Doubles* list : {&rz, &terms}) {
    for (double v : *list) {
      sum += v;
      size += std::abs(v);
    }
  }
  const double error = (4 * kPacks + kSolves) * kEps64 * size;
  struct Outcome {
    shaders::CgState state;
    Words arguments;
  };
  const auto check = [&](const Doubles& of_rz, shaders::CgState before, bool first,
                         std::uint32_t guess = 1) {
    vulkan::Buffer of_state;
    state(of_state) = before;
    const auto sums = buffer(of_rz), of_terms = buffer(terms);
    const auto arguments = buffer(Words(gpu::kCgSizeWords, 9));
    shaders::CgPush push{};
    push.groups = 50;
    push.partials = kPacks;
    push.rigid_groups = 23;
    push.rigid_solves = 17;
    push.rigid_terms = kSolves;
    push.rigid_aggregates = 7;
    push.rigid_rows = 3;
    push.elements = 31;
    push.first = first ? 1 : 0;
    push.guess = guess;
    push.reduction = 1e-3;
    run("cg_check", {&sums, &of_terms, &of_state, &arguments}, push, 1, factory_->closing_group());
    Words sizes(gpu::kCgSizeWords);
    arguments.read(std::span<std::uint32_t>(sizes));
    return Outcome{state(of_state), sizes};
  };
  const Words on = {50, 1, 1, 23, 1, 1, 17, 1, 1, 1, 1, 1, 31, 1, 1, 7, 1, 1, 3, 1, 1};
  shaders::CgState before{};
  before.iterations = 99;
  before.energy = 2 * sum;
  const auto first = check(rz, before, true);
  EXPECT_NEAR(first.state.rz, sum, error);
  EXPECT_EQ(first.state.target, 2 * sum * 1e-3);
  EXPECT_EQ(first.state.iterations, 0u);
  EXPECT_EQ(first.state.broken, 0u);
  EXPECT_EQ(first.state.running, 1u);
  EXPECT_EQ(first.arguments, on);
  // What a sum of known solutions leaves has to be a hundred times the target to be worth
  // iterations.
  EXPECT_EQ(check(rz, before, true, 2).state.running, 1u);
  before.energy = 20 * sum;
  EXPECT_EQ(check(rz, before, true).state.running, 1u);
  EXPECT_EQ(check(rz, before, true, 2).state.running, 0u);
  EXPECT_EQ(check(rz, before, false, 2).state.running, 1u);
  before.energy = 0;
  EXPECT_NEAR(check(rz, before, true).state.target, sum * 1e-3, 1e-3 * error);

  before.rz = 7;
  before.target = sum / 2;
  const auto later = check(rz, before, false);
  EXPECT_NEAR(later.state.ratio, sum / 7, error / 7 + 2 * kEps64 * sum / 7);
  EXPECT_EQ(later.state.iterations, 100u);
  EXPECT_EQ(later.state.target, sum / 2);
  EXPECT_EQ(later.state.running, 1u);
  for (std::size_t word = 0; word < gpu::kCgSizeWords; word += 3) {
    EXPECT_EQ(later.arguments[word], on[word]) << word;
  }

  const auto expect_stopped = [](const Outcome& outcome, std::uint32_t broken, const char* why) {
    EXPECT_EQ(outcome.state.running, 0u) << why;
    EXPECT_EQ(outcome.state.broken, broken) << why;
    for (std::size_t word = 0; word < gpu::kCgSizeWords; word += 3) {
      EXPECT_EQ(outcome.arguments[word], 0u) << why << ", word " << word;
    }
  };
  before.target = 2 * sum;
  expect_stopped(check(rz, before, false), 0, "converged");
  before.target = 0;
  Doubles bad = rz;
  for (const double value : {kNaN, -1e6, std::numeric_limits<double>::infinity()}) {
    bad[60] = value;
    expect_stopped(check(bad, before, false), 1, "no number or negative");
  }
  bad[60] = kNaN;
  expect_stopped(check(bad, before, true), 1, "no number at the start");
  before.broken = 1;
  expect_stopped(check(rz, before, false), 1, "broken before");
}

INSTANTIATE_TEST_SUITE_P(All, CgKernels,
                         testing::Values(Numbers{gpu::Variant::gpu, true},
                                         Numbers{gpu::Variant::lvp, true}),
                         [](const auto& tested) { return name_of(tested.param); });

}  // namespace
}  // namespace sunder::test
