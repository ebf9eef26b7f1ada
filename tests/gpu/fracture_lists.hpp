// SPDX-License-Identifier: Apache-2.0
// When two backends may tear a scene differently. A decision compares ratios with 1 and with each
// other; a stress error within the accuracy table moves a ratio within a band, and only inside it
// may another element, or none, break.
#pragma once

#include <algorithm>
#include <cmath>
#include <functional>
#include <optional>
#include <sstream>
#include <string>
#include <vector>

#include "sunder/report.hpp"

namespace sunder::test {

/// Relative band of r_e / max(rho, h/2): r_e goes with K^2, and K follows from the pristine field,
/// which every backend has to nine digits; the terms of Eq. 2 may cancel two of them.
inline constexpr double kReachBand = 1e-6;

/// What the reference knows of an element right before the decision at which the lists part.
struct Yielding {
  double ratio = 0;
  double band = 0;  ///< how far the accuracy table lets another backend's ratio be from it
};

struct Parting {
  std::size_t index = 0;   ///< in both lists
  int step = 0;            ///< in which the decision was taken
  std::size_t before = 0;  ///< destroyed elements at that decision
};

using Fractures = std::vector<DestroyedElement>;

inline bool same_fracture(const DestroyedElement& a, const DestroyedElement& b) {
  return a.step == b.step && a.event == b.event && a.element == b.element && a.cause == b.cause &&
         a.crack == b.crack;
}

/// Where two lists first differ; none: nowhere.
inline std::optional<Parting> parting(const Fractures& reference, const Fractures& other) {
  std::size_t i = 0;
  while (i < reference.size() && i < other.size() && same_fracture(reference[i], other[i])) ++i;
  if (i == reference.size() && i == other.size()) return std::nullopt;
  const DestroyedElement* a = i < reference.size() ? &reference[i] : nullptr;
  const DestroyedElement* b = i < other.size() ? &other[i] : nullptr;
  const DestroyedElement& first = !b || (a && a->step <= b->step) ? *a : *b;
  Parting p{i, first.step, i};
  // An event's elements were decided together.
  while (p.before > 0 && reference[p.before - 1].event == first.event) --p.before;
  return p;
}

/// Why the lists may part there; empty: they may not. `yielding` tells of elements at `p`.
inline std::string excuse(const Parting& p, const Fractures& reference, const Fractures& other,
                          const std::function<Yielding(Index)>& yielding) {
  const auto at = [&](const Fractures& list) {
    return p.index < list.size() && list[p.index].step == p.step ? &list[p.index] : nullptr;
  };
  std::ostringstream why;
  why.precision(17);
  // What only one of them broke must have been at the limit.
  const auto marginal = [&](const DestroyedElement& d) {
    const bool sif = d.cause == Cause::sif;
    if (!sif && d.cause != Cause::mss) return false;
    const Yielding y = sif ? Yielding{d.ratio.value(), kReachBand} : yielding(d.element);
    if (!(std::abs(y.ratio - 1) <= y.band)) return false;
    why << "element " << d.element << " has the ratio " << y.ratio << " of "
        << (sif ? "reach to distance" : "stress to yield") << ", within " << y.band << " of 1";
    return true;
  };
  const DestroyedElement *a = at(reference), *b = at(other);
  if (a && b && a->cause == Cause::mss && b->cause == Cause::mss && a->element != b->element) {
    const Yielding ya = yielding(a->element), yb = yielding(b->element);
    if (!(std::abs(ya.ratio - yb.ratio) <= ya.band + yb.band)) return {};
    why << "elements " << a->element << " and " << b->element << " have the ratios " << ya.ratio
        << " and " << yb.ratio << ", nearer than " << ya.band + yb.band;
    return why.str();
  }
  if ((a && marginal(*a)) || (b && marginal(*b))) return why.str();
  return {};
}

}  // namespace sunder::test
