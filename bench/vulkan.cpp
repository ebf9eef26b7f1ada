// SPDX-License-Identifier: Apache-2.0
// The Vulkan backend's kernels, frames and start, each beside the CPU reference in the same run.
//   bench_vulkan [--results=DIR] [--big] [--device=N] [Google Benchmark's options]
// --results writes vulkan.csv and vulkan.md, anew after every row. --big adds what only a large GPU
// does in good time: updates up to n = 50,000, a million tetrahedra.
#include <algorithm>
#include <chrono>
#include <cstdio>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <iostream>
#include <optional>
#include <string_view>
#include <utility>

#include "gpu/choose_device.hpp"
#include "gpu/vulkan/commands.hpp"
#include "sunder/error.hpp"
#include "vulkan_rows.hpp"

namespace sunder::bench {

Gpu::Gpu(int device) {
  const auto instance = std::make_shared<vulkan::Instance>(vulkan::InstanceOptions{});
  device_ = vulkan::create_device(instance, gpu::choose_device(*instance, device));
  device_->set_timing(!device_->physical().is_cpu());  // a time stamp makes lavapipe wait
  variant_ = gpu::choose_variant(device_->physical());
  k32_ = std::make_unique<gpu::KernelFactory>(*device_, variant_, false);
  k64_ = std::make_unique<gpu::KernelFactory>(*device_, variant_, true);
}

Machine Gpu::machine() const {
  return {device_->physical().name, device_->physical().driver,
          variant_ == gpu::Variant::lvp ? "lvp" : "gpu", copy_gigabytes_per_second()};
}

double Gpu::copy_gigabytes_per_second() const {
  if (copy_ > 0) return copy_;
  const std::size_t bytes = device_->physical().is_cpu() ? 128u << 20 : 1u << 30;
  constexpr int kCopies = 8;  // in one submit: its own cost does not count
  const vulkan::Buffer from(*device_, bytes, vulkan::Placement::device);
  const vulkan::Buffer to(*device_, bytes, vulkan::Placement::device);
  vulkan::Commands commands(*device_);
  commands.begin();
  for (int c = 0; c < kCopies; ++c) {
    commands.copy(from.handle(), from.offset(), to.handle(), to.offset(), bytes);
  }
  commands.end();
  for (int run = 0; run < 5; ++run) {
    const auto start = std::chrono::steady_clock::now();
    commands.submit();
    const std::chrono::duration<double> time = std::chrono::steady_clock::now() - start;
    copy_ = std::max(copy_, 2e-9 * kCopies * static_cast<double>(bytes) / time.count());
  }
  return copy_;
}

void add_row(const std::string& name, const std::function<void(benchmark::State&)>& run,
             double seconds) {
  const auto guarded = [=, begun = false](benchmark::State& state) mutable {
    if (!std::exchange(begun, true)) std::cerr << "bench_vulkan: " << name << "\n";
    try {
      run(state);
    } catch (const Error& error) {
      state.SkipWithError(error.what());
    }
  };
  benchmark::RegisterBenchmark(name.c_str(), guarded)
      ->UseManualTime()
      ->MinTime(seconds)
      ->Unit(benchmark::kMillisecond);
}

namespace {

struct Options {
  std::string results, start_up;
  bool big = false;
  int device = kNone;
};

/// Takes its own options out of argv.
Options take_options(int& argc, char** argv) {
  Options options;
  const auto is_own = [&](const char* argument) {
    const std::string_view text = argument;
    const auto value = [&](std::string_view key) -> std::optional<std::string> {
      if (!text.starts_with(key)) return std::nullopt;
      return std::string(text.substr(key.size()));
    };
    if (const auto dir = value("--results="))
      options.results = *dir;
    else if (const auto precision = value("--start-up="))
      options.start_up = *precision;
    else if (const auto device = value("--device="))
      options.device = std::atoi(device->c_str());
    else if (text == "--big")
      options.big = true;
    else
      return false;
    return true;
  };
  argc = static_cast<int>(std::remove_if(argv + 1, argv + argc, is_own) - argv);
  return options;
}

void write_results(const std::filesystem::path& folder, const Table& table,
                   const Machine& machine) {
  std::filesystem::create_directories(folder);
  const auto replace = [&](const char* name, const auto& write) {
    const auto part = folder / (std::string(name) + ".part");
    std::ofstream out(part);
    write(out);
    out.close();
    if (!out) throw std::runtime_error("cannot write " + part.string());
    std::filesystem::rename(part, folder / name);
  };
  replace("vulkan.csv", [&](std::ostream& out) { table.write_csv(out, machine); });
  replace("vulkan.md", [&](std::ostream& out) { table.write_markdown(out, machine); });
}

}  // namespace
}  // namespace sunder::bench

int main(int argc, char** argv) try {
  using namespace sunder::bench;
  const Options options = take_options(argc, argv);
  if (!options.start_up.empty()) {
    std::printf("%.3f\n", start_up_ms(options.start_up == "fp64", options.device));
    return 0;
  }
  benchmark::Initialize(&argc, argv);
  if (benchmark::ReportUnrecognizedArguments(argc, argv)) return 2;
  const Gpu gpu(options.device);
  Table table;
  const Machine machine = gpu.machine();  // while nothing else holds its memory
  const auto write = [&] {
    if (!options.results.empty()) write_results(options.results, table, machine);
  };
  table.on_row(write);
  const Rows rows{gpu, table, options.big, options.device};
  register_kernel_rows(rows);
  register_system_rows(rows);
  register_frame_rows(rows);
  benchmark::AddCustomContext("device", machine.device);
  benchmark::AddCustomContext("driver", machine.driver);
  benchmark::RunSpecifiedBenchmarks();
  write();
} catch (const std::exception& error) {
  std::cerr << "bench_vulkan: " << error.what() << "\n";
  return 1;
}
