// SPDX-License-Identifier: Apache-2.0
// A strip that a host takes hold of, by every way to compute it.
#pragma once

#include <gtest/gtest.h>

#include <map>
#include <optional>

#include "core/frame/strip.hpp"
#include "sunder/error.hpp"
#include "support/fresh_body.hpp"

namespace sunder::test {

struct LiveWay {
  const char* name;
  Route route;
  Update update = Update::automatic;
  bool patch = false;  ///< what lies below y = 3 alone can break: the region of route condensed
};
inline void PrintTo(const LiveWay& way, std::ostream* out) { *out << way.name; }
inline const std::vector<LiveWay> kLiveWays{{"inverse", Route::inverse},
                                            {"factor", Route::factor},
                                            {"condensed", Route::condensed},
                                            {"patch", Route::condensed, Update::automatic, true},
                                            {"cg", Route::cg},
                                            {"eager", Route::inverse, Update::eager}};

/// Nothing breaks by itself; held at y = 8, pulled down at y = 0 by the same force in all steps.
inline Scene live_strip(const LiveWay& way) {
  Scene scene = strip(1e9, 2, 1 << 30);
  scene.instruments[0].ramp.reset();
  scene.live = true;
  scene.fracture.model = FractureModel::none;
  if (way.patch) {
    scene.mesh = structured_board({4, 8, 1, 4, 8, 1}, [](const Vec3& at) {
      return std::string(at.y() < 3 ? "board" : "firm");
    });
    scene.materials["firm"] = {5, 0.3, {}};
    scene.fracture.model = FractureModel::a;
  }
  scene.solver.route = way.route;
  scene.solver.update = way.update;
  return scene;
}

// Nodes of the strip, 5 x 9 x 2: at the left and the right edge, and of the lower edge.
inline const std::vector<Index> kLeft{10, 15, 20, 55, 60}, kRight{19, 24, 29, 64},
    kLow{0, 2, 4, 45, 47, 49};

/// With what acts on it, so that it can be computed anew.
struct LiveRun {
  using Make = Simulation::MakeBackend;
  explicit LiveRun(Scene scene) : LiveRun(std::make_shared<const Problem>(std::move(scene))) {}
  explicit LiveRun(std::shared_ptr<const Problem> of)
      : LiveRun(of, [of] { return cpu_reference::create(of, needs_of(*of)); }) {}
  LiveRun(std::shared_ptr<const Problem> of, Make how)
      : problem(std::move(of)), make(std::move(how)), simulation(problem, make()) {
    const auto* pull = std::get_if<Pull>(&problem->scene().instruments[0].action);
    if (pull) driven = pull->force;
  }
  void keep_history() { simulation.keep_history(make); }
  void drive(const Vec3& force) {
    simulation.drive(0, force);
    driven = force;
  }
  int push(const std::vector<Index>& nodes, const Vec3& force) {
    const int id = simulation.push(nodes, force);
    pushes[id] = {nodes, force};
    return id;
  }
  void move(int id, const std::vector<Index>& nodes, const Vec3& force) {
    simulation.move(id, nodes, force);
    pushes[id] = {nodes, force};
  }
  void drop(int id) {
    simulation.drop(id);
    pushes.erase(id);
  }

  /// Computed anew, the last solution having seen all of this.
  [[nodiscard]] FreshBody fresh() const {
    std::vector<double> force(3 * problem->mesh().nodes.size(), 0.0);
    if (driven) add_force(problem->mesh(), simulation.acting_nodes(0), *driven, force);
    for (const auto& [id, of] : pushes) add_force(problem->mesh(), of.first, of.second, force);
    return FreshBody(simulation, force);
  }
  void expect_fresh(double tolerance) const { EXPECT_LE(fresh().error(), tolerance); }
  /// Its share of what the body is loaded by is at least a thousandth.
  void expect_wrench(int grip) const {
    const Wrench felt = simulation.wrench(grip),
                 anew = fresh().wrench(simulation.held_nodes(grip), simulation.centre_of(grip));
    EXPECT_LE((felt.force - anew.force).norm(), 1e-6 * (1 + anew.force.norm()));
    EXPECT_LE((felt.torque - anew.torque).norm(), 1e-6 * (1 + anew.torque.norm()));
  }

  std::shared_ptr<const Problem> problem;
  Make make;
  Simulation simulation;
  std::optional<Vec3> driven;  // of the scene's instrument, where it pulls
  std::map<int, std::pair<std::vector<Index>, Vec3>> pushes;
};

/// Throws UsageError with `why` in its sentence.
template <class Do>
void refused(Do&& act, const std::string& why) {
  try {
    act();
    ADD_FAILURE() << why;
  } catch (const UsageError& error) {
    EXPECT_NE(std::string(error.what()).find(why), std::string::npos) << error.what();
  }
}

}  // namespace sunder::test
