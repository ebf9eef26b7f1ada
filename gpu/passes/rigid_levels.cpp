// SPDX-License-Identifier: Apache-2.0
#include "gpu/passes/rigid_levels.hpp"

#include <algorithm>
#include <array>
#include <bit>
#include <span>
#include <vector>

#include "gpu/passes/cg_sizes.hpp"
#include "gpu/passes/slices.hpp"

namespace sunder::gpu {
namespace {

using vulkan::Buffer;
using vulkan::Placement;

// Of so many groups one aggregate, or of fewer while there are less than kFewAggregates. By a model
// of the boards 43 of 166 groups and 156 of 1,251 take as many iterations as all equations of the
// groups.
constexpr Index kGroupsOfOne = 8, kFewestOfOne = 4, kFewAggregates = 64, kMostAggregates = 256;
// Blocks of a group in S and in Q: of a board 11 and 4, of a body as thick as long 27 and 15;
// slices pad.
constexpr std::size_t kPlannedSmoother = 32, kPlannedProlongation = 18;
constexpr std::size_t kEntryWords = shaders::kSixWords;

/// Nine packs of four, row by row in quarters (shift and turn by shift and turn), then the column.
void pack(const Six& block, Index column, std::uint32_t* to) {
  for (int quarter = 0; quarter < 4; ++quarter) {
    for (int i = 0; i < 3; ++i) {
      for (int j = 0; j < 3; ++j) {
        const double value = block(3 * (quarter / 2) + i, 3 * (quarter % 2) + j);
        *to++ = std::bit_cast<std::uint32_t>(static_cast<float>(value));
      }
    }
  }
  *to = static_cast<std::uint32_t>(column);
}

Slices slices_of(const GroupBlocks& matrix) {
  std::vector<std::size_t> lengths;
  for (std::size_t r = 0; r < matrix.rows(); ++r) lengths.push_back(matrix.row(r).size());
  return Slices(lengths);
}

void pack_all(const GroupBlocks& matrix, const Slices& slices, std::uint32_t* to) {
  for (std::size_t r = 0; r < matrix.rows(); ++r) {
    for (std::size_t k = 0; k < matrix.row(r).size(); ++k) {
      const GroupBlocks::Entry& entry = matrix.row(r)[k];
      pack(entry.block, entry.column, to + slices.place(r, k) * kEntryWords);
    }
  }
}

/// Symmetric: with what rounding to fp32 may take from a quadratic form more on the diagonal.
GroupBlocks kept_positive(GroupBlocks matrix) {
  constexpr double kRounding = 0x1p-24;
  for (std::size_t r = 0; r < matrix.rows(); ++r) {
    Eigen::Matrix<double, 6, 1> sum = Eigen::Matrix<double, 6, 1>::Zero();
    for (const GroupBlocks::Entry& entry : matrix.row(r)) {
      sum += entry.block.cwiseAbs().rowwise().sum();
    }
    matrix.at(static_cast<Index>(r), static_cast<Index>(r)).diagonal() += 2 * kRounding * sum;
  }
  return matrix;
}

std::uint32_t rows_of(Index groups) {
  return round_up(static_cast<std::uint32_t>(groups), shaders::kGroup) / shaders::kGroup;
}

std::size_t size_of(Index aggregates) {
  return round_up(6 * static_cast<std::uint32_t>(aggregates), 16);
}

}  // namespace

RigidLevels::RigidLevels(const KernelFactory& kernels, Index groups)
    : kernels_(kernels), most_(aggregates_of(groups)), rows_(rows_of(groups)) {
  const auto make = [&](std::size_t count) {
    Buffer buffer(kernels.device(), count * sizeof(double), Placement::device);
    buffer.fill_zero();
    return buffer;
  };
  const std::size_t size = size_of(most_);
  inverse_ = make(size * size);
  of_y_ = make(size);
  of_w_ = make((size / 6 + 1) * 8);
  of_terms_ = make(size / 4);
}

Index RigidLevels::aggregates_of(Index groups) {
  return std::clamp(groups / kGroupsOfOne, std::min(groups / kFewestOfOne, kFewAggregates),
                    kMostAggregates);
}

std::size_t RigidLevels::planned_bytes(Index groups) {
  const std::size_t size = size_of(aggregates_of(groups));
  return static_cast<std::size_t>(groups) * (kPlannedSmoother + 2 * kPlannedProlongation) *
             kEntryWords * sizeof(std::uint32_t) +
         (size * size + size + (size / 6 + 1) * 8 + size / 4) * sizeof(double);
}

void RigidLevels::bind(const Buffer& y, const Buffer& w, const Buffer& terms) {
  y_ = &y;
  w_ = &w;
  terms_ = &terms;
  const KernelFactory kernels = kernels_.in_fp64();
  aggregate_.kernel = kernels.make("cg_aggregate", kernels_.summing_group());
  solve_.kernel = kernels.make("cg_coarse", kernels_.summing_group());
  expand_.kernel = kernels.make("cg_expand", shaders::kGroup);
  rebind_ = true;
  if (blocks_.bytes() > 0) bind_all();
}

void RigidLevels::bind_all() {
  const auto bind = [&](Pass& pass, const std::vector<const Buffer*>& buffers) {
    pass.binding = std::make_unique<vulkan::Binding>(kernels_.device(), *pass.kernel, buffers);
  };
  bind(aggregate_, {&first_, &restriction_, y_, &of_y_});
  bind(solve_, {&inverse_, &of_y_, &of_w_, &of_terms_});
  bind(expand_, {&blocks_, &slices_, y_, &of_w_, w_, terms_});
  rebind_ = false;
  ++bound_;
}

void RigidLevels::hold(Buffer& buffer, std::size_t bytes) {
  if (buffer.bytes() >= bytes) return;
  buffer = Buffer(kernels_.device(), bytes, Placement::device);
  rebind_ = true;
}

void RigidLevels::update(const SmoothedLevels& levels) {
  rows_ = rows_of(static_cast<Index>(levels.smoother.rows()));
  write_sums(levels);
  write_aggregates(levels.prolongation.transposed());
  const auto size = static_cast<Eigen::Index>(size_of(most_));
  Eigen::MatrixXd padded = Eigen::MatrixXd::Zero(size, size);
  padded.topLeftCorner(levels.inverse.rows(), levels.inverse.cols()) = levels.inverse;
  inverse_.write(std::span<const double>(padded.data(), static_cast<std::size_t>(padded.size())));
  if (rebind_ && y_) bind_all();
}

void RigidLevels::write_sums(const SmoothedLevels& levels) {
  const Slices smoother = slices_of(levels.smoother), rest = slices_of(levels.prolongation);
  std::vector<std::uint32_t> blocks((smoother.count() + rest.count()) * kEntryWords, 0);
  pack_all(kept_positive(levels.smoother), smoother, blocks.data());
  pack_all(levels.prolongation, rest, blocks.data() + smoother.count() * kEntryWords);
  std::vector<std::uint32_t> slices = smoother.first();
  for (const std::uint32_t first : rest.first()) {
    slices.push_back(smoother.first().back() + first);
  }
  blocks.resize(std::max(blocks.size(), kEntryWords), 0);  // of a body of which nothing is left
  hold(blocks_, blocks.size() * sizeof(std::uint32_t));
  hold(slices_, slices.size() * sizeof(std::uint32_t));
  blocks_.write(std::span<const std::uint32_t>(blocks));
  slices_.write(std::span<const std::uint32_t>(slices));
}

void RigidLevels::write_aggregates(const GroupBlocks& restriction) {
  aggregates_ = static_cast<std::uint32_t>(restriction.rows());
  std::vector<std::uint32_t> first{0}, entries;
  for (std::size_t a = 0; a < restriction.rows(); ++a) {
    for (const GroupBlocks::Entry& entry : restriction.row(a)) {
      entries.resize(entries.size() + kEntryWords, 0);
      pack(entry.block, entry.column, &entries[entries.size() - kEntryWords]);
    }
    first.push_back(static_cast<std::uint32_t>(entries.size() / kEntryWords));
  }
  if (entries.empty()) entries.resize(kEntryWords, 0);
  hold(first_, first.size() * sizeof(std::uint32_t));
  hold(restriction_, entries.size() * sizeof(std::uint32_t));
  first_.write(std::span<const std::uint32_t>(first));
  restriction_.write(std::span<const std::uint32_t>(entries));
  of_y_.fill_zero();  // of aggregates no longer there
}

void RigidLevels::add_to(shaders::CgPush& push) const {
  push.rigid_solves = solve_groups();
  push.rigid_aggregates = aggregates_;
  push.rigid_rows = rows_;
  push.rigid_terms = round_up(rows_ * kernels_.parts(), 4);
}

void RigidLevels::record(vulkan::Commands& commands, const shaders::CgPush& push) const {
  commands.dispatch(*aggregate_.binding, aggregates_);
  commands.dispatch(*solve_.binding, push, solve_groups());
  commands.dispatch(*expand_.binding, push, rows_);
}

void RigidLevels::record_indirect(vulkan::Commands& commands, const shaders::CgPush& push,
                                  const Buffer& arguments) const {
  commands.dispatch_indirect(*aggregate_.binding, arguments,
                             size_of_dispatch(shaders::kCgByAggregate));
  commands.dispatch_indirect(*solve_.binding, push, arguments,
                             size_of_dispatch(shaders::kCgBySolve));
  commands.dispatch_indirect(*expand_.binding, push, arguments,
                             size_of_dispatch(shaders::kCgByRow));
}

std::size_t RigidLevels::bytes() const {
  return blocks_.bytes() + slices_.bytes() + restriction_.bytes() + first_.bytes() +
         inverse_.bytes() + of_y_.bytes() + of_w_.bytes() + of_terms_.bytes();
}

}  // namespace sunder::gpu
