// SPDX-License-Identifier: Apache-2.0
// A scene run along its crack, frame by frame, and the same scenes for every device that is held
// against the yardstick.
#pragma once

#include <gtest/gtest.h>

#include <algorithm>
#include <memory>
#include <utility>
#include <vector>

#include "body/pieces.hpp"
#include "cpu_reference/plain/plain.hpp"
#include "sunder/simulation.hpp"
#include "support/accuracy.hpp"
#include "support/notch_board.hpp"
#include "support/structured_board.hpp"

namespace sunder::test {

/// After a solve.
struct RunFrame {
  std::size_t fractures = 0;
  std::vector<double> displacement, reactions;
  std::vector<Voigt> stress;
};

struct WholeRun {
  std::vector<DestroyedElement> elements;
  std::vector<RunFrame> frames;
  std::vector<Deformation> deformation;  // per step
};

/// Until so many elements are destroyed, or the last step.
inline WholeRun whole_run(const std::shared_ptr<const Problem>& problem,
                          std::unique_ptr<Backend> backend, std::size_t count) {
  Simulation simulation(problem, std::move(backend));
  WholeRun run;
  const auto enough = [&] { return simulation.destroyed().size() >= count; };
  simulation.observe_events([&](std::span<const DestroyedElement>) { return !enough(); });
  simulation.observe_frames([&] {
    RunFrame frame{simulation.destroyed().size(), {}, {}, simulation.stress()};
    frame.displacement.resize(problem->dofs().size());
    frame.reactions.resize(problem->gripped_dofs().size());
    simulation.backend().read_displacement(frame.displacement);
    simulation.backend().read_reactions(frame.reactions);
    run.frames.push_back(std::move(frame));
  });
  while (!simulation.done() && !enough()) {
    run.deformation.push_back(simulation.step().deformation.value());
  }
  run.elements = simulation.destroyed();
  return run;
}

inline void expect_same_fractures(const WholeRun& right, const WholeRun& run) {
  ASSERT_EQ(run.elements.size(), right.elements.size());
  for (std::size_t i = 0; i < run.elements.size(); ++i) {
    const DestroyedElement &a = run.elements[i], &b = right.elements[i];
    SCOPED_TRACE(i);
    ASSERT_EQ(a.element, b.element);
    ASSERT_EQ(a.step, b.step);
    ASSERT_EQ(a.event, b.event);
    ASSERT_EQ(a.cause, b.cause);
    ASSERT_EQ(a.crack, b.crack);
  }
}

/// Displacement and stress of live elements that hang together with a support, and the grips'
/// forces, by the largest of each.
inline void expect_same_frames(const Problem& problem, const WholeRun& right, const WholeRun& run,
                               double along_a_crack) {
  ASSERT_EQ(run.frames.size(), right.frames.size());
  std::vector<std::uint8_t> destroyed(problem.mesh().tets.size(), 0);
  std::size_t done = 0;
  for (std::size_t f = 0; f < run.frames.size(); ++f) {
    const RunFrame &a = run.frames[f], &b = right.frames[f];
    ASSERT_EQ(a.fractures, b.fractures);
    for (; done < b.fractures; ++done) destroyed[right.elements[done].element] = 1;
    std::vector<std::uint8_t> ignored = destroyed;
    const auto pieces = find_loose_parts(problem, destroyed).pieces;
    for (const auto& piece : pieces) {
      for (Index e : piece) ignored[e] = 1;
    }
    const double tolerance =
        pieces.empty() ? along_a_crack : std::max(along_a_crack, kCutTolerance);
    SCOPED_TRACE("frame " + std::to_string(f));
    EXPECT_LE(displacement_error(problem.mesh(), ignored, a.displacement, b.displacement),
              tolerance);
    EXPECT_LE(stress_error(ignored, a.stress, b.stress), tolerance);
    double largest = 0, off = 0;
    for (std::size_t g = 0; g < b.reactions.size(); ++g) {
      largest = std::max(largest, std::abs(b.reactions[g]));
      const double difference = std::abs(a.reactions[g] - b.reactions[g]);
      if (!(difference <= off)) off = difference;
    }
    EXPECT_LE(off, tolerance * largest);
  }
}

/// A small board between stiff frames that tears from its right edge under a pull or a grip.
inline Scene tearing_board(double contrast = 100, double poisson = 0.4) {
  Scene scene;
  scene.mesh = structured_board({14, 12, 1, 50, 50, 2.5}, [](const Vec3& x) {
    return x.y() < 4 ? "bottom-frame" : x.y() < 25 ? "lower" : x.y() < 46 ? "upper" : "top-frame";
  });
  scene.materials = table1_materials();
  set_contrast(scene, contrast);
  set_poisson(scene, poisson);
  scene.supports.push_back({top_edge(), Axes{7}});
  scene.fracture.model = FractureModel::a;
  scene.steps = 20;
  return scene;
}

inline Instrument tool(decltype(Instrument::action) action) {
  Instrument instrument;
  instrument.action = std::move(action);
  instrument.ramp = Ramp{0, 1};
  return instrument;
}

inline Box right_edge(double low, double high) { return {Vec3(49.9, low, -1), Vec3(51, high, 4)}; }

struct RunCase {
  const char* name;
  Scene (*scene)();
};

inline std::vector<RunCase> run_cases() {
  return {
      {"NotchA", [] { return notch_board(FractureModel::a); }},
      {"NotchB", [] { return notch_board(FractureModel::b); }},
      {"Contrast10000",
       [] {
         Scene scene = notch_board(FractureModel::a);
         set_contrast(scene, 1e4);
         scene.instruments.front().action = Pull{lower_right_corner(), Vec3(0, -90, 0)};
         return scene;
       }},
      {"Poisson499",
       [] {
         Scene scene = tearing_board(100, 0.499);
         scene.instruments.push_back(tool(Pull{lower_right_corner(), Vec3(0, -200, 0)}));
         return scene;
       }},
      {"Grip",
       [] {
         Scene scene = tearing_board();
         scene.instruments.push_back(tool(Grip{lower_right_corner(), Vec3(0, -60, 0), Axes{2}}));
         return scene;
       }},
      {"HeldByGripsAlone",
       [] {
         Scene scene = tearing_board();
         scene.supports.clear();
         scene.instruments.push_back(tool(Grip{top_edge(), Vec3(0, 2, 0), Axes{7}}));
         scene.instruments.push_back(tool(Grip{lower_right_corner(), Vec3(0, -60, 0), Axes{7}}));
         return scene;
       }},
      {"SeveralTools", [] {
         Scene scene = tearing_board();
         scene.instruments.push_back(tool(Pull{lower_right_corner(), Vec3(0, -300, 0)}));
         scene.instruments.push_back(tool(Pull{right_edge(10, 25), Vec3(120, 0, 0)}));
         scene.instruments.push_back(
             tool(Grip{Box{Vec3(-1, -1, -1), Vec3(0.1, 0.1, 4)}, Vec3(-2, 1, 0), Axes{3}}));
         return scene;
       }}};
}

inline constexpr std::size_t kRunFractures = 60;

/// The scene by the yardstick.
inline WholeRun yardstick_run(Scene scene) {
  const auto problem = std::make_shared<const Problem>(std::move(scene));
  return whole_run(problem, plain::create(problem, needs_of(*problem)), kRunFractures);
}

}  // namespace sunder::test
