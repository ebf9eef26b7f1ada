// SPDX-License-Identifier: Apache-2.0
#include "gpu/device_rates.hpp"

#include <algorithm>
#include <chrono>
#include <cmath>
#include <cstdlib>
#include <fstream>
#include <iomanip>
#include <limits>
#include <locale>
#include <map>
#include <mutex>
#include <random>
#include <sstream>
#include <string>
#include <system_error>
#include <utility>

#include "gpu/vulkan/commands.hpp"

namespace sunder::gpu {
namespace {

namespace fs = std::filesystem;

constexpr const char* kFirstLine = "sunder device rates 1";
// More than most caches hold, where a buffer may be so large; of a processor that emulates a GPU
// fewer, as it takes its time.
constexpr std::size_t kBytes = std::size_t{128} << 20, kBytesEmulated = std::size_t{64} << 20;
constexpr std::uint32_t kReads = 16;        // packs of an invocation
constexpr std::uint32_t kSmallGroups = 32;  // of a small body's dispatch: 2,048 nodes
constexpr int kDispatches = 64, kPasses = 2, kRuns = 5, kSubmits = 32;
constexpr double kLongEnough = 2e-3;  // [s] of what is counted, against what a clock adds
constexpr std::uint32_t kMostTurns = 1u << 20;

/// One kernel, its buffers, and how long what is recorded of it takes.
class Probe {
 public:
  Probe(vulkan::Device& device, Variant variant)
      : device_(device), kernels_(device, variant, device.physical().float64) {
    pack_bytes_ = 4 * (kernels_.single() ? sizeof(float) : sizeof(double));
    const vulkan::PhysicalDevice& physical = device.physical();
    const std::size_t limit =
        std::min<std::size_t>(physical.limits.buffer_bytes.value / 4 * 3, physical.memory / 4);
    const std::size_t bytes = std::min(kernels_.emulated() ? kBytesEmulated : kBytes, limit);
    groups_ = std::max<std::uint32_t>(
        static_cast<std::uint32_t>(bytes / (pack_bytes_ * kReads * shaders::kGroup)), 1);
    source_ = vulkan::Buffer(device, packs() * pack_bytes_, vulkan::Placement::device);
    source_.fill_zero();
    result_ =
        vulkan::Buffer(device, std::max(groups_, kSmallGroups) * shaders::kGroup * sizeof(double),
                       vulkan::Placement::device);
    kernel_ = kernels_.make_fp64("rate");
    const vulkan::Buffer* buffers[] = {&source_, &result_};
    binding_ = std::make_unique<vulkan::Binding>(device, *kernel_, buffers);
  }

  [[nodiscard]] std::size_t bytes() const { return packs() * pack_bytes_; }
  [[nodiscard]] std::uint32_t groups() const { return groups_; }

  /// [s] of a submit of so many dispatches, the least of some runs.
  [[nodiscard]] double seconds(int dispatches, std::uint32_t groups, std::uint32_t reads,
                               std::uint32_t turns, int runs) {
    vulkan::Commands commands(device_);
    commands.begin();
    for (int i = 0; i < dispatches; ++i) {
      commands.dispatch(*binding_, shaders::RatePush{groups * shaders::kGroup, reads, turns},
                        groups);
    }
    commands.end();
    double least = std::numeric_limits<double>::infinity();
    for (int run = 0; run <= runs; ++run) {  // the first warms up
      const auto start = std::chrono::steady_clock::now();
      commands.submit();
      const std::chrono::duration<double> passed = std::chrono::steady_clock::now() - start;
      if (run > 0) least = std::min(least, passed.count());
    }
    return least;
  }

 private:
  [[nodiscard]] std::size_t packs() const {
    return std::size_t{groups_} * shaders::kGroup * kReads;
  }
  vulkan::Device& device_;
  KernelFactory kernels_;
  std::size_t pack_bytes_ = 0;
  std::uint32_t groups_ = 0;
  vulkan::Buffer source_, result_;
  std::unique_ptr<vulkan::Kernel> kernel_;
  std::unique_ptr<vulkan::Binding> binding_;
};

std::optional<fs::path> cache_folder() {
  const auto variable = [](const char* name) -> std::string {
    const char* value = std::getenv(name);
    return value ? value : "";
  };
  if (std::getenv("SUNDER_CACHE_DIR")) {
    const std::string own = variable("SUNDER_CACHE_DIR");
    return own.empty() ? std::nullopt : std::optional<fs::path>(own);
  }
  if (const std::string xdg = variable("XDG_CACHE_HOME"); !xdg.empty())
    return fs::path(xdg) / "sunder";
  if (const std::string home = variable("HOME"); !home.empty())
    return fs::path(home) / ".cache" / "sunder";
  if (const std::string local = variable("LOCALAPPDATA"); !local.empty())
    return fs::path(local) / "sunder";
  return std::nullopt;
}

/// By the driver's own number for what it makes of kernels, another with every build of it.
std::string name_of(const vulkan::PhysicalDevice& device) {
  std::ostringstream name;
  name.imbue(std::locale::classic());  // whatever a host's is
  name << "rates-" << std::hex << device.vendor << "-" << device.device << "-" << std::setfill('0');
  for (const std::uint8_t byte : device.cache_uuid) name << std::setw(2) << int{byte};
  name << (device.float64 ? ".txt" : "-fp32.txt");
  return name.str();
}

/// The driver by its text as well: lavapipe has one number whatever its build.
std::string second_line(const vulkan::PhysicalDevice& device) {
  return "# " + device.name + ", " + device.driver;
}

/// What this process has measured, where no folder keeps it.
class Measured {
 public:
  std::optional<DeviceRates> of(const std::string& name) {
    const std::scoped_lock lock(mutex_);
    const auto at = all_.find(name);
    return at == all_.end() ? std::nullopt : std::optional(at->second);
  }
  void set(const std::string& name, const DeviceRates& rates) {
    const std::scoped_lock lock(mutex_);
    all_[name] = rates;
  }

