// SPDX-License-Identifier: Apache-2.0
#include "engine/factor_base.hpp"

#include <algorithm>

namespace sunder::engine {
namespace {

// Columns that go through the factor together: wide enough for the panels' products.
constexpr Index kGroup = 32;

/// Columns are processed in full vectors.
Index padded(Index columns) { return (columns + 7) / 8 * 8; }

}  // namespace

FactorBase::FactorBase(const fem::Factor& factor)
    : l_(factor.cholesky()), columns_(l_.supernodes()) {
  rows_.setZero(l_.size(), kGroup);
  of_load_.setZero(l_.size());
  y_.resize(l_.size());
  block_.resize(1024, kGroup);
  groups_.reserve(1024);
  places_.reserve(1024);
  path_.reserve(static_cast<std::size_t>(l_.supernodes().count()));
}

void FactorBase::push(std::span<const Difference> vectors, fem::RowMajor& gram) {
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

void FactorBase::push_group(std::span<const Difference> vectors, Index column,
                            fem::RowMajor& gram) {
  const auto count = static_cast<Index>(vectors.size());
  places_.clear();
  for (std::size_t i = 0; i < vectors.size(); ++i) {
    const auto column_of = static_cast<Index>(i);
    places_.push_back(l_.supernodes().place[vectors[i].dof]);
    rows_(places_.back(), column_of) = 1;
    if (vectors[i].other == kNone) continue;
    places_.push_back(l_.supernodes().place[vectors[i].other]);
    rows_(places_.back(), column_of) = -1;
  }
  l_.reach(places_, path_, work_);
  l_.forward(path_, rows_.leftCols(padded(count)), work_);
  columns_.append(path_, rows_, count);
  if (block_.rows() < columns_.size()) block_.resize(2 * columns_.size() + 256, kGroup);
  columns_.multiply(path_, rows_, padded(count), block_);
  gram.block(0, column, columns_.size(), count) = block_.topLeftCorner(columns_.size(), count);
  for (Index s : path_) {
    rows_.middleRows(l_.supernodes().first[s], l_.supernodes().width(s)).setZero();
  }
}

void FactorBase::pop() {
  for (Index g = 0; g < groups_.back(); ++g) columns_.pop();
  groups_.pop_back();
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
  if (load_.take(forces)) forward(forces, of_load_);
  columns_.project(of_load_, projected_);
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
  return {{"update vectors along the elimination paths", columns_.bytes()}};
}

}  // namespace sunder::engine
