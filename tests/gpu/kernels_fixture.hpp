// SPDX-License-Identifier: Apache-2.0
// A watched device with kernels of one variant and precision, for tests of single kernels.
#pragma once

#include <limits>
#include <random>

#include "gpu/passes/fields.hpp"
#include "gpu_body.hpp"

namespace sunder::test {

inline constexpr double kEps32 = 1.1920928955078125e-7;
inline constexpr double kEps64 = 2.220446049250313e-16;
inline constexpr double kNaN = std::numeric_limits<double>::quiet_NaN();

struct Numbers {
  gpu::Variant variant;
  bool fp64;
  [[nodiscard]] double eps() const { return fp64 ? kEps64 : kEps32; }
};

inline std::string name_of(const Numbers& numbers) {
  return std::string(numbers.variant == gpu::Variant::gpu ? "gpu" : "lvp") +
         (numbers.fp64 ? "_fp64" : "_fp32");
}

class Kernels : public WithVulkan<testing::TestWithParam<Numbers>> {
 protected:
  using Doubles = std::vector<double>;
  using Floats = std::vector<float>;
  using Words = std::vector<std::uint32_t>;

  void SetUp() override {
    WithVulkan<testing::TestWithParam<Numbers>>::SetUp();
    if (IsSkipped()) return;
    vulkan::InstanceOptions options;
    options.validation = validated();
    options.messages = messages_;
    const auto instance = std::make_shared<vulkan::Instance>(options);
    device_ = watched_device(instance, watched_probe());
    factory_ = std::make_unique<gpu::KernelFactory>(*device_, GetParam().variant, GetParam().fp64);
  }
  void TearDown() override {
    factory_.reset();
    device_.reset();
    for (const std::string& m : messages_->texts) ADD_FAILURE() << m;
  }

  /// Stress of the displacement, its summary and f - K u.
  void compute_state(gpu::Fields& fields) {
    vulkan::Commands commands(*device_);
    commands.begin();
    fields.record_state(commands);
    commands.end();
    commands.submit();
  }

  /// Symmetric, entries in [-1, 1], representable in storage precision.
  Eigen::MatrixXd random_symmetric(Index n) {
    Eigen::MatrixXd m(n, n);
    for (Index j = 0; j < n; ++j) {
      for (Index i = 0; i <= j; ++i) m(i, j) = m(j, i) = random();
    }
    return m;
  }
  double random() {
    const double v = uniform_(generator_);
    return GetParam().fp64 ? v : static_cast<double>(static_cast<float>(v));
  }
  [[nodiscard]] Doubles random_values(std::size_t count) {
    Doubles values(count);
    for (double& v : values) v = random();
    return values;
  }

  template <class T>
  [[nodiscard]] vulkan::Buffer buffer(const std::vector<T>& values) const {
    vulkan::Buffer made(*device_, values.size() * sizeof(T), vulkan::Placement::device);
    made.write(std::span<const T>(values));
    return made;
  }
  [[nodiscard]] vulkan::Buffer zeros(std::size_t doubles) const {
    return buffer(Doubles(doubles, 0.0));
  }
  /// Of numbers that are none: whatever is not written shows.
  [[nodiscard]] vulkan::Buffer empty(std::size_t doubles) const {
    return buffer(Doubles(doubles, kNaN));
  }
  template <class T = double>
  [[nodiscard]] static std::vector<T> read(const vulkan::Buffer& from, std::size_t count) {
    std::vector<T> values(count);
    from.read(std::span<T>(values));
    return values;
  }
  /// One dispatch of a kernel that make() or make_fp64() gave.
  void run(const vulkan::Kernel& kernel, const std::vector<const vulkan::Buffer*>& buffers,
           std::uint32_t x) const {
    const vulkan::Binding binding(*device_, kernel, buffers);
    vulkan::Commands commands(*device_);
    commands.begin();
    commands.dispatch(binding, x);
    commands.end();
    commands.submit();
  }
  template <class Push>
  void run(const vulkan::Kernel& kernel, const std::vector<const vulkan::Buffer*>& buffers,
           const Push& push, std::uint32_t x, std::uint32_t y = 1) const {
    const vulkan::Binding binding(*device_, kernel, buffers);
    vulkan::Commands commands(*device_);
    commands.begin();
    commands.dispatch(binding, push, x, y);
    commands.end();
    commands.submit();
  }

  std::shared_ptr<vulkan::Messages> messages_ = std::make_shared<vulkan::Messages>();
  std::unique_ptr<vulkan::Device> device_;
  std::unique_ptr<gpu::KernelFactory> factory_;
  std::mt19937 generator_{42};
  std::uniform_real_distribution<double> uniform_{-1, 1};
};

}  // namespace sunder::test
