// SPDX-License-Identifier: Apache-2.0
// Columns of the base's inverse in fp64 on the device: those that the damage, the grips and a few
// loads multiply (mixed recipe: their coefficients grow to 30 times the load, so they must be
// exact).
#pragma once

#include <Eigen/Core>
#include <algorithm>
#include <memory>
#include <span>

#include "gpu/kernels.hpp"
#include "gpu/passes/dense_inverse.hpp"
#include "gpu/vulkan/commands.hpp"

namespace sunder::gpu {

class ExactColumns {
 public:
  ExactColumns(const KernelFactory& kernels, std::uint32_t rows);

  /// Columns beyond this do not fit the device's buffers.
  [[nodiscard]] Index most() const;
  [[nodiscard]] static std::uint32_t most(const vulkan::PhysicalDevice& device, std::uint32_t rows);
  /// Adds columns, shape (n x columns). Returns true when buffers moved: bind() anew.
  bool append(const Eigen::Ref<const Eigen::MatrixXd>& columns);
  void clear() { count_ = 0; }
  /// Drops those from `count` on.
  void keep(Index count) { count_ = std::min(count_, count); }
  /// Room for the damage to come, so that a frame need not allocate.
  void reserve();
  /// Room for so many columns.
  void reserve(std::uint32_t columns);
  /// Columns that reserve() and then extend() to `count` make room for, and their bytes.
  [[nodiscard]] static std::uint32_t planned_capacity(const vulkan::PhysicalDevice& device,
                                                      std::uint32_t rows, Index count);
  [[nodiscard]] static std::size_t planned_bytes(std::uint32_t rows, std::uint32_t capacity);

  [[nodiscard]] Index count() const { return count_; }
  [[nodiscard]] std::uint32_t chunks() const;
  /// Chunks that the present capacity may need.
  [[nodiscard]] std::uint32_t chunk_capacity() const { return capacity_ / shaders::kChunk; }
  void bind(const PartialSums& partials);
  /// For record_solve(): places of the unknowns in `nodal`.
  void bind_solve(const vulkan::Buffer& positions, const vulkan::Buffer& nodal);

  void set_coefficients(const Eigen::VectorXd& coefficients);
  /// partials from `first_chunk` on = columns times coefficients; returns how many.
  std::uint32_t record_apply(vulkan::Commands& commands, std::uint32_t first_chunk) const;
  /// One pass may do the whole product: few columns, or a device with few cores.
  [[nodiscard]] bool whole_in_one() const;
  /// nodal = columns times coefficients, without partial sums.
  void record_solve(vulkan::Commands& commands) const;

  /// Copies some columns that lie side by side.
  void record_copy(vulkan::Commands& commands, Index first, Index count, const vulkan::Buffer& to,
                   std::size_t to_offset) const;

  [[nodiscard]] std::size_t bytes() const { return columns_.bytes(); }

 private:
  const KernelFactory& kernels_;
  std::uint32_t rows_, capacity_ = 0, zeroed_ = 0;  // columns
  Index count_ = 0;
  void allocate(std::uint32_t capacity);
  void zero_to(std::uint32_t end);

  std::unique_ptr<vulkan::Kernel> dense_, solve_;
  vulkan::Buffer columns_, coefficients_;
  std::unique_ptr<vulkan::Binding> apply_binding_, solve_binding_;
};

}  // namespace sunder::gpu
