// SPDX-License-Identifier: Apache-2.0
// A new base's inverse on the device, from the last one: against the damaged body's own inverse,
// and under route inverse.
#include <numeric>

#include "agreement.hpp"
#include "gpu/host_base.hpp"
#include "gpu/inverse_route.hpp"
#include "linear_algebra/factor.hpp"
#include "on_device.hpp"

namespace sunder::test {
namespace {

using Inversion = WithVulkan<>;

/// Held at its upper edge.
Scene held(const Mesh& mesh) {
  Scene scene;
  scene.mesh = mesh;
  scene.materials["board"] = {5, 0.45, 2.0};
  scene.supports.push_back({Box{Vec3(-1, 9.9, -1), Vec3(51, 11, 3)}, Axes{7}});
  return scene;
}
/// Some 300 unknowns, no multiple of 64.
Scene board_of_300() { return held(structured_board({8, 5, 1})); }

/// Its damage over the inverse of the whole, and what that is on the device.
struct Damaged300 {
  Damaged300(OnDevice& device, std::size_t panel_bytes, Index every = 1)
      : problem(std::make_shared<const Problem>(board_of_300())),
        body(problem),
        n(problem->dof_count()),
        rows(gpu::round_up(static_cast<std::uint32_t>(n), shaders::kRowPad)),
        inverse(*device.factory, n, rows, panel_bytes),
        columns(*device.factory, rows) {
    const auto host = std::make_shared<const gpu::HostInverse>(*problem, false);
    gpu::upload_inverse(*host, inverse);
    auto base = std::make_unique<gpu::HostBase>(host);
    const gpu::HostBase& of = *base;
    solver::Deferred deferred(*problem, std::move(base));
    for (Index e = 0; e < problem->tet_count();
         e += 6 * every) {  // of a cell one: no node is loose
      body.destroy({&e, 1});
      EXPECT_TRUE(deferred.destroy({&e, 1}));
    }
    deferred.copy_damage(damage);
    // Columns of loads lie among them, as a route has them.
    const Index half = of.count() / 2, other = 5;
    columns.append(of.columns().leftCols(half));
    columns.append(host->columns({&other, 1}));
    columns.append(of.columns().middleCols(half, of.count() - half));
    for (Index i = 0; i < of.count(); ++i) places.push_back(i < half ? i : i + 1);
  }
  [[nodiscard]] Eigen::MatrixXd whole() const {
    std::vector<Index> all(static_cast<std::size_t>(n));
    std::iota(all.begin(), all.end(), 0);
    Eigen::MatrixXd x(n, n);
    inverse.read_columns(all, x);
    return x;
  }

