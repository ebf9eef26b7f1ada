// SPDX-License-Identifier: Apache-2.0
// A board whose intact stress is uniform and known: nu = 0 and E = 1, so that stress = strain.
#pragma once

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <functional>
#include <memory>
#include <set>
#include <utility>
#include <vector>

#include "fracture/board.hpp"
#include "fracture/criterion.hpp"
#include "sunder/problem.hpp"
#include "support/structured_board.hpp"

namespace sunder::test {

inline constexpr double kYield = 1.0;

/// Held on its top edge; volumes "board" (yield kYield), "strong" (10 kYield), "frame" (none).
inline Scene board_scene(Mesh mesh, FractureModel model) {
  Scene scene;
  scene.title = "structured board";
  double top = 0;
  for (const Vec3& x : mesh.nodes) top = std::max(top, x.y());
  for (const NamedVolume& v : mesh.volumes) {
    Material m{1.0, 0.0, kYield};
    if (v.name == "strong") m.yield = 10 * kYield;
    if (v.name == "frame") m.yield.reset();
    scene.materials[v.name] = m;
  }
  scene.mesh = std::move(mesh);
  scene.supports.push_back({Box{Vec3(-1e9, top - 1e-9, -1e9), Vec3(1e9, 1e9, 1e9)}, Axes{7}});
  scene.fracture.model = model;
  return scene;
}

/// u = gradient x at all nodes: the intact body's field of the stress sym(gradient).
inline std::vector<double> uniform_field(const Mesh& mesh, const Mat3& gradient) {
  std::vector<double> u;
  for (const Vec3& x : mesh.nodes) {
    const Vec3 v = gradient * x;
    u.insert(u.end(), {v.x(), v.y(), v.z()});
  }
  return u;
}

/// Uniaxial tension s0 along the in-plane direction at `degrees` from x.
inline Mat3 tension(double s0, double degrees) {
  const double angle = degrees * EIGEN_PI / 180;
  const Vec3 n(std::cos(angle), std::sin(angle), 0);
  return s0 * n * n.transpose();
}

/// Drives a criterion without a backend: the field is given, destroyed elements are remembered.
class Driver {
 public:
  explicit Driver(Scene scene)
      : problem(std::move(scene)),
        board(problem.mesh(), problem.scene().fracture.plane_normal),
        criterion(make_criterion(problem)),
        destroyed(problem.mesh().tets.size(), 0),
        pristine(uniform_field(problem.mesh(), Mat3::Zero())) {
    if (!problem.scene().cracks.empty()) apply(criterion->preset());
  }

  [[nodiscard]] FractureState state() const {
    return {problem,
            destroyed,
            summary,
            [this](Index) { return current; },
            [this] { return std::span<const double>(pristine); },
            resultant,
            presses};
  }

  Decision decide() {
    Decision d;
    criterion->decide(state(), d);
    apply(d);
    return d;
  }

  void apply(const Decision& d) {
    for (const auto& row : d.elements) {
      ASSERT_FALSE(destroyed[row.element]) << "element " << row.element << " twice";
      destroyed[row.element] = 1;
    }
    excluded.insert(d.excluded.begin(), d.excluded.end());
  }

  void pull(const Mat3& stress) { pristine = uniform_field(problem.mesh(), stress); }

  Problem problem;
  fracture::Board board;
  std::unique_ptr<FractureCriterion> criterion;
  std::vector<std::uint8_t> destroyed;
  std::vector<double> pristine;
  std::set<Index> excluded;
  StressSummary summary;
  Voigt current = Voigt::Zero();
  Vec3 resultant = Vec3::Zero();
  std::vector<ActingPress> presses;
};

/// Elements of the cells of row j from column `begin` to `end` (exclusive), all layers.
inline std::vector<Index> row_elements(const BoardShape& s, Index j, Index begin, Index end) {
  std::vector<Index> elements;
  for (Index k = 0; k < s.nz; ++k)
    for (Index i = begin; i < end; ++i)
      for (Index t = 0; t < 6; ++t) elements.push_back(6 * (i + s.nx * (j + s.ny * k)) + t);
  return elements;
}

/// 20 x 11 x 2 mm in cells of 1 x 1 x 2 mm.
inline constexpr BoardShape kSlitShape{20, 11, 1, 20, 11, 2};
/// Height of its middle row.
inline constexpr double kSlitHeight = 5.5;

/// An edge slit through the middle row from the left edge to x = `length`.
inline Scene edge_slit(Index length, Mesh mesh = structured_board(kSlitShape)) {
  Scene scene = board_scene(std::move(mesh), FractureModel::b);
  scene.cracks.push_back({row_elements(kSlitShape, 5, 0, length),
                          Vec3(0, kSlitHeight, 1),
                          {Vec3(length, kSlitHeight, 1)}});
  return scene;
}

/// An internal slit through the middle row from x = begin to x = end.
inline Scene internal_slit(Index begin, Index end, Mesh mesh = structured_board(kSlitShape)) {
  Scene scene = board_scene(std::move(mesh), FractureModel::b);
  scene.cracks.push_back({row_elements(kSlitShape, 5, begin, end),
                          std::nullopt,
                          {Vec3(begin, kSlitHeight, 1), Vec3(end, kSlitHeight, 1)}});
  return scene;
}

}  // namespace sunder::test
