// SPDX-License-Identifier: Apache-2.0
#include "app/view/colours.hpp"

#include <Eigen/Dense>
#include <algorithm>
#include <cmath>

#include "sunder/fracture_model.hpp"
#include "sunder/stress_measures.hpp"

namespace sunder::app {
namespace {

double largest_displacement(const Problem& problem, const State& state, Index element) {
  double largest = 0;
  for (const Index n : mesh_of(problem, state).tets[static_cast<std::size_t>(element)]) {
    largest = std::max(largest, state.displacement[static_cast<std::size_t>(n)].norm());
  }
  return largest;
}

std::string label_of(const Problem& problem, Field field) {
  switch (field) {
    case Field::stress:
      return "max. shear stress [MPa]";
    case Field::yield:
      switch (strength_measure(problem.scene().fracture)) {
        case YieldMeasure::tresca:
          return "Tresca stress / yield";
        case YieldMeasure::principal:
          return "principal stress / yield";
        default:
          return "max. shear / yield";
      }
    case Field::strain:
      return "largest strain";
    default:
      return "displacement [mm]";
  }
}

double value_of(const Problem& problem, const State& state, Index e, Field field) {
  const auto at = static_cast<std::size_t>(e);
  switch (field) {
    case Field::stress:
      return max_shear(state.stress[at]);
    case Field::yield:
      return problem.breakable(e) ? problem.yield_ratio(e, state.stress[at],
                                                        strength_measure(problem.scene().fracture))
                                  : 0.0;
    case Field::strain:
      return largest_strain(problem, state, e);
    default:
      return largest_displacement(problem, state, e);
  }
}

}  // namespace

double largest_strain(const Problem& problem, const State& state, Index element) {
  const Mesh& mesh = mesh_of(problem, state);
  const Mat3 gradient = nodal_gradient(mesh, element, state.displacement);
  Eigen::SelfAdjointEigenSolver<Mat3> solver;
  if (problem.material(element).law == MaterialLaw::linear) {
    solver.computeDirect((gradient + gradient.transpose()) / 2, Eigen::EigenvaluesOnly);
    return solver.eigenvalues().cwiseAbs().maxCoeff();
  }
  const Mat3 f = Mat3::Identity() + gradient;
  solver.computeDirect(f.transpose() * f, Eigen::EigenvaluesOnly);
  double largest = 0;
  for (const double square : solver.eigenvalues()) {
    largest = std::max(largest, std::abs(std::sqrt(std::max(square, 0.0)) - 1));
  }
  return largest;
}

std::vector<std::uint8_t> unbreakable(const Problem& problem) {
  if (!shows_frame(problem)) return {};
  std::vector<std::uint8_t> grey(problem.mesh().tets.size());
  for (Index e = 0; e < problem.tet_count(); ++e) {
    grey[static_cast<std::size_t>(e)] = problem.destructible(e) ? 0 : 1;
  }
  return grey;
}

Paint paint(const Problem& problem, const State& state, std::span<const SurfaceTriangle> triangles,
            const input::Colour& colour, Values values) {
  Paint paint;
  const bool of_stress = colour.field == Field::stress || colour.field == Field::yield;
  if (of_stress && state.stress.empty()) return paint;
  paint.label = label_of(problem, colour.field);
  const bool found = !colour.maximum && colour.field != Field::yield;
  if (!found) paint.maximum = colour.maximum.value_or(1.0);
  if (values == Values::on_device && !found) return paint;
  const bool frame = shows_frame(problem);
  std::vector<double> counted;
  for (const SurfaceTriangle& t : triangles) {
    const bool counts = found && !(frame && !problem.destructible(t.element));
    if (values == Values::on_device && !counts) continue;
    const double value = value_of(problem, state, t.element, colour.field);
    if (counts) counted.push_back(value);
    if (values == Values::here) paint.values.push_back(static_cast<float>(value));
  }
  if (found) paint.maximum = round_maximum(std::move(counted));
  return paint;
}

}  // namespace sunder::app
