// SPDX-License-Identifier: Apache-2.0
// What a device may lack of what is relied on: each limit has its sentence, and a dispatch of more
// workgroups than the device takes does what one dispatch does.
#include <numeric>

#include "gpu/passes/damage_solution.hpp"
#include "gpu/vulkan/commands.hpp"
#include "gpu/vulkan/host_commands.hpp"
#include "gpu/vulkan/shader_memory.hpp"
#include "gpu_body.hpp"
#include "shaders/embedded.hpp"
#include "shaders/layout.h"
#include "tearing_board.hpp"
#include "torn_run.hpp"

namespace sunder::test {
namespace {

using vulkan::Access;
using vulkan::Buffer;
using vulkan::LimitsProbe;
using vulkan::Placement;

/// A device that claims some limits, under validation.
class LimitedDevice {
 public:
  explicit LimitedDevice(const LimitsProbe& limits) {
    vulkan::InstanceOptions options;
    options.validation = validated();
    options.messages = messages_;
    vulkan::DeviceProbe probe = watched_probe();
    probe.limits = limits;
    device = watched_device(std::make_shared<vulkan::Instance>(options), probe);
  }
  ~LimitedDevice() {
    device.reset();
    for (const std::string& m : messages_->texts) ADD_FAILURE() << m;
  }
  LimitedDevice(const LimitedDevice&) = delete;
  LimitedDevice& operator=(const LimitedDevice&) = delete;

  /// The kernel u += du.
  [[nodiscard]] std::unique_ptr<vulkan::Kernel> adder(const char* name = "add_gpu_fp64") const {
    const bool texels = std::string_view(name).find("lvp") != std::string_view::npos;
    const Access access[] = {texels ? Access::texel_uint4 : Access::storage, Access::storage};
    const std::uint32_t group[] = {shaders::kGroup};
    return std::make_unique<vulkan::Kernel>(
        *device,
        vulkan::KernelCode{shaders::find(name), access, sizeof(std::uint32_t), group, name});
  }
  /// What binding two buffers to it is refused with.
  [[nodiscard]] std::string refusal(const vulkan::Kernel& kernel, const Buffer& a,
                                    const Buffer& b) const {
    const Buffer* buffers[] = {&a, &b};
    return message_of([&] { const vulkan::Binding binding(*device, kernel, buffers); });
  }

  std::unique_ptr<vulkan::Device> device;

