// SPDX-License-Identifier: Apache-2.0
#include "linear_algebra/nested_dissection.hpp"

#include <algorithm>
#include <array>
#include <span>
#include <utility>

#include "linear_algebra/elimination_order.hpp"
#include "linear_algebra/minimum_degree.hpp"

namespace sunder::linear_algebra {
namespace {

// Pieces of up to this many nodes are left to minimum degree.
constexpr std::size_t kPiece = 32;

// A separator counts as this much larger for each share of the piece that one side has over half.
constexpr double kImbalance = 4;

bool has_unknowns(const std::array<Index, 3>& unknowns) {
  return std::ranges::any_of(unknowns, [](Index i) { return i != kNone; });
}

/// Points that share a group, ascending.
class Neighbours {
 public:
  explicit Neighbours(const CoupledPoints& of) : begin_(of.points.size() + 1, 0) {
    for (const auto& group : of.groups) {
      for (Index n : group) begin_[n + 1] += 3;
    }
    for (std::size_t n = 1; n < begin_.size(); ++n) begin_[n] += begin_[n - 1];
    of_.resize(begin_.back());
    std::vector<std::size_t> at(begin_.begin(), begin_.end() - 1);
    for (const auto& group : of.groups) {
      for (Index n : group) {
        for (Index m : group) {
          if (m != n) of_[at[n]++] = m;
        }
      }
    }
    end_.resize(at.size());
    for (std::size_t n = 0; n < at.size(); ++n) {
      const auto first = of_.begin() + static_cast<std::ptrdiff_t>(begin_[n]);
      const auto last = of_.begin() + static_cast<std::ptrdiff_t>(begin_[n + 1]);
      std::sort(first, last);
      end_[n] = static_cast<std::size_t>(std::unique(first, last) - of_.begin());
    }
  }
  [[nodiscard]] std::span<const Index> of(Index node) const {
    return {of_.data() + begin_[node], end_[node] - begin_[node]};
  }

 private:
  std::vector<std::size_t> begin_, end_;
  std::vector<Index> of_;
};

class Dissection {
 public:
  explicit Dissection(const CoupledPoints& of)
      : points_(of.points), neighbours_(of), side_(of.points.size(), 0) {
    std::vector<Index> all;
    for (std::size_t n = 0; n < of.points.size(); ++n) {
      if (has_unknowns(of.unknowns[n])) all.push_back(static_cast<Index>(n));
    }
    order_.reserve(all.size());
    dissect(std::move(all));
  }

  [[nodiscard]] const std::vector<Index>& order() const { return order_; }

 private:
  struct Cut {
    std::vector<Index> one, other, separator;
    double cost = 0;
  };

  void dissect(std::vector<Index> piece) {
    if (piece.size() <= kPiece) {
      minimum_degree(piece);
      return;
    }
    Cut best = cut_across(piece, 0);
    for (int axis = 1; axis < 3; ++axis) {
      Cut cut = cut_across(piece, axis);
      if (cut.cost < best.cost) best = std::move(cut);
    }
    piece = {};
    dissect(std::move(best.one));
    dissect(std::move(best.other));
    order_.insert(order_.end(), best.separator.begin(), best.separator.end());
  }

  /// By a plane through the median node; where too many nodes lie on it, by their numbers as well.
  Cut cut_across(const std::vector<Index>& piece, int axis) {
    keys_.clear();
    for (Index n : piece) keys_.emplace_back(points_[static_cast<std::size_t>(n)][axis], n);
    const auto middle = keys_.begin() + static_cast<std::ptrdiff_t>(keys_.size() / 2);
    std::nth_element(keys_.begin(), middle, keys_.end());
    // Coordinates of one grid plane may differ by rounding.
    const auto [low, high] = std::minmax_element(keys_.begin(), keys_.end());
    const double plane = middle->first - 1e-9 * (high->first - low->first);
    const auto before = [plane](const auto& key) { return key.first < plane; };
    auto end = std::partition(keys_.begin(), middle, before);
    if (static_cast<std::size_t>(end - keys_.begin()) < piece.size() / 4) end = middle;
    Cut cut;
    ++mark_;
    for (auto key = keys_.begin(); key != end; ++key) {
      side_[key->second] = mark_;
      cut.one.push_back(key->second);
    }
    for (Index n : piece) {
      if (side_[n] == mark_) continue;
      const bool touches =
          std::ranges::any_of(neighbours_.of(n), [this](Index m) { return side_[m] == mark_; });
      (touches ? cut.separator : cut.other).push_back(n);
    }
    const auto larger = static_cast<double>(std::max(cut.one.size(), cut.other.size()));
    const double over = std::max(0.0, larger / static_cast<double>(piece.size()) - 0.5);
    cut.cost = static_cast<double>(cut.separator.size()) * (1 + kImbalance * over);
    return cut;
  }

  void minimum_degree(std::vector<Index>& piece) {
    std::sort(piece.begin(), piece.end());
    const auto size = static_cast<Index>(piece.size());
    std::vector<std::pair<Index, Index>> edges;
    for (Index i = 0; i < size; ++i) {
      edges.emplace_back(i, i);
      for (Index m : neighbours_.of(piece[i])) {
        const auto at = std::lower_bound(piece.begin(), piece.end(), m);
        if (at == piece.end() || *at != m) continue;
        edges.emplace_back(i, static_cast<Index>(at - piece.begin()));
      }
    }
    for (Index i : minimum_degree_order(size, edges)) order_.push_back(piece[i]);
  }

  const std::span<const Vec3> points_;
  const Neighbours neighbours_;
  std::vector<int> side_;  // the last cut that put the node on its first side
  int mark_ = 0;
  std::vector<std::pair<double, Index>> keys_;
  std::vector<Index> order_;
};

}  // namespace

std::vector<Index> nested_dissection(const CoupledPoints& of) {
  return places_of_unknowns(Dissection(of).order(), of.unknowns);
}

}  // namespace sunder::linear_algebra
