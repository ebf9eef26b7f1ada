// SPDX-License-Identifier: Apache-2.0
#include "fracture/averaged_strength.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <sstream>
#include <tuple>

#include "sunder/error.hpp"
#include "sunder/fracture_model.hpp"
#include "sunder/stress_measures.hpp"

namespace sunder::fracture {
namespace {

constexpr double kNothing = -std::numeric_limits<double>::infinity();
constexpr std::size_t kMostNeighbours = std::size_t{1} << 30;  // 4 GiB of ids

Vec3 centroid(const Mesh& mesh, Index e) {
  Vec3 sum = Vec3::Zero();
  for (Index n : mesh.tets[static_cast<std::size_t>(e)])
    sum += mesh.nodes[static_cast<std::size_t>(n)];
  return sum / 4;
}

/// Points in cubes, sorted by cube, so that a neighbourhood costs what lies in it.
class Cubes {
 public:
  struct Point {
    std::array<long long, 3> cube;
    Index id;
    bool operator<(const Point& other) const {
      return std::tie(cube, id) < std::tie(other.cube, other.id);
    }
  };

  Cubes(const Problem& problem, double side) : side_(side) {
    const Mesh& mesh = problem.mesh();
    centroids_.reserve(mesh.tets.size());
    for (Index e = 0; e < problem.tet_count(); ++e) {
      centroids_.push_back(centroid(mesh, e));
      if (problem.breakable(e)) points_.push_back({cube_of(centroids_.back()), e});
    }
    std::sort(points_.begin(), points_.end());
  }

  /// visit(id) for the points at most one side away from `centre`.
  template <class Visit>
  void around(const Vec3& centre, Visit&& visit) const {
    const auto own = cube_of(centre);
    for (long long x = own[0] - 1; x <= own[0] + 1; ++x) {
      for (long long y = own[1] - 1; y <= own[1] + 1; ++y) {
        auto it = std::lower_bound(points_.begin(), points_.end(), Point{{x, y, own[2] - 1}, 0});
        const Point end{{x, y, own[2] + 2}, 0};
        for (; it != points_.end() && *it < end; ++it) {
          const Vec3& other = centroids_[static_cast<std::size_t>(it->id)];
          if ((other - centre).norm() <= side_) visit(it->id);
        }
      }
    }
  }

 private:
  [[nodiscard]] std::array<long long, 3> cube_of(const Vec3& p) const {
    std::array<long long, 3> cube{};
    for (int axis = 0; axis < 3; ++axis)
      cube[static_cast<std::size_t>(axis)] = std::llround(std::floor(p[axis] / side_));
    return cube;
  }

