// SPDX-License-Identifier: Apache-2.0
// Every kernel once: what it computes, what it reads through each binding, how many bytes it is
// pushed. tests/gpu/kernel_table_test.cpp holds the table against the SPIR-V of every variant.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <initializer_list>
#include <span>
#include <string_view>

namespace sunder::gpu {

/// What a kernel reads through a binding; decides how the variant binds it.
enum class Reads : std::uint8_t {
  reals,    ///< IN_REAL4: the storage precision
  doubles,  ///< IN_DVEC4
  words,    ///< IN_UVEC4
  plain,    ///< everything else: a storage buffer in both variants
};

class KernelBindings {
 public:
  static constexpr std::size_t kMost = 12;
  constexpr KernelBindings(std::initializer_list<Reads> list) {
    for (Reads reads : list) of_[count_++] = reads;
  }
  [[nodiscard]] constexpr std::span<const Reads> list() const { return {of_.data(), count_}; }

 private:
  std::array<Reads, kMost> of_{};
  std::size_t count_ = 0;
};

struct KernelRow {
  std::string_view name;  ///< of shaders/NAME.comp
  std::string_view does;  ///< for `plan`
  KernelBindings bindings;
  std::size_t push_bytes;
};

/// By name, ascending.
[[nodiscard]] std::span<const KernelRow> kernel_table();

/// The row of a kernel. Throws std::logic_error for a name that is not in the table.
[[nodiscard]] const KernelRow& kernel_row(std::string_view name);

/// Of "stress_lvp_fp64": "stress".
[[nodiscard]] std::string_view without_variant(std::string_view full_name);

}  // namespace sunder::gpu
