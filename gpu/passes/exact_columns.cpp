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
      dense_(kernels.make_fp64("dense")),
      solve_(kernels.make_fp64("solve")) {}

namespace {

// Room for so much damage from the start, if it takes no more memory than that.
constexpr std::size_t kRoom = 512;
constexpr std::size_t kRoomBytes = std::size_t{64} << 20;

std::uint32_t reserved(const vulkan::PhysicalDevice& device, std::uint32_t rows) {
  const std::size_t room = std::min(kRoom, kRoomBytes / (rows * sizeof(double)));
  return std::min(round_up(static_cast<std::uint32_t>(room), shaders::kChunk),
                  ExactColumns::most(device, rows));
}

/// Capacity for `count` columns beyond `capacity`: doubled, so that growth is rare.
std::uint32_t grown(std::uint32_t capacity, std::uint32_t count, std::uint32_t most) {
  return std::min(round_up(std::max(count, 2 * capacity), 2 * shaders::kChunk),
                  std::max(most, round_up(count, shaders::kChunk)));
}

}  // namespace

Index ExactColumns::most() const {
  return static_cast<Index>(most(kernels_.device().physical(), rows_));
}

std::uint32_t ExactColumns::most(const vulkan::PhysicalDevice& device, std::uint32_t rows) {
  const std::size_t limit =
      std::min<std::size_t>(device.limits.buffer_bytes.value, device.limits.allocation_bytes.value);
  const std::size_t columns = limit / (rows * sizeof(double)) / shaders::kChunk * shaders::kChunk;
  return static_cast<std::uint32_t>(std::min<std::size_t>(columns, 1u << 20));
}

std::uint32_t ExactColumns::planned_capacity(const vulkan::PhysicalDevice& device,
                                             std::uint32_t rows, Index count) {
  const std::uint32_t first = reserved(device, rows), wanted = static_cast<std::uint32_t>(count);
  return wanted <= first ? first : grown(first, wanted, most(device, rows));
}

std::size_t ExactColumns::planned_bytes(std::uint32_t rows, std::uint32_t capacity) {
  const std::size_t vector = capacity * sizeof(double);
  return vector * rows + Buffer::padded(vector);
}

std::uint32_t ExactColumns::chunks() const {
  return round_up(static_cast<std::uint32_t>(count_), shaders::kChunk) / shaders::kChunk;
}

/// What is there stays.
void ExactColumns::allocate(std::uint32_t capacity) {
  capacity_ = capacity;
  apply_binding_.reset();
  solve_binding_.reset();
  const Buffer before = std::move(columns_);
  columns_ =
      Buffer(kernels_.device(), std::size_t{capacity_} * rows_ * sizeof(double), Placement::device);
  zeroed_ = 0;
  coefficients_ = Buffer(kernels_.device(), capacity_ * sizeof(double), Placement::sent);
  coefficients_.fill_zero();
  if (count_ == 0) return;
  zeroed_ = static_cast<std::uint32_t>(count_);
  vulkan::Commands commands(kernels_.device());
  commands.begin();
  commands.copy(before.handle(), before.offset(), columns_.handle(), columns_.offset(),
                std::size_t{zeroed_} * rows_ * sizeof(double));
  commands.end();
  commands.submit();
}

void ExactColumns::reserve() { reserve(reserved(kernels_.device().physical(), rows_)); }

void ExactColumns::reserve(std::uint32_t columns) {
  if (columns > capacity_) allocate(columns);
}

bool ExactColumns::append(const Eigen::Ref<const Eigen::MatrixXd>& columns) {
  const Index count = count_ + static_cast<Index>(columns.cols());
  if (count == count_) return false;
  const bool moved = static_cast<std::uint32_t>(count) > capacity_;
  if (moved) {
    allocate(
        grown(capacity_, static_cast<std::uint32_t>(count), static_cast<std::uint32_t>(most())));
  }
  zero_to(round_up(static_cast<std::uint32_t>(count), shaders::kChunk));
  const auto rows = static_cast<std::size_t>(columns.rows());
  if (kernels_.device().physical().unified()) {  // rows beyond the unknowns stay zero
    for (Eigen::Index c = 0; c < columns.cols(); ++c) {
      columns_.write(std::span<const double>(columns.col(c).data(), rows),
                     static_cast<std::size_t>(count_ + c) * rows_);
    }
  } else {  // one transfer
    Eigen::MatrixXd padded = Eigen::MatrixXd::Zero(static_cast<Index>(rows_), columns.cols());
    padded.topRows(columns.rows()) = columns;
    columns_.write(std::span<const double>(padded.data(), static_cast<std::size_t>(padded.size())),
                   static_cast<std::size_t>(count_) * rows_);
  }
  count_ = count;
  return moved;
}

/// Columns up to `end` are zero where nothing was written. No more of them: on a processor that
/// emulates a GPU every page first touched costs.
void ExactColumns::zero_to(std::uint32_t end) {
  if (end <= zeroed_) return;
  const std::size_t column_bytes = rows_ * sizeof(double);
  columns_.fill_zero(zeroed_ * column_bytes, (end - zeroed_) * column_bytes);
  zeroed_ = end;
}

void ExactColumns::bind(const PartialSums& partials) {
  if (capacity_ == 0) return;
  const Buffer* apply[] = {&columns_, &coefficients_, &partials.buffer()};
  apply_binding_ = std::make_unique<vulkan::Binding>(kernels_.device(), *dense_, apply);
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

void ExactColumns::record_copy(vulkan::Commands& commands, Index first, Index count,
                               const Buffer& to, std::size_t to_offset) const {
  const std::size_t column_bytes = rows_ * sizeof(double);
  commands.copy(columns_.handle(),
                columns_.offset() + static_cast<std::size_t>(first) * column_bytes, to.handle(),
                to.offset() + to_offset, static_cast<std::size_t>(count) * column_bytes);
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
  commands.dispatch(
      *apply_binding_,
      shaders::ApplyPush{rows_ / 4, 0, chunks() * shaders::kChunk, 0, first_chunk, 0, capacity_, 0},
      rows_ / shaders::kRowPad, chunks());
  return chunks();
}

}  // namespace sunder::gpu
