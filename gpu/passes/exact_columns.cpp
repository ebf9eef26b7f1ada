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
                                 sizeof(shaders::ProjectPush))) {}

Index ExactColumns::most() const {
  const vulkan::PhysicalDevice& device = kernels_.device().physical();
  const std::size_t limit = std::min<std::size_t>(device.largest_buffer, device.largest_allocation);
  const std::size_t most = limit / (rows_ * sizeof(double)) / shaders::kChunk * shaders::kChunk;
  return static_cast<Index>(std::min<std::size_t>(most, 1u << 20));
}

std::uint32_t ExactColumns::chunks() const {
  return round_up(static_cast<std::uint32_t>(count_), shaders::kChunk) / shaders::kChunk;
}

bool ExactColumns::extend(const Eigen::MatrixXd& all, Index count) {
  bool moved = false;
  if (static_cast<std::uint32_t>(count) > capacity_) {
    const auto wanted = std::max(static_cast<std::uint32_t>(count), 2 * capacity_);
    capacity_ = std::min(round_up(wanted, 2 * shaders::kChunk),
                         std::max(static_cast<std::uint32_t>(most()),
                                  round_up(static_cast<std::uint32_t>(count), shaders::kChunk)));
    apply_binding_.reset();
    project_binding_.reset();
    columns_ = Buffer(kernels_.device(), std::size_t{capacity_} * rows_ * sizeof(double),
                      Placement::device);
    columns_.fill_zero();
    coefficients_ = Buffer(kernels_.device(), capacity_ * sizeof(double), Placement::host);
    projection_ = Buffer(kernels_.device(), capacity_ * sizeof(double), Placement::host);
    count_ = 0;
    moved = true;
  }
  if (count > count_) {
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
  commands.dispatch(*project_binding_, shaders::ProjectPush{rows_ / 4},
                    static_cast<std::uint32_t>(count_));
}

Eigen::VectorXd ExactColumns::projection() const {
  if (count_ == 0) return {};
  return Eigen::Map<const Eigen::VectorXd>(projection_.mapped<double>(), count_);
}

}  // namespace sunder::gpu
