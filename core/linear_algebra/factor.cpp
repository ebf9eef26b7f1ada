// SPDX-License-Identifier: Apache-2.0
#include "linear_algebra/factor.hpp"

#include <algorithm>
#include <numeric>

#include "sunder/error.hpp"

namespace sunder::linear_algebra {
namespace {

// Right-hand sides that go through the factor together: wide enough for the panels' products.
constexpr std::size_t kBlock = 64;

/// The part of a block of columns from `start` on that is in the lower triangle, and its mirror
/// image. A square at a time: both its rows and its columns stay in the cache.
void leave_triangle(const RowMajor& block, Index start, std::span<const Index> unknown,
                    Eigen::MatrixXd& result) {
  const auto n = static_cast<Index>(block.rows()), width = static_cast<Index>(block.cols());
  for (Index first = start; first < n; first += width) {
    const Index end = std::min(n, first + width);
    for (Index c = 0; c < width; ++c) {
      double* column = result.col(unknown[start + c]).data();
      for (Index row = std::max(first, start + c); row < end; ++row) {
        column[unknown[row]] = block(row, c);
      }
    }
    for (Index row = first; row < end; ++row) {
      double* column = result.col(unknown[row]).data();
      for (Index c = 0; c < std::min(width, row - start); ++c) {
        column[unknown[start + c]] = block(row, c);
      }
    }
  }
}

}  // namespace

Factor::Factor(const SparseMatrix& lower) : cholesky_(lower) { check(); }

Factor::Factor(const SparseMatrix& lower, std::vector<Index> place, const FactorWork& work)
    : cholesky_(lower, std::move(place), work) {
  if (work.stop && work.stop->load()) throw Stopped();
  check();
}

Factor::Factor(std::shared_ptr<const Supernodes> nodes, const SparseMatrix& ordered,
               const FactorWork& work)
    : cholesky_(std::move(nodes), ordered, work) {
  if (work.stop && work.stop->load()) throw Stopped();
  check();
}

void Factor::check() const {
  if (!cholesky_.succeeded()) {
    throw NumericalError(
        "the stiffness matrix is not positive definite in double precision: a part of the body "
        "hangs on a hinge, or stiffness contrast, Poisson's ratio or slivers are too extreme");
  }
}

Eigen::VectorXd Factor::solve(const Eigen::VectorXd& rhs) const {
  SolveWork work;
  Eigen::VectorXd x;
  solve(rhs, x, work);
  return x;
}

void Factor::solve(const Eigen::VectorXd& rhs, Eigen::VectorXd& x, SolveWork& work) const {
  const auto& place = cholesky_.supernodes().place;
  Eigen::VectorXd& y = work.permuted;
  y.resize(rhs.size());
  x.resize(rhs.size());
  for (std::size_t i = 0; i < place.size(); ++i) y[place[i]] = rhs[static_cast<Eigen::Index>(i)];
  cholesky_.forward(y, work);
  cholesky_.backward(y, work);
  for (std::size_t i = 0; i < place.size(); ++i) x[static_cast<Eigen::Index>(i)] = y[place[i]];
}

Eigen::MatrixXd Factor::inverse_block(std::span<const Index> rows, std::span<const Index> columns,
                                      const std::atomic<bool>* stop) const {
  const auto& place = cholesky_.supernodes().place;
  // In the factor's own order, so that the columns of a block share their path.
  std::vector<Index> order(columns.size());
  std::iota(order.begin(), order.end(), 0);
  std::sort(order.begin(), order.end(),
            [&](Index a, Index b) { return place[columns[a]] < place[columns[b]]; });
  Eigen::MatrixXd result(static_cast<Index>(rows.size()), static_cast<Index>(columns.size()));
  RowMajor block;
  SolveWork work;
  std::vector<Index> seeds, path, wanted;
  for (Index r : rows) seeds.push_back(place[r]);
  cholesky_.reach(seeds, wanted, work);
  for (std::size_t start = 0; start < columns.size(); start += kBlock) {
    if (stop && *stop) throw Stopped();
    const std::size_t width = std::min(kBlock, columns.size() - start);
    block.setZero(cholesky_.size(), static_cast<Index>(width));
    seeds.clear();
    for (std::size_t c = 0; c < width; ++c) {
      seeds.push_back(place[columns[order[start + c]]]);
      block(seeds.back(), static_cast<Index>(c)) = 1;
    }
    cholesky_.reach(seeds, path, work);
    cholesky_.forward(path, block, work);
    cholesky_.backward(wanted, block, work);
    for (std::size_t c = 0; c < width; ++c) {
      auto column = result.col(order[start + c]);
      for (std::size_t i = 0; i < rows.size(); ++i) {
        column[static_cast<Eigen::Index>(i)] = block(place[rows[i]], static_cast<Index>(c));
      }
    }
  }
  return result;
}

std::size_t Factor::path_entries(std::span<const Index> dofs) const {
  const Supernodes& nodes = cholesky_.supernodes();
  std::vector<Index> rows, path;
  for (Index d : dofs) rows.push_back(nodes.place[d]);
  SolveWork work;
  cholesky_.reach(rows, path, work);
  std::size_t entries = 0;
  for (Index s : path) entries += nodes.value_begin[s + 1] - nodes.value_begin[s];
  return entries;
}

Eigen::MatrixXd Factor::inverse_columns(std::span<const Index> columns) const {
  std::vector<Index> rows(static_cast<std::size_t>(cholesky_.size()));
  std::iota(rows.begin(), rows.end(), 0);
  return inverse_block(rows, columns);
}

// In the factor's order the rows of a block of columns from its first one on are the lower
// triangle: the way back up stops there, which halves it, and the rest is its mirror image, to the
// last bit.
Eigen::MatrixXd Factor::inverse() const {
  const Supernodes& nodes = cholesky_.supernodes();
  const auto n = static_cast<Index>(cholesky_.size());
  std::vector<Index> unknown(static_cast<std::size_t>(n)), seeds, path, tail;
  for (Index i = 0; i < n; ++i) unknown[nodes.place[i]] = i;
  Eigen::MatrixXd result(n, n);
  RowMajor block;
  SolveWork work;
  for (Index start = 0; start < n; start += static_cast<Index>(kBlock)) {
    const Index width = std::min(static_cast<Index>(kBlock), n - start);
    block.setZero(n, width);
    for (Index c = 0; c < width; ++c) block(start + c, c) = 1;
    seeds.resize(static_cast<std::size_t>(width));
    std::iota(seeds.begin(), seeds.end(), start);
    tail.resize(static_cast<std::size_t>(nodes.count() - nodes.of[start]));
    std::iota(tail.begin(), tail.end(), nodes.of[start]);
    cholesky_.reach(seeds, path, work);
    cholesky_.forward(path, block, work);
    cholesky_.backward(tail, block, work);
    leave_triangle(block, start, unknown, result);
  }
  return result;
}

}  // namespace sunder::linear_algebra
