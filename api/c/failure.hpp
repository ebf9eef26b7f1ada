// SPDX-License-Identifier: Apache-2.0
// The border: what is thrown inside becomes a status and a sentence; nothing passes it.
#pragma once

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <exception>
#include <limits>
#include <string>

#include "sunder/sunder.h"

namespace sunder::c {

/// A failure with the status that the caller gets.
class Failure : public std::exception {
 public:
  Failure(sunder_status status, std::string text) : status_(status), text_(std::move(text)) {}
  [[nodiscard]] sunder_status status() const noexcept { return status_; }
  [[nodiscard]] const char* what() const noexcept override { return text_.c_str(); }

 private:
  sunder_status status_;
  std::string text_;
};

/// Keeps a thread's last failure; cuts long texts instead of allocating.
void remember(const char* text) noexcept;

/// Call inside a catch block: the status of what was thrown, its text remembered for this thread.
[[nodiscard]] sunder_status status_of_exception() noexcept;

/// Runs one call of the interface.
template <class Body>
[[nodiscard]] sunder_status guarded(Body&& body) noexcept {
  try {
    body();
    return SUNDER_OK;
  } catch (...) {
    return status_of_exception();
  }
}

/// Throws SUNDER_ERROR_NULL.
inline void require(const void* pointer, const char* what) {
  if (!pointer) throw Failure(SUNDER_ERROR_NULL, std::string(what) + " is null");
}

/// Throws SUNDER_ERROR_VALUE about element `at` of an array, or about a number alone (-1).
[[noreturn]] void not_finite(double value, std::ptrdiff_t at, const char* what);

/// Throws SUNDER_ERROR_SIZE unless an array has the size that it must have.
inline void require_size(std::size_t size, std::size_t wanted, const char* what) {
  if (size == wanted) return;
  throw Failure(SUNDER_ERROR_SIZE, std::string(what) + " has " + std::to_string(size) +
                                       " values; it must have " + std::to_string(wanted));
}

/// Throws SUNDER_ERROR_SIZE where ids of 32 bits could not tell the rows of an array apart: such a
/// size was never meant, and what it says is there cannot be read.
inline void require_rows(std::size_t rows, const char* what) {
  if (rows <= static_cast<std::size_t>(std::numeric_limits<std::int32_t>::max())) return;
  throw Failure(SUNDER_ERROR_SIZE, std::string(what) + " has " + std::to_string(rows) +
                                       " rows; it may have at most 2^31 - 1");
}

/// Throws SUNDER_ERROR_VALUE unless 0 <= index < count.
inline void require_index(std::int64_t index, std::int64_t count, const char* what) {
  if (index >= 0 && index < count) return;
  throw Failure(SUNDER_ERROR_VALUE, std::string(what) + " " + std::to_string(index) +
                                        " does not exist; there are " + std::to_string(count));
}

/// Throws SUNDER_ERROR_VALUE unless all numbers of an array that goes in are finite.
inline void require_finite(const double* values, std::size_t count, const char* what) {
  const double* const bad =
      std::find_if(values, values + count, [](double v) { return !std::isfinite(v); });
  if (bad != values + count) not_finite(*bad, bad - values, what);
}

inline void require_finite(double value, const char* what) {
  if (!std::isfinite(value)) not_finite(value, -1, what);
}

/// An enumeration value out of 0 .. count - 1. Throws SUNDER_ERROR_VALUE.
template <class Enum>
[[nodiscard]] Enum choice(std::int32_t value, std::int32_t count, const char* what) {
  if (value >= 0 && value < count) return static_cast<Enum>(value);
  throw Failure(SUNDER_ERROR_VALUE, std::string(what) + " = " + std::to_string(value) +
                                        " is none of 0 to " + std::to_string(count - 1));
}

}  // namespace sunder::c
