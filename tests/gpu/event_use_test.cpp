// SPDX-License-Identifier: Apache-2.0
// What an event takes of its device, on memory that the host does not map: submits, allocations and
// what is recorded, from the change to the stress after it and to what a host reads.
#include <algorithm>
#include <numeric>

#include "device_use.hpp"
#include "support/table1_board.hpp"

namespace sunder::test {
namespace {

// Memory that the host does not map; `maps`: that it writes directly and reads by copies.
struct Unmapped {
  explicit Unmapped(Route route, Scene scene = held_board())
      : Unmapped(Way{.route = route}, std::move(scene)) {}
  explicit Unmapped(Way way, Scene scene = held_board(), bool maps = false) {
    if (way.route == Route::cg) way.update = Update::automatic;
    problem = problem_for(std::move(scene), way);
    gpu::VulkanOptions options = watched(way);
    options.probe.as_gpu = true;
    options.probe.maps = maps;
    options.probe.allocations = &allocations;
    if (way.inverts) options.invert_on_device = true;
    options.probe.no_float64 = !way.float64;
    options.region_on_device = way.region;
    options.damage_on_device = way.damage;
    backend = gpu::create(problem, needs_with(true), options);
  }
  SolveReport frame(const Vec3& force) {
    backend->set_load(pull(*problem, nodes_in(problem->mesh(), lower_right_corner()), force));
    const SolveReport report = backend->solve();
    static_cast<void>(backend->stress());
    return report;
  }
  [[nodiscard]] gpu::DeviceUse use() const { return gpu::device_use(*backend); }

