// SPDX-License-Identifier: Apache-2.0
// Rows of the Vulkan benchmark: how they are measured, and the table that is committed under
// bench/results/<machine>.
#pragma once

#include <benchmark/benchmark.h>

#include <functional>
#include <iosfwd>
#include <string>
#include <vector>

namespace sunder::bench {

/// One measured row. Zero: not measured, or does not apply.
struct Row {
  std::string name;
  double min_ms = 0, median_ms = 0;
  double cpu_ms = 0;        ///< of all threads, per repetition; twice the wall on two busy cores
  double reference_ms = 0;  ///< minimum of the CPU reference on the same work
  double bytes = 0;         ///< that the work must move at least
  [[nodiscard]] double gigabytes_per_second() const { return bytes / (1e6 * min_ms); }
};

struct Work {
  std::function<void()> prepare = [] {};  ///< untimed
  bool warm_up = false;                   ///< run once untimed: a device compiles kernels then
  std::function<void()> run;
  /// Own measure of one run [ms] instead of its wall time.
  std::function<double()> milliseconds = {};
  std::function<void()> reference = {};          ///< the same on the CPU reference
  std::function<void()> prepare_reference = {};  ///< untimed
  double bytes = 0;
};

/// Everything that a table's head states.
struct Machine {
  std::string device, driver, variant;
  double copy_gigabytes_per_second = 0;  ///< read plus written, by vkCmdCopyBuffer
};

class Table {
 public:
  /// Runs `work` for as long as `state` wants, then the reference, and keeps the row.
  Row& measure(benchmark::State& state, const std::string& name, const Work& work);
  /// Called after every row: a run that is ended has left what was measured by then.
  void on_row(std::function<void()> act) { on_row_ = std::move(act); }
  void write_csv(std::ostream& out, const Machine& machine) const;
  void write_markdown(std::ostream& out, const Machine& machine) const;

 private:
  [[nodiscard]] Row& row_of(const std::string& name);
  void show(benchmark::State& state, const Row& row) const;
  std::vector<Row> rows_;
  std::function<void()> on_row_ = [] {};
};

}  // namespace sunder::bench
