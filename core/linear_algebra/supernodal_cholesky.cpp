// SPDX-License-Identifier: Apache-2.0
#include "linear_algebra/supernodal_cholesky.hpp"

#include <algorithm>
#include <numeric>

#include "linear_algebra/panel_kernels.hpp"

namespace sunder::linear_algebra {
namespace {

// Entries of the panel before that are asked for: enough that the processor's own prefetching goes
// on from there.
constexpr std::ptrdiff_t kAhead = 1024;

}  // namespace

SupernodalCholesky::SupernodalCholesky(const SparseMatrix& lower, std::vector<Index> place,
                                       const FactorWork& work) {
  SparseMatrix permuted;
  nodes_ = std::make_shared<const Supernodes>(find_supernodes(lower, std::move(place), permuted));
  compute(permuted, work);
  if (work.ordered) *work.ordered = std::move(permuted);
}

SupernodalCholesky::SupernodalCholesky(std::shared_ptr<const Supernodes> nodes,
                                       const SparseMatrix& ordered, const FactorWork& work)
    : nodes_(std::move(nodes)) {
  compute(ordered, work);
}

void SupernodalCholesky::compute(const SparseMatrix& ordered, const FactorWork& work) {
  for (Index s = 0; s < nodes_->count(); ++s) tallest_ = std::max(tallest_, nodes_->height(s));
  values_.resize(static_cast<Eigen::Index>(entries()) + kPanelLanes);
  values_.tail(kPanelLanes).setZero();
  succeeded_ = factorise(*nodes_, ordered, work, {values_.data(), entries()});
}

/// What lies under a panel, and its solved part.
std::size_t SupernodalCholesky::room_of_a_panel() const {
  return 2 * static_cast<std::size_t>(tallest_ + kPanelLanes);
}

SupernodalCholesky::ConstPanel SupernodalCholesky::panel(Index s) const {
  return {values_.data() + nodes_->value_begin[s], nodes_->height(s), nodes_->width(s)};
}

void SupernodalCholesky::make_room(Index columns, SolveWork& work) const {
  work.seen.resize(static_cast<std::size_t>(nodes_->count()), 0);
  work.below.resize(room_of_a_panel());
  const Index few = 3 * kFewColumns * (tallest_ + kPanelLanes);
  work.product.resize(
      std::max(work.product.size(), static_cast<std::size_t>(std::max(tallest_ * columns, few))));
}

void SupernodalCholesky::reach(std::span<const Index> rows, std::vector<Index>& path,
                               SolveWork& work) const {
  path.clear();
  work.seen.resize(static_cast<std::size_t>(nodes_->count()), 0);
  for (Index row : rows) {
    for (Index s = nodes_->of[row]; s != kNone && !work.seen[s]; s = nodes_->parent[s]) {
      work.seen[s] = 1;
      path.push_back(s);
    }
  }
  for (Index s : path) work.seen[s] = 0;
  std::sort(path.begin(), path.end());
}

void SupernodalCholesky::forward_panel(Index s, Eigen::VectorXd& y, SolveWork& work) const {
  const auto below = nodes_->below(s);
  std::fill_n(work.below.begin(), below.size(), 0.0);
  panel_forward(values_.data() + nodes_->value_begin[s], nodes_->width(s), nodes_->height(s),
                y.data() + nodes_->first[s], work.below.data());
  for (std::size_t i = 0; i < below.size(); ++i) y[below[i]] -= work.below[i];
}

void SupernodalCholesky::forward(std::span<const Index> supernodes, Eigen::VectorXd& y,
                                 SolveWork& work) const {
  work.below.resize(room_of_a_panel());
  for (Index s : supernodes) forward_panel(s, y, work);
}

void SupernodalCholesky::forward(Eigen::VectorXd& y, SolveWork& work) const {
  work.below.resize(room_of_a_panel());
  for (Index s = 0; s < nodes_->count(); ++s) forward_panel(s, y, work);
}

void SupernodalCholesky::backward(Eigen::VectorXd& y, SolveWork& work) const {
  nodes_->solved.add(1);
  work.below.resize(room_of_a_panel());
  for (Index s = nodes_->count() - 1; s >= 0; --s) {
    const auto below = nodes_->below(s);
    for (std::size_t i = 0; i < below.size(); ++i) work.below[i] = y[below[i]];
    std::fill_n(work.below.begin() + static_cast<std::ptrdiff_t>(below.size()), kPanelLanes, 0.0);
    const double* values = values_.data() + nodes_->value_begin[s];
    const double* before = s > 0 ? values_.data() + nodes_->value_begin[s - 1] : values;
    panel_backward(values, nodes_->width(s), nodes_->height(s), y.data() + nodes_->first[s],
                   work.below.data(), work.below.data() + tallest_ + kPanelLanes, before,
                   std::min(values, before + kAhead));
  }
}

void SupernodalCholesky::forward(std::span<const Index> supernodes, Eigen::Ref<RowMajor> y,
                                 SolveWork& work) const {
  work.product.resize(std::max(work.product.size(), static_cast<std::size_t>(tallest_ * y.cols())));
  for (Index s : supernodes) {
    const ConstPanel p = panel(s);
    const Index width = nodes_->width(s);
    auto x = y.middleRows(nodes_->first[s], width);
    lower_solve(p.data(), p.outerStride(), width, x.data(), y.outerStride(), y.cols(),
                work.product.data());
    const auto below = nodes_->below(s);
    if (below.empty()) continue;
    const auto under = static_cast<Eigen::Index>(below.size());
    row_product({p.data() + width, under, width, 1, p.outerStride()}, x.data(), x.outerStride(),
                y.cols(), work.product.data(), y.cols());
    const ConstRows product(work.product.data(), under, y.cols());
    for (Eigen::Index i = 0; i < under; ++i) {
      y.row(below[static_cast<std::size_t>(i)]) -= product.row(i);
    }
  }
}

void SupernodalCholesky::forward_few(std::span<const Index> supernodes, Eigen::Ref<RowMajor> y,
                                     SolveWork& work) const {
  const Index stride = tallest_ + kPanelLanes, columns = static_cast<Index>(y.cols());
  const auto room = static_cast<std::size_t>(kFewColumns) * static_cast<std::size_t>(stride);
  work.product.resize(std::max(work.product.size(), 3 * room));
  double *x = work.product.data(), *under = x + room, *product = under + room;
  for (Index s : supernodes) {
    const Index first = nodes_->first[s], width = nodes_->width(s);
    for (Index c = 0; c < columns; ++c) {
      for (Index i = 0; i < width; ++i) x[c * stride + i] = y(first + i, c);
    }
    panel_forward_few(values_.data() + nodes_->value_begin[s], width, nodes_->height(s), columns, x,
                      under, product, stride);
    const auto below = nodes_->below(s);
    for (Index c = 0; c < columns; ++c) {
      for (Index i = 0; i < width; ++i) y(first + i, c) = x[c * stride + i];
      for (std::size_t i = 0; i < below.size(); ++i) {
        y(below[i], c) -= under[static_cast<std::size_t>(c * stride) + i];
      }
    }
  }
}

void SupernodalCholesky::backward(Eigen::Ref<RowMajor> y, SolveWork& work) const {
  std::vector<Index> all(static_cast<std::size_t>(nodes_->count()));
  std::iota(all.begin(), all.end(), 0);
  backward(all, y, work);
}

void SupernodalCholesky::backward(std::span<const Index> supernodes, Eigen::Ref<RowMajor> y,
                                  SolveWork& work) const {
  nodes_->solved.add(static_cast<std::size_t>(y.cols()));
  RowMajor gathered;
  const Eigen::Index room = std::max<Eigen::Index>(tallest_, kBackRows) * y.cols();
  work.product.resize(std::max(work.product.size(), static_cast<std::size_t>(room)));
  for (std::size_t at = supernodes.size(); at-- > 0;) {
    const Index s = supernodes[at];
    const ConstPanel p = panel(s);
    const Index width = nodes_->width(s);
    const auto below = nodes_->below(s);
    auto x = y.middleRows(nodes_->first[s], width);
    if (!below.empty()) {
      gathered.resize(static_cast<Index>(below.size()), y.cols());
      for (std::size_t i = 0; i < below.size(); ++i) {
        gathered.row(static_cast<Eigen::Index>(i)) = y.row(below[i]);
      }
      row_product({p.data() + width, width, gathered.rows(), p.outerStride(), 1}, gathered.data(),
                  gathered.outerStride(), y.cols(), work.product.data(), y.cols());
      x -= ConstRows(work.product.data(), width, y.cols());
    }
    upper_solve(p.data(), p.outerStride(), width, x.data(), y.outerStride(), y.cols(),
                work.product.data());
  }
}

std::size_t SupernodalCholesky::bytes() const {
  return static_cast<std::size_t>(values_.size()) * sizeof(double) +
         (nodes_->rows.size() + 2 * nodes_->place.size()) * sizeof(Index);
}

}  // namespace sunder::linear_algebra
