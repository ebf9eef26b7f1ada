// SPDX-License-Identifier: Apache-2.0
// What a device does in a second: measured, kept by device and driver, and what plans make of it.
#include "gpu/device_rates.hpp"

#include <gtest/gtest.h>
#include <unistd.h>

#include <cmath>
#include <fstream>

#include "app/output/variable.hpp"
#include "gpu/plan_device.hpp"
#include "kernels_fixture.hpp"

namespace sunder::test {
namespace {

namespace fs = std::filesystem;

/// Removed at the end.
class Folder {
 public:
  Folder() : path_(fs::path(testing::TempDir()) / ("rates-" + std::to_string(getpid()))) {
    fs::remove_all(path_);
    fs::create_directory(path_);
  }
  ~Folder() { fs::remove_all(path_); }
  Folder(const Folder&) = delete;
  Folder& operator=(const Folder&) = delete;
  [[nodiscard]] fs::path operator/(const char* name) const { return path_ / name; }
  [[nodiscard]] std::string name() const { return path_.string(); }

 private:
  fs::path path_;
};

/// No other test's, so that nothing of it is known yet.
vulkan::PhysicalDevice device_number(std::uint8_t number) {
  vulkan::PhysicalDevice device;
  device.name = "a card";
  device.driver = "a driver 1.0";
  device.type = VK_PHYSICAL_DEVICE_TYPE_DISCRETE_GPU;
  device.float64 = true;
  device.cache_uuid.fill(number);
  return device;
}

void write(const fs::path& path, const std::string& text) {
  fs::create_directories(path.parent_path());
  std::ofstream(path) << text;
}

std::string text_of(const fs::path& path) {
  std::ifstream in(path);
  return {std::istreambuf_iterator<char>(in), {}};
}

TEST(DeviceRates, AreKeptByDeviceAndDriver) {
  const Folder folder;
  const Variable here("SUNDER_CACHE_DIR", (folder / "new").string());
  const auto device = device_number(1);
  EXPECT_FALSE(gpu::kept_rates(device));
  ASSERT_TRUE(gpu::keep_rates(device, {1. / 1024, 1. / 4096, 3e11, 4e12}));
  const auto path = gpu::rates_file(device);
  ASSERT_TRUE(path);
  EXPECT_EQ(text_of(*path),
            "sunder device rates 1\n# a card, a driver 1.0\nsubmit_s 0.0009765625\n"
            "dispatch_s 0.000244140625\nbytes_per_s 300000000000\nflops_per_s 4000000000000\n");
  EXPECT_EQ(std::distance(fs::directory_iterator(folder / "new"), {}), 1) << "nothing beside it";
  // Another driver is another device.
  EXPECT_FALSE(gpu::kept_rates(device_number(2)));
  EXPECT_NE(gpu::rates_file(device_number(2)), path);
}

TEST(DeviceRates, OfAFileAreReadWhereItIsWhole) {
  const Folder folder;
  const Variable here("SUNDER_CACHE_DIR", folder.name());
  const auto device = device_number(3);
  const auto path = gpu::rates_file(device).value();
  const std::string head = "sunder device rates 1\n# a card, a driver 1.0\n";
  for (const std::string& bad :
       {std::string(), std::string("sunder device rates 2\n# a card\nsubmit_s 1\n"), head,
        head + "submit_s 1e-5\ndispatch_s 2e-6\nbytes_per_s 3e11\n",
        head + "submit_s 1e-5\ndispatch_s 0\nbytes_per_s 3e11\nflops_per_s 4e12\n",
        head + "submit_s 1e-5\ndispatch_s -2e-6\nbytes_per_s 3e11\nflops_per_s 4e12\n",
        head + "submit_s nan\ndispatch_s 2e-6\nbytes_per_s 3e11\nflops_per_s 4e12\n"}) {
    write(path, bad);
    EXPECT_FALSE(gpu::kept_rates(device)) << bad;
    EXPECT_FALSE(gpu::plan_device(device, false).rates.measured);
  }
  write(path, head + "submit_s 1e-5\ndispatch_s 2e-6\nbytes_per_s 3e11\nflops_per_s 4e12\n");
  auto updated = device;  // lavapipe's number stays the same
  updated.driver = "a driver 1.1";
  EXPECT_EQ(gpu::rates_file(updated), path);
  EXPECT_FALSE(gpu::kept_rates(updated));
  const auto rates = gpu::plan_device(device, false).rates;
  EXPECT_TRUE(rates.measured);
  EXPECT_EQ(rates.submit, 1e-5);
  EXPECT_EQ(rates.dispatch, 2e-6);
  EXPECT_EQ(rates.flops, 4e12);
  EXPECT_LT(rates.bytes, 3e11) << "kernels gather";
  EXPECT_GT(rates.bytes, 1e11);
}

TEST(DeviceRates, WithoutAFolderAreThisProcesss) {
  const Variable here("SUNDER_CACHE_DIR", "");
  const auto device = device_number(4);
  EXPECT_FALSE(gpu::rates_file(device));
  EXPECT_FALSE(gpu::keep_rates(device, {1e-5, 2e-6, 3e11, 4e12}));
  EXPECT_EQ(gpu::kept_rates(device)->bytes, 3e11);
}

TEST(DeviceRates, ThatAFolderDoesNotTakeAreThisProcesss) {
  const Folder folder;
  write(folder / "file", "");
  const Variable here("SUNDER_CACHE_DIR", (folder / "file").string());
  const auto device = device_number(5);
  EXPECT_FALSE(gpu::keep_rates(device, {1e-5, 2e-6, 3e11, 4e12}));
  EXPECT_TRUE(gpu::kept_rates(device));
}

class RatesKernels : public Kernels {};

INSTANTIATE_TEST_SUITE_P(All, RatesKernels,
                         testing::Values(Numbers{gpu::Variant::gpu, true},
                                         Numbers{gpu::Variant::lvp, true}),
                         [](const auto& info) { return name_of(info.param); });

void expect_rates(vulkan::Device& device, gpu::Variant variant) {
  const std::size_t before = device.held_bytes();
  const gpu::DeviceRates rates = gpu::measure_rates(device, variant);
  EXPECT_EQ(device.held_bytes(), before);
  for (const double seconds : {rates.submit, rates.dispatch}) {
    EXPECT_GT(seconds, 0);
    EXPECT_LT(seconds, 1);
  }
  for (const double per_second : {rates.bytes, rates.flops}) {
    EXPECT_GT(per_second, 1e6);
    EXPECT_LT(per_second, 1e16);
  }
}

TEST_P(RatesKernels, MeasureWhatTheDeviceDoesAndLeaveNothing) {
  expect_rates(*device_, GetParam().variant);
}

TEST_P(RatesKernels, MeasureADeviceWithoutFp64) {
  vulkan::InstanceOptions options;
  options.validation = validated();
  options.messages = messages_;
  vulkan::DeviceProbe probe = watched_probe();
  probe.no_float64 = true;
  const auto single = watched_device(std::make_shared<vulkan::Instance>(options), probe);
  expect_rates(*single, GetParam().variant);
}

}  // namespace
}  // namespace sunder::test
