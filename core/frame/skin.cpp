// SPDX-License-Identifier: Apache-2.0
#include "sunder/skin.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

#include "sunder/error.hpp"

namespace sunder {
namespace {

/// Barycentric coordinates in an element.
std::array<double, 4> shares(const Problem& problem, Index element, const Vec3& at) {
  const auto& tet = problem.mesh().tets[element];
  const TetShape& shape = problem.shape(element);
  std::array<double, 4> share{};
  share[0] = 1;
  for (int a = 1; a < 4; ++a) {
    const auto i = static_cast<std::size_t>(a);
    share[i] = shape.gradient.col(a).dot(at - problem.mesh().nodes[tet[0]]);
    share[0] -= share[i];
  }
  return share;
}

double least(const std::array<double, 4>& share) { return *std::ranges::min_element(share); }

/// Elements by the cells of a grid that their boxes touch.
class Cells {
 public:
  explicit Cells(const Problem& problem) {
    const Mesh& mesh = problem.mesh();
    low_ = high_ = mesh.nodes.front();
    for (const Vec3& x : mesh.nodes) {
      low_ = low_.cwiseMin(x);
      high_ = high_.cwiseMax(x);
    }
    const double volume = (high_ - low_).cwiseMax(Vec3::Constant(1e-12)).prod();
    size_ = std::max(std::cbrt(volume / static_cast<double>(mesh.tets.size())),
                     (high_ - low_).maxCoeff() / 256);
    for (int i = 0; i < 3; ++i) {
      count_[i] = std::max<std::ptrdiff_t>(
          1, static_cast<std::ptrdiff_t>(std::ceil((high_[i] - low_[i]) / size_)));
    }
    lists_.resize(static_cast<std::size_t>(count_[0] * count_[1] * count_[2]));
    for (Index e = 0; e < mesh.tet_count(); ++e) {
      if (problem.in_interface(e)) continue;  // a vertex belongs to the tissue of a side
      Vec3 low = mesh.nodes[mesh.tets[e][0]], high = low;
      for (Index n : mesh.tets[e]) {
        low = low.cwiseMin(mesh.nodes[n]);
        high = high.cwiseMax(mesh.nodes[n]);
      }
      for_cells(cell(low), cell(high), [&](std::vector<Index>& list) { list.push_back(e); });
    }
  }

  /// Calls `look` with the elements of each cell at most so many cells away.
  template <class Look>
  void around(const Vec3& at, std::ptrdiff_t cells, Look&& look) {
    auto low = cell(at), high = low;
    for (int i = 0; i < 3; ++i) {
      low[i] = std::max<std::ptrdiff_t>(0, low[i] - cells);
      high[i] = std::min(count_[i] - 1, high[i] + cells);
    }
    for_cells(low, high, look);
  }
  [[nodiscard]] std::ptrdiff_t most() const { return *std::ranges::max_element(count_); }

 private:
  using Cell = std::array<std::ptrdiff_t, 3>;
  [[nodiscard]] Cell cell(const Vec3& at) const {
    Cell cell{};
    for (int i = 0; i < 3; ++i) {
      const double x = std::clamp((at[i] - low_[i]) / size_, 0.0, static_cast<double>(count_[i]));
      cell[i] = std::min(count_[i] - 1, static_cast<std::ptrdiff_t>(x));
    }
    return cell;
  }
  template <class Look>
  void for_cells(const Cell& low, const Cell& high, Look&& look) {
    for (std::ptrdiff_t z = low[2]; z <= high[2]; ++z) {
      for (std::ptrdiff_t y = low[1]; y <= high[1]; ++y) {
        for (std::ptrdiff_t x = low[0]; x <= high[0]; ++x) {
          look(lists_[static_cast<std::size_t>(x + count_[0] * (y + count_[1] * z))]);
        }
      }
    }
  }

  Vec3 low_, high_;
  double size_ = 0;
  Cell count_{};
  std::vector<std::vector<Index>> lists_;
};

}  // namespace

Skin::Skin(const Simulation& simulation, std::span<const Vec3> vertices) : simulation_(simulation) {
  constexpr double kInside = -1e-9;  // of a coordinate: on a face counts as inside
  const Problem& problem = simulation.problem();
  Cells cells(problem);
  carriers_.reserve(vertices.size());
  for (const Vec3& at : vertices) {
    if (!at.allFinite()) throw UsageError("the vertices of a skin must be finite");
    Carrier best;
    double most = -std::numeric_limits<double>::infinity();
    const auto look = [&](const std::vector<Index>& elements) {
      for (Index e : elements) {
        const auto share = shares(problem, e, at);
        const double inside = std::min(least(share), kInside);  // all that hold it are alike
        if (inside < most || (inside == most && best.element <= e)) continue;
        most = inside;
        best = {e, share};
      }
    };
    for (std::ptrdiff_t away = 0; away <= cells.most() && best.element == kNone;
         away = 2 * away + 1)
      cells.around(at, away, look);
    if (most < kInside) cells.around(at, 1, look);  // outside: what is nearest may be next door
    carriers_.push_back(best);
  }
}

void Skin::places(std::span<float> places, std::span<std::uint8_t> lives) const {
  if (places.size() != 3 * size()) throw UsageError("a skin has 3 values for each vertex");
  if (!lives.empty() && lives.size() != size()) throw UsageError("one value for each vertex");
  const auto moved = simulation_.displacement();
  const Problem& problem = simulation_.problem();
  const auto split = simulation_.corners();
  const auto gone = simulation_.backend().destroyed();
  for (std::size_t v = 0; v < size(); ++v) {
    const auto& [element, share] = carriers_[v];
    const auto& tet = problem.mesh().tets[element];
    const auto& corners = split.empty() ? tet : split[static_cast<std::size_t>(element)];
    Vec3 at = Vec3::Zero();
    for (std::size_t a = 0; a < 4; ++a) {
      at += share[a] * (problem.mesh().nodes[tet[a]] + moved[static_cast<std::size_t>(corners[a])]);
    }
    for (std::size_t i = 0; i < 3; ++i) {
      places[3 * v + i] = static_cast<float>(at[static_cast<Eigen::Index>(i)]);
    }
    if (!lives.empty()) lives[v] = gone[static_cast<std::size_t>(element)] ? 0 : 1;
  }
}

}  // namespace sunder
