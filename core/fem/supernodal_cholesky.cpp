// SPDX-License-Identifier: Apache-2.0
#include "fem/supernodal_cholesky.hpp"

#include <Eigen/Cholesky>
#include <algorithm>
#include <numeric>

#include "fem/panel_kernels.hpp"

namespace sunder::fem {

SupernodalCholesky::SupernodalCholesky(const SparseMatrix& lower) {
  SparseMatrix permuted;
  nodes_ = find_supernodes(lower, permuted);
  for (Index s = 0; s < nodes_.count(); ++s) tallest_ = std::max(tallest_, nodes_.height(s));
  values_.assign(nodes_.value_begin.back(), 0.0);
  succeeded_ = factorise(permuted);
}

SupernodalCholesky::ConstPanel SupernodalCholesky::panel(Index s) const {
  return {values_.data() + nodes_.value_begin[s], nodes_.height(s), nodes_.width(s)};
}

// Left-looking (Ng and Peyton 1993): a panel collects A's columns, subtracts what each descendant
// panel that reaches into it contributes, and is factored as a dense block. A descendant waits in
// the list of the next panel that its rows reach.
bool SupernodalCholesky::factorise(const SparseMatrix& a) {
  const Index count = nodes_.count();
  std::vector<Index> head(static_cast<std::size_t>(count), kNone), next(head), done(head);
  std::vector<Index> at(static_cast<std::size_t>(size()));  // row -> row of the current panel
  RowMajor product;
  for (Index s = 0; s < count; ++s) {
    const Index begin = nodes_.first[s], width = nodes_.width(s), end = begin + width;
    const auto below = nodes_.below(s);
    Panel p(values_.data() + nodes_.value_begin[s], nodes_.height(s), width);
    std::iota(at.begin() + begin, at.begin() + end, 0);
    for (std::size_t i = 0; i < below.size(); ++i) at[below[i]] = width + static_cast<Index>(i);
    for (Index j = begin; j < end; ++j) {
      for (SparseMatrix::InnerIterator it(a, j); it; ++it) p(at[it.row()], j - begin) = it.value();
    }
    for (Index d = head[s]; d != kNone;) {
      const Index following = next[d];
      const auto rows = nodes_.below(d).subspan(static_cast<std::size_t>(done[d]));
      const auto reached = std::lower_bound(rows.begin(), rows.end(), end) - rows.begin();
      const Index height = nodes_.height(d), left = static_cast<Index>(rows.size());
      const double* tail = values_.data() + nodes_.value_begin[d] + height - left;
      product.resize(left, reached);
      row_product({tail, left, nodes_.width(d), 1, height}, tail, height, reached, product.data(),
                  reached);
      for (Index j = 0; j < reached; ++j) {
        double* column = p.col(at[rows[static_cast<std::size_t>(j)]]).data();
        for (Index i = j; i < product.rows(); ++i) {
          column[at[rows[static_cast<std::size_t>(i)]]] -= product(i, j);
        }
      }
      done[d] += static_cast<Index>(reached);
      if (reached < static_cast<std::ptrdiff_t>(rows.size())) {
        const Index target = nodes_.of[rows[static_cast<std::size_t>(reached)]];
        next[d] = head[target];
        head[target] = d;
      }
      d = following;
    }
    auto triangle = p.topRows(width);
    const Eigen::LLT<Eigen::Ref<Eigen::MatrixXd>> llt(triangle);
    if (llt.info() != Eigen::Success || !triangle.diagonal().allFinite()) return false;
    if (below.empty()) continue;
    auto lower = p.bottomRows(static_cast<Index>(below.size()));
    triangle.triangularView<Eigen::Lower>().transpose().solveInPlace<Eigen::OnTheRight>(lower);
    done[s] = 0;
    const Index target = nodes_.of[below.front()];
    next[s] = head[target];
    head[target] = s;
  }
  return true;
}

void SupernodalCholesky::reach(std::span<const Index> rows, std::vector<Index>& path,
                               SolveWork& work) const {
  path.clear();
  work.seen.resize(static_cast<std::size_t>(nodes_.count()), 0);
  for (Index row : rows) {
    for (Index s = nodes_.of[row]; s != kNone && !work.seen[s]; s = nodes_.parent[s]) {
      work.seen[s] = 1;
      path.push_back(s);
    }
  }
  for (Index s : path) work.seen[s] = 0;
  std::sort(path.begin(), path.end());
}

void SupernodalCholesky::forward_panel(Index s, Eigen::VectorXd& y, SolveWork& work) const {
  const auto below = nodes_.below(s);
  std::fill_n(work.below.begin(), below.size(), 0.0);
  panel_forward(values_.data() + nodes_.value_begin[s], nodes_.width(s), nodes_.height(s),
                y.data() + nodes_.first[s], work.below.data());
  for (std::size_t i = 0; i < below.size(); ++i) y[below[i]] -= work.below[i];
}

void SupernodalCholesky::forward(std::span<const Index> supernodes, Eigen::VectorXd& y,
                                 SolveWork& work) const {
  work.below.resize(static_cast<std::size_t>(tallest_));
  for (Index s : supernodes) forward_panel(s, y, work);
}

void SupernodalCholesky::forward(Eigen::VectorXd& y, SolveWork& work) const {
  work.below.resize(static_cast<std::size_t>(tallest_));
  for (Index s = 0; s < nodes_.count(); ++s) forward_panel(s, y, work);
}

void SupernodalCholesky::backward(Eigen::VectorXd& y, SolveWork& work) const {
  work.below.resize(static_cast<std::size_t>(tallest_));
  for (Index s = nodes_.count() - 1; s >= 0; --s) {
    const auto below = nodes_.below(s);
    for (std::size_t i = 0; i < below.size(); ++i) work.below[i] = y[below[i]];
    panel_backward(values_.data() + nodes_.value_begin[s], nodes_.width(s), nodes_.height(s),
                   y.data() + nodes_.first[s], work.below.data());
  }
}

void SupernodalCholesky::forward(std::span<const Index> supernodes, Eigen::Ref<RowMajor> y,
                                 SolveWork& work) const {
  work.product.resize(std::max(work.product.size(), static_cast<std::size_t>(tallest_ * y.cols())));
  for (Index s : supernodes) {
    const ConstPanel p = panel(s);
    const Index width = nodes_.width(s);
    auto x = y.middleRows(nodes_.first[s], width);
    lower_solve(p.data(), p.outerStride(), width, x.data(), y.outerStride(), y.cols(),
                work.product.data());
    const auto below = nodes_.below(s);
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

void SupernodalCholesky::backward(Eigen::Ref<RowMajor> y, SolveWork& work) const {
  std::vector<Index> all(static_cast<std::size_t>(nodes_.count()));
  std::iota(all.begin(), all.end(), 0);
  backward(all, y, work);
}

void SupernodalCholesky::backward(std::span<const Index> supernodes, Eigen::Ref<RowMajor> y,
                                  SolveWork& work) const {
  RowMajor gathered;
  work.product.resize(std::max(work.product.size(), static_cast<std::size_t>(tallest_ * y.cols())));
  for (std::size_t at = supernodes.size(); at-- > 0;) {
    const Index s = supernodes[at];
    const ConstPanel p = panel(s);
    const Index width = nodes_.width(s);
    const auto below = nodes_.below(s);
    auto x = y.middleRows(nodes_.first[s], width);
    if (!below.empty()) {
      gathered.resize(static_cast<Index>(below.size()), y.cols());
      for (std::size_t i = 0; i < below.size(); ++i) {
        gathered.row(static_cast<Eigen::Index>(i)) = y.row(below[i]);
      }
      row_product({p.data() + width, width, gathered.rows(), p.outerStride(), 1}, gathered.data(),
                  gathered.outerStride(), y.cols(), work.product.data(), y.cols());
      x -= ConstRows(work.product.data(), width, y.cols());
    }
    p.topRows(width).transpose().triangularView<Eigen::Upper>().solveInPlace(x);
  }
}

std::size_t SupernodalCholesky::bytes() const {
  return values_.size() * sizeof(double) +
         (nodes_.rows.size() + 2 * nodes_.place.size()) * sizeof(Index);
}

}  // namespace sunder::fem