 private:
  std::shared_ptr<vulkan::Messages> messages_ = std::make_shared<vulkan::Messages>();
};

/// What the sentence says between who and instead of what.
std::string needs(const vulkan::Device& device, std::uint64_t needed, const std::string& of,
                  std::uint64_t taken, const std::string& field) {
  return " needs " + std::to_string(needed) + " " + of + ", but the Vulkan device \"" +
         device.physical().name + "\" takes " + std::to_string(taken) + " (" + field + "); ";
}

using Limits = WithVulkan<>;

TEST_F(Limits, OfAKernel) {
  const auto refused = [](const LimitsProbe& limits, const char* kernel, std::uint64_t needed,
                          const char* of, std::uint64_t taken, const char* field) {
    const LimitedDevice limited(limits);
    const std::string expected =
        "kernel " + std::string(kernel) + needs(*limited.device, needed, of, taken, field);
    const std::string said = message_of([&] { static_cast<void>(limited.adder(kernel)); });
    EXPECT_EQ(said.substr(0, expected.size()), expected);
    EXPECT_NE(said.find("use "), std::string::npos) << said;
  };
  refused({.storage_buffers = 1}, "add_gpu_fp64", 2, "storage buffers", 1,
          "maxPerStageDescriptorStorageBuffers");
  refused({.buffers = 1}, "add_gpu_fp64", 2, "buffers", 1, "maxPerStageResources");
  refused({.push_bytes = 3}, "add_gpu_fp64", 4, "bytes of push constants", 3,
          "maxPushConstantsSize");
  refused({.group = 63}, "add_lvp_fp64", 64, "invocations in a workgroup", 63,
          "maxComputeWorkGroupInvocations and maxComputeWorkGroupSize[0]");
}

// The step of conjugate gradients binds ten buffers (shaders/cg_step.comp), five of them texel
// buffers in lvp.
TEST_F(Limits, TenStorageBuffersAreNeededByConjugateGradientsAlone) {
  const auto refusal = [](gpu::Variant variant, Route route, const LimitsProbe& limits) {
    WatchedBackend watched(pulled_until_it_tears(),
                           {.variant = variant,
                            .update = route == Route::cg ? Update::automatic : Update::deferred,
                            .route = route});
    watched.options.probe.limits = limits;
    return message_of([&] { static_cast<void>(watched.create()); });
  };
  const std::string of_gpu = refusal(gpu::Variant::gpu, Route::cg, {.storage_buffers = 9});
  EXPECT_NE(of_gpu.find("kernel cg_step_gpu_fp64 needs 10 storage buffers"), std::string::npos)
      << of_gpu;
  EXPECT_NE(of_gpu.find("use another route or backend cpu"), std::string::npos) << of_gpu;
  const std::string of_lvp = refusal(gpu::Variant::lvp, Route::cg, {.texel_buffers = 4});
  EXPECT_NE(of_lvp.find("kernel cg_step_lvp_fp64 needs 5 texel buffers"), std::string::npos)
      << of_lvp;
  const std::string taken = "no DeviceError was thrown";
  EXPECT_EQ(refusal(gpu::Variant::gpu, Route::inverse, {.storage_buffers = 9}), taken);
  EXPECT_EQ(refusal(gpu::Variant::gpu, Route::cg, {.storage_buffers = 10}), taken);
}

TEST_F(Limits, OfBuffers) {
  constexpr std::size_t bytes = 256 * sizeof(double);
  const LimitedDevice limited(
      {.buffer_bytes = bytes, .texels = bytes / 16, .allocation_bytes = 1 << 20});
  vulkan::Device& device = *limited.device;
  const auto by_storage = limited.adder("add_gpu_fp64"), by_texels = limited.adder("add_lvp_fp64");
  const Buffer fits(device, bytes, Placement::device), over(device, bytes + 16, Placement::device);
  const std::string taken = "no DeviceError was thrown";
  EXPECT_EQ(limited.refusal(*by_storage, fits, fits), taken);
  EXPECT_EQ(limited.refusal(*by_texels, fits, fits), taken);
  EXPECT_EQ(
      limited.refusal(*by_storage, fits, over),
      "kernel add_gpu_fp64" +
          needs(device, bytes + 16, "bytes in one storage buffer", bytes, "maxStorageBufferRange") +
          "use precision fp32, another route, a smaller mesh or backend cpu");
  EXPECT_EQ(limited.refusal(*by_texels, over, fits),
            "kernel add_lvp_fp64" +
                needs(device, bytes / 16 + 1, "texels in one buffer", bytes / 16,
                      "maxTexelBufferElements") +
                "use a smaller mesh or backend cpu");
  const std::string too_large =
      message_of([&] { const Buffer large(device, 2 << 20, Placement::device); });
  EXPECT_NE(too_large.find("bytes in one allocation"), std::string::npos) << too_large;
  EXPECT_NE(too_large.find("takes 1048576 (maxMemoryAllocationSize)"), std::string::npos)
      << too_large;
}

// Vulkan promises 4,096 of a device.
TEST_F(Limits, OfAllocations) {
  const LimitedDevice limited({.allocations = 2});
  vulkan::Device& device = *limited.device;
  {
    const Buffer first(device, 64, Placement::device), second(device, 64, Placement::host);
    EXPECT_EQ(
        message_of([&] { const Buffer third(device, 64, Placement::device); }),
        "a scene" +
            needs(device, 3, "allocations of memory at a time", 2, "maxMemoryAllocationCount") +
            "use fewer backends on one device, another route or backend cpu");
  }
  const Buffer again(device, 64, Placement::device);
  // What can be left to the host is: the small matrices of damage are eight buffers.
  const gpu::KernelFactory kernels(device, gpu::Variant::lvp, true);
  EXPECT_EQ(gpu::DamageSolution::make(kernels, 64, 0, 1), nullptr);
  const Buffer and_again(device, 64, Placement::device);
}

// Stress of 324 elements, padded to 384: eight numbers each, the largest storage buffer of lvp,
// which reads all else that is as large as texels.
TEST_F(Limits, OfTheStressOfAllElements) {
  Scene scene;
  scene.mesh = structured_board({9, 6, 1});
  scene.materials["board"] = {5, 0.4, 2.0};
  scene.supports.push_back({Box{Vec3(-1, 9.9, -1), Vec3(11, 11, 2)}, Axes{7}});
  WatchedBackend watched(scene, {.update = Update::automatic, .route = Route::cg});
  const std::size_t bytes = 384 * 8 * sizeof(double);
  watched.options.probe.limits.buffer_bytes = bytes - 1;
  const std::string said = message_of([&] { static_cast<void>(watched.create(all_needs())); });
  EXPECT_NE(said.find("kernel stress_lvp_fp64 needs " + std::to_string(bytes) +
                      " bytes in one storage buffer"),
            std::string::npos)
      << said;
  watched.options.probe.limits.buffer_bytes = bytes;
  EXPECT_NE(watched.create(all_needs()), nullptr);
}

TEST_F(Limits, OfWhereABufferBegins) {
  const LimitedDevice limited({.alignment = 512});
  const auto kernel = limited.adder();
  const Buffer whole(*limited.device, 4096, Placement::device);
  const Buffer at_512 = Buffer::lent(whole.handle(), 512, 1024),
               at_256 = Buffer::lent(whole.handle(), 256, 1024);
  EXPECT_EQ(limited.refusal(*kernel, at_512, at_512), "no DeviceError was thrown");
  EXPECT_EQ(limited.refusal(*kernel, at_512, at_256),
            "kernel add_gpu_fp64 is to see a buffer from byte 256 on, but the Vulkan device \"" +
                limited.device->physical().name +
                "\" binds at multiples of 512 (minStorageBufferOffsetAlignment, "
                "minTexelBufferOffsetAlignment)");
}

TEST_F(Limits, OfRowsOfWorkgroups) {
  const LimitedDevice limited({.groups = 2, .rows_of_groups = 3});
  const auto kernel = limited.adder();
  const Buffer of(*limited.device, 4096, Placement::device);
  const Buffer* buffers[] = {&of, &of};
  const vulkan::Binding binding(*limited.device, *kernel, buffers);
  vulkan::Commands commands(*limited.device);
  commands.begin();
  EXPECT_EQ(message_of([&] { commands.dispatch(binding, 0u, 8); }),
            "kernel add_gpu_fp64" +
                needs(*limited.device, 4, "rows of workgroups in one dispatch", 3,
                      "maxComputeWorkGroupCount[1] and [2]") +
                "use a smaller mesh or backend cpu");
  EXPECT_THROW(commands.dispatch(binding, 0u, 1, 4), DeviceError);
  commands.end();
}

TEST_F(Limits, OfIndirectDispatches) {
  WatchedBackend watched(pulled_until_it_tears(),
                         {.update = Update::automatic, .route = Route::cg});
  // Of the small matrix of 64 groups of nodes, four rows each; those of the nodes are fewer here.
  constexpr std::uint64_t groups = 6 * 64 / 4;
  ASSERT_LT(watched.problem->node_count() / shaders::kGroup, groups);
  watched.options.probe.limits.groups = groups - 1;
  const std::string said = message_of([&] { static_cast<void>(watched.create()); });
  EXPECT_NE(said.find("route cg needs " + std::to_string(groups) +
                      " workgroups in one indirect dispatch"),
            std::string::npos)
      << said;
}

// Counted by hand from the sources: the gpu variants of dense, stress and residual.
TEST(SharedMemory, IsThatOfTheSource) {
  const auto of = [](const char* name) { return vulkan::shared_bytes(shaders::find(name)); };
  EXPECT_EQ(of("add_gpu_fp64"), 0u);
  EXPECT_EQ(of("stress_lvp_fp64"), 0u);
  // 16 packs of four.
  EXPECT_EQ(of("dense_gpu_fp32"), 16u * 16);
  EXPECT_EQ(of("dense_gpu_fp64"), 16u * 32);
  // 64 times: two pairs of ratio and element, the norm, three words as four, what rounding costs.
  EXPECT_EQ(of("stress_gpu_fp64"), 64u * (16 + 16 + 8 + 16 + 4));
  EXPECT_EQ(of("stress_gpu_fp32"), 64u * (8 + 8 + 4 + 16 + 4));
  EXPECT_EQ(of("residual_gpu_fp64"), 64u * 32);
}

// Vulkan promises 16 KiB of every device.
TEST(SharedMemory, OfNoKernelIsMoreThanEveryDeviceHas) {
  for (std::string_view name : shaders::names()) {
    EXPECT_LE(vulkan::shared_bytes(shaders::find(name)), 16384u) << name;
  }
}

TEST_F(Limits, OfMemoryThatAWorkgroupShares) {
  const std::uint32_t group[] = {shaders::kGroup};
  const LimitedDevice limited({.shared_bytes = 2047});
  const std::vector<Access> access(8, Access::storage);
  const std::string said = message_of([&] {
    const vulkan::Kernel kernel(
        *limited.device, vulkan::KernelCode{shaders::find("residual_gpu_fp64"), access, 0, group,
                                            "residual_gpu_fp64"});
  });
  const std::string expected =
      "kernel residual_gpu_fp64" + needs(*limited.device, 2048, "bytes that a workgroup shares",
                                         2047, "maxComputeSharedMemorySize");
  EXPECT_EQ(said.substr(0, expected.size()), expected);
}

/// u + du of so many workgroups on a device that takes `most` along x: values that each invocation
/// must have changed once.
void expect_added(std::uint32_t groups, std::uint32_t most, const char* name, bool by_host) {
  SCOPED_TRACE(std::string(name) + ", " + std::to_string(groups) + " groups by " +
               std::to_string(most));
  const LimitedDevice limited({.groups = most});
  vulkan::Device& device = *limited.device;
  const auto kernel = limited.adder(name);
  const std::uint32_t packs = groups * shaders::kGroup;
  std::vector<double> u(4 * packs), du(4 * packs, 1000.0);
  std::iota(u.begin(), u.end(), 0.0);
  Buffer to(device, u.size() * sizeof(double), Placement::device),
      from(device, du.size() * sizeof(double), Placement::device);
  to.write(std::span<const double>(u));
  from.write(std::span<const double>(du));
  const Buffer* buffers[] = {&from, &to};
  const vulkan::Binding binding(device, *kernel, buffers);
  vulkan::Commands commands(device);
  commands.begin();
  if (by_host) {
    vulkan::HostCommands host(device, commands.handle());
    host.dispatch(binding, packs, groups);
    host.end();
  } else {
    commands.dispatch(binding, packs, groups);
  }
  commands.end();
  commands.submit();
  std::vector<double> got(u.size());
  to.read(std::span<double>(got));
  for (std::size_t i = 0; i < u.size(); ++i) ASSERT_EQ(got[i], u[i] + 1000) << i;
}

TEST_F(Limits, AFoldedDispatchRunsEveryWorkgroupOnce) {
  for (const std::uint32_t groups : {1u, 6u, 7u}) {
    for (const std::uint32_t most : {1u, 2u, 3u, 4u, 6u, 7u, 8u}) {
      expect_added(groups, most, "add_gpu_fp64", false);
    }
  }
  expect_added(7, 3, "add_lvp_fp64", false);
  expect_added(7, 3, "add_gpu_fp64", true);
}

// 2 does not divide the workgroups of elements, nodes and rows, so that there are rests.
TEST_F(Limits, ARunOfFoldedDispatchesHasTheSameBits) {
  for (const Way& way : all_ways()) {
    if (way.precision == Precision::fp64 && way.update == Update::deferred) continue;
    SCOPED_TRACE(name_of(way));
    const TornRun whole = tear(way, 0), folded = tear(way, 2);
    EXPECT_FALSE(whole.destroyed.empty());
    EXPECT_EQ(folded.destroyed, whole.destroyed);
    EXPECT_EQ(folded.displacement, whole.displacement);
    EXPECT_EQ(folded.stress, whole.stress);
  }
}

}  // namespace
}  // namespace sunder::test