  std::shared_ptr<const Problem> problem;
  fem::DamagedBody body;
  Index n;
  std::uint32_t rows;
  gpu::DenseInverse inverse;
  gpu::ExactColumns columns;
  std::vector<Index> places;
  solver::DamageMatrices damage;
};

TEST_F(Inversion, AnUpdateIsTheDamagedBodysInverse) {
  for (const gpu::Variant variant : {gpu::Variant::gpu, gpu::Variant::lvp}) {
    Eigen::MatrixXd first;
    for (const std::size_t panel_bytes : {std::size_t{0}, std::size_t{64} * 512 * 8}) {
      for (const std::size_t parts : {1, 3, 50}) {
        SCOPED_TRACE(std::to_string(parts) + " parts, panels of " + std::to_string(panel_bytes));
        OnDevice device(variant, true);
        Damaged300 torn(device, panel_bytes);
        ASSERT_GT(torn.places.size(), 64u);
        ASSERT_NE(torn.places.size() % 64, 0u);
        gpu::InverseUpdate update(*device.factory, torn.n, torn.rows, panel_bytes, 32);
        update.begin(torn.inverse, torn.columns, torn.places, torn.damage, parts);
        const Eigen::MatrixXd before = torn.whole();
        for (std::size_t i = 0; i + 1 < parts; ++i) update.advance();
        EXPECT_EQ((torn.whole() - before).norm(), 0) << "frames still read the last one";
        EXPECT_FALSE(update.finished());
        update.finish();
        EXPECT_TRUE(update.finished());
        update.hand_over(torn.inverse);
        EXPECT_FALSE(update.in_work());
        const Eigen::MatrixXd x = torn.whole(),
                              expected = linear_algebra::Factor(torn.body.stiffness()).inverse();
        EXPECT_GT((before - expected).norm(), 1e-2 * expected.norm());
        EXPECT_LE((x - expected).norm(), 1e-11 * expected.norm());
        EXPECT_LE((x - x.transpose()).norm(), 1e-14 * x.norm());
        if (first.size() == 0) first = x;
        EXPECT_EQ((x - first).norm(), 0) << "the same bits however it is divided up";
      }
    }
  }
}

// With the room of one of more columns, which was given up.
TEST_F(Inversion, AnUpdateServesAgain) {
  OnDevice device(gpu::Variant::lvp, true);
  Damaged300 torn(device, 0), less(device, 0, 3);
  ASSERT_LT(less.places.size() + 64, torn.places.size());
  gpu::InverseUpdate update(*device.factory, torn.n, torn.rows, 0, 100);
  update.begin(torn.inverse, torn.columns, torn.places, torn.damage, 4);
  const std::size_t submits = device.device->queue().submits();
  update.advance();
  EXPECT_EQ(device.device->queue().submits(), submits + 1);
  update.drop();
  EXPECT_FALSE(update.in_work());
  for (Damaged300* one : {&torn, &less}) {
    update.begin(one->inverse, one->columns, one->places, one->damage, 4);
    update.finish();
    update.hand_over(one->inverse);
    const Eigen::MatrixXd expected = linear_algebra::Factor(one->body.stiffness()).inverse();
    EXPECT_LE((one->whole() - expected).norm(), 1e-11 * expected.norm());
  }
}

TEST_F(Inversion, AnInverseThatIsNotTheBasesIsNotRead) {
  OnDevice device(gpu::Variant::lvp, true);
  Damaged300 torn(device, 0);
  const auto intact = std::make_shared<const gpu::HostInverse>(*torn.problem, false),
             damaged = std::make_shared<const gpu::HostInverse>(
                 std::make_shared<const linear_algebra::Factor>(torn.body.stiffness()), false,
                 linear_algebra::FactorWork{});
  for (const auto& of : {intact, damaged}) {
    gpu::HostBase base(of);
    base.keep_columns();
    EXPECT_EQ(base.try_device(torn.inverse), of == intact);
  }
}

/// A tear that goes on over several bases of route inverse, whose inverse the device has.
struct LongTear {
  explicit LongTear(gpu::Variant variant, VkDeviceSize memory = 0)
      : device(variant, true, memory),
        problem(std::make_shared<const Problem>(held(structured_board({20, 9, 1})))),
        body(problem),
        fields(*device.factory, *problem, needs_of(*problem)),
        route(*device.factory, body, fields,
              std::make_shared<const gpu::HostInverse>(*problem, false),
              {.on_device = true, .fp64 = true}, true),
        load(pull(*problem, {0}, Vec3(0, -1, 0))),
        order(scattered_sequence(*problem, 200)),
        f(Eigen::VectorXd::Zero(problem->dof_count())) {
    for (std::size_t i = 0; i < load.forces.size(); ++i) f[load.force_dofs[i]] = load.forces[i];
    fields.set_load({f.data(), static_cast<std::size_t>(f.size())}, {});
  }
  void tear(std::size_t until) {
    for (; done < until; ++done) {
      const std::span<const Index> one(&order[done], 1);
      body.destroy(one);
      fields.destroy(one, body.scale());
      route.destroy(one);
      route.solve(load, 0, false);
      if (!columns_there()) ++without;
      const solver::Deferred* made = route.update()->made();
      if (!made) continue;
      ++catching_up;
      if (!static_cast<const gpu::HostBase&>(made->base()).reads_device()) ++without;
    }
  }
  /// Until a base is being made, or until it is made and lacks events.
  void tear_until(bool made) {
    const auto there = [&] {
      return made ? route.update()->made() != nullptr : route.update()->coming_events().has_value();
    };
    while (!there()) tear(done + 1);
  }
  [[nodiscard]] bool renews() const {
    return std::ranges::any_of(route.buffers(), [](const BufferPlan& b) {
      return b.name == "inverse of the next base (device)";
    });
  }
  /// A force on every unknown, which no exact columns are held for.
  void load_all() {
    f.setConstant(1e-3);
    load.force_dofs.resize(static_cast<std::size_t>(f.size()));
    std::iota(load.force_dofs.begin(), load.force_dofs.end(), 0);
    load.forces.assign(load.force_dofs.size(), 1e-3);
    fields.set_load({f.data(), static_cast<std::size_t>(f.size())}, {});
  }
  void grasp(const std::vector<Index>& dofs) {
    body.grip(dofs, {});
    fields.grip(body.forms().gripped(), body.scale());
    fem::Event event;
    event.grasp = dofs;
    route.grip(event);
    load.displacements.assign(dofs.size(), 0.0);
    fields.set_load({f.data(), static_cast<std::size_t>(f.size())}, load.displacements);
  }
  [[nodiscard]] bool columns_there() const {
    solver::FrameShape shape;
    route.add_to(shape);
    return shape.columns_there;
  }
  [[nodiscard]] Eigen::VectorXd u() {
    std::vector<Index> all(static_cast<std::size_t>(f.size()));
    std::iota(all.begin(), all.end(), 0);
    return fields.read_unknowns(gpu::Field::displacement, all);
  }
  /// Of the body as it is, by a factor of its own.
  [[nodiscard]] double error() {
    const Eigen::VectorXd expected = linear_algebra::Factor(body.stiffness()).solve(f);
    return (u() - expected).norm() / expected.norm();
  }

