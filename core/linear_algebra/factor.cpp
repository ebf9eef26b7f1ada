// SPDX-License-Identifier: Apache-2.0
#include "linear_algebra/factor.hpp"

#include <algorithm>
#include <numeric>

#include "linear_algebra/shared_loop.hpp"
#include "sunder/error.hpp"

namespace sunder::linear_algebra {
namespace {

// Right-hand sides that go through the factor together: wide enough for the panels' products.
constexpr Index kBlock = 64;
// Bytes of such blocks that threads may have at the same time: of a body of a million tetrahedra
// one has 300 MB.
constexpr std::size_t kRooms = std::size_t{1} << 29;

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

void Factor::solve(Eigen::Ref<Eigen::MatrixXd> columns, RowMajor& room, SolveWork& work) const {
  const auto& place = cholesky_.supernodes().place;
  std::vector<Index> all(static_cast<std::size_t>(cholesky_.supernodes().count()));
  std::iota(all.begin(), all.end(), 0);
  for (Eigen::Index first = 0; first < columns.cols(); first += kBlock) {
    auto block = columns.middleCols(first, std::min<Eigen::Index>(kBlock, columns.cols() - first));
    room.resize(block.rows(), block.cols());
    for (Eigen::Index i = 0; i < block.rows(); ++i) {
      room.row(place[static_cast<std::size_t>(i)]) = block.row(i);
    }
    cholesky_.forward(all, room, work);
    cholesky_.backward(all, room, work);
    for (Eigen::Index i = 0; i < block.rows(); ++i) {
      block.row(i) = room.row(place[static_cast<std::size_t>(i)]);
    }
  }
}

/// What a thread solves with for a block of columns.
struct Factor::Room {
  RowMajor block;
  SolveWork work;
  std::vector<Index> seeds, path, tail;

  /// A unit vector for each seed; zeros in the rows that their paths, and the way back to some
  /// supernodes, go through, which alone are read. In a large body these are few.
  void begin(const Supernodes& nodes, std::span<const Index> wanted) {
    for (const std::span<const Index> some : {std::span<const Index>(path), wanted}) {
      for (Index s : some) block.middleRows(nodes.first[s], nodes.width(s)).setZero();
    }
    for (std::size_t c = 0; c < seeds.size(); ++c) block(seeds[c], static_cast<Index>(c)) = 1;
  }
};

/// body(start, width, room) for each block of columns, by several threads.
template <class Body>
void Factor::each_block(Index columns, const FactorWork& work, Body&& body) const {
  const Index blocks = (columns + kBlock - 1) / kBlock;
  const std::size_t room_bytes =
      static_cast<std::size_t>(cholesky_.size()) * kBlock * sizeof(double);
  const auto most = static_cast<int>(std::max<std::size_t>(kRooms / room_bytes, 1));
  SharedLoop loop(std::min({work.threads, static_cast<int>(blocks), most}), work.stop);
  std::vector<Room> rooms(static_cast<std::size_t>(loop.count()));
  const bool done = loop.run(blocks, [&](Index b, int worker) {
    const Index start = b * kBlock, width = std::min(kBlock, columns - start);
    Room& room = rooms[static_cast<std::size_t>(worker)];
    room.block.resize(cholesky_.size(), width);
    body(start, width, room);
  });
  if (!done) throw Stopped();
}

Eigen::MatrixXd Factor::inverse_block(std::span<const Index> rows, std::span<const Index> columns,
                                      const FactorWork& work) const {
  const auto& place = cholesky_.supernodes().place;
  // In the factor's own order, so that the columns of a block share their path.
  std::vector<Index> order(columns.size());
  std::iota(order.begin(), order.end(), 0);
  std::sort(order.begin(), order.end(),
            [&](Index a, Index b) { return place[columns[a]] < place[columns[b]]; });
  Eigen::MatrixXd result(static_cast<Index>(rows.size()), static_cast<Index>(columns.size()));
  std::vector<Index> seeds, wanted;
  SolveWork reaching;
  for (Index r : rows) seeds.push_back(place[r]);
  cholesky_.reach(seeds, wanted, reaching);
  each_block(static_cast<Index>(columns.size()), work, [&](Index start, Index width, Room& room) {
    room.seeds.clear();
    for (Index c = 0; c < width; ++c) {
      room.seeds.push_back(place[columns[order[start + c]]]);
    }
    cholesky_.reach(room.seeds, room.path, room.work);
    room.begin(cholesky_.supernodes(), wanted);
    cholesky_.forward(room.path, room.block, room.work);
    cholesky_.backward(wanted, room.block, room.work);
    for (Index c = 0; c < width; ++c) {
      auto column = result.col(order[start + c]);
      for (std::size_t i = 0; i < rows.size(); ++i) {
        column[static_cast<Eigen::Index>(i)] = room.block(place[rows[i]], c);
      }
    }
  });
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

Eigen::MatrixXd Factor::inverse_columns(std::span<const Index> columns,
                                        const FactorWork& work) const {
  std::vector<Index> rows(static_cast<std::size_t>(cholesky_.size()));
  std::iota(rows.begin(), rows.end(), 0);
  return inverse_block(rows, columns, work);
}

// In the factor's order the rows of a block of columns from its first one on are the lower
// triangle: the way back up stops there, which halves it, and the rest is its mirror image, to the
// last bit.
Eigen::MatrixXd Factor::inverse(const FactorWork& work) const {
  const Supernodes& nodes = cholesky_.supernodes();
  const Index n = cholesky_.size();
  std::vector<Index> unknown(static_cast<std::size_t>(n));
  for (Index i = 0; i < n; ++i) unknown[nodes.place[i]] = i;
  Eigen::MatrixXd result(n, n);
  each_block(n, work, [&](Index start, Index width, Room& room) {
    room.seeds.resize(static_cast<std::size_t>(width));
    std::iota(room.seeds.begin(), room.seeds.end(), start);
    room.tail.resize(static_cast<std::size_t>(nodes.count() - nodes.of[start]));
    std::iota(room.tail.begin(), room.tail.end(), nodes.of[start]);
    cholesky_.reach(room.seeds, room.path, room.work);
    room.begin(nodes, room.tail);
    cholesky_.forward(room.path, room.block, room.work);
    cholesky_.backward(room.tail, room.block, room.work);
    leave_triangle(room.block, start, unknown, result);
  });
  return result;
}

}  // namespace sunder::linear_algebra
