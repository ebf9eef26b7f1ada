// SPDX-License-Identifier: Apache-2.0
#include "engine/substructure.hpp"

#include <algorithm>

#include "fem/assembly.hpp"
#include "fem/element.hpp"
#include "sunder/stress_measures.hpp"

namespace sunder::engine {

Substructure::Substructure(const Problem& whole, Region region)
    : whole_(whole), region_(std::move(region)) {
  number();
  find_touched();
  Surroundings around{touched_, condense()};
  part_ = std::make_shared<Problem>(whole, nodes_and_elements_, std::move(around));
}

void Substructure::number() {
  const auto unknowns = static_cast<std::size_t>(whole_.dof_count());
  inner_.assign(unknowns, kNone);
  outer_.assign(unknowns, kNone);
  for (std::size_t i = 0; i < region_.dofs.size(); ++i) {
    inner_[region_.dofs[i]] = static_cast<Index>(i);
  }
  for (Index d = 0; d < whole_.dof_count(); ++d) {
    if (inner_[d] != kNone) continue;
    outer_[d] = static_cast<Index>(rest_.size());
    rest_.push_back(d);
  }
  element_.assign(whole_.mesh().tets.size(), kNone);
  std::vector<std::uint8_t> used(whole_.mesh().nodes.size(), 0);
  for (Index n : region_.nodes) used[n] = 1;
  for (std::size_t i = 0; i < region_.elements.size(); ++i) {
    element_[region_.elements[i]] = static_cast<Index>(i);
    for (Index n : whole_.mesh().tets[region_.elements[i]]) used[n] = 1;
  }
  node_.assign(used.size(), kNone);
  for (Index n = 0; n < whole_.node_count(); ++n) {
    if (!used[n]) continue;
    node_[n] = static_cast<Index>(nodes_and_elements_.nodes.size());
    nodes_and_elements_.nodes.push_back(n);
  }
  nodes_and_elements_.elements = region_.elements;
}

/// Unknowns B of the part that elements outside touch.
void Substructure::find_touched() {
  std::vector<std::uint8_t> is_touched(region_.dofs.size(), 0);
  for (Index e = 0; e < whole_.tet_count(); ++e) {
    if (element_[e] != kNone) continue;
    for (Index n : whole_.mesh().tets[e]) {
      for (int axis = 0; axis < 3; ++axis) {
        const Index d = whole_.dof(n, axis);
        if (d != kNone && inner_[d] != kNone) is_touched[inner_[d]] = 1;
      }
    }
  }
  for (std::size_t i = 0; i < is_touched.size(); ++i) {
    if (is_touched[i]) touched_.push_back(static_cast<Index>(i));
  }
}

/// Of the elements outside: K_RR, factored, K_RS, and K_BB, which is returned.
Eigen::MatrixXd Substructure::split_stiffness() {
  const auto b = static_cast<Index>(touched_.size()), r = static_cast<Index>(rest_.size());
  std::vector<Index> place(region_.dofs.size(), kNone);
  for (Index i = 0; i < b; ++i) place[touched_[i]] = i;
  std::vector<double> outside(whole_.mesh().tets.size());
  for (std::size_t e = 0; e < outside.size(); ++e) outside[e] = element_[e] == kNone ? 1 : 0;
  const fem::SparseMatrix lower = fem::assemble_lower(whole_, outside);
  Eigen::MatrixXd of_touched = Eigen::MatrixXd::Zero(b, b);
  std::vector<Eigen::Triplet<double, Index>> among_rest, between;
  for (Index j = 0; j < lower.outerSize(); ++j) {
    for (fem::SparseMatrix::InnerIterator it(lower, j); it; ++it) {
      const Index i = it.row(), inner_i = inner_[i], inner_j = inner_[j];
      if (inner_i == kNone && inner_j == kNone) {
        among_rest.emplace_back(outer_[i], outer_[j], it.value());
      } else if (inner_i == kNone) {
        between.emplace_back(outer_[i], inner_j, it.value());
      } else if (inner_j == kNone) {
        between.emplace_back(outer_[j], inner_i, it.value());
      } else if (place[inner_i] != kNone && place[inner_j] != kNone) {
        of_touched(place[inner_i], place[inner_j]) = it.value();
        of_touched(place[inner_j], place[inner_i]) = it.value();
      }
    }
  }
  for (Index d : whole_.anchored_dofs()) {  // the part has them
    const Index at = place[inner_[d]];
    if (at != kNone) of_touched(at, at) -= whole_.anchor_stiffness();
  }
  fem::SparseMatrix rest(r, r);
  rest.setFromTriplets(among_rest.begin(), among_rest.end());
  factor_.emplace(rest);
  coupling_.setFromTriplets(between.begin(), between.end());
  return of_touched;
}

/// K_BB - K_BR K_RR^-1 K_RB, for which the inverse of K_RR is needed next to B alone.
Eigen::MatrixXd Substructure::condense() {
  coupling_.resize(static_cast<Index>(rest_.size()), static_cast<Index>(region_.dofs.size()));
  if (rest_.empty()) return {};
  Eigen::MatrixXd of_touched = split_stiffness();
  std::vector<Index> next, at(rest_.size(), kNone);
  std::vector<Eigen::Triplet<double, Index>> entries;
  for (std::size_t j = 0; j < touched_.size(); ++j) {
    for (Eigen::SparseMatrix<double>::InnerIterator it(coupling_, touched_[j]); it; ++it) {
      Index& row = at[it.row()];
      if (row == kNone) {
        row = static_cast<Index>(next.size());
        next.push_back(static_cast<Index>(it.row()));
      }
      entries.emplace_back(row, static_cast<Index>(j), it.value());
    }
  }
  Eigen::SparseMatrix<double> near(static_cast<Index>(next.size()), of_touched.cols());
  near.setFromTriplets(entries.begin(), entries.end());
  const Eigen::MatrixXd x = factor_->inverse_block(next, next);
  const Eigen::MatrixXd product = near.transpose() * (x * near);
  of_touched -= (product + product.transpose()) / 2;
  return of_touched;
}

Eigen::VectorXd Substructure::rest_of(const Load& of_body) const {
  Eigen::VectorXd f = Eigen::VectorXd::Zero(static_cast<Index>(rest_.size()));
  for (std::size_t i = 0; i < of_body.force_dofs.size(); ++i) {
    const Index place = outer_[of_body.force_dofs[i]];
    if (place != kNone) f[place] = of_body.forces[i];
  }
  return f;
}

Load Substructure::load(const Load& of_body) {
  Load load;
  load.displacements = of_body.displacements;
  bool beyond = false;
  for (std::size_t i = 0; i < of_body.force_dofs.size(); ++i) {
    const Index place = inner_[of_body.force_dofs[i]];
    beyond = beyond || place == kNone;
    if (place == kNone) continue;
    load.force_dofs.push_back(place);
    load.forces.push_back(of_body.forces[i]);
  }
  if (!beyond) return load;
  // f_B - K_BR K_RR^-1 f_R
  Eigen::VectorXd f = -(coupling_.transpose() * factor_->solve(rest_of(of_body)));
  for (std::size_t i = 0; i < load.force_dofs.size(); ++i) f[load.force_dofs[i]] += load.forces[i];
  std::vector<std::uint8_t> loaded(region_.dofs.size(), 0);
  for (Index d : touched_) loaded[d] = 1;
  for (Index d : load.force_dofs) loaded[d] = 1;
  load.force_dofs.clear();
  load.forces.clear();
  for (std::size_t d = 0; d < loaded.size(); ++d) {
    if (!loaded[d]) continue;
    load.force_dofs.push_back(static_cast<Index>(d));
    load.forces.push_back(f[static_cast<Index>(d)]);
  }
  return load;
}

void Substructure::expand(const Load& of_body, std::span<const double> of_part,
                          std::span<double> displacement) const {
  std::fill(displacement.begin(), displacement.end(), 0.0);
  for (std::size_t i = 0; i < nodes_and_elements_.nodes.size(); ++i) {
    const auto n = static_cast<std::size_t>(nodes_and_elements_.nodes[i]);
    std::copy_n(&of_part[3 * i], 3, &displacement[3 * n]);
  }
  if (rest_.empty()) return;
  Eigen::VectorXd u(static_cast<Index>(region_.dofs.size()));
  fem::gather(*part_, of_part, {u.data(), region_.dofs.size()});
  const Eigen::VectorXd f = rest_of(of_body) - coupling_ * u;
  const Eigen::VectorXd of_rest = factor_->solve(f);
  const auto dofs = whole_.dofs();
  for (std::size_t i = 0; i < dofs.size(); ++i) {
    if (dofs[i] != kNone && outer_[dofs[i]] != kNone) displacement[i] = of_rest[outer_[dofs[i]]];
  }
}

Voigt Substructure::stress_of(Index element, std::span<const double> displacement) const {
  return fem::stress(whole_.shape(element), whole_.small_strain(element),
                     fem::corner_displacement(whole_.mesh(), element, displacement));
}

void Substructure::stress_outside(std::span<const double> displacement,
                                  std::span<Voigt> stress) const {
  for (Index e = 0; e < whole_.tet_count(); ++e) {
    if (element_[e] == kNone) stress[e] = stress_of(e, displacement);
  }
}

double Substructure::largest_outside(std::span<const double> displacement) const {
  double largest = 0;
  for (Index e = 0; e < whole_.tet_count(); ++e) {
    if (element_[e] == kNone) {
      largest = std::max(largest, tensor(stress_of(e, displacement)).norm());
    }
  }
  return largest;
}

std::size_t Substructure::bytes() const {
  const auto b = static_cast<std::size_t>(part_->surroundings().stiffness.size());
  return (factor_ ? factor_->bytes() : 0) + b * sizeof(double) +
         static_cast<std::size_t>(coupling_.nonZeros()) * (sizeof(double) + sizeof(int));
}

}  // namespace sunder::engine
