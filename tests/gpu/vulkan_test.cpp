// SPDX-License-Identifier: Apache-2.0
// The Vulkan layer by itself: what is missing is named, what goes wrong is noticed.
#include <sys/wait.h>

#include <unistd.h>

#include <array>
#include <bit>
#include <cstdio>
#include <functional>

#include "gpu/vulkan/check.hpp"
#include "gpu_body.hpp"
#include "shaders/embedded.hpp"
#include "shaders/layout.h"
#include "sunder/backends.hpp"
#include "sunder/error.hpp"

namespace sunder::test {
namespace {

using vulkan::Access;
using vulkan::Buffer;
using vulkan::Placement;

/// Output and exit code of this program, run again with other variables and tests.
std::pair<std::string, int> run_again(const std::string& variables, const std::string& filter) {
  std::array<char, 4096> path{};
  EXPECT_GT(readlink("/proc/self/exe", path.data(), path.size() - 1), 0);
  const std::string command = variables + " '" + path.data() +
                              "' --gtest_also_run_disabled_tests --gtest_filter='" + filter +
                              "' 2>&1";
  std::FILE* pipe = popen(command.c_str(), "r");
  std::string output;
  for (int c = std::fgetc(pipe); c != EOF; c = std::fgetc(pipe)) output += static_cast<char>(c);
  const int status = pclose(pipe);
  return {output, WIFEXITED(status) ? WEXITSTATUS(status) : -1};
}

std::string message_of(const std::function<void()>& f) {
  try {
    f();
  } catch (const DeviceError& error) {
    return error.what();
  }
  return "no DeviceError was thrown";
}

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

// Run by the test below in a process without drivers.
TEST(VulkanWithoutDriver, DISABLED_AutoTakesTheCpuAndVulkanSaysWhy) {
  EXPECT_TRUE(gpu::devices().empty());
  Scene scene = small_scene();
  scene.solver.backend = "vulkan";
  const auto problem = std::make_shared<const Problem>(scene);
  const std::string message =
      message_of([&] { static_cast<void>(create_backend(problem, everything())); });
  EXPECT_NE(message.find("no Vulkan driver"), std::string::npos) << message;
  scene.solver.backend = "auto";
  const auto created = create_backend(std::make_shared<const Problem>(scene), everything());
  EXPECT_EQ(created.backend->info().backend, "cpu");
  EXPECT_TRUE(created.warnings.empty());
}

TEST(VulkanMissing, DriverIsNamed) {
  const auto [output, code] = run_again(
      "VK_DRIVER_FILES=/nonexistent VK_ICD_FILENAMES=/nonexistent", "VulkanWithoutDriver.*");
  EXPECT_EQ(code, 0) << output;
  EXPECT_NE(output.find("[  PASSED  ] 1 test"), std::string::npos) << output;
}

TEST(VulkanMissing, ADeviceThatIsExpectedFailsTheTests) {
  const auto [output, code] =
      run_again("VK_DRIVER_FILES=/nonexistent VK_ICD_FILENAMES=/nonexistent", "VulkanExpected.*");
  EXPECT_NE(code, 0) << output;
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
      message_of([&] { static_cast<void>(gpu::create(problem, everything())); });
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
  EXPECT_NE(device.shortcoming().find("shaderFloat64"), std::string::npos);
  device.float64 = true;
  EXPECT_EQ(device.shortcoming(), "");
}

TEST_F(VulkanDevices, PrecisionFollowsTheToleranceAndIsSaid) {
  for (const double tolerance : {1e-4, 1e-6}) {
    Scene scene = small_scene();
    scene.solver.tolerance = tolerance;
    const auto problem = std::make_shared<const Problem>(scene);
    const auto backend = gpu::create(problem, everything(), {});
    EXPECT_EQ(backend->info().precision, tolerance == 1e-4 ? "fp32" : "fp64");
    EXPECT_NE(backend->info().why.find("tolerance"), std::string::npos);
    EXPECT_GT(backend->info().memory_bytes, 0u);
  }
}

TEST_F(VulkanDevices, AnUnknownShaderVariantIsAnError) {
  const auto [output, code] = run_again("SUNDER_SHADER_VARIANT=fast", "DeterminismState.*");
  EXPECT_NE(code, 0);
  EXPECT_NE(output.find("SUNDER_SHADER_VARIANT is \"fast\"; it may be gpu or lvp"),
            std::string::npos)
      << output;
}

/// A device under validation, with the kernel `add` on two buffers.
struct Adder {
  explicit Adder(std::size_t guard_bytes = 0) {
    vulkan::InstanceOptions options;
    options.validation = true;
    options.messages = messages;
    instance = std::make_shared<vulkan::Instance>(options);
    device =
        vulkan::create_device(instance, vulkan::list_devices(*instance).front(), {-1, guard_bytes});
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

using VulkanWatch = WithVulkan<>;

TEST_F(VulkanWatch, AMissingBarrierIsNoticed) {
  Adder adder;
  const Buffer* swapped[] = {&adder.to, &adder.from};
  const vulkan::Binding back(*adder.device, *adder.kernel, swapped);
  vulkan::Commands commands(*adder.device);
  commands.begin();
  commands.dispatch(*adder.binding, 64u, 1);
  commands.dispatch(back, 64u, 1);
  commands.end();
  const std::string message = message_of([&] { commands.submit(); });
  EXPECT_NE(message.find("SYNC-HAZARD"), std::string::npos) << message;
}

TEST_F(VulkanWatch, ABarrierIsEnough) {
  Adder adder;
  const std::vector<double> ones(256, 1.0);
  adder.from.write(std::span<const double>(ones));
  vulkan::Commands commands(*adder.device);
  commands.begin();
  commands.pass("first");
  commands.dispatch(*adder.binding, 64u, 1);
  commands.barrier();
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
  Adder adder(256);
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

using Determinism = WithVulkan<>;

/// One step of FNV-1a over the bits of doubles.
std::uint64_t hash(std::uint64_t h, std::span<const double> values) {
  for (double v : values) {
    for (std::uint64_t bits = std::bit_cast<std::uint64_t>(v), i = 0; i < 8; ++i, bits >>= 8) {
      h = (h ^ (bits & 0xff)) * 1099511628211ull;
    }
  }
  return h;
}

// Prints a hash of displacement and stress after a crack; run by the test below.
TEST(DeterminismState, DISABLED_Print) {
  std::uint64_t h = 14695981039346656037ull;
  for (const Update update : {Update::deferred, Update::eager}) {
    Scene scene = held_board();
    scene.solver.precision = update == Update::eager ? Precision::fp64 : Precision::fp32;
    scene.solver.update = update;
    const auto problem = std::make_shared<const Problem>(scene);
    const auto backend = gpu::create(problem, everything(), {});
    backend->set_load(corner_pull(*problem));
    for (Index e : crack_sequence(*problem, 10, 10)) backend->destroy({&e, 1});
    backend->solve();
    backend->stress();
    h = hash(h, Pair::displacement(*backend));
    for (const Voigt& s : Pair::stress(*backend)) h = hash(h, {s.data(), 6});
  }
  std::printf("state %016llx\n", static_cast<unsigned long long>(h));
}

TEST_F(Determinism, SameBitsInEveryRunAndForEveryThreadCount) {
  std::string first;
  for (const char* threads : {"0", "1", "2", "2"}) {
    const auto [output, code] =
        run_again(std::string("LP_NUM_THREADS=") + threads, "DeterminismState.*");
    ASSERT_EQ(code, 0) << output;
    const auto at = output.find("state ");
    ASSERT_NE(at, std::string::npos) << output;
    const std::string state = output.substr(at, 22);
    if (first.empty()) first = state;
    EXPECT_EQ(state, first) << "with " << threads << " threads";
  }
}

}  // namespace
}  // namespace sunder::test
