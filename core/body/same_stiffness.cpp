// SPDX-License-Identifier: Apache-2.0
#include "sunder/same_stiffness.hpp"

#include <algorithm>
#include <tuple>

#include "material/fibres.hpp"

namespace sunder {
namespace {

bool same_elasticity(const SmallStrain& a, const SmallStrain& b) {
  return a.lambda == b.lambda && a.mu == b.mu && a.young == b.young && a.poisson == b.poisson;
}

/// Those of the linear law: no other has a base that is shared.
bool same_fibres(const ElementFibres* a, const ElementFibres* b) {
  if (!a || !b) return a == b;
  const auto numbers = [](const ElementFibres& of) {
    return std::tuple(of.linear.lambda, of.linear.alpha, of.linear.beta, of.linear.mu);
  };
  return a->family[0].direction == b->family[0].direction && numbers(*a) == numbers(*b);
}

}  // namespace

bool same_stiffness(const Problem& a, const Problem& b) {
  if (a.mesh().nodes != b.mesh().nodes || a.mesh().tets != b.mesh().tets) return false;
  if (!std::ranges::equal(a.dofs(), b.dofs())) return false;
  if (a.anchor_stiffness() != b.anchor_stiffness() ||
      !std::ranges::equal(a.anchored_dofs(), b.anchored_dofs())) {
    return false;
  }
  for (Index e = 0; e < a.tet_count(); ++e) {
    if (!same_elasticity(a.small_strain(e), b.small_strain(e))) return false;
    if (!same_fibres(a.small_strain(e).fibres, b.small_strain(e).fibres)) return false;
    if (a.material(e).volume != b.material(e).volume) return false;
  }
  return true;
}

}  // namespace sunder