  double side_;
  std::vector<Vec3> centroids_;
  std::vector<Point> points_;
};

}  // namespace

AveragedStrength::AveragedStrength(const Problem& problem)
    : problem_(problem),
      place_of_(4 * problem.mesh().tets.size(), kNone),
      excluded_(problem.mesh().tets.size(), 0),
      stress_(problem.mesh().tets.size()) {
  const std::vector<Place> places = number_places();
  find_neighbours(places, problem.scene().fracture.averaging);
  measure_.resize(places.size());
}

/// By volume, then by the first element that has them.
std::vector<AveragedStrength::Place> AveragedStrength::number_places() {
  const Mesh& mesh = problem_.mesh();
  std::vector<Place> places;
  for (int volume = 0; volume < static_cast<int>(mesh.volumes.size()); ++volume) {
    std::vector<Index> of_node(mesh.nodes.size(), kNone);
    for (Index e = 0; e < problem_.tet_count(); ++e) {
      const auto at = static_cast<std::size_t>(e);
      if (mesh.volume_of[at] != volume || !problem_.breakable(e)) continue;
      for (std::size_t a = 0; a < 4; ++a) {
        Index& place = of_node[static_cast<std::size_t>(mesh.tets[at][a])];
        if (place == kNone) {
          place = static_cast<Index>(places.size());
          places.push_back({mesh.tets[at][a], volume});
        }
        place_of_[4 * at + a] = place;
      }
    }
  }
  return places;
}

void AveragedStrength::find_neighbours(const std::vector<Place>& places, double radius) {
  const Mesh& mesh = problem_.mesh();
  Vec3 size = Vec3::Zero();
  for (const Vec3& node : mesh.nodes) size = size.cwiseMax((node - mesh.nodes.front()).cwiseAbs());
  // No farther than the body reaches, and no cubes beyond what counts them.
  radius = std::clamp(radius, 1e-9 * size.norm(), 2 * size.norm());
  const Cubes cubes(problem_, radius);
  for (const Place& place : places) {
    begin_.push_back(neighbours_.size());
    cubes.around(mesh.nodes[static_cast<std::size_t>(place.node)], [&](Index other) {
      if (mesh.volume_of[static_cast<std::size_t>(other)] == place.volume)
        neighbours_.push_back(other);
    });
    std::sort(neighbours_.begin() + static_cast<std::ptrdiff_t>(begin_.back()), neighbours_.end());
    if (neighbours_.size() <= kMostNeighbours) continue;
    std::ostringstream words;
    words << "fracture.averaging = " << problem_.scene().fracture.averaging
          << " mm reaches so many elements that their lists pass 4 GiB; take a smaller radius";
    throw InputError(InputFault::out_of_range, words.str());
  }
  begin_.push_back(neighbours_.size());
}

void AveragedStrength::exclude(std::span<const Index> elements) {
  for (Index e : elements) excluded_[static_cast<std::size_t>(e)] = 1;
}

void AveragedStrength::measure_places(std::span<const std::uint8_t> destroyed) {
  const YieldMeasure measure = strength_measure(problem_.scene().fracture);
  for (std::size_t place = 0; place < measure_.size(); ++place) {
    Voigt sum = Voigt::Zero();
    double volume = 0;
    for (std::size_t i = begin_[place]; i < begin_[place + 1]; ++i) {
      const auto other = static_cast<std::size_t>(neighbours_[i]);
      if (destroyed[other]) continue;
      const double share = problem_.shape(neighbours_[i]).volume;
      sum += share * stress_[other];
      volume += share;
    }
    measure_[place] = volume > 0 ? yield_measure(sum / volume, measure) : kNothing;
  }
}

double AveragedStrength::own_ratio(Index element) const {
  return yield_measure(stress_[static_cast<std::size_t>(element)],
                       strength_measure(problem_.scene().fracture)) /
         problem_.yield(element);
}

double AveragedStrength::ratio(Index element) const {
  double largest = kNothing;
  for (std::size_t a = 0; a < 4; ++a) {
    const Index place = place_of_[4 * static_cast<std::size_t>(element) + a];
    largest = std::max(largest, measure_[static_cast<std::size_t>(place)]);
  }
  return largest > kNothing ? largest / problem_.yield(element) : own_ratio(element);
}

void AveragedStrength::over(std::span<const std::uint8_t> destroyed,
                            std::vector<Worst>& found) const {
  for (Index e = 0; e < problem_.tet_count(); ++e) {
    if (destroyed[static_cast<std::size_t>(e)] || !problem_.breakable(e)) continue;
    if (const double r = ratio(e); r >= 1) found.push_back({e, r});
  }
}

StressSummary AveragedStrength::summarize(const Backend& backend) {
  backend.read_stress(stress_);
  const auto destroyed = backend.destroyed();
  measure_places(destroyed);
  StressSummary summary;
  // All elements at one corner may have its mean.
  const auto take = [this](Worst& worst, Index e, double r) {
    const bool equal = r == worst.ratio && worst.element != kNone;
    if (r > worst.ratio || (equal && own_ratio(e) > own_ratio(worst.element))) worst = {e, r};
  };
  for (Index e = 0; e < problem_.tet_count(); ++e) {
    const auto at = static_cast<std::size_t>(e);
    if (destroyed[at] || !problem_.breakable(e)) continue;
    const double r = ratio(e);
    take(summary.any, e, r);
    if (r >= 1) ++summary.over;
    if (!excluded_[at]) take(summary.candidate, e, r);
  }
  return summary;
}

}  // namespace sunder::fracture