 private:
  std::mutex mutex_;
  std::map<std::string, DeviceRates> all_;
};

Measured& measured() {
  static Measured all;
  return all;
}

bool holds(const DeviceRates& rates) {
  const auto good = [](double value) { return std::isfinite(value) && value > 0; };
  return good(rates.submit) && good(rates.dispatch) && good(rates.bytes) && good(rates.flops);
}

}  // namespace

DeviceRates measure_rates(vulkan::Device& device, Variant variant) {
  Probe probe(device, variant);
  DeviceRates rates;
  const double one = probe.seconds(1, kSmallGroups, 0, 0, kSubmits);
  const double many = probe.seconds(1 + kDispatches, kSmallGroups, 0, 0, kSubmits);
  // No clock may make them nothing: a nanosecond is under what any device takes.
  rates.dispatch = std::max((many - one) / kDispatches, 1e-9);
  rates.submit = std::max(one - rates.dispatch, 1e-9);
  const auto counted = [&](int dispatches, std::uint32_t reads, std::uint32_t turns) {
    const double all = probe.seconds(dispatches, probe.groups(), reads, turns, kRuns);
    return std::max(all - rates.submit - dispatches * rates.dispatch, all / 10);
  };
  rates.bytes = kPasses * static_cast<double>(probe.bytes()) / counted(kPasses, kReads, 0);
  std::uint32_t turns = 16;
  double seconds = counted(1, 0, turns);
  while (seconds < kLongEnough && turns < kMostTurns) seconds = counted(1, 0, turns *= 4);
  // A multiply-add counts twice, a pack has four values.
  const double flops = 8.0 * shaders::kRateUnrolled * turns * shaders::kGroup * probe.groups();
  rates.flops = flops / seconds;
  return rates;
}

std::optional<fs::path> rates_file(const vulkan::PhysicalDevice& device) {
  const auto folder = cache_folder();
  if (!folder) return std::nullopt;
  return *folder / name_of(device);
}

std::optional<DeviceRates> kept_rates(const vulkan::PhysicalDevice& device) {
  if (const auto own = measured().of(name_of(device))) return own;
  const auto path = rates_file(device);
  if (!path) return std::nullopt;
  std::ifstream in(*path);
  in.imbue(std::locale::classic());
  std::string line, key;
  if (!std::getline(in, line) || line != kFirstLine) return std::nullopt;
  if (!std::getline(in, line) || line != second_line(device)) return std::nullopt;
  DeviceRates rates;
  const std::pair<const char*, double*> all[] = {{"submit_s", &rates.submit},
                                                 {"dispatch_s", &rates.dispatch},
                                                 {"bytes_per_s", &rates.bytes},
                                                 {"flops_per_s", &rates.flops}};
  for (const auto& [name, value] : all) {
    if (!(in >> key >> *value) || key != name) return std::nullopt;
  }
  return holds(rates) ? std::optional(rates) : std::nullopt;
}

bool keep_rates(const vulkan::PhysicalDevice& device, const DeviceRates& rates) {
  if (!holds(rates)) return false;
  measured().set(name_of(device), rates);
  const auto path = rates_file(device);
  if (!path) return false;
  std::error_code failed;
  fs::create_directories(path->parent_path(), failed);
  // Another program may write the same at this moment: each to a name of its own.
  fs::path own = *path;
  own += "." + std::to_string(std::random_device{}()) + ".tmp";
  {
    std::ofstream out(own);
    out.imbue(std::locale::classic());
    out << kFirstLine << "\n"
        << second_line(device) << "\n"
        << std::setprecision(std::numeric_limits<double>::max_digits10) << "submit_s "
        << rates.submit << "\ndispatch_s " << rates.dispatch << "\nbytes_per_s " << rates.bytes
        << "\nflops_per_s " << rates.flops << "\n";
    out.close();
    if (!out) {
      fs::remove(own, failed);
      return false;
    }
  }
  fs::rename(own, *path, failed);
  if (!failed) return true;
  fs::remove(own, failed);
  return false;
}

}  // namespace sunder::gpu
