// SPDX-License-Identifier: Apache-2.0
#include "solver/path_columns.hpp"

#include <algorithm>

#include "machine/compiler.hpp"
#include "solver/columns.hpp"

namespace sunder::solver {
namespace {

constexpr Index kFirstColumns = 16;  // room that a block begins with

SUNDER_VECTORISED
double dot(const double* a, const double* b, Index n) {
  double lanes[8] = {};
  Index i = 0;
  for (; i + 8 <= n; i += 8) {
    for (int l = 0; l < 8; ++l) lanes[l] += a[i + l] * b[i + l];
  }
  for (int l = 0; i < n; ++i, ++l) lanes[l] += a[i] * b[i];
  return ((lanes[0] + lanes[1]) + (lanes[2] + lanes[3])) +
         ((lanes[4] + lanes[5]) + (lanes[6] + lanes[7]));
}

}  // namespace

template <class T>
T* PathColumns::Arena<T>::take(std::size_t count) {
  if (count > kChunk) {  // a piece of its own, before the chunk in use
    chunks_.insert(chunks_.begin(), std::unique_ptr<T[]>(new T[count]));
    return chunks_.front().get();
  }
  if (used_ + count > kChunk) {
    chunks_.emplace_back(new T[kChunk]);  // not touched before it is used
    used_ = 0;
  }
  T* piece = chunks_.back().get() + used_;
  used_ += count;
  return piece;
}

PathColumns::PathColumns(const linear_algebra::Supernodes& nodes)
    : nodes_(nodes), blocks_(static_cast<std::size_t>(nodes.count())) {}

void PathColumns::make_room() {
  reached_.reserve(blocks_.size());
  pushes_.reserve(1024);
  paths_.reserve(std::size_t{1} << 16);
  product_.resize(std::size_t{1} << 14);
  gathered_.resize(1024);
  static_cast<void>(values_.take(1));  // the first chunk
  static_cast<void>(ids_.take(1));
}

void PathColumns::reserve(Index s, Index count) {
  Block& b = blocks_[s];
  if (count <= b.capacity) return;
  const auto width = static_cast<std::size_t>(nodes_.width(s));
  if (b.capacity == 0) reached_.insert(std::ranges::lower_bound(reached_, s), s);
  const Index capacity = std::max({count, 2 * b.capacity, kFirstColumns});
  double* values = values_.take(width * static_cast<std::size_t>(capacity));
  Index* ids = ids_.take(static_cast<std::size_t>(capacity));
  std::copy_n(b.values, width * static_cast<std::size_t>(b.count), values);
  std::copy_n(b.ids, b.count, ids);
  b = {values, ids, b.count, capacity};
}

void PathColumns::append(std::span<const Index> path, const linear_algebra::RowMajor& rows,
                         Index count) {
  pushes_.push_back({paths_.size(), count});
  paths_.insert(paths_.end(), path.begin(), path.end());
  for (Index s : path) {
    reserve(s, blocks_[s].count + count);
    Block& b = blocks_[s];
    const Index width = nodes_.width(s);
    double* to = b.values + static_cast<std::size_t>(width) * static_cast<std::size_t>(b.count);
    for (Index c = 0; c < count; ++c) {
      b.ids[b.count + c] = columns_ + c;
      for (Index r = 0; r < width; ++r) *to++ = rows(nodes_.first[s] + r, c);
    }
    b.count += count;
  }
  columns_ += count;
}

void PathColumns::pop() {
  const Push last = pushes_.back();
  for (std::size_t i = last.path_begin; i < paths_.size(); ++i) {
    blocks_[paths_[i]].count -= last.count;
  }
  paths_.resize(last.path_begin);
  columns_ -= last.count;
  pushes_.pop_back();
}

void PathColumns::multiply(std::span<const Index> path, const linear_algebra::RowMajor& rows,
                           Index width, Eigen::Ref<linear_algebra::RowMajor> gram) {
  gram.topLeftCorner(columns_, width).setZero();
  for (Index s : path) {
    const Block& b = blocks_[s];
    if (b.count == 0) continue;
    const Index height = nodes_.width(s);
    const auto needed = static_cast<std::size_t>(b.count) * static_cast<std::size_t>(width);
    if (product_.size() < needed) product_.resize(2 * needed);
    linear_algebra::row_product({b.values, b.count, height, height, 1},
                                rows.row(nodes_.first[s]).data(), rows.outerStride(), width,
                                product_.data(), width);
    const Eigen::Map<const linear_algebra::RowMajor> product(product_.data(), b.count, width);
    for (Index i = 0; i < b.count; ++i) gram.row(b.ids[i]).head(width) += product.row(i);
  }
}

void PathColumns::project(const Eigen::VectorXd& y, Index first, Eigen::VectorXd& p) {
  if (p.size() < columns_) p.conservativeResize(2 * columns_ + 256);
  p.segment(first, columns_ - first).setZero();
  for (Index s : reached_) {
    const Block& b = blocks_[s];
    const Index width = nodes_.width(s);
    for (Index i = b.count - 1; i >= 0 && b.ids[i] >= first; --i) {
      p[b.ids[i]] += dot(b.values + static_cast<std::size_t>(i) * static_cast<std::size_t>(width),
                         y.data() + nodes_.first[s], width);
    }
  }
}

void PathColumns::add(const Eigen::VectorXd& c, Eigen::VectorXd& y) {
  if (gathered_.size() < static_cast<std::size_t>(columns_)) {
    gathered_.resize(2 * static_cast<std::size_t>(columns_));
  }
  for (Index s : reached_) {
    const Block& b = blocks_[s];
    for (Index i = 0; i < b.count; ++i) gathered_[static_cast<std::size_t>(i)] = c[b.ids[i]];
    const Index width = nodes_.width(s);
    add_product(b.values, width, width, gathered_.data(), b.count, y.data() + nodes_.first[s]);
  }
}

std::size_t PathColumns::bytes() const {
  std::size_t sum = 0;
  for (Index s : reached_) {
    sum += static_cast<std::size_t>(blocks_[s].count) *
           (static_cast<std::size_t>(nodes_.width(s)) * sizeof(double) + sizeof(Index));
  }
  return sum;
}

}  // namespace sunder::solver
