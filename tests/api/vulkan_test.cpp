// SPDX-License-Identifier: Apache-2.0
// On a host's own Vulkan device: the same bits as on a device of ours, fields in buffers without
// submit or copy, typed refusals, and a host whose device survives all of it.
#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <optional>
#include <string_view>

#include "api/c_scene.hpp"
#include "api/guarded_bytes.hpp"
#include "api/vulkan_host.hpp"
#include "c/simulation.hpp"
#include "gpu/vulkan_backend.hpp"

namespace sunder::test {
namespace {

class CVulkan : public testing::Test {
 protected:
  void SetUp() override {
    if (std::getenv("SUNDER_EXPECT_NO_VULKAN")) {
      GTEST_SKIP() << "no Vulkan device is expected";
    }
    host.emplace();
    scene = board_scene(SUNDER_BACKEND_VULKAN);
  }
  void TearDown() override {
    if (!host) return;
    if (simulation) {
      EXPECT_OK(sunder_simulation_destroy(simulation));
    }
    EXPECT_OK(sunder_scene_destroy(scene));
    EXPECT_FALSE(VulkanHost::calls.nested);
    EXPECT_FALSE(VulkanHost::calls.submitted_unlocked);
    EXPECT_EQ(VulkanHost::calls.device_waits, 0);
  }
  void create() { create(host->lend()); }
  void create(const sunder_vulkan_host& lent) {
    ASSERT_OK(sunder_vulkan_create(scene, &lent, nullptr, &simulation));
  }
  void steps(int count) {
    for (int i = 0; i < count; ++i) ASSERT_OK(sunder_simulation_step(simulation, nullptr));
  }
  [[nodiscard]] sunder_vulkan_display display() const {
    sunder_vulkan_display d{};
    d.struct_size = sizeof d;
    EXPECT_OK(sunder_vulkan_get_display(simulation, &d));
    return d;
  }
  [[nodiscard]] static std::vector<double> displacement(sunder_simulation of) {
    std::vector<double> u(3 * kBoardNodes);
    EXPECT_OK(sunder_simulation_displacement(of, u.data(), u.size()));
    return u;
  }
  /// The display buffers hold what the fields are.
  void expect_shown(const std::vector<std::byte>& u, const std::vector<std::byte>& stress,
                    const std::vector<std::byte>& live) const {
    const std::vector<double> nodal = displacement(simulation);
    std::vector<double> ratio(kBoardTets);
    std::vector<std::uint8_t> destroyed(kBoardTets);
    EXPECT_OK(sunder_simulation_yield_ratio(simulation, ratio.data(), ratio.size()));
    EXPECT_OK(sunder_simulation_destroyed(simulation, destroyed.data(), destroyed.size()));
    std::vector<float> shown(4 * kBoardNodes), colour(2 * kBoardTets);
    std::vector<std::uint32_t> alive(kBoardTets);
    ASSERT_EQ(u.size(), shown.size() * 4);
    ASSERT_EQ(stress.size(), colour.size() * 4);
    ASSERT_EQ(live.size(), alive.size() * 4);
    std::memcpy(shown.data(), u.data(), u.size());
    std::memcpy(colour.data(), stress.data(), stress.size());
    std::memcpy(alive.data(), live.data(), live.size());
    for (std::size_t n = 0; n < kBoardNodes; ++n) {
      for (std::size_t axis = 0; axis < 3; ++axis) {
        EXPECT_EQ(shown[4 * n + axis], static_cast<float>(nodal[3 * n + axis]));
      }
    }
    for (std::size_t e = 0; e < kBoardTets; ++e) {
      EXPECT_EQ(alive[e], destroyed[e] ? 0u : 1u);
      // Two ways to a principal stress in fp32.
      EXPECT_NEAR(static_cast<double>(colour[2 * e + 1]), ratio[e], 1e-5 * (1 + ratio[e]));
    }
  }
  void expect_shown() const {
    const auto d = display();
    expect_shown(host->read(d.displacement), host->read(d.stress), host->read(d.live));
  }
  void record() {
    host->run(
        [&](VkCommandBuffer commands) { EXPECT_OK(sunder_vulkan_record(simulation, commands)); });
  }

