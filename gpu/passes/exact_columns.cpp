// SPDX-License-Identifier: Apache-2.0
#include "gpu/passes/exact_columns.hpp"

#include <algorithm>

#include "gpu/passes/fields.hpp"

namespace sunder::gpu {

using vulkan::Buffer;
using vulkan::Placement;

ExactColumns::ExactColumns(const KernelFactory& kernels, std::uint32_t rows)
    : kernels_(kernels),
      rows_(rows),
      dense_(kernels.make_fp64("dense", {Reads::doubles, Reads::doubles, Reads::plain},
                               sizeof(shaders::ApplyPush))),
      project_(kernels.make_fp64("project", {Reads::doubles, Reads::doubles, Reads::plain},
                                 sizeof(shaders::ProjectPush))),
      solve_(kernels.make_fp64("solve",
                               {Reads::doubles, Reads::doubles, Reads::words, Reads::plain},
                               sizeof(shaders::SolvePush))) {}

Index ExactColumns::most() const {
  const vulkan::PhysicalDevice& device = kernels_.device().physical();
  const std::size_t limit = std::min<std::size_t>(device.largest_buffer, device.largest_allocation);
  const std::size_t most = limit / (rows_ * sizeof(double)) / shaders::kChunk * shaders::kChunk;
  return static_cast<Index>(std::min<std::size_t>(most, 1u << 20));
}

std::uint32_t ExactColumns::chunks() const {
  return round_up(static_cast<std::uint32_t>(count_), shaders::kChunk) / shaders::kChunk;
}

void ExactColumns::allocate(std::uint32_t capacity) {
  capacity_ = capacity;
  apply_binding_.reset();
  project_binding_.reset();
  solve_binding_.reset();
  columns_ =
      Buffer(kernels_.device(), std::size_t{capacity_} * rows_ * sizeof(double), Placement::device);
  columns_.fill_zero();
  coefficients_ = Buffer(kernels_.device(), capacity_ * sizeof(double), Placement::host);
  coefficients_.fill_zero();
  projection_ = Buffer(kernels_.device(), capacity_ * sizeof(double), Placement::host);
  count_ = 0;
}

void ExactColumns::reserve(Index count) {
  const auto wanted = std::min(round_up(static_cast<std::uint32_t>(count), shaders::kChunk),
                               static_cast<std::uint32_t>(most()));
  if (wanted > capacity_) allocate(wanted);
}

bool ExactColumns::extend(const Eigen::MatrixXd& all, Index count) {
  bool moved = false;
  if (static_cast<std::uint32_t>(count) > capacity_) {
    const auto wanted = std::max(static_cast<std::uint32_t>(count), 2 * capacity_);
    allocate(std::min(round_up(wanted, 2 * shaders::kChunk),
                      std::max(static_cast<std::uint32_t>(most()),
                               round_up(static_cast<std::uint32_t>(count), shaders::kChunk))));
    moved = true;
  }
  if (kernels_.device().physical().unified()) {
    // Rows beyond the unknowns stay the zeros that allocate() wrote.
    for (; count_ < count; ++count_) {
      columns_.write(
          std::span<const double>(all.col(count_).data(), static_cast<std::size_t>(all.rows())),
          static_cast<std::size_t>(count_) * rows_);
    }
  } else if (count > count_) {  // one transfer
    Eigen::MatrixXd padded = Eigen::MatrixXd::Zero(static_cast<Index>(rows_), count - count_);
    padded.topRows(all.rows()) = all.middleCols(count_, count - count_);
    columns_.write(std::span<const double>(padded.data(), static_cast<std::size_t>(padded.size())),
                   static_cast<std::size_t>(count_) * rows_);
    count_ = count;
  }
  return moved;
}

void ExactColumns::bind(const PartialSums& partials, const Buffer& vector) {
  if (capacity_ == 0) return;
  const Buffer* apply[] = {&columns_, &coefficients_, &partials.buffer()};
  const Buffer* project[] = {&columns_, &vector, &projection_};
  apply_binding_ = std::make_unique<vulkan::Binding>(kernels_.device(), *dense_, apply);
  project_binding_ = std::make_unique<vulkan::Binding>(kernels_.device(), *project_, project);
}

void ExactColumns::bind_solve(const Buffer& positions, const Buffer& nodal) {
  if (capacity_ == 0) return;
  const Buffer* buffers[] = {&columns_, &coefficients_, &positions, &nodal};
  solve_binding_ = std::make_unique<vulkan::Binding>(kernels_.device(), *solve_, buffers);
}

bool ExactColumns::whole_in_one() const {
  return kernels_.device().physical().is_cpu() || chunks() <= 1;
}

void ExactColumns::record_solve(vulkan::Commands& commands) const {
  commands.dispatch(*solve_binding_,
                    shaders::SolvePush{rows_ / 4, round_up(static_cast<std::uint32_t>(count_), 4)},
                    rows_ / shaders::kRowPad);
}

void ExactColumns::set_coefficients(const Eigen::VectorXd& coefficients) {
  if (count_ == 0) return;
  auto* to = coefficients_.mapped<double>();
  std::copy_n(coefficients.data(), count_, to);
  std::fill(to + count_, to + std::size_t{chunks()} * shaders::kChunk, 0.0);
}

std::uint32_t ExactColumns::record_apply(vulkan::Commands& commands,
                                         std::uint32_t first_chunk) const {
  if (count_ == 0) return 0;
  commands.dispatch(*apply_binding_,
                    shaders::ApplyPush{rows_ / 4, 0, chunks() * shaders::kChunk, 0, first_chunk},
                    rows_ / shaders::kRowPad, chunks());
  return chunks();
}

void ExactColumns::record_project(vulkan::Commands& commands) const {
  if (count_ == 0) return;
  const std::uint32_t parts = kernels_.parts();
  commands.dispatch(*project_binding_, shaders::ProjectPush{rows_ / 4},
                    round_up(static_cast<std::uint32_t>(count_), parts) / parts);
}

Eigen::VectorXd ExactColumns::projection() const {
  if (count_ == 0) return {};
  return Eigen::Map<const Eigen::VectorXd>(projection_.mapped<double>(), count_);
}

}  // namespace sunder::gpu
