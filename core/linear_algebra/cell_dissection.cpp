// SPDX-License-Identifier: Apache-2.0
#include "linear_algebra/cell_dissection.hpp"

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <numeric>
#include <utility>

#include "linear_algebra/elimination_order.hpp"
#include "linear_algebra/minimum_degree.hpp"

namespace sunder::linear_algebra {
namespace {

// Pieces of up to this many points are left to minimum degree.
constexpr std::size_t kFewPoints = 32;
// Of the points, the least share that one side of a cut may have.
constexpr double kLeastSide = 0.35;
// A separator counts as this much larger for each share of the piece that one side has over half.
constexpr double kLopsided = 2;

class CellDissection {
 public:
  explicit CellDissection(const CoupledCells& of)
      : of_(of), local_(of.points.size(), kNone), first_(of.points.size()), last_(first_.size()) {
    std::vector<Index> cells(of.cells.size()), points;
    std::iota(cells.begin(), cells.end(), 0);
    for (std::size_t n = 0; n < of.points.size(); ++n) {
      const auto& unknowns = of.unknowns[n];
      if (std::ranges::any_of(unknowns, [](Index i) { return i != kNone; })) {
        points.push_back(static_cast<Index>(n));
      }
    }
    for (const std::vector<Index>& cell : of.cells) {
      Vec3 sum = Vec3::Zero();
      for (Index n : cell) sum += of.points[at(n)];
      middle_.push_back(sum / static_cast<double>(cell.size()));
    }
    order_.reserve(points.size());
    dissect(std::move(cells), std::move(points));
  }

  [[nodiscard]] const std::vector<Index>& order() const { return order_; }

 private:
  struct Cut {
    std::vector<Index> cells;  // in the order along the axis
    std::size_t count = 0;     // of them on the first side
    double cost = -1;          // below 0: none
  };

  static std::size_t at(Index i) { return static_cast<std::size_t>(i); }

  /// `points`: those that are left of the cells'.
  void dissect(std::vector<Index> cells, std::vector<Index> points) {
    Cut best;
    if (points.size() > kFewPoints) {
      for (int axis = 0; axis < 3; ++axis) {
        Cut cut = cut_across(cells, points, axis);
        if (cut.cost >= 0 && (best.cost < 0 || cut.cost < best.cost)) best = std::move(cut);
      }
    }
    if (best.cost < 0) {
      minimum_degree(cells, points);
      return;
    }
    find_extent(best.cells, points);
    std::vector<Index> one, other, separator;
    for (Index n : points) {
      const bool before = first_[at(n)] < best.count, after = last_[at(n)] >= best.count;
      (before && after ? separator : before ? one : other).push_back(n);
    }
    std::vector<Index> first(best.cells.begin(),
                             best.cells.begin() + static_cast<std::ptrdiff_t>(best.count)),
        rest(best.cells.begin() + static_cast<std::ptrdiff_t>(best.count), best.cells.end());
    best = {};
    cells = {};
    points = {};
    dissect(std::move(first), std::move(one));
    dissect(std::move(rest), std::move(other));
    order_.insert(order_.end(), separator.begin(), separator.end());
  }

  /// The places of a point's first and last cell.
  void find_extent(const std::vector<Index>& cells, const std::vector<Index>& points) {
    for (Index n : points) {
      first_[at(n)] = cells.size();
      last_[at(n)] = 0;
    }
    for (std::size_t i = 0; i < cells.size(); ++i) {
      for (Index n : of_.cells[at(cells[i])]) {
        first_[at(n)] = std::min(first_[at(n)], i);
        last_[at(n)] = i;
      }
    }
  }

  /// The smallest separator between cells that are sorted along the axis.
  Cut cut_across(const std::vector<Index>& cells, const std::vector<Index>& points, int axis) {
    Cut cut;
    cut.cells = cells;
    std::ranges::sort(cut.cells, [&](Index a, Index b) {
      const double x = middle_[at(a)][axis], y = middle_[at(b)][axis];
      return x != y ? x < y : a < b;
    });
    find_extent(cut.cells, points);
    // Points that begin and end at each place.
    std::vector<std::size_t> begins(cells.size() + 1, 0), ends(cells.size() + 1, 0);
    for (Index n : points) {
      ++begins[first_[at(n)]];
      ++ends[last_[at(n)]];
    }
    std::size_t before = 0, done = 0;  // that have begun; that have ended too
    const auto all = static_cast<double>(points.size());
    for (std::size_t count = 1; count < cells.size(); ++count) {
      before += begins[count - 1];
      done += ends[count - 1];
      const std::size_t separator = before - done, beyond = points.size() - before;
      const auto least = static_cast<double>(std::min(done, beyond));
      if (least < kLeastSide * (all - static_cast<double>(separator))) continue;
      const double over = static_cast<double>(std::max(done, beyond)) / all - 0.5;
      const double cost = static_cast<double>(separator) * (1 + kLopsided * std::max(0.0, over));
      if (cut.cost >= 0 && cost >= cut.cost) continue;
      cut.cost = cost;
      cut.count = count;
    }
    return cut;
  }

  void minimum_degree(const std::vector<Index>& cells, const std::vector<Index>& points) {
    for (std::size_t i = 0; i < points.size(); ++i) local_[at(points[i])] = static_cast<Index>(i);
    std::vector<std::pair<Index, Index>> edges;
    std::vector<Index> inside;
    for (Index c : cells) {
      inside.clear();
      for (Index n : of_.cells[at(c)]) {
        if (local_[at(n)] != kNone) inside.push_back(local_[at(n)]);
      }
      for (Index i : inside) {
        for (Index j : inside) edges.emplace_back(i, j);
      }
    }
    for (Index i : minimum_degree_order(static_cast<Index>(points.size()), edges)) {
      order_.push_back(points[at(i)]);
    }
    for (Index n : points) local_[at(n)] = kNone;
  }

  const CoupledCells& of_;
  std::vector<Vec3> middle_;               // of each cell
  std::vector<Index> local_;               // of each point in the piece at hand; else kNone
  std::vector<std::size_t> first_, last_;  // of each point: find_extent
  std::vector<Index> order_;
};

}  // namespace

std::vector<Index> cell_dissection(const CoupledCells& of) {
  return places_of_unknowns(CellDissection(of).order(), of.unknowns);
}

}  // namespace sunder::linear_algebra
