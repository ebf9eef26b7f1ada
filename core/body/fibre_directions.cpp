// SPDX-License-Identifier: Apache-2.0
#include "body/fibre_directions.hpp"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>
#include <vector>

#include "sunder/error.hpp"
#include "sunder/in_quotes.hpp"
#include "sunder/words.hpp"

namespace sunder::fem {
namespace {

/// Of the way to an axis: nearer to it, fibres around it have no direction. Of a direction: less of
/// it along a surface is none.
constexpr double kOnAxis = 1e-9, kAcross = 1e-6;

[[noreturn]] void refuse(InputFault fault, const std::string& sentence) {
  throw InputError(fault, sentence);
}

std::string in_brackets(const Vec3& v) {
  return "[" + in_digits(v[0]) + ", " + in_digits(v[1]) + ", " + in_digits(v[2]) + "]";
}

bool is_direction(const Vec3& v) { return v.allFinite() && v.cwiseAbs().maxCoeff() > 0; }

Vec3 centroid(const Mesh& mesh, Index e) {
  Vec3 sum = Vec3::Zero();
  for (Index n : mesh.tets[static_cast<std::size_t>(e)]) {
    sum += mesh.nodes[static_cast<std::size_t>(n)];
  }
  return sum / 4;
}

void check_straight(const std::string& what, const Vec3& direction) {
  if (is_direction(direction)) return;
  refuse(InputFault::out_of_range,
         what + " has direction = " + in_brackets(direction) + "; it must be finite and not zero");
}

class Straight final : public FibreDirections {
 public:
  Straight(const Vec3& direction, const std::string& what) : direction_(direction) {
    check_straight(what, direction);
  }
  Vec3 in(Index, double) const override { return direction_.stableNormalized(); }

 private:
  Vec3 direction_;
};

class RoundAnAxis final : public FibreDirections {
 public:
  RoundAnAxis(const AroundAxis& round, const Mesh& mesh, std::string what)
      : round_(round), mesh_(mesh), what_(std::move(what)) {
    if (!round.point.allFinite() || !is_direction(round.axis)) {
      refuse(InputFault::out_of_range, what_ + " runs around axis = " + in_brackets(round.axis) +
                                           " through " + in_brackets(round.point) +
                                           "; both must be finite and the axis not zero");
    }
  }
  Vec3 in(Index e, double volume) const override {
    const Vec3 way = centroid(mesh_, e) - round_.point;
    const Vec3 along = round_.axis.stableNormalized().cross(way);
    if (!(along.norm() > kOnAxis * (way.norm() + std::cbrt(volume)))) {
      refuse(InputFault::out_of_range, what_ + " has the centroid of element " + std::to_string(e) +
                                           " on the axis, where fibres around it have no "
                                           "direction; move the axis, or give a direction");
    }
    return along.normalized();
  }

 private:
  const AroundAxis& round_;
  const Mesh& mesh_;
  std::string what_;
};

class ByField final : public FibreDirections {
 public:
  ByField(const std::string& name, const Mesh& mesh, std::string what)
      : name_(name), what_(std::move(what)) {
    if (const auto found = mesh.fields.find(name); found != mesh.fields.end()) {
      field_ = &found->second;
      if (field_->size() == mesh.tets.size()) return;
      refuse(InputFault::out_of_range, what_ + " has field = " + in_quotes(name) + ", which has " +
                                           std::to_string(field_->size()) + " vectors for " +
                                           std::to_string(mesh.tets.size()) + " elements");
    }
    std::vector<std::string> names;
    for (const auto& field : mesh.fields) names.push_back(field.first);
    refuse(InputFault::unknown_name,
           what_ + " has field = " + in_quotes(name) +
               ", which is no vector of the mesh's cells; " +
               (names.empty() ? "its file has none" : "it has " + name_list(names)));
  }
  Vec3 in(Index e, double) const override {
    const Vec3& v = (*field_)[static_cast<std::size_t>(e)];
    if (!is_direction(v)) {
      refuse(InputFault::out_of_range, what_ + " has " + in_brackets(v) + " in field " +
                                           in_quotes(name_) + " at element " + std::to_string(e) +
                                           "; a direction must be finite and not zero");
    }
    return v.stableNormalized();
  }

