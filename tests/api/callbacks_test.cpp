// SPDX-License-Identifier: Apache-2.0
// Log, progress and cancel; what a callback may do.
#include <algorithm>
#include <cmath>
#include <stdexcept>
#include <string>

#include "api/c_scene.hpp"

namespace sunder::test {
namespace {

struct Host {
  std::vector<std::string> log;
  std::vector<sunder_progress> progress;
  int cancel_at = -1;  // call of progress
  sunder_simulation simulation = nullptr;
  sunder_status from_inside = SUNDER_OK;
  bool throws = false;

  sunder_callbacks callbacks() {
    sunder_callbacks c{};
    c.struct_size = sizeof c;
    c.log = [](void* user, std::int32_t, const char* text) {
      static_cast<Host*>(user)->log.emplace_back(text);
    };
    c.progress = [](void* user, const sunder_progress* p) {
      return static_cast<Host*>(user)->report(*p);
    };
    c.log_user = c.progress_user = this;
    return c;
  }
  std::int32_t report(const sunder_progress& p) {
    progress.push_back(p);
    if (simulation) from_inside = sunder_simulation_step(simulation, nullptr);
    if (throws && p.phase == SUNDER_PHASE_STEP) throw std::runtime_error("thrown by the host");
    return static_cast<int>(progress.size()) - 1 == cancel_at ? 1 : 0;
  }
};

class CCallbacks : public testing::Test {
 protected:
  ~CCallbacks() override { EXPECT_OK(sunder_scene_destroy(scene)); }
  sunder_status create(sunder_simulation* simulation) {
    const auto callbacks = host.callbacks();
    return sunder_simulation_create(scene, &callbacks, simulation);
  }
  Host host;
  sunder_scene scene = board_scene(SUNDER_BACKEND_CPU, 4, -400);
};

TEST_F(CCallbacks, TellPhasesEventsAndTheEngine) {
  sunder_simulation simulation = nullptr;
  ASSERT_OK(create(&simulation));
  ASSERT_EQ(host.progress.size(), 2u);
  EXPECT_EQ(host.progress[0].phase, SUNDER_PHASE_CHECK);
  EXPECT_EQ(host.progress[1].phase, SUNDER_PHASE_PREPARE);
  ASSERT_FALSE(host.log.empty());
  EXPECT_NE(host.log[0].find("backend cpu"), std::string::npos) << host.log[0];
  sunder_step step{};
  step.struct_size = sizeof step;
  ASSERT_OK(sunder_simulation_step(simulation, &step));
  ASSERT_GT(step.events, 1);
  EXPECT_EQ(host.progress.size(), 2u + static_cast<std::size_t>(step.events));
  EXPECT_EQ(host.progress.back().events, step.events);
  EXPECT_EQ(host.progress.back().destroyed, step.destroyed);
  EXPECT_EQ(host.progress.back().steps, 4);
  EXPECT_OK(sunder_simulation_destroy(simulation));
}

TEST_F(CCallbacks, TellOfStrainBeyondTheTheory) {
  sunder_simulation simulation = nullptr;
  ASSERT_OK(create(&simulation));
  sunder_step step{};
  step.struct_size = sizeof step;
  ASSERT_OK(sunder_simulation_step(simulation, &step));
  EXPECT_EQ(step.measured, 1);
  EXPECT_GT(std::abs(step.strain_max), 0.1);
  EXPECT_GT(step.rotation_max_deg, 10);
  const std::string said = "step 0 strained live tissue by over 10 %";
  EXPECT_TRUE(std::any_of(host.log.begin(), host.log.end(),
                          [&](const std::string& line) { return line.find(said) == 0; }));
  EXPECT_NE(("\n" + warnings_of(simulation)).find("\n" + said), std::string::npos);
  EXPECT_OK(sunder_simulation_destroy(simulation));
}

/// Volume of each tetrahedron six times, with its sign.
std::vector<double> volumes(const Arrays& arrays, const std::vector<double>& moved) {
  std::vector<double> all;
  for (std::size_t t = 0; t < arrays.tets.size(); t += 4) {
    const auto at = [&](std::size_t corner) {
      const auto n = static_cast<std::size_t>(3 * arrays.tets[t + corner]);
      return Vec3(arrays.nodes[n] + moved[n], arrays.nodes[n + 1] + moved[n + 1],
                  arrays.nodes[n + 2] + moved[n + 2]);
    };
    all.push_back((at(1) - at(0)).cross(at(2) - at(0)).dot(at(3) - at(0)));
  }
  return all;
}

TEST_F(CCallbacks, CountInvertedElementsAndSaySo) {
  const auto none = model(SUNDER_FRACTURE_NONE);
  ASSERT_OK(sunder_scene_set_fracture(scene, &none));
  sunder_simulation simulation = nullptr;
  ASSERT_OK(create(&simulation));
  sunder_step step{};
  step.struct_size = sizeof step;
  ASSERT_OK(sunder_simulation_step(simulation, &step));
  const Arrays arrays = board_arrays(4);
  std::vector<double> u(arrays.nodes.size());
  ASSERT_OK(sunder_simulation_displacement(simulation, u.data(), u.size()));
  const auto before = volumes(arrays, std::vector<double>(u.size())), after = volumes(arrays, u);
  int inverted = 0;
  for (std::size_t e = 0; e < before.size(); ++e) inverted += after[e] / before[e] <= 0;
  ASSERT_GT(inverted, 0);
  EXPECT_EQ(step.inverted, inverted);
  const std::string said = warnings_of(simulation);
  EXPECT_NE(said.find("turned live elements inside out"), std::string::npos) << said;
  EXPECT_NE(said.find("turned live tissue by over 10 deg"), std::string::npos) << said;
  EXPECT_OK(sunder_simulation_destroy(simulation));
}

TEST_F(CCallbacks, CancelTheCreation) {
  for (const int at : {0, 1}) {
    host.progress.clear();
    host.cancel_at = at;
    sunder_simulation simulation = nullptr;
    EXPECT_EQ(create(&simulation), SUNDER_ERROR_CANCELLED);
    EXPECT_EQ(simulation, nullptr);
  }
}

TEST_F(CCallbacks, CancelAStepAfterItsEvent) {
  host.cancel_at = 2;  // the first event
  sunder_simulation simulation = nullptr;
  ASSERT_OK(create(&simulation));
  sunder_step step{};
  step.struct_size = sizeof step;
  EXPECT_EQ(sunder_simulation_step(simulation, &step), SUNDER_ERROR_CANCELLED);
  EXPECT_EQ(step.events, 1) << "the report is filled in all the same";
  std::vector<double> u(150);
  EXPECT_OK(sunder_simulation_displacement(simulation, u.data(), u.size()));
  EXPECT_OK(sunder_simulation_step(simulation, &step)) << "the next step goes on";
  EXPECT_EQ(step.step, 1);
  EXPECT_OK(sunder_simulation_destroy(simulation));
}

TEST_F(CCallbacks, CancelFromOutsideEndsTheNextStepOnce) {
  sunder_simulation simulation = nullptr;
  ASSERT_OK(create(&simulation));
  ASSERT_OK(sunder_simulation_cancel(simulation));
  EXPECT_EQ(sunder_simulation_step(simulation, nullptr), SUNDER_ERROR_CANCELLED);
  EXPECT_OK(sunder_simulation_step(simulation, nullptr));
  EXPECT_OK(sunder_simulation_destroy(simulation));
}

TEST_F(CCallbacks, FindTheirOwnHandleBusy) {
  sunder_simulation simulation = nullptr;
  ASSERT_OK(create(&simulation));
  host.simulation = simulation;
  ASSERT_OK(sunder_simulation_step(simulation, nullptr));
  EXPECT_EQ(host.from_inside, SUNDER_ERROR_BUSY);
  host.simulation = nullptr;
  EXPECT_OK(sunder_simulation_destroy(simulation));
}

TEST_F(CCallbacks, MayEvenThrow) {
  sunder_simulation simulation = nullptr;
  ASSERT_OK(create(&simulation));
  host.throws = true;
  EXPECT_EQ(sunder_simulation_step(simulation, nullptr), SUNDER_ERROR_INTERNAL);
  EXPECT_STREQ(sunder_last_error(), "thrown by the host");
  EXPECT_OK(sunder_simulation_destroy(simulation));
}

}  // namespace
}  // namespace sunder::test
