// SPDX-License-Identifier: Apache-2.0
// The Vulkan layer by itself: what is missing is named, what goes wrong is noticed.
#include <functional>

#include "gpu/vulkan/check.hpp"
#include "gpu_body.hpp"
#include "run_again.hpp"
#include "shaders/embedded.hpp"
#include "shaders/layout.h"
#include "sunder/backends.hpp"
#include "sunder/error.hpp"
#include "validation_watch.hpp"

namespace sunder::test {
namespace {

using vulkan::Access;
using vulkan::Buffer;
using vulkan::Placement;

TEST(VulkanExpected, ADeviceIsThereUnlessNoneIsExpected) {
  EXPECT_EQ(gpu::devices().empty(), std::getenv("SUNDER_EXPECT_NO_VULKAN") != nullptr)
      << "a Vulkan device is missing; set SUNDER_EXPECT_NO_VULKAN where none is expected";
}

TEST(VulkanMissing, LoaderIsNamed) {
  vulkan::InstanceOptions options;
  options.loader = "libvulkan-that-does-not-exist.so";
  EXPECT_EQ(message_of([&] { vulkan::Instance instance(options); }),
            "no Vulkan loader was found (libvulkan-that-does-not-exist.so); install libvulkan1 or "
            "use backend cpu");
}

TEST(VulkanMissing, ALibraryThatIsNoLoaderIsNamed) {
  vulkan::InstanceOptions options;
  options.loader = "libm.so.6";
  EXPECT_NE(message_of([&] { vulkan::Instance instance(options); }).find("no Vulkan loader"),
            std::string::npos);
}

Scene small_scene() {
  Scene scene;
  scene.mesh = structured_board({2, 2, 1});
  scene.materials["board"] = {5, 0.4, 2.0};
  scene.supports.push_back({Box{Vec3(-1, 9.9, -1), Vec3(11, 11, 2)}, Axes{7}});
  return scene;
}

TEST(VulkanPooled, AutoTakesTheCpuForASmallBody) {
  Scene scene = small_scene();
  scene.materials["board"].volume = MaterialVolume::pooled;
  scene.solver.backend = "auto";
  const auto created = create_backend(std::make_shared<const Problem>(scene), all_needs());
  EXPECT_EQ(created.backend->info().backend, "cpu");
  EXPECT_TRUE(created.warnings.empty());
}

TEST(VulkanFibres, AutoTakesTheCpu) {
  Scene scene = small_scene();
  Fibres f;
  f.direction = Vec3(1, 0, 0);
  f.young_along = 20;
  f.poisson_along = 0.3;
  f.shear_along = 3;
  scene.materials["board"].fibres = {f};
  scene.solver.backend = "auto";
  const auto created = create_backend(std::make_shared<const Problem>(scene), all_needs());
  EXPECT_EQ(created.backend->info().backend, "cpu");
  EXPECT_TRUE(created.warnings.empty());
}

// Run by the test below in a process without drivers.
TEST(VulkanWithoutDriver, DISABLED_AutoTakesTheCpuAndVulkanSaysWhy) {
  EXPECT_TRUE(gpu::devices().empty());
  Scene scene = small_scene();
  scene.solver.backend = "vulkan";
  const auto problem = std::make_shared<const Problem>(scene);
  const std::string message =
      message_of([&] { static_cast<void>(create_backend(problem, all_needs())); });
  EXPECT_NE(message.find("no Vulkan driver"), std::string::npos) << message;
  scene.solver.backend = "auto";
  const auto created = create_backend(std::make_shared<const Problem>(scene), all_needs());
  EXPECT_EQ(created.backend->info().backend, "cpu");
  ASSERT_EQ(created.warnings.size(), 1u);
  EXPECT_EQ(created.warnings.front(), "backend auto found no GPU, cpu is used instead: " + message);
}

TEST(VulkanMissing, DriverIsNamed) {
  const auto [output, code] = run_again(kNoDriver, "VulkanWithoutDriver.*");
  EXPECT_EQ(code, 0) << output;
  EXPECT_NE(output.find("[  PASSED  ] 1 test"), std::string::npos) << output;
}

TEST(VulkanMissing, WhereNoneIsExpectedTheTestsAreLeftOut) {
  const auto [output, code] = run_again(std::string(kNoDriver) + " SUNDER_EXPECT_NO_VULKAN=1",
                                        "Vulkan*.*-*DISABLED*:VulkanMissing.*");
  EXPECT_EQ(code, 0) << output;
  EXPECT_NE(output.find("[  SKIPPED ] "), std::string::npos) << output;
}

TEST(VulkanMissing, ADeviceWhereNoneIsExpectedFailsTheTests) {
  const bool none = std::getenv("SUNDER_EXPECT_NO_VULKAN") != nullptr;
  const auto [output, code] = run_again(
      none ? "env -u SUNDER_EXPECT_NO_VULKAN" : "SUNDER_EXPECT_NO_VULKAN=1", "VulkanExpected.*");
  EXPECT_NE(code, 0) << output;
}

TEST(VulkanMissing, ADeviceThatIsExpectedFailsTheTests) {
  const auto [output, code] = run_again(kNoDriver, "VulkanExpected.*");
  EXPECT_NE(code, 0) << output;
  EXPECT_NE(output.find("a Vulkan device is missing"), std::string::npos) << output;
}

using VulkanDevices = WithVulkan<>;

TEST_F(VulkanDevices, AProcessorIsListedAndNeverChosen) {
  int chosen = 0;
  for (const DeviceInfo& d : devices()) {
    chosen += d.chosen;
    EXPECT_FALSE(d.name.empty());
    EXPECT_FALSE(d.why.empty());
    if (d.name.find("llvmpipe") == std::string::npos) continue;
    EXPECT_FALSE(d.chosen);
    EXPECT_EQ(d.precisions, "fp32 fp64");
  }
  EXPECT_EQ(chosen, 1);
}

TEST_F(VulkanDevices, AnUnknownDeviceIsAnError) {
  Scene scene = small_scene();
  scene.solver.backend = "vulkan";
  scene.solver.device = 99;
  const auto problem = std::make_shared<const Problem>(scene);
  const std::string message =
      message_of([&] { static_cast<void>(gpu::create(problem, all_needs())); });
  EXPECT_NE(message.find("there is no Vulkan device 99; devices 0 to"), std::string::npos)
      << message;
}

TEST_F(VulkanDevices, AShortcomingIsNamed) {
  vulkan::PhysicalDevice device;
  device.api_version = VK_API_VERSION_1_1;
  EXPECT_NE(device.shortcoming().find("Vulkan 1.1"), std::string::npos);
  device.api_version = VK_API_VERSION_1_2;
  EXPECT_EQ(device.shortcoming(), "it has no compute queue");
  device.compute_family = 0;
  EXPECT_EQ(device.shortcoming(), "");  // without shaderFloat64 too
}

TEST_F(VulkanDevices, WithoutFloat64OnlyFp32ByTheMixedRecipeIsOffered) {
  for (const auto& [change, reason] :
       {std::pair{+[](SolverOptions& s) { s.precision = Precision::fp64; }, "precision fp64"},
        std::pair{+[](SolverOptions& s) { s.tolerance = 1e-6; }, "tolerance 1e-06 needs fp64"},
        std::pair{+[](SolverOptions& s) { s.route = Route::cg; }, "route cg"},
        std::pair{+[](SolverOptions& s) { s.update = Update::eager; }, "eager"}}) {
    Scene scene = small_scene();
    scene.solver.backend = "vulkan";
    change(scene.solver);
    const auto problem = std::make_shared<const Problem>(scene);
    gpu::VulkanOptions options;
    options.probe.no_float64 = true;
    const std::string message =
        message_of([&] { static_cast<void>(gpu::create(problem, all_needs(), options)); });
    EXPECT_NE(message.find(reason), std::string::npos) << message;
    EXPECT_NE(message.find("lacks shaderFloat64; use"), std::string::npos) << message;
  }
}

TEST_F(VulkanDevices, PrecisionFollowsTheToleranceAndIsSaid) {
  for (const double tolerance : {1e-4, 1e-6}) {
    Scene scene = small_scene();
    scene.solver.tolerance = tolerance;
    const auto problem = std::make_shared<const Problem>(scene);
    const auto backend = gpu::create(problem, all_needs(), {});
    EXPECT_EQ(backend->info().precision, tolerance == 1e-4 ? "fp32" : "fp64");
    EXPECT_NE(backend->info().why.find("tolerance"), std::string::npos);
    EXPECT_GT(backend->info().memory_bytes, 0u);
  }
}

TEST_F(VulkanDevices, PrecisionFollowsTheMaterialsAndIsSaid) {
  for (const auto& [young, poisson, precision] :
       {std::tuple{5e3, 0.4, "fp32"}, std::tuple{5e4, 0.4, "fp64"}, std::tuple{5.0, 0.4999, "fp32"},
        std::tuple{5.0, 0.49999, "fp64"}}) {
    Scene scene = small_scene();
    scene.mesh = structured_board(
        {2, 2, 1}, [](const Vec3& x) { return std::string(x.y() > 5 ? "frame" : "board"); });
    scene.materials["frame"] = {young, poisson, std::nullopt};
    const auto backend = gpu::create(std::make_shared<const Problem>(scene), all_needs(), {});
    EXPECT_EQ(backend->info().precision, precision) << young << ", " << poisson;
    const bool said = backend->info().why.find("these materials need fp64") != std::string::npos;
    EXPECT_EQ(said, backend->info().precision == "fp64") << backend->info().why;
    EXPECT_TRUE(gpu::warnings(*backend).empty());
    scene.solver.precision = Precision::fp32;  // asked for: what it costs is the caller's choice
    scene.solver.backend = "vulkan";
    const CreatedBackend asked =
        create_backend(std::make_shared<const Problem>(scene), all_needs());
    EXPECT_EQ(asked.backend->info().precision, "fp32");
    ASSERT_EQ(asked.warnings.size(), said ? 1u : 0u) << young << ", " << poisson;
    if (!said) continue;
    const std::string& warning = asked.warnings.front();
    const char* value = poisson > 0.4 ? "Poisson's ratio is 0.49999" : "factor of 10000";
    EXPECT_NE(warning.find(value), std::string::npos) << warning;
    EXPECT_NE(warning.find("use precision fp64 or auto"), std::string::npos) << warning;
  }
}

// Where the device has no fp64 there is no other choice; it is said all the same.
TEST_F(VulkanDevices, MaterialsThatNeedMoreThanTheDeviceHasAreSaid) {
  Scene scene = small_scene();
  scene.materials.begin()->second.poisson = 0.49995;
  gpu::VulkanOptions options;
  options.probe.no_float64 = true;
  const auto backend = gpu::create(std::make_shared<const Problem>(scene), all_needs(), options);
  const auto warnings = gpu::warnings(*backend);
  ASSERT_EQ(warnings.size(), 1u);
  EXPECT_NE(warnings.front().find("0.49995"), std::string::npos) << warnings.front();
  EXPECT_NE(warnings.front().find("backend cpu"), std::string::npos) << warnings.front();
}

// Run by the test below.
TEST(VulkanVariant, DISABLED_FromTheEnvironment) {
  Scene scene = small_scene();
  scene.solver.backend = "vulkan";
  static_cast<void>(gpu::create(std::make_shared<const Problem>(scene), all_needs()));
}

TEST_F(VulkanDevices, AnUnknownShaderVariantIsAnError) {
  const auto [output, code] = run_again("SUNDER_SHADER_VARIANT=fast", "VulkanVariant.*");
  EXPECT_NE(code, 0);
  EXPECT_NE(output.find("SUNDER_SHADER_VARIANT is \"fast\"; it may be gpu or lvp"),
            std::string::npos)
      << output;
}

TEST(VulkanMissing, AnUnknownProbeIsAnError) {
  for (const char* probe : {"as_cpu", "memory", "memory=", "memory=1k", "lost=x", "as_gpu,,"}) {
    const auto [output, code] =
        run_again("SUNDER_VULKAN_PROBE=" + std::string(probe), "VulkanVariant.*");
    EXPECT_NE(code, 0) << probe;
    EXPECT_NE(output.find("SUNDER_VULKAN_PROBE has \""), std::string::npos) << output;
  }
}

/// A device under validation, with the kernel `add` on two buffers.
struct Adder {
  explicit Adder(std::size_t guard_bytes = 0, bool validation = true, bool unmapped = false) {
    vulkan::InstanceOptions options;
    options.validation = validation;
    options.messages = messages;
    instance = std::make_shared<vulkan::Instance>(options);
    vulkan::DeviceProbe probe = watched_probe();
    probe.guard_bytes = guard_bytes;
    probe.as_gpu = probe.as_gpu || unmapped;
    device = watched_device(instance, probe);
    const Access access[] = {Access::storage, Access::storage};
    const std::uint32_t group[] = {shaders::kGroup};
    kernel = std::make_unique<vulkan::Kernel>(
        *device, vulkan::KernelCode{shaders::find("add_gpu_fp64"), access, 4, group});
    from = Buffer(*device, 256 * sizeof(double), Placement::host);
    to = Buffer(*device, 256 * sizeof(double), Placement::device);
    from.fill_zero();
    to.fill_zero();
    const Buffer* buffers[] = {&from, &to};
    binding = std::make_unique<vulkan::Binding>(*device, *kernel, buffers);
  }

