// SPDX-License-Identifier: Apache-2.0
#include "vulkan_table.hpp"

#include <algorithm>
#include <array>
#include <chrono>
#include <cstdio>
#include <ctime>
#include <fstream>
#include <ostream>
#include <thread>

namespace sunder::bench {
namespace {

using Clock = std::chrono::steady_clock;

double milliseconds_since(Clock::time_point start) {
  return std::chrono::duration<double, std::milli>(Clock::now() - start).count();
}

/// Of all threads of the process: lavapipe's workers included.
double process_cpu_ms() {
  timespec t{};
  clock_gettime(CLOCK_PROCESS_CPUTIME_ID, &t);
  return 1e3 * static_cast<double>(t.tv_sec) + 1e-6 * static_cast<double>(t.tv_nsec);
}

/// Fewest milliseconds of some repetitions: at least three, and a fifth of a second together.
double reference_ms(const Work& work) {
  double least = 1e300, sum = 0;
  for (int runs = 0; runs < 3 || (sum < 200 && runs < 10000); ++runs) {
    if (work.prepare_reference) work.prepare_reference();
    const auto start = Clock::now();
    work.reference();
    const double ms = milliseconds_since(start);
    least = std::min(least, ms);
    sum += ms;
  }
  return least;
}

std::string output_of(const char* command) {
  std::string text;
  if (std::FILE* pipe = popen(command, "r")) {
    for (int c = std::fgetc(pipe); c != EOF; c = std::fgetc(pipe)) text += static_cast<char>(c);
    pclose(pipe);
  }
  while (!text.empty() && text.back() == '\n') text.pop_back();
  return text;
}

std::string processor() {
  std::ifstream info("/proc/cpuinfo");
  std::string name = "unknown";
  int count = 0;
  for (std::string line; std::getline(info, line);) {
    if (!line.starts_with("model name")) continue;
    name = line.substr(line.find(':') + 2);
    ++count;
  }
  return name + ", " + std::to_string(count) + " logical processors";
}

using Field = std::array<std::string, 2>;

double load_average() {
  double load = 0;
  std::ifstream("/proc/loadavg") >> load;
  return load;
}

std::vector<Field> head(const Machine& machine) {
  std::array<char, 64> text{};
  std::snprintf(text.data(), text.size(), "%.1f GB/s", machine.copy_gigabytes_per_second);
  const std::string commit =
      output_of("git -C '" SUNDER_SOURCE "' describe --always --dirty --abbrev=10 2>/dev/null");
  return {{"date", output_of("date -u +%Y-%m-%d")},
          {"processor", processor()},
          {"load at the end", std::to_string(load_average()).substr(0, 4)},
          {"device", machine.device},
          {"driver", machine.driver},
          {"shader variant", machine.variant},
          {"copy bandwidth", text.data()},
          {"commit", commit.empty() ? "unknown" : commit}};
}

/// Three significant digits; empty for what was not measured.
std::string number(double value) {
  if (!(value > 0)) return "";
  std::array<char, 32> text{};
  std::snprintf(text.data(), text.size(), value < 1000 ? "%.3g" : "%.0f", value);
  return text.data();
}

double over(double a, double b) { return b > 0 ? a / b : 0; }

std::vector<std::string> cells(const Row& row, const Machine& machine) {
  const double rate = row.gigabytes_per_second();
  return {row.name,
          number(row.min_ms),
          number(row.median_ms),
          number(row.cpu_ms),
          number(row.reference_ms),
          number(over(row.min_ms, row.reference_ms)),
          number(rate),
          number(over(rate, machine.copy_gigabytes_per_second))};
}

const std::vector<std::string> kColumns = {
    "row",          "min_ms",         "median_ms",       "cpu_ms",
    "reference_ms", "over_reference", "gigabytes_per_s", "of_copy_bandwidth"};

}  // namespace

Row& Table::measure(benchmark::State& state, const std::string& name, const Work& work) {
  Row row;
  row.name = name;
  row.bytes = work.bytes;
  std::vector<double> ms;
  double cpu = 0;
  if (work.warm_up) {
    work.prepare();
    work.run();
    if (work.milliseconds) static_cast<void>(work.milliseconds());
  }
  for (auto _ : state) {
    work.prepare();
    const double cpu_before = process_cpu_ms();
    const auto start = Clock::now();
    work.run();
    const double wall = milliseconds_since(start);
    cpu += process_cpu_ms() - cpu_before;
    ms.push_back(work.milliseconds ? work.milliseconds() : wall);
    state.SetIterationTime(1e-3 * ms.back());
  }
  Row& kept = row_of(name);
  if (ms.empty()) return kept;
  std::sort(ms.begin(), ms.end());
  row.min_ms = ms.front();
  row.median_ms = ms[ms.size() / 2];
  row.cpu_ms = work.milliseconds ? 0 : cpu / static_cast<double>(ms.size());
  row.reference_ms = kept.reference_ms;
  if (work.reference && !(row.reference_ms > 0)) row.reference_ms = reference_ms(work);
  show(state, row);
  kept = row;
  on_row_();
  return kept;
}

// Google Benchmark calls a row several times until it has found its number of iterations; the last
// call counts.
Row& Table::row_of(const std::string& name) {
  const auto same =
      std::find_if(rows_.begin(), rows_.end(), [&](const Row& row) { return row.name == name; });
  if (same != rows_.end()) return *same;
  rows_.emplace_back().name = name;
  return rows_.back();
}

void Table::show(benchmark::State& state, const Row& row) const {
  state.counters["min_ms"] = row.min_ms;
  state.counters["median_ms"] = row.median_ms;
  state.counters["cpu_ms"] = row.cpu_ms;
  if (row.reference_ms > 0) state.counters["reference_ms"] = row.reference_ms;
  if (row.bytes > 0) state.counters["GB/s"] = row.gigabytes_per_second();
}

void Table::write_csv(std::ostream& out, const Machine& machine) const {
  for (const Field& f : head(machine)) out << "# " << f[0] << ": " << f[1] << "\n";
  for (std::size_t c = 0; c < kColumns.size(); ++c) out << (c ? "," : "") << kColumns[c];
  out << "\n";
  for (const Row& row : rows_) {
    const auto texts = cells(row, machine);
    for (std::size_t c = 0; c < texts.size(); ++c) out << (c ? "," : "") << texts[c];
    out << "\n";
  }
}

void Table::write_markdown(std::ostream& out, const Machine& machine) const {
  out << "<!-- SPDX-License-Identifier: Apache-2.0 -->\n# Vulkan backend on " << machine.device
      << "\n\nWritten by `bench_vulkan --results=DIR`. Times in ms: minimum and median wall time, "
         "CPU time of all threads;\n`reference_ms` is the CPU reference (double precision, one "
         "thread) on the same work in the same run.\n\n";
  for (const Field& f : head(machine)) out << "- " << f[0] << ": " << f[1] << "\n";
  // lavapipe's own threads and this one account for the processors.
  if (load_average() > 1.5 * std::thread::hardware_concurrency()) {
    out << "\n**Other work kept the processors busy: every time is an upper bound.**\n";
  }
  out << "\n|";
  for (const std::string& c : kColumns) out << " " << c << " |";
  out << "\n|---|";
  for (std::size_t c = 1; c < kColumns.size(); ++c) out << "---:|";
  out << "\n";
  for (const Row& row : rows_) {
    out << "|";
    for (const std::string& text : cells(row, machine)) out << " " << text << " |";
    out << "\n";
  }
}

}  // namespace sunder::bench