  std::shared_ptr<const Problem> problem;
  std::size_t allocations = 0;
  std::unique_ptr<Backend> backend;
};

// From the change to the stress after it: what must cross to the device rides in the frame's own
// submit. A refinement is one more: the residual comes with the solution, and what corrects that is
// added with its own estimate. 100 elements at once take two where the base is the whole body's,
// and one of the region. Memory that the host maps has the same bits.
TEST_F(DeviceUse, AnEventIsOneSubmitAndNoAllocation) {
  for (const Route route : {Route::inverse, Route::condensed}) {
    for (const std::size_t of_an_event : {1, 10, 100}) {
      SCOPED_TRACE(std::string(route == Route::inverse ? "inverse" : "condensed") + ", elements " +
                   std::to_string(of_an_event));
      Unmapped unmapped(route), mapped({.route = route}, held_board(), true);
      for (Unmapped* of : {&unmapped, &mapped}) {
        of->frame(Vec3(0, -10, 0));
        const auto crack = crack_sequence(*of->problem, 3 * of_an_event, 10);
        for (std::size_t event = 0; event < 3; ++event) {
          const std::size_t submits = of->use().submits, allocated = of->allocations,
                            solved = of->use().host_solves;
          of->backend->destroy({crack.data() + event * of_an_event, of_an_event});
          of->frame(Vec3(0, -10, 0));
          const std::size_t expected = of_an_event < 100 ? 1 : route == Route::inverse ? 3 : 2;
          EXPECT_EQ(of->use().submits - submits, expected) << "event " << event;
          EXPECT_EQ(of->allocations, allocated) << "event " << event;
          // A hundred elements at once take checks or a refinement, and a thread makes a base.
          if (of_an_event == 100) continue;
          EXPECT_EQ(of->use().host_solves, solved) << "event " << event;
        }
      }
      EXPECT_EQ(Pair::displacement(*mapped.backend), Pair::displacement(*unmapped.backend));
    }
  }
}

// The first large event after small ones, whose residuals no one has fetched: it is read in a
// submit of its own, once.
TEST_F(DeviceUse, ARefinementGoesByTheResidualOfItsOwnState) {
  Unmapped body(Route::inverse);
  Pair reference(held_board(), {});
  const auto crack = crack_sequence(*body.problem, 102, 10);
  body.frame(Vec3(0, -10, 0));
  for (std::size_t first = 0; first < 102;) {
    const std::size_t count = first < 2 ? 1 : 100, submits = body.use().submits;
    const std::span elements(crack.data() + first, count);
    body.backend->destroy(elements);
    reference.reference->destroy(elements);
    const SolveReport report = body.frame(Vec3(0, -10, 0));
    EXPECT_EQ(report.back_solves, count == 1 ? 1 : 3);
    EXPECT_EQ(body.use().submits - submits, count == 1 ? 1u : 4u);
    first += count;
  }
  reference.reference->set_load(
      pull(*body.problem, nodes_in(body.problem->mesh(), lower_right_corner()), Vec3(0, -10, 0)));
  static_cast<void>(reference.reference->solve());
  EXPECT_LE(displacement_error(body.problem->mesh(), body.backend->destroyed(),
                               Pair::displacement(*body.backend),
                               Pair::displacement(*reference.reference)),
            kCrackTolerance);
}

// Without shaderFloat64 the host sums the residual, of a displacement that comes with the frame.
TEST_F(DeviceUse, AnEventWithoutFloat64IsOneSubmit) {
  Scene scene = held_board();
  scene.solver.tolerance = 1e-3;
  Unmapped body(Way{.precision = Precision::fp32, .float64 = false}, std::move(scene));
  body.frame(Vec3(0, -10, 0));
  const auto crack = crack_sequence(*body.problem, 3, 10);
  for (const Index e : crack) {
    const std::size_t submits = body.use().submits, allocated = body.allocations;
    body.backend->destroy({&e, 1});
    const SolveReport report = body.frame(Vec3(0, -10, 0));
    EXPECT_EQ(report.back_solves, 1);
    EXPECT_EQ(body.use().submits - submits, 1u);
    EXPECT_EQ(body.allocations, allocated);
  }
}

// What a haptic loop reads after a frame: some nodes, and the forces of the grips.
TEST_F(DeviceUse, NodesAndReactionsAreReadInOneSubmitEach) {
  for (const Route route : {Route::inverse, Route::condensed, Route::cg}) {
    SCOPED_TRACE(static_cast<int>(route));
    Scene scene = held_board();
    scene.instruments.push_back(
        {"grip",
         Grip{Box{Vec3(20, -0.001, -1), Vec3(51, 0.001, 3)}, Vec3(0.5, -2, 0), Axes{7}},
         {}});
    Unmapped body(route, std::move(scene));
    std::vector<Index> nodes(64);
    std::iota(nodes.begin(), nodes.end(), 0);
    std::vector<Vec3> u(nodes.size());
    std::vector<double> reactions(body.problem->gripped_dofs().size());
    std::vector<double> held(reactions.size(), 0.1);
    const auto crack = crack_sequence(*body.problem, 3, 10);
    for (std::size_t event = 0; event < 3; ++event) {
      body.backend->destroy({&crack[event], 1});
      Load load = pull(*body.problem, nodes_in(body.problem->mesh(), lower_right_corner()),
                       Vec3(0, -10, 0));
      load.displacements = held;
      body.backend->set_load(load);
      static_cast<void>(body.backend->solve());
      static_cast<void>(body.backend->stress());
      const std::size_t allocated = body.allocations;
      const auto submits_of = [&](auto&& read) {
        const std::size_t before = body.use().submits;
        read();
        return body.use().submits - before;
      };
      for (const std::size_t count : {1, 2, 64}) {
        EXPECT_LE(submits_of([&] {
                    body.backend->read_displacement(std::span(nodes).first(count),
                                                    std::span(u).first(count));
                  }),
                  1u)
            << count << " nodes";
      }
      EXPECT_LE(submits_of([&] { body.backend->read_reactions(reactions); }), 1u);
      EXPECT_EQ(body.allocations, allocated) << "event " << event;
    }
    const std::vector<double> all = Pair::displacement(*body.backend);
    for (std::size_t i = 0; i < nodes.size(); ++i) {
      for (int axis = 0; axis < 3; ++axis) EXPECT_EQ(u[i][axis], all[3 * i + axis]);
    }
  }
}

// Where a part turns far for its strain the residual is summed element by element on the host,
// which has the displacement for it in place of the device's residual: the first time in a submit
// of its own, which nobody could know of. The last addition but one left what is rounding's, so
// that another was not foreseen and has its own submit too.
TEST_F(DeviceUse, ACheckByElementsTakesNoMoreSubmitsThanAnother) {
  Unmapped body(Route::inverse);
  body.frame(Vec3(0, -10, 0));
  auto cut = elements_across(body.problem->mesh(), 26.5);
  cut.pop_back();
  const std::size_t submits = body.use().submits, allocated = body.allocations,
                    read = gpu::bytes_read(*body.backend);
  body.backend->destroy(cut);
  const SolveReport report = body.frame(Vec3(0, -10, 0));
  const auto checks = static_cast<std::size_t>(report.back_solves) - 1;
  EXPECT_GE(checks, 2u);
  EXPECT_EQ(body.use().submits - submits, 1 + checks + 2);
  EXPECT_EQ(body.allocations, allocated);
  EXPECT_GE(gpu::bytes_read(*body.backend) - read,
            checks * 4 * sizeof(double) * body.problem->mesh().nodes.size())
      << "not every check was by elements";
}

// Of an inverse that the device has computed the host has no columns: those that are new come in a
// submit before, and no factor solves for them. With frames a hundred times stiffer, as of this
// board, the inverse was refined when it was made.
TEST_F(DeviceUse, AnEventOfAnInverseFromTheDeviceIsTwoSubmits) {
  for (const std::size_t of_an_event : {1, 10, 100}) {
    SCOPED_TRACE(std::to_string(of_an_event) + " elements");
    Unmapped body(Way{.inverts = true});
    body.frame(Vec3(0, -10, 0));
    const auto crack = crack_sequence(*body.problem, 3 * of_an_event, 10);
    const std::size_t events = of_an_event < 100 ? 3 : 1;  // 200 make a new base
    for (std::size_t event = 0; event < events; ++event) {
      const std::size_t submits = body.use().submits, allocated = body.allocations,
                        solved = body.use().host_solves;
      body.backend->destroy({crack.data() + event * of_an_event, of_an_event});
      body.frame(Vec3(0, -10, 0));
      EXPECT_EQ(body.use().submits - submits, of_an_event < 100 ? 2u : 4u) << "event " << event;
      EXPECT_EQ(body.use().host_solves - solved, of_an_event < 100 ? 0u : 2u) << "event " << event;
      EXPECT_EQ(body.allocations, allocated) << "event " << event;
    }
  }
}

// Where the device multiplies the columns of a region, the host reads what comes of it before the
// stress: four of them, with two of stress, where 100 elements at once take a refinement.
TEST_F(DeviceUse, AProductOfTheRegionIsOneSubmitMore) {
  for (const std::size_t of_an_event : {1, 10, 100}) {
    Unmapped body({.route = Route::condensed, .region = true}), by_host(Route::condensed);
    body.frame(Vec3(0, -10, 0));
    by_host.frame(Vec3(0, -10, 0));
    const auto crack = crack_sequence(*body.problem, 3 * of_an_event, 10);
    for (std::size_t event = 0; event < 3; ++event) {
      const std::size_t submits = body.use().submits, allocated = body.allocations;
      for (const Unmapped* of : {&body, &by_host}) {
        of->backend->destroy({crack.data() + of_an_event * event, of_an_event});
      }
      body.frame(Vec3(0, -10, 0));
      EXPECT_EQ(body.use().submits - submits, of_an_event < 100 ? 2u : 6u) << "event " << event;
      EXPECT_EQ(body.allocations, allocated) << "event " << event;
      by_host.frame(Vec3(0, -10, 0));
      EXPECT_LE(displacement_error(body.problem->mesh(), body.backend->destroyed(),
                                   Pair::displacement(*body.backend),
                                   Pair::displacement(*by_host.backend)),
                kCrackTolerance);
    }
  }
}

// Its forces with three refinements are one submit, once the matrices have come over three
// solutions.
TEST_F(DeviceUse, ASolutionByTheSmallMatricesIsOneSubmitMore) {
  for (const Route route : {Route::inverse, Route::condensed}) {
    SCOPED_TRACE(route == Route::inverse ? "inverse" : "condensed");
    Unmapped body({.route = route, .damage = true}), by_host(route);
    const auto submits_more = [&] {
      const std::size_t before = body.use().submits, allocated = body.allocations,
                        of_host = by_host.use().submits;
      body.frame(Vec3(0, -10, 0));
      by_host.frame(Vec3(0, -10, 0));
      EXPECT_EQ(body.allocations, allocated);
      EXPECT_LE(displacement_error(body.problem->mesh(), body.backend->destroyed(),
                                   Pair::displacement(*body.backend),
                                   Pair::displacement(*by_host.backend)),
                kCrackTolerance);
      return body.use().submits - before - (by_host.use().submits - of_host);
    };
    EXPECT_EQ(submits_more(), 0u);
    const auto crack = crack_sequence(*body.problem, 113, 10);
    std::size_t gone = 0;
    const auto destroy = [&](std::size_t count) {
      for (const Unmapped* of : {&body, &by_host}) {
        of->backend->destroy({crack.data() + gone, count});
      }
      gone += count;
    };
    destroy(1);
    for (const std::size_t more : {0, 0, 1, 1}) EXPECT_EQ(submits_more(), more);
    for (const std::size_t count : {1, 1, 10}) {
      destroy(count);
      EXPECT_EQ(submits_more(), 1u) << count << " elements";
    }
    destroy(100);                                 // more vectors than there is room for
    for (const std::size_t solutions : {3, 1}) {  // in the first frame the region is refined
      const std::size_t more = submits_more();
      EXPECT_GE(more, 1u);
      EXPECT_LE(more, 2 * solutions) << "a fourth refinement is one more";
    }
  }
}

// Conjugate gradients of an event: a submit for every 64 iterations, of the solution and of the
// estimate of its error, and some for what goes before and after. The iterations are recorded once.
TEST_F(DeviceUse, AnEventOfConjugateGradientsTakesFewSubmits) {
  Unmapped body(Route::cg);
  body.frame(Vec3(0, -10, 0));
  const auto crack = crack_sequence(*body.problem, 100, 10);
  for (const std::size_t of_an_event : {1, 10, 89}) {
    const std::size_t submits = body.use().submits, allocated = body.allocations,
                      recorded = body.use().recorded, dispatches = body.use().dispatches;
    body.backend->destroy({crack.data() + (of_an_event == 1    ? 0
                                           : of_an_event == 10 ? 1
                                                               : 11),
                           of_an_event});
    const SolveReport report = body.frame(Vec3(0, -10, 0));
    EXPECT_GT(report.iterations, 64);
    EXPECT_LE(body.use().submits - submits, static_cast<std::size_t>(report.iterations) / 64 + 8);
    EXPECT_EQ(body.allocations, allocated);
    EXPECT_GT(body.use().dispatches - dispatches, 7 * static_cast<std::size_t>(report.iterations));
    EXPECT_LE(body.use().recorded - recorded, 64u);
  }
}

// Vectors of patches, too, ride in the frame's own submit.
TEST_F(DeviceUse, AnEventOfPooledVolumeTakesNoMoreSubmits) {
  for (const Route route : {Route::inverse, Route::cg}) {
    SCOPED_TRACE(route == Route::inverse ? "inverse" : "cg");
    Unmapped body(route, all_pooled(held_board()));
    body.frame(Vec3(0, -10, 0));
    const auto crack = crack_sequence(*body.problem, 6, 10);
    for (std::size_t event = 0; event < 3; ++event) {
      const std::size_t submits = body.use().submits, allocated = body.allocations;
      body.backend->destroy({crack.data() + 2 * event, 2});
      const SolveReport report = body.frame(Vec3(0, -10, 0));
      const auto iterations = static_cast<std::size_t>(report.iterations);
      EXPECT_LE(body.use().submits - submits, route == Route::inverse ? 1 : iterations / 64 + 8);
      EXPECT_EQ(body.allocations, allocated);
    }
  }
}

// A load that is a multiple of one that is known takes no iteration, and nothing is recorded for
// one: the dispatches left are those of a step along what is known.
TEST_F(DeviceUse, AQuietFrameOfConjugateGradientsHasNoEmptyDispatch) {
  Unmapped body(Route::cg);
  body.frame(Vec3(0, -10, 0));
  body.frame(Vec3(0, -20, 0));
  const gpu::DeviceUse before = body.use();
  const SolveReport report = body.frame(Vec3(0, -15, 0));
  EXPECT_EQ(report.iterations, 0);
  EXPECT_LE(body.use().submits - before.submits, 3u);
  EXPECT_LE(body.use().dispatches - before.dispatches, 17u);
  for (const char* of_patches : {"patch_sums", "cg_multiply_pooled", "residual_pooled"}) {
    EXPECT_FALSE(has_kernel(*body.backend, of_patches)) << of_patches;
  }
}

}  // namespace
}  // namespace sunder::test
