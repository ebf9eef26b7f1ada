// SPDX-License-Identifier: Apache-2.0
#include "frame/attribution.hpp"

#include <Eigen/Eigenvalues>
#include <algorithm>

#include "sunder/stress_measures.hpp"

namespace sunder {
namespace {

/// d tau / d sigma of tau = (s1 - s3)/2: G = (n1 n1^T - n3 n3^T)/2, so that tau = G : sigma.
Mat3 shear_gradient(const Voigt& stress) {
  const Eigen::SelfAdjointEigenSolver<Mat3> principal(tensor(stress));
  const Vec3 n3 = principal.eigenvectors().col(0), n1 = principal.eigenvectors().col(2);
  return (n1 * n1.transpose() - n3 * n3.transpose()) / 2;
}

/// d tau / d u of the element's corners (columns). G has no trace, hence tau = 2 mu G : grad u.
Eigen::Matrix<double, 3, 4> corner_gradient(const Problem& problem, const Voigt& stress,
                                            Index element) {
  return 2 * problem.small_strain(element).mu * shear_gradient(stress) *
         problem.shape(element).gradient;
}

/// The gradient as a load with all grips at 0; gripped dofs do not move and take none of it.
Load adjoint_load(const Backend& backend, Index element,
                  const Eigen::Matrix<double, 3, 4>& gradient) {
  const Problem& problem = backend.problem();
  const auto gripped = backend.gripped_dofs();
  std::vector<std::pair<Index, double>> entries;
  for (int corner = 0; corner < 4; ++corner) {
    for (int axis = 0; axis < 3; ++axis) {
      const Index d = problem.dof(problem.mesh().tets[element][corner], axis);
      if (d == kNone || std::ranges::find(gripped, d) != gripped.end()) continue;
      entries.emplace_back(d, gradient(axis, corner));
    }
  }
  std::sort(entries.begin(), entries.end());
  Load load;
  for (const auto& [dof, value] : entries) {
    load.force_dofs.push_back(dof);
    load.forces.push_back(value);
  }
  load.displacements.assign(gripped.size(), 0.0);
  return load;
}

/// Gradient at a dof of the element's corners, 0 elsewhere.
double gradient_at(const Problem& problem, Index element,
                   const Eigen::Matrix<double, 3, 4>& gradient, Index dof) {
  for (int corner = 0; corner < 4; ++corner) {
    for (int axis = 0; axis < 3; ++axis) {
      if (problem.dof(problem.mesh().tets[element][corner], axis) == dof) {
        return gradient(axis, corner);
      }
    }
  }
  return 0.0;
}

void choose(Attribution& result) {
  double sum = 0;
  for (std::size_t i = 0; i < result.terms.size(); ++i) {
    sum += result.terms[i];
    if (result.terms[i] == 0) continue;
    if (result.instrument == kNone || result.terms[i] > result.terms[result.instrument]) {
      result.instrument = static_cast<int>(i);
    }
  }
  if (result.instrument != kNone && sum > 0) result.share = result.terms[result.instrument] / sum;
}

}  // namespace

Attribution attribution(Backend& backend, const Loads& loads, Index element) {
  const Problem& problem = backend.problem();
  const auto gradient = corner_gradient(problem, backend.read_stress(element), element);
  backend.set_load(adjoint_load(backend, element, gradient));
  backend.solve();
  Attribution result;
  const std::size_t count = problem.scene().instruments.size();
  result.terms.assign(count + loads.tools().size(), 0.0);
  std::vector<Vec3> v;
  // Of a force in equal parts.
  const auto work = [&](std::span<const Index> nodes, const Vec3& force) {
    v.resize(nodes.size());
    backend.read_displacement(nodes, v);
    double sum = 0;
    for (const Vec3& at : v) sum += force.dot(at) / static_cast<double>(nodes.size());
    return sum;
  };
  for (std::size_t i = 0; i < count; ++i) {
    const auto nodes = loads.nodes(i);
    if (nodes.empty() || std::holds_alternative<Grip>(problem.scene().instruments[i].action)) {
      continue;
    }
    result.terms[i] = work(nodes, loads.force(i));
  }
  // Grips: minus the adjoint reaction, times what they prescribe.
  const auto gripped = backend.gripped_dofs();
  std::vector<double> reactions(gripped.size());
  if (!gripped.empty()) backend.read_reactions(reactions);
  const auto add = [&](std::size_t g, double& term) {
    const double direct = gradient_at(problem, element, gradient, gripped[g]);
    term += (direct - reactions[g]) * loads.load().displacements[g];
  };
  for (std::size_t g = 0; g < loads.gripped().size(); ++g) {
    add(g, result.terms[loads.gripped()[g].instrument]);
  }
  for (std::size_t t = 0; t < loads.tools().size(); ++t) {
    const Tool& tool = loads.tools()[t];
    double& term = result.terms[count + t];
    if (!tool.holds) term = work(tool.nodes, tool.force);
    for (std::size_t d = 0; tool.holds && d < 3 * tool.nodes.size(); ++d) add(tool.first + d, term);
  }
  choose(result);
  if (result.instrument >= static_cast<int>(count)) {
    result.instrument = loads.tools()[static_cast<std::size_t>(result.instrument) - count].id;
  }
  return result;
}

}  // namespace sunder