  OnDevice device;
  std::shared_ptr<const Problem> problem;
  fem::DamagedBody body;
  gpu::Fields fields;
  gpu::InverseRoute route;
  Load load;
  std::vector<Index> order;
  Eigen::VectorXd f;
  // Events; those whose columns the device does not have; those after which a base lacks some.
  std::size_t done = 0, without = 0, catching_up = 0;
};

// Without a new base there would be 1,200 columns at the end, and without its inverse on the device
// the host would solve for those of each event.
TEST_F(Inversion, ATearGoesOnOverNewBases) {
  LongTear tear(gpu::Variant::lvp), again(gpu::Variant::lvp), other(gpu::Variant::gpu);
  for (LongTear* one : {&tear, &again, &other}) {
    ASSERT_TRUE(one->renews());
    std::size_t bases = 1;
    while (one->done < one->order.size()) {
      one->tear(one->done + 1);
      if (static_cast<std::size_t>(one->route.update()->bases()) == bases) continue;
      ++bases;  // it has just come
      EXPECT_LE(one->error(), kIntactTolerance);
    }
    EXPECT_GE(bases, 3u);
    EXPECT_LT(one->route.update()->deferred().rank(), 800);
    EXPECT_GT(one->catching_up, 20u);
    EXPECT_EQ(one->without, 0u);
    EXPECT_LE(one->error(), kIntactTolerance);
  }
  EXPECT_EQ((tear.u() - again.u()).norm(), 0);
}

// Until a wide load needs its inverse; then bases are made anew again.
TEST_F(Inversion, ABaseThatComesBetweenHasColumnsOfItsFactor) {
  for (const bool catching_up : {false, true}) {
    LongTear tear(gpu::Variant::lvp);
    const auto& update = *tear.route.update();
    tear.tear_until(catching_up);
    tear.tear(tear.done + 2);
    ASSERT_EQ(update.made() != nullptr, catching_up);
    ASSERT_TRUE(tear.route.rebase());
    tear.tear(tear.done + 50);
    EXPECT_FALSE(tear.columns_there());
    EXPECT_GT(update.deferred().rank(), 256);
    EXPECT_FALSE(update.coming_events().has_value());
    EXPECT_LE(tear.error(), kIntactTolerance);
    tear.load_all();
    tear.tear(tear.done + 2);
    EXPECT_TRUE(tear.columns_there());
    EXPECT_TRUE(update.coming_events().has_value());
    EXPECT_LE(tear.error(), kIntactTolerance);
  }
}

TEST_F(Inversion, WhereMemoryIsShortNoBaseIsMadeAnew) {
  VkDeviceSize memory = 0;
  for (const bool is_short : {false, true}) {
    LongTear tear(gpu::Variant::lvp, memory);
    EXPECT_EQ(tear.renews(), !is_short);
    memory = tear.device.device->held_bytes() / 3 * 2;
    if (!is_short) continue;
    tear.tear(60);
    EXPECT_GT(tear.route.update()->deferred().rank(), 256);
    EXPECT_FALSE(tear.route.update()->coming_events().has_value());
    EXPECT_EQ(tear.without, 0u);
    EXPECT_LE(tear.error(), kIntactTolerance);
  }
}

// Grips are unit vectors of the bases above; the inverse knows nothing of them.
TEST_F(Inversion, AGripTakesHoldWhileABaseIsMade) {
  for (const bool catching_up : {false, true}) {
    LongTear tear(gpu::Variant::lvp);
    const auto& update = *tear.route.update();
    tear.tear_until(catching_up);
    tear.grasp({1, 5, 9});
    const int bases = update.bases();
    while (update.bases() == bases) tear.tear(tear.done + 1);
    EXPECT_EQ(tear.without, 0u);
    const Eigen::VectorXd u = tear.u();
    for (Index d : {1, 5, 9}) EXPECT_NEAR(u[d], 0, 1e-9 * u.norm());
  }
}

}  // namespace
}  // namespace sunder::test
