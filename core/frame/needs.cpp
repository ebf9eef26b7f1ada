// SPDX-License-Identifier: Apache-2.0
#include "frame/needs.hpp"

#include <algorithm>
#include <string>
#include <vector>

#include "sunder/error.hpp"
#include "sunder/fracture_model.hpp"
#include "sunder/simulation.hpp"

namespace sunder {
namespace {

bool any(const Problem& problem, bool (Problem::*property)(Index) const) {
  const auto& volumes = problem.mesh().volume_of;
  std::vector<std::uint8_t> seen(problem.mesh().volumes.size(), 0);
  for (Index e = 0; e < static_cast<Index>(volumes.size()); ++e) {
    if (seen[volumes[e]]) continue;
    seen[volumes[e]] = 1;
    if ((problem.*property)(e)) return true;
  }
  return false;
}

}  // namespace

void check_needs(const Needs& scene, const Needs& backend) {
  const auto check = [](bool needed, bool offered, const char* what) {
    if (needed && !offered) {
      throw UsageError(std::string("the scene needs ") + what +
                       ", which was left out of the backend's needs");
    }
  };
  check(scene.stress, backend.stress, "stress");
  check(scene.yield, backend.yield, "the yield summary");
  check(scene.damage, backend.damage, "damage");
  check(scene.split, backend.split, "new nodes");
  check(scene.contact, backend.contact, "lips that are kept apart");
  check(scene.pristine, backend.pristine, "the intact body's field");
}

Needs needs_of(const Problem& problem) {
  const Scene& scene = problem.scene();
  const FractureModelRow& model = row_of(scene.fracture.model);
  const bool breaks = model.breaks && any(problem, &Problem::destructible);
  const bool presses =
      std::any_of(scene.instruments.begin(), scene.instruments.end(),
                  [](const Instrument& i) { return std::holds_alternative<Press>(i.action); });
  Needs needs;
  needs.stress = breaks || scene.output.stress;
  needs.yield = needs.stress && any(problem, &Problem::breakable);
  needs.damage = breaks || !scene.cracks.empty() || !scene.removals.empty();
  needs.split = breaks && scene.fracture.crack == CrackWay::split;
  needs.contact = needs.split && scene.fracture.contact;
  needs.pristine =
      breaks && !needs.split && model.pristine && scene.fracture.sigma0 != RemoteStress::present;
  if (!needs.stress) {
    needs.left_out.push_back(
        "stress of each element: no fracture model and no output needs it; a frame's check "
        "takes the largest alone");
    needs.left_out.push_back(
        "largest strain and rotation, and the warnings that rest on them: measured with the "
        "stress");
  }
  if (!needs.yield) needs.left_out.push_back("yield summary: nothing breakable or no stress");
  if (!needs.damage) needs.left_out.push_back("update of the inverse: nothing can be destroyed");
  if (!needs.pristine)
    needs.left_out.push_back(
        "intact body's field: only model B reads it, not with sigma0 present nor where cracks "
        "split");
  if (!presses) needs.left_out.push_back("pressure terms K_b, K_c: no pressing instrument");
  if (problem.gripped_dofs().empty()) {
    needs.left_out.push_back("compliance block of grips: no prescribed displacement");
  }
  return needs;
}

}  // namespace sunder
