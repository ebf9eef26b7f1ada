// SPDX-License-Identifier: Apache-2.0
#include "linear_algebra/factorise.hpp"

#include <Eigen/Cholesky>
#include <algorithm>
#include <atomic>
#include <numeric>

#include "linear_algebra/row_product.hpp"
#include "linear_algebra/shared_loop.hpp"

namespace sunder::linear_algebra {
namespace {

// Panels of more entries than this are shared by the threads: below, waking them takes as long.
constexpr std::size_t kSharedEntries = 100'000;
// A factor of fewer entries is done before further threads have started.
constexpr std::size_t kWorthThreads = 1'000'000;
// Parts of a shared panel for each thread: their rows cost unequal work.
constexpr int kParts = 3;
// Subtrees for each thread: the largest ones that threads take one by one do a share of the work
// that is by so much smaller.
constexpr int kSubtrees = 4;
// Rows that are solved together: with a panel's triangle they stay in the cache.
constexpr Index kSolvedRows = 256;

/// What a descendant contributes to a panel: from this one of its rows below, so many of which lie
/// in the panel's own columns.
struct Contribution {
  Index panel, from, reached;
};

/// A descendant that has to wait for a panel.
struct Waiting {
  Index descendant, panel;
};

/// What a thread works with.
struct Room {
  std::vector<double> product, packed;
};

/// The panel in work: row of each unknown in it, and what its descendants contribute.
struct Gathering {
  std::vector<Index> at;
  std::vector<Contribution> contributions;
};

/// A subtree of supernodes, first to last, which depends on nothing else; and which of its
/// supernodes wait for panels outside, in the order in which they came to that.
struct Subtree {
  Index first, last;
  std::vector<Waiting> outside = {};
};

class Factorisation {
 public:
  Factorisation(const Supernodes& nodes, const SparseMatrix& matrix, const FactorWork& work,
                std::span<double> values)
      : nodes_(nodes),
        matrix_(matrix),
        values_(values),
        loop_(values.size() < kWorthThreads ? 1 : work.threads, work.stop),
        stop_(work.stop),
        rooms_(static_cast<std::size_t>(loop_.count())),
        gatherings_(rooms_.size()),
        head_(static_cast<std::size_t>(nodes.count()), kNone),
        next_(head_),
        done_(head_) {}

  /// Subtrees that many threads take one by one, then what is above them panel by panel. A panel's
  /// descendants wait for it in the order in which one thread would have come by them.
  bool run() {
    find_subtrees();
    std::atomic<bool> positive{true};
    if (!loop_.run(static_cast<Index>(subtrees_.size()), [&](Index t, int worker) {
          Subtree& subtree = subtrees_[static_cast<std::size_t>(t)];
          const auto w = static_cast<std::size_t>(worker);
          for (Index s = subtree.first; s <= subtree.last && positive && !stopped(); ++s) {
            if (!factor(s, w, &subtree)) positive = false;
          }
        })) {
      return false;
    }
    if (!positive) return false;
    auto subtree = subtrees_.begin();
    for (Index s = 0; s < nodes_.count(); ++s) {
      if (subtree != subtrees_.end() && s == subtree->first) {
        for (const Waiting& w : subtree->outside) wait_in(w.panel, w.descendant);
        s = subtree->last;
        ++subtree;
        continue;
      }
      if (stopped() || !factor(s, 0, nullptr)) return false;
    }
    return !stopped();
  }

 private:
  [[nodiscard]] bool stopped() const { return stop_ && stop_->load(std::memory_order_relaxed); }
  double* panel(Index s) { return values_.data() + nodes_.value_begin[s]; }

  Gathering& gathering(std::size_t worker) {
    Gathering& g = gatherings_[worker];
    g.at.resize(nodes_.place.size());
    return g;
  }

  /// The largest subtrees that are small enough for threads to have about as much each; none for
  /// one thread.
  void find_subtrees() {
    if (loop_.count() == 1) return;
    const auto count = static_cast<std::size_t>(nodes_.count());
    std::vector<double> work(count, 0.0);
    std::vector<Index> first(count);
    std::iota(first.begin(), first.end(), 0);
    double all = 0;
    for (Index s = 0; s < nodes_.count(); ++s) {
      const double height = nodes_.height(s), own = height * height * nodes_.width(s);
      all += own;
      work[s] += own;
      const Index above = nodes_.parent[s];
      if (above == kNone) continue;
      work[above] += work[s];
      first[above] = std::min(first[above], first[s]);
    }
    const double most = all / (kSubtrees * loop_.count());
    for (Index s = 0; s < nodes_.count(); ++s) {
      const Index above = nodes_.parent[s];
      if (work[s] <= most && (above == kNone || work[above] > most)) {
        subtrees_.push_back({first[s], s});
      }
    }
  }

