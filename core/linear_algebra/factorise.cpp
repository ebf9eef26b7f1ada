// SPDX-License-Identifier: Apache-2.0
#include "linear_algebra/factorise.hpp"

#include <Eigen/Cholesky>
#include <algorithm>
#include <atomic>
#include <numeric>

#include "linear_algebra/row_product.hpp"
#include "linear_algebra/workers.hpp"

namespace sunder::linear_algebra {
namespace {

// Panels of more entries than this are shared by the threads: below, waking them takes as long.
constexpr std::size_t kSharedEntries = 100'000;
// A factor of fewer entries is done before further threads have started.
constexpr std::size_t kWorthThreads = 1'000'000;
// Parts of a shared panel for each thread: their rows cost unequal work.
constexpr int kParts = 3;
// Rows that are solved together: with a panel's triangle they stay in the cache.
constexpr Index kSolvedRows = 256;

/// What a descendant contributes to a panel: from this one of its rows below, so many of which lie
/// in the panel's own columns.
struct Contribution {
  Index panel, from, reached;
};

/// A thread's own.
struct Room {
  std::vector<double> product, packed;
};

class Factorisation {
 public:
  Factorisation(const Supernodes& nodes, const SparseMatrix& matrix, const FactorWork& work,
                std::span<double> values)
      : nodes_(nodes),
        matrix_(matrix),
        values_(values),
        stop_(work.stop),
        workers_(values.size() < kWorthThreads ? 1 : work.threads),
        rooms_(static_cast<std::size_t>(workers_.count())),
        head_(static_cast<std::size_t>(nodes.count()), kNone),
        next_(head_),
        done_(head_),
        at_(nodes.place.size()) {}

  bool run() {
    for (Index s = 0; s < nodes_.count(); ++s) {
      if (stop_ && stop_->load(std::memory_order_relaxed)) return false;
      begin(s);
      share(s, [&](Index first, Index last, Room& room) { collect(s, first, last, room); });
      if (!factor_triangle(s)) return false;
      if (nodes_.below(s).empty()) continue;
      share(s, [&](Index first, Index last, Room& room) { solve_rows(s, first, last, room); });
      done_[s] = 0;
      wait_for(s, nodes_.below(s).front());
    }
    return true;
  }

 private:
  double* panel(Index s) { return values_.data() + nodes_.value_begin[s]; }

  /// The descendant waits in the list of the next panel that its rows reach.
  void wait_for(Index descendant, Index row) {
    const Index target = nodes_.of[row];
    next_[descendant] = head_[target];
    head_[target] = descendant;
  }

  void begin(Index s) {
    const Index first = nodes_.first[s], end = nodes_.first[s + 1];
    std::iota(at_.begin() + first, at_.begin() + end, 0);
    const auto below = nodes_.below(s);
    for (std::size_t i = 0; i < below.size(); ++i) {
      at_[below[i]] = end - first + static_cast<Index>(i);
    }
    contributions_.clear();
    for (Index d = head_[s]; d != kNone;) {
      const Index following = next_[d];
      const auto rows = nodes_.below(d).subspan(static_cast<std::size_t>(done_[d]));
      const auto reached =
          static_cast<Index>(std::lower_bound(rows.begin(), rows.end(), end) - rows.begin());
      contributions_.push_back({d, done_[d], reached});
      done_[d] += reached;
      if (static_cast<std::size_t>(reached) < rows.size()) {
        wait_for(d, rows[static_cast<std::size_t>(reached)]);
      }
      d = following;
    }
  }

  /// Calls body(first, last, room) for parts of the panel's rows that make up all of them.
  template <class Body>
  void share(Index s, Body&& body) {
    const Index height = nodes_.height(s);
    const std::size_t entries = nodes_.value_begin[s + 1] - nodes_.value_begin[s];
    if (workers_.count() == 1 || entries < kSharedEntries) {
      body(0, height, rooms_.front());
      return;
    }
    const Index parts = kParts * workers_.count();
    std::atomic<Index> taken{0};
    workers_.run([&](int worker) {
      for (Index p = taken++; p < parts; p = taken++) {
        body(part(height, p, parts), part(height, p + 1, parts),
             rooms_[static_cast<std::size_t>(worker)]);
      }
    });
  }

  static Index part(Index height, Index p, Index parts) {
    return static_cast<Index>(static_cast<std::int64_t>(height) * p / parts);
  }