  std::optional<VulkanHost> host;
  sunder_scene scene = nullptr;
  sunder_simulation simulation = nullptr;
};

TEST_F(CVulkan, GivesTheSameBitsAsADeviceOfItsOwn) {
  create();
  sunder_simulation own = nullptr;
  ASSERT_OK(sunder_simulation_create(scene, nullptr, &own));
  for (int i = 0; i < 4; ++i) {
    ASSERT_OK(sunder_simulation_step(simulation, nullptr));
    ASSERT_OK(sunder_simulation_step(own, nullptr));
    EXPECT_EQ(displacement(simulation), displacement(own)) << i;
  }
  std::int32_t count = 0;
  ASSERT_OK(sunder_simulation_event_count(simulation, &count));
  EXPECT_GT(count, 0);
  EXPECT_OK(sunder_simulation_destroy(own));
}

TEST_F(CVulkan, BringsTheFieldsToItsBuffersInTheHostsCommands) {
  create();
  for (int i = 0; i < 4; ++i) {
    steps(1);
    record();
    expect_shown();
  }
}

TEST_F(CVulkan, AddsNoSubmitAndNoCopyToTheFrame) {
  create();
  steps(1);
  record();
  const Calls before = VulkanHost::calls;
  record();
  EXPECT_EQ(VulkanHost::calls.submits, before.submits);
  EXPECT_EQ(VulkanHost::calls.copies, before.copies);
  EXPECT_EQ(VulkanHost::calls.dispatches, before.dispatches + 1);
  EXPECT_EQ(VulkanHost::calls.locks, VulkanHost::calls.submits) << "one lock a submit";
}

TEST_F(CVulkan, WritesToTheHostsBuffersAndNotBeside) {
  constexpr VkDeviceSize kBefore = 256, kAfter = 64;
  constexpr VkBufferUsageFlags kUsage =
      VK_BUFFER_USAGE_STORAGE_BUFFER_BIT | VK_BUFFER_USAGE_VERTEX_BUFFER_BIT;
  auto lent = host->lend();
  const VkDeviceSize sizes[] = {16 * kBoardNodes, 8 * kBoardTets, 4 * kBoardTets};
  sunder_vulkan_buffer* const parts[] = {&lent.displacement, &lent.stress, &lent.live};
  std::vector<VulkanHost::Memory> memory;
  for (std::size_t i = 0; i < 3; ++i) {
    memory.push_back(host->allocate(kBefore + sizes[i] + kAfter, kUsage));
    *parts[i] = {reinterpret_cast<std::uint64_t>(memory[i].buffer), kBefore, sizes[i]};
  }
  create(lent);
  EXPECT_EQ(display().stress.buffer, lent.stress.buffer);
  EXPECT_EQ(display().stress.offset, kBefore);
  steps(3);
  record();
  std::vector<std::vector<std::byte>> shown;
  for (std::size_t i = 0; i < 3; ++i) {
    const auto* bytes = static_cast<const std::byte*>(memory[i].mapped);
    shown.emplace_back(bytes + kBefore, bytes + kBefore + sizes[i]);
    const auto untouched = [](std::byte b) { return b == std::byte{0xa5}; };
    EXPECT_TRUE(std::all_of(bytes, bytes + kBefore, untouched));
    EXPECT_TRUE(std::all_of(bytes + kBefore + sizes[i], bytes + memory[i].size, untouched));
  }
  expect_shown(shown[0], shown[1], shown[2]);
  EXPECT_OK(sunder_simulation_destroy(simulation));
  simulation = nullptr;
  for (const auto& m : memory) host->free(m);
}

TEST_F(CVulkan, SubmitsBetweenTimelineSemaphores) {
  create();
  steps(1);
  const VkSemaphore wait = host->timeline(), signal = host->timeline();
  sunder_vulkan_signals signals{};
  signals.struct_size = sizeof signals;
  signals.wait_semaphore = reinterpret_cast<std::uint64_t>(wait);
  signals.wait_value = 3;
  signals.signal_semaphore = reinterpret_cast<std::uint64_t>(signal);
  signals.signal_value = 7;
  const int before = VulkanHost::calls.submits;
  ASSERT_OK(sunder_vulkan_submit(simulation, &signals));
  EXPECT_EQ(VulkanHost::calls.submits, before + 1);
  std::uint64_t value = 99;
  ASSERT_EQ(vkGetSemaphoreCounterValue(host->device, signal, &value), VK_SUCCESS);
  EXPECT_EQ(value, 0u) << "it has not waited";
  VkSemaphoreSignalInfo go{};
  go.sType = VK_STRUCTURE_TYPE_SEMAPHORE_SIGNAL_INFO;
  go.semaphore = wait;
  go.value = 3;
  ASSERT_EQ(vkSignalSemaphore(host->device, &go), VK_SUCCESS);
  VkSemaphoreWaitInfo done{};
  done.sType = VK_STRUCTURE_TYPE_SEMAPHORE_WAIT_INFO;
  done.semaphoreCount = 1;
  done.pSemaphores = &signal;
  done.pValues = &signals.signal_value;
  ASSERT_EQ(vkWaitSemaphores(host->device, &done, 10'000'000'000), VK_SUCCESS);
  expect_shown();
  // Without semaphores: the next step waits for it by itself.
  sunder_vulkan_signals none{};
  none.struct_size = sizeof none;
  ASSERT_OK(sunder_vulkan_submit(simulation, &none));
  steps(1);
  ASSERT_OK(sunder_vulkan_submit(simulation, &none));
}

TEST_F(CVulkan, RunsWithoutTheFeaturesThatItCanDoWithout) {
  VulkanHost::Options few;
  few.int64 = few.timeline = false;
  sunder_simulation there = nullptr;
  std::optional<VulkanHost> other(few);
  const auto lent = other->lend();
  ASSERT_OK(sunder_vulkan_create(scene, &lent, nullptr, &there));
  ASSERT_OK(sunder_simulation_step(there, nullptr));
  sunder_vulkan_signals signals{};
  signals.struct_size = sizeof signals;
  signals.signal_semaphore = 1;
  EXPECT_EQ(sunder_vulkan_submit(there, &signals), SUNDER_ERROR_DEVICE);
  EXPECT_NE(std::string(sunder_last_error()).find("timelineSemaphore"), std::string::npos);
  EXPECT_OK(sunder_simulation_destroy(there));
}

// Validation says so when a kernel uses a feature that is off.
TEST_F(CVulkan, RunsWithoutFloat64) {
  for (const bool int64 : {true, false}) {
    host.reset();
    VulkanHost::Options few;
    few.float64 = false;
    few.int64 = int64;
    host.emplace(few);
    create();
    sunder_simulation own = nullptr;
    ASSERT_OK(sunder_simulation_create(scene, nullptr, &own));
    for (int i = 0; i < 4; ++i) {
      steps(1);
      record();
      expect_shown();
      ASSERT_OK(sunder_simulation_step(own, nullptr));
      const auto u = displacement(simulation), reference = displacement(own);
      double largest = 0;
      for (double v : reference) largest = std::max(largest, std::abs(v));
      for (std::size_t n = 0; n < u.size(); ++n) EXPECT_NEAR(u[n], reference[n], 1e-4 * largest);
    }
    std::int32_t count = 0;
    ASSERT_OK(sunder_simulation_event_count(simulation, &count));
    EXPECT_GT(count, 0);
    EXPECT_OK(sunder_simulation_destroy(own));
    EXPECT_OK(sunder_simulation_destroy(simulation));
    simulation = nullptr;
  }
}

// What needs fp64 on the device is refused by name, and the host's device lives on.
TEST_F(CVulkan, RefusesFp64WithoutFloat64) {
  host.reset();
  VulkanHost::Options few;
  few.float64 = false;
  host.emplace(few);
  sunder_solver_options solver = on(SUNDER_BACKEND_VULKAN);
  solver.precision = SUNDER_PRECISION_FP64;
  ASSERT_OK(sunder_scene_set_solver(scene, &solver));
  const auto lent = host->lend();
  EXPECT_EQ(sunder_vulkan_create(scene, &lent, nullptr, &simulation), SUNDER_ERROR_DEVICE);
  EXPECT_NE(std::string(sunder_last_error()).find("shaderFloat64"), std::string::npos);
  host->run([](VkCommandBuffer) {});
}

struct Refusal {
  const char* name;
  sunder_status status;
  const char* says;
  void (*change)(sunder_vulkan_host&);
};

/// Functions of a driver that lacks one, as vkGetInstanceProcAddr gives them.
sunder_vulkan_function no_functions(void*, const char*) { return nullptr; }
VKAPI_ATTR PFN_vkVoidFunction VKAPI_CALL no_dispatch(VkDevice device, const char* name) {
  return std::string_view(name) == "vkCmdDispatch" ? nullptr : vkGetDeviceProcAddr(device, name);
}
sunder_vulkan_function without_dispatch(void* instance, const char* name) {
  if (std::string_view(name) == "vkGetDeviceProcAddr") {
    return reinterpret_cast<sunder_vulkan_function>(&no_dispatch);
  }
  return vkGetInstanceProcAddr(static_cast<VkInstance>(instance), name);
}

/// How far a creation came.
struct Phases {
  int checked = 0, prepared = 0;
  static std::int32_t count(void* user, const sunder_progress* p) {
    auto& phases = *static_cast<Phases*>(user);
    ++(p->phase == SUNDER_PHASE_CHECK ? phases.checked : phases.prepared);
    return 0;
  }
  [[nodiscard]] sunder_callbacks callbacks() {
    sunder_callbacks c = SUNDER_CALLBACKS_INIT;
    c.progress = count;
    c.progress_user = this;
    return c;
  }
};

// Before the scene is looked at, let alone its solver prepared.
TEST_F(CVulkan, RefusesByNameAtOnce) {
  const Refusal refusals[] = {
      {"version", SUNDER_ERROR_DEVICE, "Vulkan 1.1",
       [](auto& h) { h.api_version = VK_API_VERSION_1_1; }},
      {"get", SUNDER_ERROR_NULL, "get_instance_proc_addr is null",
       [](auto& h) { h.get_instance_proc_addr = nullptr; }},
      {"instance", SUNDER_ERROR_NULL, "instance is null", [](auto& h) { h.instance = nullptr; }},
      {"physical", SUNDER_ERROR_NULL, "physical_device is null",
       [](auto& h) { h.physical_device = nullptr; }},
      {"device", SUNDER_ERROR_NULL, "host: device is null", [](auto& h) { h.device = nullptr; }},
      {"queue", SUNDER_ERROR_NULL, "queue is null", [](auto& h) { h.queue = nullptr; }},
      {"family", SUNDER_ERROR_VALUE, "queue_family 77 does not exist",
       [](auto& h) { h.queue_family = 77; }},
      {"family_of_none", SUNDER_ERROR_VALUE, "queue_family 4294967295",
       [](auto& h) { h.queue_family = VK_QUEUE_FAMILY_IGNORED; }},
      {"feature", SUNDER_ERROR_VALUE, "features = 15", [](auto& h) { h.features |= 8; }},
      {"features", SUNDER_ERROR_VALUE, "features = 4294967295", [](auto& h) { h.features = ~0u; }},
      {"functions", SUNDER_ERROR_DEVICE, "lacks the function vk",
       [](auto& h) { h.get_instance_proc_addr = no_functions; }},
      {"dispatch", SUNDER_ERROR_DEVICE, "lacks the function vkCmdDispatch",
       [](auto& h) { h.get_instance_proc_addr = without_dispatch; }},
      {"lock", SUNDER_ERROR_NULL, "pairs", [](auto& h) { h.unlock = nullptr; }},
      {"unlock", SUNDER_ERROR_NULL, "pairs", [](auto& h) { h.lock = nullptr; }},
      {"struct", SUNDER_ERROR_STRUCT_SIZE, "host", [](auto& h) { h.struct_size = 1; }},
      {"struct_unset", SUNDER_ERROR_STRUCT_SIZE, "host",
       [](auto& h) { h.struct_size = 0xcdcdcdcd; }},
  };
  Phases phases;
  const sunder_callbacks callbacks = phases.callbacks();
  for (const Refusal& refusal : refusals) {
    SCOPED_TRACE(refusal.name);
    auto lent = host->lend();
    refusal.change(lent);
    EXPECT_EQ(sunder_vulkan_create(scene, &lent, &callbacks, &simulation), refusal.status);
    EXPECT_NE(std::string(sunder_last_error()).find(refusal.says), std::string::npos)
        << sunder_last_error();
    char text[200];
    EXPECT_OK(sunder_error_of(scene, text, sizeof text, nullptr));
    EXPECT_STREQ(text, sunder_last_error());
    ASSERT_EQ(simulation, nullptr);
  }
  EXPECT_EQ(sunder_vulkan_create(scene, nullptr, &callbacks, &simulation), SUNDER_ERROR_NULL);
  EXPECT_EQ(phases.checked, 0);
  create();  // and the device works all the same
  steps(1);
}

// Of the sizes that a display needs the scene must tell; the solver is not prepared.
TEST_F(CVulkan, RefusesBuffersBeforeItPrepares) {
  const Refusal refusals[] = {
      {"displacement", SUNDER_ERROR_SIZE, "displacement has 16 bytes; it must have 800",
       [](auto& h) {
         h.displacement = {1, 0, 16};
       }},
      {"stress", SUNDER_ERROR_SIZE, "stress has 767 bytes; it must have 768",
       [](auto& h) {
         h.stress = {1, 256, 767};
       }},
      {"live", SUNDER_ERROR_SIZE, "live has 0 bytes", [](auto& h) { h.live.buffer = 1; }},
      {"offset", SUNDER_ERROR_VALUE, "multiple of 256",
       [](auto& h) {
         h.live = {1, 4, 4096};
       }},
  };
  for (const Refusal& refusal : refusals) {
    SCOPED_TRACE(refusal.name);
    auto lent = host->lend();
    refusal.change(lent);
    EXPECT_EQ(sunder_vulkan_create(scene, &lent, nullptr, &simulation), refusal.status);
    EXPECT_NE(std::string(sunder_last_error()).find(refusal.says), std::string::npos)
        << sunder_last_error();
    ASSERT_EQ(simulation, nullptr);
  }
  create();
  steps(1);
}

TEST_F(CVulkan, FillsADisplayOfAnySizeAndNothingBeside) {
  create();
  for (const std::uint32_t stated : {88u, 96u, 65536u}) {
    GuardedBytes exact(88, stated), longer(160, stated);
    for (GuardedBytes* bytes : {&exact, &longer}) {
      auto* to = reinterpret_cast<sunder_vulkan_display*>(bytes->data());
      ASSERT_OK(sunder_vulkan_get_display(simulation, to));
      EXPECT_EQ(to->struct_size, stated);
      EXPECT_EQ(to->nodes, static_cast<std::uint32_t>(kBoardNodes));
    }
    EXPECT_TRUE(longer.untouched_from(88));
  }
  for (const std::uint32_t stated : {0u, 87u, 65537u, 0xcdcdcdcdu}) {
    GuardedBytes bytes(88, stated);
    EXPECT_EQ(sunder_vulkan_get_display(simulation,
                                        reinterpret_cast<sunder_vulkan_display*>(bytes.data())),
              SUNDER_ERROR_STRUCT_SIZE);
    EXPECT_TRUE(bytes.untouched_from(4));
  }
}

TEST_F(CVulkan, MisuseGivesStatuses) {
  auto lent = host->lend();
  const sunder_scene on_cpu = board_scene(SUNDER_BACKEND_CPU);
  EXPECT_EQ(sunder_vulkan_create(on_cpu, &lent, nullptr, &simulation), SUNDER_ERROR_VALUE);
  EXPECT_EQ(sunder_vulkan_create(nullptr, &lent, nullptr, &simulation), SUNDER_ERROR_HANDLE);
  EXPECT_OK(sunder_scene_destroy(on_cpu));
  create();
  EXPECT_EQ(sunder_vulkan_record(simulation, nullptr), SUNDER_ERROR_NULL);
  host->run([&](VkCommandBuffer commands) {
    EXPECT_EQ(sunder_vulkan_record(simulation, commands), SUNDER_ERROR_ORDER) << "no step yet";
  });
  EXPECT_EQ(sunder_vulkan_submit(simulation, nullptr), SUNDER_ERROR_NULL);
  EXPECT_EQ(sunder_vulkan_get_display(simulation, nullptr), SUNDER_ERROR_NULL);
  const sunder_simulation elsewhere = board_simulation();
  sunder_vulkan_display d{};
  d.struct_size = sizeof d;
  EXPECT_EQ(sunder_vulkan_get_display(elsewhere, &d), SUNDER_ERROR_ORDER);
  EXPECT_OK(sunder_simulation_destroy(elsewhere));
}

// What the host counts at its queue is what the same steps submit on a device of their own.
TEST_F(CVulkan, AStepSubmitsNoMoreThanOnItsOwnDevice) {
  create();
  const auto lent = c::find<c::SimulationObject>(simulation, "simulation");
  const auto problem = std::make_shared<const Problem>(lent->problem().scene());
  gpu::VulkanOptions options;
  options.probe.guard_bytes = 256;
  std::optional<Simulation> own;
  own.emplace(problem, gpu::create(problem, needs_of(*problem), options));
  std::size_t before = gpu::device_use(own->backend()).submits;
  for (int i = 0; i < 3; ++i) {
    const int host_before = VulkanHost::calls.submits;
    own->step();
    EXPECT_EQ(VulkanHost::calls.submits, host_before) << "own device, yet the host's queue";
    steps(1);
    const std::size_t now = gpu::device_use(own->backend()).submits;
    EXPECT_GT(now, before);
    EXPECT_EQ(static_cast<std::size_t>(VulkanHost::calls.submits - host_before), now - before);
    before = now;
  }
  own.reset();
  for (const std::string& message : options.instance.messages->texts) ADD_FAILURE() << message;
}

TEST_F(CVulkan, CyclesLeaveNothing) {
  const char* asked = std::getenv("SUNDER_CYCLES");
  const int count = asked ? std::atoi(asked) : 20;
  const sunder_scene small = board_scene(SUNDER_BACKEND_VULKAN, 2);
  const auto lent = host->lend();
  for (int i = 0; i < count; ++i) {
    sunder_simulation s = nullptr;
    ASSERT_OK(sunder_vulkan_create(small, &lent, nullptr, &s));
    ASSERT_OK(sunder_simulation_step(s, nullptr));
    ASSERT_OK(sunder_simulation_destroy(s));
  }
  EXPECT_OK(sunder_scene_destroy(small));
  // ~VulkanHost asks the validation layer for objects that were left behind.
}

}  // namespace
}  // namespace sunder::test