 private:
  std::string name_;
  const std::vector<Vec3>* field_ = nullptr;
  std::string what_;
};

class AlongACurve final : public FibreDirections {
 public:
  AlongACurve(const AlongCurve& curve, const Mesh& mesh, const std::string& what)
      : points_(curve.points), mesh_(mesh) {
    if (points_.size() < 2) {
      refuse(InputFault::out_of_range,
             what + " has a curve of " + count_of(static_cast<long long>(points_.size()), "point") +
                 "; it needs two or more");
    }
    for (std::size_t i = 0; i < points_.size(); ++i) {
      if (points_[i].allFinite() && (i == 0 || (points_[i] - points_[i - 1]).norm() > 0)) continue;
      refuse(InputFault::out_of_range, what + " has a curve whose point " + std::to_string(i) +
                                           ", " + in_brackets(points_[i]) +
                                           ", is not finite or the one before once more");
    }
  }
  Vec3 in(Index e, double) const override {
    const Vec3 x = centroid(mesh_, e);
    double nearest = std::numeric_limits<double>::infinity();
    Vec3 along = Vec3::Zero();
    for (std::size_t i = 1; i < points_.size(); ++i) {
      const Vec3 piece = points_[i] - points_[i - 1], way = x - points_[i - 1];
      const double at = std::clamp(way.dot(piece) / piece.squaredNorm(), 0.0, 1.0);
      const double distance = (way - at * piece).squaredNorm();
      if (distance >= nearest) continue;
      nearest = distance;
      along = piece;
    }
    return along.normalized();
  }

 private:
  const std::vector<Vec3>& points_;
  const Mesh& mesh_;
};

class AlongASurface final : public FibreDirections {
 public:
  AlongASurface(const AlongSurface& along, const Mesh& mesh, std::string what)
      : direction_(along.direction), mesh_(mesh), what_(std::move(what)), name_(along.surface) {
    check_straight(what_, direction_);
    const auto surface = std::ranges::find(mesh.surfaces, along.surface, &NamedSurface::name);
    if (surface == mesh.surfaces.end() || surface->triangles.empty()) {
      std::vector<std::string> names;
      for (const NamedSurface& s : mesh.surfaces) names.push_back(s.name);
      refuse(InputFault::unknown_name,
             what_ + " has surface = " + in_quotes(along.surface) +
                 (surface == mesh.surfaces.end() ? ", which the mesh has not; "
                                                 : ", which has no "
                                                   "triangle; ") +
                 (names.empty() ? "it has none" : "it has " + name_list(names)));
    }
    for (const auto& triangle : surface->triangles) {
      const auto x = [&](std::size_t i) {
        return mesh.nodes[static_cast<std::size_t>(triangle[i])];
      };
      triangles_.push_back(
          {(x(0) + x(1) + x(2)) / 3, (x(1) - x(0)).cross(x(2) - x(0)).stableNormalized()});
    }
    std::ranges::stable_sort(triangles_, {}, [](const Triangle& t) { return t.middle.x(); });
  }
  Vec3 in(Index e, double) const override {
    const Vec3 normal = nearest(centroid(mesh_, e)).normal, d = direction_.stableNormalized();
    const Vec3 along = d - normal.dot(d) * normal;
    if (!(along.norm() > kAcross)) {
      refuse(InputFault::out_of_range, what_ + " has direction = " + in_brackets(direction_) +
                                           ", which is across surface " + in_quotes(name_) +
                                           " at element " + std::to_string(e) +
                                           "; take one that lies along it everywhere");
    }
    return along.normalized();
  }

 private:
  struct Triangle {
    Vec3 middle, normal;
  };
  /// By ascending x from the place on, to both sides, until x alone is farther.
  [[nodiscard]] const Triangle& nearest(const Vec3& at) const {
    const auto from = std::ranges::lower_bound(triangles_, at.x(), {},
                                               [](const Triangle& t) { return t.middle.x(); });
    double least = std::numeric_limits<double>::infinity();
    const Triangle* found = nullptr;
    const auto look_at = [&](const Triangle& t) {
      const double across = t.middle.x() - at.x();
      if (across * across > least) return false;
      const double distance = (t.middle - at).squaredNorm();
      if (distance < least) {
        least = distance;
        found = &t;
      }
      return true;
    };
    for (auto t = from; t != triangles_.end() && look_at(*t);) ++t;
    for (auto t = from; t != triangles_.begin() && look_at(*std::prev(t));) --t;
    return *found;
  }

  Vec3 direction_;
  const Mesh& mesh_;
  std::string what_, name_;
  std::vector<Triangle> triangles_;
};

}  // namespace

std::unique_ptr<FibreDirections> directions_of(const Fibres& fibres, const Mesh& mesh,
                                               const std::string& what) {
  const auto& by = fibres.direction;
  if (const auto* of = std::get_if<Vec3>(&by)) return std::make_unique<Straight>(*of, what);
  if (const auto* of = std::get_if<AroundAxis>(&by)) {
    return std::make_unique<RoundAnAxis>(*of, mesh, what);
  }
  if (const auto* of = std::get_if<AlongCurve>(&by)) {
    return std::make_unique<AlongACurve>(*of, mesh, what);
  }
  if (const auto* of = std::get_if<AlongSurface>(&by)) {
    return std::make_unique<AlongASurface>(*of, mesh, what);
  }
  return std::make_unique<ByField>(std::get<FieldName>(by).name, mesh, what);
}

}  // namespace sunder::fem