  /// The unknown behind a row of the panel.
  Index unknown(Index s, Index row) const {
    const Index width = nodes_.width(s);
    return row < width ? nodes_.first[s] + row
                       : nodes_.below(s)[static_cast<std::size_t>(row - width)];
  }

  /// The matrix's columns less what the descendants contribute, in some rows of the panel.
  void collect(Index s, Index first, Index last, Room& room) {
    if (first == last) return;
    const Index begin = nodes_.first[s], width = nodes_.width(s), height = nodes_.height(s);
    double* p = panel(s);
    for (Index j = 0; j < width; ++j) {
      for (SparseMatrix::InnerIterator it(matrix_, begin + j); it; ++it) {
        const Index row = at_[it.row()];
        if (row >= first && row < last)
          p[static_cast<std::ptrdiff_t>(j) * height + row] = it.value();
      }
    }
    const Index lowest = unknown(s, first), highest = unknown(s, last - 1);
    for (const Contribution& c : contributions_) {
      const auto rows = nodes_.below(c.panel).subspan(static_cast<std::size_t>(c.from));
      const auto from = std::lower_bound(rows.begin(), rows.end(), lowest) - rows.begin();
      const auto to = std::upper_bound(rows.begin() + from, rows.end(), highest) - rows.begin();
      if (from < to) subtract(c, s, static_cast<Index>(from), static_cast<Index>(to), room);
    }
  }

  /// Rows from..to of the contribution, each up to its diagonal.
  void subtract(const Contribution& c, Index s, Index from, Index to, Room& room) {
    const auto rows = nodes_.below(c.panel).subspan(static_cast<std::size_t>(c.from));
    const Index height = nodes_.height(c.panel), columns = std::min(c.reached, to);
    const Index count = to - from;
    const double* tail = panel(c.panel) + height - static_cast<Index>(rows.size());
    room.product.resize(std::max(
        room.product.size(), static_cast<std::size_t>(columns) * static_cast<std::size_t>(count)));
    packed_product({tail, columns, nodes_.width(c.panel), 1, height}, tail + from, height, count,
                   room.product.data(), count, room.packed);
    for (Index j = 0; j < columns; ++j) {
      double* column =
          panel(s) +
          static_cast<std::ptrdiff_t>(at_[rows[static_cast<std::size_t>(j)]]) * nodes_.height(s);
      const double* product = room.product.data() + static_cast<std::ptrdiff_t>(j) * count;
      for (Index i = std::max(from, j); i < to; ++i) {
        column[at_[rows[static_cast<std::size_t>(i)]]] -= product[i - from];
      }
    }
  }

  bool factor_triangle(Index s) {
    Eigen::Map<Eigen::MatrixXd> p(panel(s), nodes_.height(s), nodes_.width(s));
    auto triangle = p.topRows(nodes_.width(s));
    const Eigen::LLT<Eigen::Ref<Eigen::MatrixXd>> llt(triangle);
    return llt.info() == Eigen::Success && triangle.diagonal().allFinite();
  }

  /// L21 = A21 L11^-T, row by row: a row is the right side of a solution with L11.
  void solve_rows(Index s, Index first, Index last, Room& room) {
    const Index width = nodes_.width(s), height = nodes_.height(s);
    room.product.resize(std::max(room.product.size(), static_cast<std::size_t>(width) *
                                                          static_cast<std::size_t>(kSolvedRows)));
    for (Index row = std::max(first, width); row < last; row += kSolvedRows) {
      lower_solve(panel(s), height, width, panel(s) + row, height,
                  std::min(kSolvedRows, last - row), room.product.data());
    }
  }

  const Supernodes& nodes_;
  const SparseMatrix& matrix_;
  std::span<double> values_;
  const std::atomic<bool>* stop_;
  Workers workers_;
  std::vector<Room> rooms_;
  std::vector<Index> head_, next_;  // lists of the descendants that wait for a panel
  std::vector<Index> done_;         // rows below a panel that have contributed
  std::vector<Index> at_;           // unknown -> row of the current panel
  std::vector<Contribution> contributions_;
};

}  // namespace

bool factorise(const Supernodes& nodes, const SparseMatrix& matrix, const FactorWork& work,
               std::span<double> values) {
  return Factorisation(nodes, matrix, work, values).run();
}

}  // namespace sunder::linear_algebra
