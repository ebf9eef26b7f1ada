// SPDX-License-Identifier: Apache-2.0
#include "body/stiffness_difference.hpp"

#include <cmath>

namespace sunder::fem {
namespace {

StiffnessPart part(const Forms& forms, const Form& form, double share) {
  return {forms.parents(form.corners), update_factor(form.shape, form.law, 0) * std::sqrt(share),
          kNone};
}

}  // namespace

StiffnessDifference difference(const Forms& forms, const Form& before, const Form& after) {
  StiffnessDifference between;
  if (same_matter(forms, before, after)) {
    const double grown = after.share - before.share;
    if (grown > 0) between.more = part(forms, after, grown);
    if (grown < 0) between.less = part(forms, after, -grown);
    return between;
  }
  if (before.share > 0) between.less = part(forms, before, before.share);
  if (after.share > 0) between.more = part(forms, after, after.share);
  return between;
}

StiffnessDifference difference(const Forms& before, const Forms& after, Index element) {
  const auto at = static_cast<std::size_t>(element);
  if (after.came().contains(element)) {
    Form first = after.of(element);
    first.share = 0;
    if (element < before.element_count()) first = before.of(element);
    return difference(after, first, after.of(element));
  }
  if (!after.destroyed()[at] || before.destroyed()[at]) return {};
  const Problem& problem = after.problem();
  return {StiffnessPart{problem.mesh().tets[at], update_factor(problem, element), kNone},
          std::nullopt};
}

}  // namespace sunder::fem
