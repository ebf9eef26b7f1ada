// SPDX-License-Identifier: Apache-2.0
// Structs that begin with struct_size, across versions: older callers' structs are shorter, newer
// callers' longer.
#pragma once

#include <algorithm>
#include <cstddef>
#include <cstring>

#include "c/failure.hpp"

namespace sunder::c {

/// Size of a struct in the first version that had it. To be specialised when a member is appended.
template <class T>
inline constexpr std::size_t kFirstSize = sizeof(T);
template <>
inline constexpr std::size_t kFirstSize<sunder_solver_options> = offsetof(sunder_solver_options,
                                                                          no_preparation);
template <>
inline constexpr std::size_t kFirstSize<sunder_step> = offsetof(sunder_step, strain_max);
template <>
inline constexpr std::size_t kFirstSize<sunder_event> = offsetof(sunder_event, lives);
template <>
inline constexpr std::size_t kFirstSize<sunder_material> = offsetof(sunder_material, law);
template <>
inline constexpr std::size_t kFirstSize<sunder_instrument> = offsetof(sunder_instrument, turn);
template <>
inline constexpr std::size_t kFirstSize<sunder_fracture_options> = offsetof(sunder_fracture_options,
                                                                            averaging);

/// No version of any struct comes near these: such a size was never set. What an option struct has
/// beyond what is known here is read, so its limit is the lower one.
inline constexpr std::size_t kLargestResult = 65536, kLargestOptions = 1024;

/// struct_size of a caller's struct. Throws SUNDER_ERROR_NULL, SUNDER_ERROR_STRUCT_SIZE.
template <class T>
[[nodiscard]] std::size_t stated_size(const T* given, const char* what,
                                      std::size_t largest = kLargestResult) {
  require(given, what);
  std::uint32_t size = 0;
  std::memcpy(&size, given, sizeof size);  // the caller's pointer may be unaligned
  if (size >= kFirstSize<T> && size <= largest) return size;
  throw Failure(SUNDER_ERROR_STRUCT_SIZE,
                std::string(what) + " has struct_size = " + std::to_string(size) +
                    "; it must be sizeof the struct, " + std::to_string(sizeof(T)) + " here");
}

/// A caller's option struct; what it leaves out comes from `defaults`.
template <class T>
[[nodiscard]] T read_struct(const T* given, T defaults, const char* what) {
  const std::size_t size = stated_size(given, what, kLargestOptions);
  const auto* bytes = reinterpret_cast<const unsigned char*>(given);
  if (size > sizeof(T) &&
      std::any_of(bytes + sizeof(T), bytes + size, [](unsigned char b) { return b != 0; })) {
    throw Failure(SUNDER_ERROR_STRUCT_SIZE,
                  std::string(what) + " sets members that this version does not know");
  }
  std::memcpy(static_cast<void*>(&defaults), given, std::min(size, sizeof(T)));
  return defaults;
}

/// Fills a caller's result struct, as much of it as it has; what it has beyond is not touched: a
/// size that was never set would have others' memory overwritten.
template <class T>
void write_struct(T* to, T value, const char* what) {
  const std::size_t size = stated_size(to, what);
  value.struct_size = static_cast<std::uint32_t>(size);
  std::memcpy(static_cast<void*>(to), &value, std::min(size, sizeof(T)));
}

/// A zeroed struct of this version.
template <class T>
[[nodiscard]] T sized() {
  T value{};
  value.struct_size = sizeof(T);
  return value;
}

}  // namespace sunder::c
