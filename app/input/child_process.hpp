// SPDX-License-Identifier: Apache-2.0
// Runs a function in a forked child with limits, so that its crash, hang or hunger for memory is
// an outcome and not the end of the program.
#pragma once

#include <chrono>
#include <cstddef>
#include <functional>
#include <string>

namespace sunder::app {

/// False under sanitizers, which reserve far more address space than any limit.
extern const bool kLimitsMemory;

struct ChildLimits {
  std::chrono::milliseconds timeout{30'000};
  std::size_t memory_bytes = std::size_t{2} << 30U;  ///< beyond what the parent holds
};

struct ChildOutcome {
  enum class End { done, crashed, timed_out, out_of_memory };
  End end = End::crashed;
  int signal = 0;          ///< that ended a crashed child, 0: none
  std::string result;      ///< what the function returned, when done
  std::string error_text;  ///< what the child wrote to its standard error
};

/// The function must not throw anything but std::bad_alloc. Its standard output is discarded.
[[nodiscard]] ChildOutcome run_in_child(const std::function<std::string()>& work,
                                        const ChildLimits& limits);

}  // namespace sunder::app
