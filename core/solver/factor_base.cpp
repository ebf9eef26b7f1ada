// SPDX-License-Identifier: Apache-2.0
#include "solver/factor_base.hpp"

#include <algorithm>
#include <array>
#include <chrono>
#include <numeric>

#include "linear_algebra/panel_kernels.hpp"

namespace sunder::solver {
namespace {

// Columns that go through the factor together: wide enough for the panels' products.
constexpr Index kGroup = 32;
// Columns that a base begins with room for.
constexpr Index kColumns = 1024;
// Room for the differences of predicted fractures.
constexpr std::size_t kPredicted = std::size_t{1} << 14;

/// Columns are processed in full vectors.
Index padded(Index columns) { return (columns + 7) / 8 * 8; }

}  // namespace

FactorBase::FactorBase(const linear_algebra::Factor& factor)
    : l_(factor.cholesky()), columns_(l_.supernodes()), prepared_(l_.supernodes()) {
  of_load_.setZero(l_.size());
  y_.resize(l_.size());
  groups_.reserve(kColumns);
  places_.reserve(kColumns);
  missing_.reserve(kGroup);
  path_.reserve(static_cast<std::size_t>(l_.supernodes().count()));
}

void FactorBase::make_room() {
  if (rows_.rows() > 0) return;
  rows_.setZero(l_.size(), kGroup);
  block_.resize(kColumns, kGroup);
  projected_.resize(kColumns);
  l_.make_room(kGroup, work_);
  columns_.make_room();
}

void FactorBase::push(std::span<const Difference> vectors, linear_algebra::RowMajor& gram) {
  make_room();
  const auto k = static_cast<Index>(vectors.size());
  const Index before = columns_.size();
  groups_.push_back((k + kGroup - 1) / kGroup);
  for (Index begin = 0; begin < k; begin += kGroup) {
    const Index count = std::min(kGroup, k - begin);
    push_group(vectors.subspan(static_cast<std::size_t>(begin), static_cast<std::size_t>(count)),
               begin, gram);
  }
  // A group sees those before it; those after it follow by symmetry.
  for (Index j = 0; j < k; ++j) {
    for (Index i = j + 1; i < k; ++i) gram(before + i, j) = gram(before + j, i);
  }
}

void FactorBase::forward_group(std::span<const Difference> vectors, std::span<const Index> which) {
  const auto& place = l_.supernodes().place;
  for (std::size_t i = 0; i < which.size(); ++i) {
    const Difference& v = vectors[static_cast<std::size_t>(which[i])];
    rows_(place[v.dof], static_cast<Index>(i)) = 1;
    if (v.other != kNone) rows_(place[v.other], static_cast<Index>(i)) = -1;
  }
  const auto count = static_cast<Index>(which.size());
  if (count <= linear_algebra::kFewColumns) {
    l_.forward_few(path_, rows_.leftCols(count), work_);
  } else {
    l_.forward(path_, rows_.leftCols(padded(count)), work_);
  }
}

void FactorBase::find_path(std::span<const Difference> vectors) {
  places_.clear();
  for (const Difference& v : vectors) {
    places_.push_back(l_.supernodes().place[v.dof]);
    if (v.other != kNone) places_.push_back(l_.supernodes().place[v.other]);
  }
  l_.reach(places_, path_, work_);
}

void FactorBase::clear_rows() {
  for (Index s : path_) {
    rows_.middleRows(l_.supernodes().first[s], l_.supernodes().width(s)).setZero();
  }
}

void FactorBase::push_group(std::span<const Difference> vectors, Index column,
                            linear_algebra::RowMajor& gram) {
  const auto count = static_cast<Index>(vectors.size());
  find_path(vectors);
  missing_.clear();
  for (Index i = 0; i < count; ++i) {
    if (!prepared_.holds(vectors[static_cast<std::size_t>(i)])) missing_.push_back(i);
  }
  if (!missing_.empty()) forward_group(vectors, missing_);
  spread_missing();
  for (Index i = 0, m = 0; i < count; ++i) {
    if (m < static_cast<Index>(missing_.size()) && missing_[static_cast<std::size_t>(m)] == i) {
      ++m;
    } else {
      prepared_.restore(vectors[static_cast<std::size_t>(i)], rows_, i);
    }
  }
  columns_.append(path_, rows_, count);
  if (block_.rows() < columns_.size()) block_.resize(2 * columns_.size() + 256, kGroup);
  columns_.multiply(path_, rows_, padded(count), block_);
  gram.block(0, column, columns_.size(), count) = block_.topLeftCorner(columns_.size(), count);
  clear_rows();
}

/// Moves the columns that were computed from the front to where they belong, the last one first.
void FactorBase::spread_missing() {
  for (std::size_t j = missing_.size(); j-- > 0;) {
    const Index from = static_cast<Index>(j), to = missing_[j];
    if (to == from) continue;
    for (Index s : path_) {
      for (Index r = l_.supernodes().first[s]; r < l_.supernodes().first[s + 1]; ++r) {
        rows_(r, to) = rows_(r, from);
        rows_(r, from) = 0;
      }
    }
  }
}

void FactorBase::prepare(std::span<const Difference> vectors) {
  using Clock = std::chrono::steady_clock;
  const auto same = [](const Difference& a, const Difference& b) {
    return a.dof == b.dof && a.other == b.other;
  };
  if (!vectors.empty() && std::ranges::equal(vectors, asked_, same)) return;
  make_room();
  asked_.reserve(kPredicted);
  asked_.assign(vectors.begin(), vectors.end());
  prepared_.retain(vectors);
  wanted_.clear();
  wanted_.reserve(kPredicted);
  for (const Difference& v : vectors) {
    const bool known =
        std::ranges::any_of(wanted_, [&](const Difference& o) { return same(o, v); });
    if (!known && !prepared_.holds(v)) wanted_.push_back(v);
  }
  std::array<Index, kGroup> all{};
  std::iota(all.begin(), all.end(), 0);
  for (std::size_t begin = 0; begin < wanted_.size(); begin += kGroup) {
    const auto group =
        std::span(wanted_).subspan(begin, std::min<std::size_t>(kGroup, wanted_.size() - begin));
    const auto start = Clock::now();
    find_path(group);
    forward_group(group, std::span(all).first(group.size()));
    const double ms = std::chrono::duration<double, std::milli>(Clock::now() - start).count() /
                      static_cast<double>(group.size());
    for (std::size_t i = 0; i < group.size(); ++i) {
      prepared_.keep(group[i], path_, rows_, static_cast<Index>(i), ms);
    }
    clear_rows();
  }
}

void FactorBase::pop() {
  for (Index g = 0; g < groups_.back(); ++g) columns_.pop();
  groups_.pop_back();
  known_ = std::min(known_, columns_.size());
}

/// y = L^-1 P f; path_ is where it is not zero.
void FactorBase::forward(const Forces& forces, Eigen::VectorXd& y) {
  y.setZero();
  places_.clear();
  for (std::size_t i = 0; i < forces.dofs.size(); ++i) {
    places_.push_back(l_.supernodes().place[forces.dofs[i]]);
    y[places_.back()] = forces.values[i];
  }
  l_.reach(places_, path_, work_);
  l_.forward(path_, y, work_);
}

const Eigen::VectorXd& FactorBase::load(const Forces& forces) {
  if (load_.take(forces)) {
    forward(forces, of_load_);
    known_ = 0;
  }
  columns_.project(of_load_, known_, projected_);
  known_ = columns_.size();
  return projected_;
}

void FactorBase::expand(const Eigen::VectorXd& c, Eigen::VectorXd& u) {
  y_ = of_load_;
  columns_.add(c, y_);
  l_.backward(y_, work_);
  const auto& place = l_.supernodes().place;
  u.resize(size());
  for (std::size_t i = 0; i < place.size(); ++i) u[static_cast<Eigen::Index>(i)] = y_[place[i]];
}

std::vector<BufferPlan> FactorBase::buffers() const {
  std::vector<BufferPlan> plan{{"update vectors along the elimination paths", columns_.bytes()}};
  if (prepared_.bytes() > 0) plan.push_back({"columns of predicted fractures", prepared_.bytes()});
  return plan;
}

}  // namespace sunder::solver
