// SPDX-License-Identifier: Apache-2.0
// What an event costs a host that draws on its own device, counted at its queue, on memory that is
// not mapped.
#include <cstdlib>

#include "api/vulkan_options.hpp"
#include "sunder/problem.hpp"
#include "sunder/simulation.hpp"
#include "support/structured_board.hpp"

namespace sunder::test {
namespace {

std::shared_ptr<const Problem> held_board() {
  Scene scene;
  scene.mesh = structured_board({6, 6, 2, 10, 10, 1});
  scene.materials["board"] = {5.0, 0.4, 2.0};
  scene.supports.push_back({Box{Vec3(-1, 9.99, -1), Vec3(11, 10.01, 2)}, Axes{7}});
  const Box corner{Vec3(9.99, -0.01, -1), Vec3(10.01, 0.01, 2)};
  scene.instruments.push_back({"forceps", Pull{corner, Vec3(0, -1, 0)}, {}});
  scene.fracture.model = FractureModel::a;
  scene.solver.route = Route::inverse;
  scene.solver.backend = "vulkan";
  return std::make_shared<const Problem>(std::move(scene));
}

// The frame's own submit and that of what is drawn: nothing waits for a copy of its own.
TEST(DrawnEvent, IsTwoSubmitsAndNoAllocation) {
  if (std::getenv("SUNDER_EXPECT_NO_VULKAN")) {
    GTEST_SKIP() << "no Vulkan device is expected";
  }
  for (const std::size_t of_an_event : {1, 5}) {
    SCOPED_TRACE(of_an_event);
    const VulkanHost host;
    const auto problem = held_board();
    gpu::VulkanOptions options = options_of(host);
    std::size_t allocations = 0;
    options.probe.as_gpu = true;
    options.probe.allocations = &allocations;
    const auto backend = gpu::create(problem, needs_of(*problem), options);
    gpu::Display& display = *gpu::display_of(*backend);
    Load load;
    const auto& nodes = problem->instrument_nodes().front().nodes;
    for (Index n : nodes) {
      load.force_dofs.push_back(problem->dof(n, 1));
      load.forces.push_back(-1);
    }
    const auto frame = [&] {
      backend->set_load(load);
      static_cast<void>(backend->solve());
      static_cast<void>(backend->stress());
      display.submit({});
      display.finish();
    };
    frame();
    for (std::size_t event = 0; event < 4; ++event) {
      std::vector<Index> leave;
      for (std::size_t i = 0; i < of_an_event; ++i) {
        leave.push_back(static_cast<Index>(100 + event * of_an_event + i));
      }
      const int submits = VulkanHost::calls.submits;
      const std::size_t allocated = allocations;
      backend->destroy(leave);
      frame();
      EXPECT_EQ(VulkanHost::calls.submits - submits, 2) << "event " << event;
      EXPECT_EQ(allocations, allocated) << "event " << event;
    }
  }
}

}  // namespace
}  // namespace sunder::test
