// SPDX-License-Identifier: Apache-2.0
#include "gpu/passes/region_inverse.hpp"

#include <algorithm>
#include <numeric>

#include "gpu/passes/fields.hpp"
#include "solver/condensed_base.hpp"
#include "solver/condensed_route.hpp"

namespace sunder::gpu {
namespace {

using vulkan::Buffer;
using vulkan::Placement;

// Columns that a product brings to the device because it needs them, and beside those, of a base
// that came in the middle of the frames: of 10,000 unknowns 5 MB and .6.
constexpr Index kAtOnce = 64, kAhead = 8;

std::uint32_t padded_rows(Index unknowns) {
  return round_up(static_cast<std::uint32_t>(unknowns), shaders::kRowPad);
}

/// Places that the damage of a base is expected to come to.
std::size_t most_places(Index unknowns) {
  return round_up(
      static_cast<std::uint32_t>(solver::columns_of_a_base(static_cast<std::size_t>(unknowns))),
      shaders::kChunk);
}

/// Columns that there is room for: further ones beside the whole are those of what S grows by.
Index capacity(Index unknowns, RegionInverse::Extent extent) {
  return (extent == RegionInverse::Extent::whole ? unknowns : 0) +
         static_cast<Index>(most_places(unknowns));
}

std::uint32_t most_chunks(std::size_t places, std::uint32_t panels) {
  return static_cast<std::uint32_t>(places / shaders::kChunk) + panels;
}

}  // namespace

RegionInverse::RegionInverse(const KernelFactory& kernels, Index unknowns, std::size_t panel_bytes,
                             std::size_t least, Extent extent)
    : unknowns_(unknowns),
      least_(least),
      most_(most_places(unknowns)),
      extent_(extent),
      stored_(kernels.in_fp64()),
      rows_(padded_rows(unknowns)),
      inverse_(stored_, {unknowns, capacity(unknowns, extent)}, rows_, panel_bytes),
      partials_(kernels, rows_,
                most_chunks(most_, static_cast<std::uint32_t>(inverse_.parts().size()))),
      positions_(kernels.device(), rows_ * sizeof(std::uint32_t), Placement::device),
      product_(kernels.device(), rows_ * sizeof(double), Placement::device),
      read_back_(kernels.device(), rows_ * sizeof(double), Placement::host),
      commands_(kernels.device()) {
  std::vector<std::uint32_t> positions(rows_);
  std::iota(positions.begin(), positions.end(), 0u);
  positions_.write(std::span<const std::uint32_t>(positions));
  inverse_.reserve_loaded(most_);
  inverse_.bind(partials_, product_);
  sum_ = partials_.bind_sum(positions_, product_);
  slot_.reserve(solver::most_unknowns(static_cast<std::size_t>(unknowns)) + most_);
  free_.reserve(static_cast<std::size_t>(capacity(unknowns, extent)));
  for (std::vector<Index>* list : {&loaded_.dofs, &order_}) list->reserve(most_);
  loaded_.values.reserve(most_);
}

std::size_t RegionInverse::planned_bytes(const KernelFactory& kernels, Index unknowns,
                                         std::size_t panel_bytes, Extent extent) {
  const KernelFactory stored = kernels.in_fp64();
  const std::uint32_t rows = padded_rows(unknowns);
  const std::size_t most = most_places(unknowns);
  const auto planned =
      DenseInverse::planned(stored, {unknowns, capacity(unknowns, extent)}, rows, panel_bytes);
  return planned.bytes + DenseInverse::planned_loaded(most) +
         std::size_t{most_chunks(most, planned.panels)} * rows * sizeof(double) +
         rows * (sizeof(std::uint32_t) + 2 * sizeof(double));
}

std::size_t RegionInverse::most_values(Index unknowns) {
  return most_places(unknowns) * static_cast<std::size_t>(unknowns);
}

std::size_t RegionInverse::bytes() const {
  return inverse_.bytes() + partials_.buffer().bytes() + positions_.bytes() + product_.bytes() +
         read_back_.bytes();
}

Index RegionInverse::count() const {
  return static_cast<Index>(std::ranges::count_if(slot_, [](Index s) { return s != kNone; }));
}

/// Before the frames there is time for all of X_SS.
void RegionInverse::begin(const solver::CondensedBase& base) {
  const Index columns = capacity(unknowns_, extent_);
  slot_.assign(static_cast<std::size_t>(unknowns_), kNone);
  free_.resize(static_cast<std::size_t>(columns));
  for (Index i = 0; i < columns; ++i) free_[static_cast<std::size_t>(i)] = columns - 1 - i;
  ahead_ = 0;
  if (begun_ || extent_ != Extent::whole) return;
  for (; ahead_ < unknowns_; ++ahead_) static_cast<void>(bring(base, ahead_));
}

void RegionInverse::forget(Index unknowns) {
  for (auto at = static_cast<std::size_t>(unknowns); at < slot_.size(); ++at) {
    if (slot_[at] != kNone) free_.push_back(slot_[at]);
  }
  slot_.resize(std::min(slot_.size(), static_cast<std::size_t>(unknowns)));
}

/// False: there is no room.
bool RegionInverse::bring(const solver::CondensedBase& base, Index place) {
  const auto at = static_cast<std::size_t>(place);
  if (at >= slot_.size()) slot_.resize(at + 1, kNone);
  if (slot_[at] != kNone) return true;
  if (free_.empty()) return false;
  slot_[at] = free_.back();
  free_.pop_back();
  inverse_.write_column(slot_[at],
                        {base.inverse().column(place).first, static_cast<std::size_t>(unknowns_)});
  return true;
}

bool RegionInverse::follow(const solver::CondensedBase& base, std::span<const Index> places) {
  begun_ = true;
  if (!takes(static_cast<Index>(places.size()))) return false;
  Index brought = 0;
  for (const Index place : places) {
    if (has(place)) continue;
    if (brought++ == kAtOnce || !bring(base, place)) break;
  }
  if (extent_ == Extent::columns) return true;
  for (Index end = std::min(unknowns_, ahead_ + kAhead); ahead_ < end; ++ahead_) {
    if (!bring(base, ahead_)) break;
  }
  return true;
}

void RegionInverse::add(std::span<const Index> places, std::span<const double> values,
                        Eigen::VectorXd& u) {
  order_.resize(places.size());
  std::iota(order_.begin(), order_.end(), 0);
  std::ranges::sort(order_, {}, [&](Index i) { return slot_[places[i]]; });
  loaded_.dofs.clear();
  loaded_.values.clear();
  for (const Index i : order_) {
    loaded_.dofs.push_back(slot_[places[i]]);
    loaded_.values.push_back(values[i]);
  }
  inverse_.set_loaded(loaded_);
  commands_.begin();
  commands_.pass("solve");
  partials_.record_sum(commands_, *sum_, inverse_.record_loaded(commands_, 0), false);
  commands_.copy(product_.handle(), product_.offset(), read_back_.handle(), read_back_.offset(),
                 product_.bytes());
  commands_.end();
  commands_.submit();
  u.head(unknowns_) += Eigen::Map<const Eigen::VectorXd>(read_back_.mapped<double>(), unknowns_);
}

}  // namespace sunder::gpu
