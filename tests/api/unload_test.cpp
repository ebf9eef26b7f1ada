// SPDX-License-Identifier: Apache-2.0
// A plugin host that loads the shared library at run time and closes it with a simulation alive:
// its threads keep the code that they run.
#include <dlfcn.h>
#include <gtest/gtest.h>

#include <chrono>
#include <cstdlib>
#include <filesystem>
#include <string>
#include <thread>
#include <vector>

#include "sunder/sunder.h"
#include "support/structured_board.hpp"

namespace sunder::test {
namespace {

/// The functions that are called, by name: nothing of the library is linked.
struct Library {
  void* handle = dlopen(SUNDER_LIBRARY, RTLD_NOW | RTLD_LOCAL);

  template <class Function>
  Function* get(Function&, const char* name) const {
    return reinterpret_cast<Function*>(dlsym(handle, name));
  }
};

#define SUNDER_GET(library, name) (library).get(name, #name)

[[noreturn]] void give_up(const std::string& why) {
  std::fprintf(stderr, "%s\n", why.c_str());
  std::_Exit(2);
}

void check(sunder_status status, const char* what) {
  if (status != SUNDER_OK) give_up(std::string(what) + ": " + std::to_string(status));
}

std::size_t threads() {
  const std::filesystem::directory_iterator tasks("/proc/self/task");
  return static_cast<std::size_t>(std::distance(begin(tasks), end(tasks)));
}

sunder_selection box(double y, double x) {
  sunder_selection s = SUNDER_SELECTION_INIT;
  s.kind = SUNDER_SELECT_BOX;
  s.min[0] = x, s.min[1] = y, s.min[2] = -1;
  s.max[0] = 10.01, s.max[1] = y + 0.02, s.max[2] = 2;
  return s;
}

sunder_scene make_scene(const Library& library) {
  sunder_scene scene = nullptr;
  check(SUNDER_GET(library, sunder_scene_create)(&scene), "scene");
  const Mesh mesh = structured_board({4, 4, 1, 10, 10, 1});
  std::vector<double> nodes;
  std::vector<std::int32_t> tets;
  for (const Vec3& x : mesh.nodes) nodes.insert(nodes.end(), x.data(), x.data() + 3);
  for (const auto& t : mesh.tets) tets.insert(tets.end(), t.begin(), t.end());
  check(SUNDER_GET(library, sunder_scene_set_mesh)(scene, nodes.data(), nodes.size(), tets.data(),
                                                   tets.size(), nullptr, 0),
        "mesh");
  sunder_material tissue = SUNDER_MATERIAL_INIT;
  tissue.young = 5, tissue.poisson = 0.4, tissue.yield = 2;
  check(SUNDER_GET(library, sunder_scene_add_material)(scene, &tissue, nullptr), "material");
  sunder_support top = SUNDER_SUPPORT_INIT;
  top.nodes = box(9.99, -0.01);
  check(SUNDER_GET(library, sunder_scene_add_support)(scene, &top), "support");
  sunder_instrument pull = SUNDER_INSTRUMENT_INIT;
  pull.nodes = box(-0.01, 9.99);
  pull.value[1] = -40;
  check(SUNDER_GET(library, sunder_scene_add_instrument)(scene, &pull, nullptr), "instrument");
  sunder_fracture_options fracture = SUNDER_FRACTURE_OPTIONS_INIT;
  fracture.model = SUNDER_FRACTURE_B;
  check(SUNDER_GET(library, sunder_scene_set_fracture)(scene, &fracture), "fracture");
  sunder_solver_options solver = SUNDER_SOLVER_OPTIONS_INIT;  // whose rebases have a thread
  solver.backend = SUNDER_BACKEND_CPU;
  solver.route = SUNDER_ROUTE_FACTOR;
  solver.update = SUNDER_UPDATE_DEFERRED;
  check(SUNDER_GET(library, sunder_scene_set_solver)(scene, &solver), "solver");
  check(SUNDER_GET(library, sunder_scene_set_steps)(scene, 100), "steps");
  return scene;
}

/// What is left of a library that was closed: a simulation whose thread runs, and its functions.
struct Closed {
  sunder_simulation simulation = nullptr;
  decltype(&sunder_simulation_step) step = nullptr;
  decltype(&sunder_simulation_destroy) destroy = nullptr;
  const Library library;

  Closed() {
    if (!library.handle) give_up(dlerror());
    const sunder_scene scene = make_scene(library);
    const std::size_t before = threads();
    check(SUNDER_GET(library, sunder_simulation_create)(scene, nullptr, &simulation), "creation");
    if (threads() <= before) give_up("the simulation has no thread of its own");
    step = SUNDER_GET(library, sunder_simulation_step);
    destroy = SUNDER_GET(library, sunder_simulation_destroy);
    check(step(simulation, nullptr), "step");
    if (dlclose(library.handle) != 0) give_up(dlerror());
    std::this_thread::sleep_for(std::chrono::milliseconds(50));  // the thread wakes meanwhile
  }
};

class CUnload : public testing::Test {
 protected:
  void SetUp() override { GTEST_FLAG_SET(death_test_style, "threadsafe"); }
};

TEST_F(CUnload, WithALiveSimulationLeavesACleanExit) {
  EXPECT_EXIT(
      {
        const Closed closed;
        std::exit(0);
      },
      testing::ExitedWithCode(0), "");
}

TEST_F(CUnload, LetsALiveSimulationGoOnAndEnd) {
  EXPECT_EXIT(
      {
        const Closed closed;
        for (int i = 0; i < 10; ++i) check(closed.step(closed.simulation, nullptr), "step");
        check(closed.destroy(closed.simulation), "destroy");
        std::exit(0);
      },
      testing::ExitedWithCode(0), "");
}

TEST_F(CUnload, AndLoadingAgainFindsTheSameHandles) {
  EXPECT_EXIT(
      {
        const Closed closed;
        const Library again;
        if (!again.handle) give_up(dlerror());
        check(SUNDER_GET(again, sunder_simulation_step)(closed.simulation, nullptr), "step");
        check(SUNDER_GET(again, sunder_simulation_destroy)(closed.simulation), "destroy");
        dlclose(again.handle);
        std::exit(0);
      },
      testing::ExitedWithCode(0), "");
}

}  // namespace
}  // namespace sunder::test
