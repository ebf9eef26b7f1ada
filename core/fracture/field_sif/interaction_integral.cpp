// SPDX-License-Identifier: Apache-2.0
#include "fracture/field_sif/interaction_integral.hpp"

#include <algorithm>

#include "fracture/crack_path.hpp"
#include "material/linear.hpp"
#include "sunder/stress_measures.hpp"

namespace sunder::fracture {
namespace {

struct Sums {
  std::array<double, kModes> mode{};
  double energy_release = 0;
};
using States = std::array<AuxiliaryState, kModes>;
using StatesAt = States(const Vec2&, int, const TipMaterial&);

/// Field of one element in the tip's frame.
struct ElementField {
  Mat3 gradient;  // u_i,j
  Mat3 stress;    // [MPa]
  Vec3 weight_gradient;

  [[nodiscard]] double energy() const { return stress.cwiseProduct(gradient).sum() / 2; }
};

ElementField element_field(const IntegralInput& in, std::size_t i, const Mat3& axes) {
  const auto& corners = in.domain.corners[i];
  const Index e = in.domain.elements[i];
  const Eigen::Matrix<double, 3, 4> shape = axes * in.problem.shape(e).gradient;
  Mat3 gradient = Mat3::Zero();
  Vec3 weight_gradient = Vec3::Zero();
  for (int a = 1; a < 4; ++a) {  // differences to corner 0: no cancellation of a rigid motion
    const Vec3 u = axes * (in.displacement[corners[a]] - in.displacement[corners[0]]);
    gradient += u * shape.col(a).transpose();
    weight_gradient += (in.domain.weight[corners[a]] - in.domain.weight[corners[0]]) * shape.col(a);
  }
  if (!in.patches.empty() && in.patches[i]) {
    gradient.diagonal().array() += (in.patches[i]->theta - gradient.trace()) / 3;
  }
  return {gradient, tensor(stress(in.problem.small_strain(e), gradient)), weight_gradient};
}

States auxiliary_at(const IntegralInput& in, const Vec2& place, const TipMaterial& material,
                    StatesAt& states) {
  const Vec2 x = in.frame.local(place);
  const bool bent = !in.bent_path.empty() && x.x() < 0;
  const int side = bent ? path_side(in.bent_path, place, 0) : 0;
  return states(x, side, material);
}

/// [s_ij u*_i,1 + s*_ij u_i,1 - s*_kl e_kl delta_1j] q,j
double integrand(const ElementField& field, const AuxiliaryState& aux) {
  const Vec3 flux = field.stress * aux.slope + aux.stress * field.gradient.col(0);
  const double work = aux.stress.cwiseProduct(field.gradient).sum();
  return flux.dot(field.weight_gradient) - work * field.weight_gradient[0];
}

/// (s_ij u_i,1 - W delta_1j) q,j
double energy_integrand(const ElementField& field) {
  return (field.stress * field.weight_gradient).dot(field.gradient.col(0)) -
         field.energy() * field.weight_gradient[0];
}

/// q (s*_ij n_j u_i,1 - s*_kl e_kl n_1) dA, and for J q W n_1 dA over its outline, over the
/// element's part of the body's free surface. Plane stress leaves top and bottom free, so only the
/// outline counts then.
void subtract_surface(const IntegralInput& in, std::size_t i, const ElementField& field,
                      const Mat3& axes, const TipMaterial& material, StatesAt& states, Sums& sum) {
  const Index e = in.domain.elements[i];
  const auto& tet = in.board.mesh().tets[e];
  for (const FreeSurface::Face& face : in.surface.of(e)) {
    if (!face.lateral && material.constraint == 0) continue;
    if (face.notch != kNone && face.notch == in.crack) continue;
    double weight = 0;
    Vec2 centre = Vec2::Zero();
    for (Index n : face.nodes) {
      const auto corner = std::find(tet.begin(), tet.end(), n) - tet.begin();
      weight += in.domain.weight[in.domain.corners[i][static_cast<std::size_t>(corner)]] / 3;
      centre += in.board.node(n) / 3;
    }
    const auto aux = auxiliary_at(in, centre, material, states);
    const Vec3 area = axes * face.area;
    for (int m = 0; m < kModes; ++m) {
      const double work = aux[m].stress.cwiseProduct(field.gradient).sum();
      sum.mode[m] -= weight * ((aux[m].stress * area).dot(field.gradient.col(0)) - work * area[0]);
    }
    if (face.lateral) sum.energy_release += weight * field.energy() * area[0];
  }
}

void subtract_forces(const IntegralInput& in, const Mat3& axes, const TipMaterial& material,
                     StatesAt& states, Sums& sum) {
  for (const NodalForce& load : in.forces) {
    const Vec2 place = in.board.node(load.node);
    const double r = (place - in.frame.position).norm();
    const double weight = domain_weight(r, in.domain.radius);
    if (!(weight > 0) || !(r > 0)) continue;
    const auto aux = auxiliary_at(in, place, material, states);
    const Vec3 force = axes * load.force;
    for (int m = 0; m < kModes; ++m) sum.mode[m] -= weight * force.dot(aux[m].slope);
  }
}

/// Per length of the front.
TipIntegrals integrals(const IntegralInput& in, const TipMaterial& material, StatesAt& states) {
  const Mat3 axes = in.frame.axes(in.board.plane());
  Sums sum{};
  for (std::size_t i = 0; i < in.domain.elements.size(); ++i) {
    const Index e = in.domain.elements[i];
    const ElementField field = element_field(in, i, axes);
    const auto aux = auxiliary_at(in, in.board.centroid(e), material, states);
    const double volume = in.problem.shape(e).volume;
    for (int m = 0; m < kModes; ++m) sum.mode[m] += volume * integrand(field, aux[m]);
    sum.energy_release += volume * energy_integrand(field);
    subtract_surface(in, i, field, axes, material, states, sum);
  }
  subtract_forces(in, axes, material, states, sum);
  const double half_young = material.effective_young() / 2;
  for (double& s : sum.mode) s /= in.domain.front_length;
  return {{half_young * sum.mode[kModeI], half_young * sum.mode[kModeII],
           material.shear() * sum.mode[kModeIII]},
          sum.energy_release / in.domain.front_length};
}

}  // namespace

TipIntegrals interaction_integral(const IntegralInput& in, const TipMaterial& material) {
  return integrals(in, material, auxiliary_states);
}

IntensityFactors shift_integral(const IntegralInput& in, const TipMaterial& material) {
  return integrals(in, material, shift_states).factors;
}

}  // namespace sunder::fracture
