// SPDX-License-Identifier: Apache-2.0
#include "gpu/passes/inverse_update.hpp"

#include <algorithm>

namespace sunder::gpu {
namespace {

using vulkan::Buffer;
using vulkan::Placement;

// Columns of a piece: of 5,000 unknowns and 256 columns of the damage .2 Gflop.
constexpr std::uint32_t kPieceColumns = shaders::kColumnPad;
// As shaders/dense_product.comp takes them.
static_assert(kPieceColumns % shaders::kDepth == 0 && kPieceColumns % shaders::kTile == 0);
static_assert(shaders::kUpdateColumns * shaders::kDepth == shaders::kTile);

std::uint32_t padded(std::size_t columns) {
  return round_up(static_cast<std::uint32_t>(columns), shaders::kColumnPad);
}

}  // namespace

InverseUpdate::InverseUpdate(const KernelFactory& kernels, Index n, std::uint32_t rows,
                             std::size_t panel_bytes, std::uint32_t columns)
    : kernels_(kernels),
      rows_(rows),
      product_(kernels.make("dense_product", kernels.low_rank_group())),
      next_(kernels_, n, rows, panel_bytes),
      commands_(kernels.device()) {
  next_.prepare_mirror();
  reserve(padded(columns));
}

std::size_t InverseUpdate::planned_bytes(const KernelFactory& kernels, Index n, std::uint32_t rows,
                                         std::size_t panel_bytes, std::uint32_t columns) {
  const std::size_t k = padded(columns);
  return DenseInverse::planned(kernels, n, rows, panel_bytes).bytes +
         (kPanels * rows + kSmall * k) * k * sizeof(double);
}

std::size_t InverseUpdate::bytes() const {
  std::size_t bytes = next_.bytes();
  for (const Buffer& panel : panels_) bytes += panel.bytes();
  for (const Buffer& small : small_) bytes += small.bytes();
  return bytes;
}

void InverseUpdate::reserve(std::uint32_t columns) {
  if (columns <= capacity_) return;
  capacity_ = columns;
  const std::size_t k = columns;
  for (Buffer& panel : panels_) {
    panel = Buffer(kernels_.device(), k * rows_ * sizeof(double), Placement::device);
  }
  for (Buffer& small : small_) {
    small = Buffer(kernels_.device(), k * k * sizeof(double), Placement::device);
  }
}

void InverseUpdate::begin(const DenseInverse& of, const ExactColumns& columns,
                          std::span<const Index> places, const solver::DamageMatrices& damage,
                          std::size_t parts) {
  bindings_.clear();
  pieces_.clear();
  all_work_ = done_work_ = 0;
  step_ = next_piece_ = part_ = 0;
  parts_ = std::max<std::size_t>(parts, 1);
  depth_ = padded(places.size());
  reserve(depth_);
  copy_columns(columns, places);
  const auto count = static_cast<Index>(places.size());
  write_small(kCompliance, damage.compliance, count);
  write_small(kM, damage.m, count);
  write_small(kD, damage.d, count);
  add_forces();
  add_inverse(of);
  in_work_ = true;
}

/// X B, and zeros where its padding has what would count.
void InverseUpdate::copy_columns(const ExactColumns& columns, std::span<const Index> places) {
  const Buffer& to = panels_[kColumns];
  const std::size_t column_bytes = rows_ * sizeof(double);
  commands_.begin();
  for (std::size_t first = 0; first < places.size();) {
    std::size_t last = first + 1;  // those that lie side by side at once
    while (last < places.size() && places[last] == places[last - 1] + 1) ++last;
    columns.record_copy(commands_, places[first], static_cast<Index>(last - first), to,
                        first * column_bytes);
    first = last;
  }
  if (places.size() < depth_) {
    commands_.fill_zero(to, places.size() * column_bytes, (depth_ - places.size()) * column_bytes);
  }
  commands_.end();
  commands_.submit();
}

void InverseUpdate::write_small(Small which, const linear_algebra::RowMajor& a, Index count) {
  linear_algebra::RowMajor all = linear_algebra::RowMajor::Zero(depth_, depth_);
  all.topLeftCorner(count, count) = a.topLeftCorner(count, count);
  small_[which].write(std::span<const double>(all.data(), static_cast<std::size_t>(all.size())));
}

// As forces_of() in solver/condensed_update.cpp has it: x = M p, lacking l = D (p + G x) - x, and
// x + l + M G l is right. All of these matrices are symmetric.
void InverseUpdate::add_forces() {
  add_small_product(kForces, kColumns, kM, 0, kColumns);
  add_small_product(kMoved, kForces, kCompliance, 1, kColumns);
  add_small_product(kLost, kMoved, kD, 0, kColumns);
  add_small_product(kLacks, kMoved, kD, -1, kForces);
  add_small_product(kMoved, kLacks, kCompliance, 0, kColumns);
  add_small_product(kForces, kMoved, kM, 1, kLost);
}

void InverseUpdate::add_small_product(Panel after, Panel left, Small right, float keep,
                                      Panel before) {
  const Buffer* buffers[] = {&panels_[before], &panels_[left], &small_[right], &panels_[after]};
  add_pieces(std::make_unique<vulkan::Binding>(kernels_.device(), *product_, buffers),
             {rows_ / 4, depth_, depth_ / 4, 0, 0, 0, keep, 0}, depth_);
}

void InverseUpdate::add_inverse(const DenseInverse& of) {
  const auto from = of.parts(), to = next_.parts();
  for (std::size_t i = 0; i < from.size(); ++i) {
    const Buffer* buffers[] = {from[i].matrix, &panels_[kColumns], &panels_[kForces], to[i].matrix};
    add_pieces(std::make_unique<vulkan::Binding>(kernels_.device(), *product_, buffers),
               {rows_ / 4, depth_, rows_ / 4, from[i].first, from[i].first, 0, 1, 1},
               from[i].columns);
  }
}

void InverseUpdate::add_pieces(std::unique_ptr<vulkan::Binding> binding, shaders::ProductPush push,
                               std::uint32_t columns) {
  for (; push.column < columns; push.column += kPieceColumns) {
    const std::uint32_t left_out = push.lower ? push.first_column + push.column : 0;
    const double work = static_cast<double>(rows_ - left_out) * push.depth;
    pieces_.push_back({step_, binding.get(), push, rows_ / shaders::kTile, work});
    all_work_ += work;
  }
  ++step_;
  bindings_.push_back(std::move(binding));
}

/// Pieces until so much work is done.
void InverseUpdate::compute(double until) {
  if (next_piece_ == pieces_.size() || done_work_ >= until) return;
  const std::uint32_t groups =
      kPieceColumns * (shaders::kTile / 4) / (kernels_.low_rank_group() * shaders::kUpdateColumns);
  commands_.begin();
  commands_.pass("update");
  std::optional<std::size_t> step;
  for (; next_piece_ < pieces_.size() && done_work_ < until; ++next_piece_) {
    const Piece& piece = pieces_[next_piece_];
    if (step == piece.step) commands_.apart();
    step = piece.step;
    commands_.dispatch(*piece.binding, piece.push, piece.tiles, groups);
    done_work_ += piece.work;
  }
  if (next_piece_ == pieces_.size()) next_.record_mirror(commands_);
  commands_.end();
  commands_.submit();
}

void InverseUpdate::advance() {
  if (!in_work_ || part_ == parts_) return;
  ++part_;
  // The last one ends it, whatever sums of many shares round.
  compute(part_ == parts_ ? 2 * all_work_
                          : all_work_ * static_cast<double>(part_) / static_cast<double>(parts_));
}

void InverseUpdate::finish() {
  if (part_ == parts_) return;
  part_ = parts_;
  compute(2 * all_work_);
}

void InverseUpdate::hand_over(DenseInverse& into) {
  into.swap(next_);
  in_work_ = false;
}

}  // namespace sunder::gpu
