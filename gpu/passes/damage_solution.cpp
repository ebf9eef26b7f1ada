// SPDX-License-Identifier: Apache-2.0
#include "gpu/passes/damage_solution.hpp"

#include <algorithm>
#include <numeric>

namespace sunder::gpu {
namespace {

using vulkan::Buffer;
using vulkan::Placement;

// Vectors of events between two solutions that there is room for, sixteen elements', and so many
// events: after more of them S and T come as a whole.
constexpr std::size_t kRank = 96, kUpdates = 8;
// Columns that are written at once.
constexpr Index kPacked = 32;
// Refinements in one submit whose energies there is room for.
constexpr std::size_t kRefinements = 4;
// Rows that two of a matrix's columns lie apart are no power of two.
constexpr std::uint32_t kRowsPad = 32;

std::uint32_t groups(Index rows, std::uint32_t of_group) {
  return round_up(static_cast<std::uint32_t>(rows), of_group) / of_group;
}

struct Sizes {
  Sizes(Index columns, Index grips)
      : rows(round_up(static_cast<std::uint32_t>(columns), kRowsPad)),
        length(static_cast<std::size_t>(columns + grips)),
        square(std::size_t{rows} * static_cast<std::size_t>(columns)),
        forces(std::size_t{rows} * length),
        vectors(std::max(kRank, static_cast<std::size_t>(grips)) * length),
        state(std::size_t{3} * rows + length),
        given(length),
        facts(length),
        found(rows + kRefinements * rows) {}
  std::uint32_t rows;
  std::size_t length, square, forces, vectors, state, given, facts, found;
};

}  // namespace

DamageSolution::DamageSolution(const KernelFactory& kernels, Index columns, Index grips,
                               Index least)
    : most_(columns),
      most_grips_(grips),
      least_(least),
      rows_(Sizes(columns, grips).rows),
      of_group_(kernels.emulated() ? kernels.summing_group() : shaders::kDamageRows),
      commands_(kernels.device()) {
  const Sizes sizes(columns, grips);
  vulkan::Device& device = kernels.device();
  const auto doubles = [&](std::size_t count, Placement placement) {
    return Buffer(device, count * sizeof(double), placement);
  };
  compliance_ = doubles(sizes.square, Placement::device);
  stiffness_ = doubles(sizes.square, Placement::device);
  forces_ = doubles(sizes.forces, Placement::device);
  vectors_ = doubles(sizes.vectors, Placement::device);
  state_ = doubles(sizes.state, Placement::device);
  given_ = doubles(sizes.given, Placement::sent);
  facts_ = Buffer(device, sizes.facts * sizeof(std::uint32_t), Placement::sent);
  found_ = doubles(sizes.found, Placement::host);
  updates_.reserve(kUpdates);
  stale_.reserve(static_cast<std::size_t>(columns));
  packed_.resize(std::max(std::size_t{kPacked} * rows_, sizes.length));
  using linear_algebra::make_room;
  const Eigen::Index row = linear_algebra::padded(columns);
  make_room(work.w, kRank, row);
  make_room(work.v, kRank, std::max<Index>(grips, 1));
  make_room(work.y, grips, kRank);
  make_room(work.z, columns, kRank);
  make_room(work.t, grips, row);
  make_room(work.of_grips, grips, row);
  work.c.resize(kRank, kRank);
  work.held.reserve(static_cast<std::size_t>(grips));
  work.only_grips.reserve(static_cast<std::size_t>(columns));
  const KernelFactory fp64 = kernels.in_fp64();
  const Buffer* buffers[] = {&compliance_, &stiffness_, &forces_, &given_,
                             &facts_,      &state_,     &found_};
  for (std::uint32_t step = 0; step < kSteps; ++step) {
    solve_[step] = fp64.make("damage_solve", kernels.closing_group(), step);
    bindings_[step] = std::make_unique<vulkan::Binding>(device, *solve_[step], buffers);
  }
  follow_ = fp64.make("damage_follow");
  const Buffer* followed[] = {&vectors_, &forces_, &compliance_};
  follow_binding_ = std::make_unique<vulkan::Binding>(device, *follow_, followed);
}

std::unique_ptr<DamageSolution> DamageSolution::make(const KernelFactory& kernels, Index columns,
                                                     std::size_t gripped,
                                                     std::optional<Index> least,
                                                     const LeaveOut& leave_out) {
  constexpr Index kGrasped = 192;  // unknowns that hands may hold
  if (!least || columns + static_cast<Index>(gripped) < *least) return nullptr;
  const Index grips = static_cast<Index>(gripped) + kGrasped, most = columns + grips;
  return where_room<DamageSolution>(
      kernels.device(), 0, [&] { return planned_bytes(most, grips); },
      "small matrices of the damage on the device, which has no memory left for them: the host "
      "multiplies",
      leave_out, kernels, most, grips, *least);
}

std::size_t DamageSolution::planned_bytes(Index columns, Index grips) {
  const Sizes sizes(columns, grips);
  std::size_t bytes = Buffer::padded(sizes.facts * sizeof(std::uint32_t));
  for (std::size_t count : {sizes.square, sizes.square, sizes.forces, sizes.vectors, sizes.state,
                            sizes.given, sizes.found}) {
    bytes += Buffer::padded(count * sizeof(double));
  }
  return bytes;
}

std::size_t DamageSolution::bytes() const {
  std::size_t bytes = 0;
  for (const Buffer* b :
       {&compliance_, &stiffness_, &forces_, &vectors_, &state_, &given_, &facts_, &found_}) {
    bytes += b->bytes();
  }
  return bytes;
}

void DamageSolution::forget() {
  there_ = There::nothing;
  forget_forces();
}

void DamageSolution::forget_forces() {
  if (there_ == There::all) there_ = There::stiffness;
  updates_.clear();
  vectors_used_ = 0;
}

void DamageSolution::change_stiffness(std::span<const Index> rows) {
  if (there_ != There::stiffness && there_ != There::all) return;
  if (stale_.size() + rows.size() > static_cast<std::size_t>(most_)) {
    forget();
    return;
  }
  stale_.insert(stale_.end(), rows.begin(), rows.end());
}

bool DamageSolution::follows(Index rank, Index columns) {
  if (there_ != There::all) return false;
  const std::size_t values =
      vectors_used_ + static_cast<std::size_t>(rank) * static_cast<std::size_t>(grips_ + columns);
  if (columns <= most_ && updates_.size() < kUpdates &&
      values * sizeof(double) <= vectors_.bytes()) {
    return true;
  }
  forget_forces();
  return false;
}

void DamageSolution::update(const linear_algebra::RowMajor& w, const linear_algebra::RowMajor& v,
                            Index rank, Index columns, bool subtract) {
  write_vectors(w, &v, {rank, columns, static_cast<std::uint32_t>(vectors_used_), subtract});
}

/// Columns [first, end) of a symmetric matrix, which are its rows; the first of them is column `at`
/// there. Nothing stands under its n rows.
void DamageSolution::write_columns(Buffer& to, const linear_algebra::RowMajor& from, Index first,
                                   Index end, Index at) {
  const auto n = static_cast<std::size_t>(columns_);
  for (Index begin = first; begin < end; begin += kPacked) {
    const Index count = std::min(kPacked, end - begin);
    for (Index j = 0; j < count; ++j) {
      double* column = packed_.data() + static_cast<std::size_t>(j) * rows_;
      std::copy_n(from.row(begin + j).data(), n, column);
      std::fill(column + n, column + rows_, 0.0);
    }
    to.write(std::span<const double>(packed_).first(static_cast<std::size_t>(count) * rows_),
             static_cast<std::size_t>(at + begin) * rows_);
  }
}

/// V and W side by side; no V: 0. They change [T S] before the next solution.
void DamageSolution::write_vectors(const linear_algebra::RowMajor& w,
                                   const linear_algebra::RowMajor* v, const Update& update) {
  const auto g = static_cast<std::size_t>(grips_), n = static_cast<std::size_t>(update.columns);
  const std::span<double> row = std::span(packed_).first(g + n);
  std::fill_n(row.begin(), g, 0.0);
  for (Index k = 0; k < update.rank; ++k) {
    if (v) std::copy_n(v->row(k).data(), g, row.begin());
    std::copy_n(w.row(k).data(), n, row.begin() + static_cast<std::ptrdiff_t>(g));
    vectors_.write(std::span<const double>(row), vectors_used_);
    vectors_used_ += g + n;
  }
  updates_.push_back(update);
}

bool DamageSolution::bring(const solver::SmallMatrices& all) {
  const auto grips = static_cast<Index>(all.held.size());
  if (grips != grips_) forget_forces();
  columns_ = all.columns;
  grips_ = grips;
  switch (there_) {
    case There::nothing:
      write_columns(compliance_, *all.compliance, 0, columns_);
      in_compliance_ = columns_;
      there_ = There::compliance;
      return false;
    case There::compliance:
      write_columns(stiffness_, *all.d, 0, columns_);
      in_stiffness_ = columns_;
      stale_.clear();
      there_ = There::stiffness;
      return false;
    case There::stiffness:
      write_columns(forces_, *all.t, 0, grips_);
      write_columns(forces_, *all.m, 0, columns_, grips_);
      if (grips_ > 0) write_vectors(*all.of_grips, nullptr, {grips_, columns_, 0, true});
      in_s_ = columns_;
      there_ = There::all;
      break;
    case There::all:
      break;
  }
  std::sort(stale_.begin(), stale_.end());
  stale_.erase(std::unique(stale_.begin(), stale_.end()), stale_.end());
  for (const Index j : stale_) {
    if (j < in_stiffness_) write_columns(stiffness_, *all.d, j, j + 1);
  }
  stale_.clear();
  write_columns(stiffness_, *all.d, in_stiffness_, columns_);
  in_stiffness_ = std::max(in_stiffness_, columns_);
  write_columns(compliance_, *all.compliance, in_compliance_, columns_);
  auto* facts = facts_.mapped<std::uint32_t>();
  std::ranges::copy(all.held, facts);
  std::fill_n(facts + grips_, columns_, 0u);
  for (const Index j : all.only_grips) facts[grips_ + j] = 1;
  return true;
}

void DamageSolution::follow(const Update& update, Index in_compliance) {
  const auto number = [](Index i) { return static_cast<std::uint32_t>(i); };
  commands_.dispatch(
      *follow_binding_,
      shaders::DamageFollowPush{number(update.columns), number(grips_), rows_, number(in_s_),
                                number(in_compliance), number(update.rank), update.at,
                                update.subtract ? 1u : 0u},
      groups(update.columns, shaders::kGroup), number(grips_ + update.columns));
  in_s_ = std::max(in_s_, update.columns);
}

void DamageSolution::record_follow() {
  for (const Update& update : updates_) {
    const bool whole = update.columns == columns_;
    follow(update, whole ? in_compliance_ : update.columns);
    if (whole) in_compliance_ = columns_;
  }
  updates_.clear();
  vectors_used_ = 0;
  if (in_compliance_ == columns_ && in_s_ == columns_) return;
  follow({0, columns_, 0, false}, in_compliance_);
  in_compliance_ = columns_;
}

void DamageSolution::record(Step step, std::uint32_t refinement) {
  const Index rows = step == kInBase ? std::max(columns_, grips_) : columns_;
  commands_.dispatch(
      *bindings_[step],
      shaders::DamagePush{static_cast<std::uint32_t>(columns_), static_cast<std::uint32_t>(grips_),
                          rows_, rows_ * (1 + refinement)},
      groups(rows, of_group_));
}

void DamageSolution::record_refinements(std::size_t count) {
  for (std::uint32_t i = 0; i < count; ++i) {
    for (const Step step : {kDisplacement, kLack, kInBase}) record(step);
    record(kRefine, i);
  }
}

void DamageSolution::solve(const Eigen::VectorXd& p, std::span<const double> displacement,
                           std::span<double> energies, Eigen::VectorXd& x) {
  auto* given = given_.mapped<double>();
  std::fill_n(given, grips_, 0.0);
  std::ranges::copy(displacement, given);
  std::copy_n(p.data(), columns_, given + grips_);
  commands_.begin();
  commands_.pass("solve");
  record_follow();
  record(kStart);
  record_refinements(energies.size());
  finish(energies, x);
}

void DamageSolution::refine(std::span<double> energies, Eigen::VectorXd& x) {
  commands_.begin();
  commands_.pass("solve");
  record_refinements(energies.size());
  finish(energies, x);
}

/// Energies of workgroups are added up in their order.
void DamageSolution::finish(std::span<double> energies, Eigen::VectorXd& x) {
  commands_.end();
  commands_.submit();
  const auto* found = found_.mapped<double>();
  std::copy_n(found, columns_, x.data());
  for (std::size_t i = 0; i < energies.size(); ++i) {
    energies[i] = std::accumulate(found + (1 + i) * rows_,
                                  found + (1 + i) * rows_ + groups(columns_, of_group_), 0.0);
  }
}

}  // namespace sunder::gpu