  /// One panel, by a thread that has its subtree for itself, or by all.
  bool factor(Index s, std::size_t worker, Subtree* within) {
    Gathering& g = gathering(worker);
    const auto by_rows = [&](auto&& body) {
      within ? body(0, nodes_.height(s), rooms_[worker]) : share(s, body);
    };
    begin(s, g, within);
    by_rows([&](Index first, Index last, Room& room) { collect(s, first, last, g, room); });
    if (!factor_triangle(s)) return false;
    if (nodes_.below(s).empty()) return true;
    by_rows([&](Index first, Index last, Room& room) { solve_rows(s, first, last, room); });
    done_[s] = 0;
    wait_for(s, nodes_.below(s).front(), within);
    return true;
  }

  /// The descendant waits in the list of the next panel that its rows reach.
  void wait_for(Index descendant, Index row, Subtree* within) {
    const Index target = nodes_.of[row];
    if (within && target > within->last) {
      within->outside.push_back({descendant, target});
    } else {
      wait_in(target, descendant);
    }
  }

  void wait_in(Index target, Index descendant) {
    next_[descendant] = head_[target];
    head_[target] = descendant;
  }

  void begin(Index s, Gathering& g, Subtree* within) {
    const Index first = nodes_.first[s], end = nodes_.first[s + 1];
    std::iota(g.at.begin() + first, g.at.begin() + end, 0);
    const auto below = nodes_.below(s);
    for (std::size_t i = 0; i < below.size(); ++i) {
      g.at[below[i]] = end - first + static_cast<Index>(i);
    }
    g.contributions.clear();
    for (Index d = head_[s]; d != kNone;) {
      const Index following = next_[d];
      const auto rows = nodes_.below(d).subspan(static_cast<std::size_t>(done_[d]));
      const auto reached =
          static_cast<Index>(std::lower_bound(rows.begin(), rows.end(), end) - rows.begin());
      g.contributions.push_back({d, done_[d], reached});
      done_[d] += reached;
      if (static_cast<std::size_t>(reached) < rows.size()) {
        wait_for(d, rows[static_cast<std::size_t>(reached)], within);
      }
      d = following;
    }
  }

  /// Calls body(first, last, room) for parts of the panel's rows that make up all of them, by all
  /// threads where it is large.
  template <class Body>
  void share(Index s, Body&& body) {
    const Index height = nodes_.height(s);
    const std::size_t entries = nodes_.value_begin[s + 1] - nodes_.value_begin[s];
    if (loop_.count() == 1 || entries < kSharedEntries) {
      body(0, height, rooms_.front());
      return;
    }
    const Index parts = kParts * loop_.count();
    (void)loop_.run(parts, [&](Index p, int worker) {
      body(part(height, p, parts), part(height, p + 1, parts),
           rooms_[static_cast<std::size_t>(worker)]);
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
  void collect(Index s, Index first, Index last, const Gathering& g, Room& room) {
    if (first == last) return;
    const Index begin = nodes_.first[s], width = nodes_.width(s), height = nodes_.height(s);
    double* p = panel(s);
    for (Index j = 0; j < width; ++j) {
      std::fill_n(p + static_cast<std::ptrdiff_t>(j) * height + first, last - first, 0.0);
      for (SparseMatrix::InnerIterator it(matrix_, begin + j); it; ++it) {
        const Index row = g.at[it.row()];
        if (row >= first && row < last)
          p[static_cast<std::ptrdiff_t>(j) * height + row] = it.value();
      }
    }
    const Index lowest = unknown(s, first), highest = unknown(s, last - 1);
    for (const Contribution& c : g.contributions) {
      const auto rows = nodes_.below(c.panel).subspan(static_cast<std::size_t>(c.from));
      const auto from = std::lower_bound(rows.begin(), rows.end(), lowest) - rows.begin();
      const auto to = std::upper_bound(rows.begin() + from, rows.end(), highest) - rows.begin();
      if (from < to) subtract(c, s, static_cast<Index>(from), static_cast<Index>(to), g.at, room);
    }
  }

  /// Rows from..to of the contribution, each up to its diagonal.
  void subtract(const Contribution& c, Index s, Index from, Index to, const std::vector<Index>& at,
                Room& room) {
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
          static_cast<std::ptrdiff_t>(at[rows[static_cast<std::size_t>(j)]]) * nodes_.height(s);
      const double* product = room.product.data() + static_cast<std::ptrdiff_t>(j) * count;
      for (Index i = std::max(from, j); i < to; ++i) {
        column[at[rows[static_cast<std::size_t>(i)]]] -= product[i - from];
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
  SharedLoop loop_;
  const std::atomic<bool>* stop_;
  std::vector<Room> rooms_;            // each thread's
  std::vector<Gathering> gatherings_;  // each thread's
  std::vector<Subtree> subtrees_;
  std::vector<Index> head_, next_;  // lists of the descendants that wait for a panel
  std::vector<Index> done_;         // rows below a panel that have contributed
};

}  // namespace

bool factorise(const Supernodes& nodes, const SparseMatrix& matrix, const FactorWork& work,
               std::span<double> values) {
  return Factorisation(nodes, matrix, work, values).run();
}

}  // namespace sunder::linear_algebra