  std::shared_ptr<vulkan::Messages> messages = std::make_shared<vulkan::Messages>();
  std::shared_ptr<vulkan::Instance> instance;
  std::unique_ptr<vulkan::Device> device;
  std::unique_ptr<vulkan::Kernel> kernel;
  Buffer from, to;
  std::unique_ptr<vulkan::Binding> binding;
};

/// Reads what it has just written, without a barrier: it says that the bytes are others.
void record_a_hazard(Adder& adder) {
  const Buffer* swapped[] = {&adder.to, &adder.from};
  const vulkan::Binding back(*adder.device, *adder.kernel, swapped);
  vulkan::Commands commands(*adder.device);
  commands.begin();
  commands.dispatch(*adder.binding, 64u, 1);
  commands.apart();  // which is not true
  commands.dispatch(back, 64u, 1);
  commands.end();
  commands.submit();
}

using VulkanWatch = WithVulkan<>;

TEST_F(VulkanWatch, AMissingBarrierIsNoticed) {
  Adder adder;
  const std::string message = message_of([&] { record_a_hazard(adder); });
  EXPECT_NE(message.find("SYNC-HAZARD"), std::string::npos) << message;
  EXPECT_NE(take_validation_messages().find("SYNC-HAZARD"), std::string::npos);
}

// Run by the test below: it never asks for validation itself.
TEST(VulkanWatched, DISABLED_AHazardOfUnwatchedCode) {
  Adder adder(0, false);
  record_a_hazard(adder);
}

TEST_F(VulkanWatch, AHazardFailsATestThatNeverAskedForValidation) {
  const auto [output, code] = run_again("", "VulkanWatched.*");
  EXPECT_NE(code, 0);
  EXPECT_NE(output.find("Vulkan validation during this test"), std::string::npos) << output;
  EXPECT_NE(output.find("SYNC-HAZARD-READ-AFTER-WRITE"), std::string::npos) << output;
}

// Two dispatches that change one buffer: the layer does not see that a barrier is missing there.
TEST_F(VulkanWatch, ABarrierStandsWhereOneIsNeeded) {
  Adder adder;
  vulkan::Commands commands(*adder.device);
  const auto add = [&] { commands.dispatch(*adder.binding, 64u, 1); };
  commands.begin();
  add();
  EXPECT_EQ(commands.barriers(), 0);
  add();
  EXPECT_EQ(commands.barriers(), 1);
  commands.fill_zero(adder.from, 0, 1024);  // is read there
  EXPECT_EQ(commands.barriers(), 2);
  commands.fill_zero(adder.from, 1024, 1024);
  EXPECT_EQ(commands.barriers(), 2);
  commands.copy(adder.from.handle(), adder.from.offset(), adder.to.handle(), adder.to.offset(), 8);
  EXPECT_EQ(commands.barriers(), 3);
  commands.end();
  EXPECT_EQ(commands.barriers(), 3);
  commands.begin();
  commands.dispatch_indirect(*adder.binding, 64u, adder.from, 0);
  EXPECT_EQ(commands.barriers(), 0) << "of a buffer that the kernel reads too";
  commands.dispatch_indirect(*adder.binding, 64u, adder.to, 0);
  EXPECT_EQ(commands.barriers(), 1) << "of a buffer that the kernel has changed";
  commands.end();
}

TEST_F(VulkanWatch, ABarrierIsEnough) {
  Adder adder;
  const std::vector<double> ones(256, 1.0);
  adder.from.write(std::span<const double>(ones));
  vulkan::Commands commands(*adder.device);
  commands.begin();
  commands.pass("first");
  commands.dispatch(*adder.binding, 64u, 1);
  commands.pass("second");
  commands.dispatch(*adder.binding, 64u, 1);
  commands.end();
  commands.submit();
  EXPECT_TRUE(adder.messages->texts.empty());
  std::vector<double> sums(256);
  adder.to.read(std::span<double>(sums));
  for (double s : sums) EXPECT_EQ(s, 2);
  const auto times = commands.pass_times();
  ASSERT_EQ(times.size(), 2u);
  for (const auto& t : times) EXPECT_GE(t.milliseconds, 0);
}

TEST_F(VulkanWatch, AWriteBehindABufferIsNoticed) {
  for (const bool unmapped : {false, true}) {
    SCOPED_TRACE(unmapped ? "unmapped" : "mapped");
    Adder adder(256, true, unmapped);
    const std::vector<double> ones(256, 1.0);
    adder.from.write(std::span<const double>(ones));
    vulkan::Commands commands(*adder.device);
    commands.begin();
    commands.dispatch(*adder.binding, 128u, 2);  // 128 packs of four doubles; 64 are there
    commands.end();
    commands.submit();
    adder.binding.reset();
    adder.to = Buffer();
    ASSERT_EQ(adder.messages->texts.size(), 1u);
    EXPECT_NE(adder.messages->texts.front().find("wrote outside a buffer"), std::string::npos);
  }
}

/// Sentinels before a buffer, where no kernel reaches: a copy changes them.
TEST_F(VulkanWatch, AWriteBeforeABufferIsNoticed) {
  for (const bool unmapped : {false, true}) {
    SCOPED_TRACE(unmapped ? "unmapped" : "mapped");
    Adder adder(256, true, unmapped);
    vulkan::Commands commands(*adder.device);
    commands.begin();
    commands.copy(adder.from.handle(), adder.from.offset(), adder.to.handle(), 252, 4);
    commands.end();
    commands.submit();
    adder.binding.reset();
    adder.to = Buffer();
    EXPECT_EQ(adder.messages->texts.size(), 1u);
  }
}

TEST_F(VulkanWatch, WhatTheHostWritesAndReadsGoesByCopiesWhereMemoryIsNotMapped) {
  Adder adder(256, true, true);
  const std::size_t before = adder.device->queue().submits();
  const std::vector<double> ones(10, 1.0);
  adder.to.write(std::span<const double>(ones), 100);
  std::vector<double> read(256);
  adder.to.read(std::span<double>(read));
  EXPECT_EQ(adder.device->queue().submits(), before + 1) << "the write goes before the read";
  for (std::size_t i = 0; i < 256; ++i) EXPECT_EQ(read[i], i >= 100 && i < 110 ? 1 : 0) << i;
}

// Writes wait in one staging buffer: one that is dropped gives no room back that others wait in.
TEST_F(VulkanWatch, ABufferThatGoesLeavesWhatWaitsForOthers) {
  Adder adder(0, true, true);  // reading sentinels would have everything copied
  const std::vector<double> ones(256, 1.0), twos(256, 2.0), threes(256, 3.0);
  const auto on_the_device = [&] {
    return Buffer(*adder.device, 256 * sizeof(double), Placement::device);
  };
  Buffer second = on_the_device();
  {
    Buffer gone = on_the_device();
    adder.to.write(std::span<const double>(ones));
    gone.write(std::span<const double>(twos));
  }
  second.write(std::span<const double>(threes));
  std::vector<double> first_read(256), second_read(256);
  adder.to.read(std::span<double>(first_read));
  second.read(std::span<double>(second_read));
  EXPECT_EQ(first_read, ones);
  EXPECT_EQ(second_read, threes);
}

// Kernels with sums over subgroups, of both variants, where a subgroup has four invocations.
TEST_F(VulkanWatch, SubgroupsOfAnotherSizeGiveTheSame) {
  const auto [output, code] = run_again(
      "LP_NATIVE_VECTOR_WIDTH=128",
      "*Products.DenseAndFew*:*Kernels.StressAndResidual*:*CgKernels.Multiply*:VulkanSubgroup.*");
  EXPECT_EQ(code, 0) << output;
  EXPECT_NE(output.find("[  PASSED  ] 11 tests"), std::string::npos) << output;
}

// In a process of the test above.
TEST(VulkanSubgroup, DISABLED_OfFour) {
  const Adder adder;
  const vulkan::PhysicalDevice& physical = adder.device->physical();
  EXPECT_EQ(physical.subgroup, 4u);
  EXPECT_TRUE(physical.subgroup_on_request);
}

TEST_F(VulkanWatch, TheVariantOfKnownSubgroupsIsRefusedWhereADriverChoosesThem) {
  vulkan::PhysicalDevice physical;
  physical.name = "GPU";
  physical.int64 = true;
  EXPECT_EQ(gpu::choose_variant(physical), gpu::Variant::gpu);
  setenv("SUNDER_SHADER_VARIANT", "lvp", 1);
  try {
    static_cast<void>(gpu::choose_variant(physical));
    ADD_FAILURE() << "not refused";
  } catch (const UsageError& error) {
    EXPECT_NE(std::string(error.what()).find("\"GPU\" lacks subgroups of a known size; use gpu"),
              std::string::npos)
        << error.what();
  }
  physical.subgroup_on_request = true;
  EXPECT_EQ(gpu::choose_variant(physical), gpu::Variant::lvp);
  unsetenv("SUNDER_SHADER_VARIANT");
}

TEST_F(VulkanWatch, ADeviceLostWhileItWorksIsNoticedByTheWait) {
  Adder adder;
  vulkan::DeviceFunctions vk = adder.device->vk();
  VkQueue handle = VK_NULL_HANDLE;
  vk.GetDeviceQueue(adder.device->handle(),
                    static_cast<std::uint32_t>(adder.device->physical().compute_family), 0,
                    &handle);
  vk.WaitForFences = [](VkDevice, std::uint32_t, const VkFence*, VkBool32, std::uint64_t) {
    return VK_ERROR_DEVICE_LOST;
  };
  vulkan::Queue queue(vk, adder.device->handle(), handle);
  VkSubmitInfo nothing{};
  nothing.sType = VK_STRUCTURE_TYPE_SUBMIT_INFO;
  queue.submit(nothing, VK_NULL_HANDLE);
  try {
    queue.wait();
    ADD_FAILURE() << "no DeviceLost was thrown";
  } catch (const DeviceLost& error) {
    EXPECT_NE(std::string(error.what()).find("was lost in vkWaitForFences"), std::string::npos)
        << error.what();
  }
  EXPECT_EQ(queue.submits(), 0u);
  vk.DeviceWaitIdle(adder.device->handle());
}

TEST_F(VulkanWatch, EachResultHasItsSentence) {
  EXPECT_NO_THROW(vulkan::check(VK_SUCCESS, "a call"));
  EXPECT_THROW(vulkan::check(VK_ERROR_DEVICE_LOST, "a call"), DeviceLost);
  const auto said = [](VkResult result) {
    return message_of([&] { vulkan::check(result, "a call"); });
  };
  EXPECT_NE(said(VK_ERROR_OUT_OF_DEVICE_MEMORY).find("out of memory"), std::string::npos);
  EXPECT_NE(said(VK_ERROR_LAYER_NOT_PRESENT).find("vulkan-validationlayers"), std::string::npos);
  EXPECT_NE(said(VK_ERROR_UNKNOWN).find("a call failed"), std::string::npos);
}

TEST_F(VulkanWatch, MoreMemoryThanThereIsIsRefusedBeforeAllocation) {
  Adder adder;
  const std::string message =
      message_of([&] { adder.device->require_memory(VkDeviceSize{1} << 62, "the dense inverse"); });
  EXPECT_NE(message.find("the dense inverse needs 4611686018427387904 bytes on the device"),
            std::string::npos)
      << message;
}

}  // namespace
}  // namespace sunder::test
