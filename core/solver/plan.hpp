// SPDX-License-Identifier: Apache-2.0
// Which route, update and precision carry a scene on a device, and why: one rule for every device.
#pragma once

#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "body/analysis.hpp"
#include "solver/frame_cost.hpp"
#include "solver/region.hpp"

namespace sunder::solver {

/// What a plan has to know of a device.
struct PlanDevice {
  std::string backend;         ///< as a scene names it
  std::string name;            ///< of a device apart from the host, for refusals
  std::vector<Route> routes;   ///< that it has
  std::size_t memory = 0;      ///< bytes that can be had
  bool fp32 = false;           ///< stores in fp32 too, with sums in fp64
  bool fp64 = true;            ///< computes in fp64
  bool displayed = false;      ///< a host draws the whole body's fields from it
  Index inverts_from = kNone;  ///< unknowns from which on it computes an inverse itself
  FrameRates rates;
  /// Of the problem that is planned for, from whoever may have it already; empty: fem::analyse.
  std::function<std::shared_ptr<const fem::Analysis>()> analysis = {};
  [[nodiscard]] bool has(Route route) const;
};

struct Plan {
  Route route = Route::automatic;
  bool eager = false;  ///< the update
  bool fp64 = true;    ///< storage of element stress and, but for exact_inverse, of the inverse
  bool invert_on_device = false;  ///< the inverse is computed there
  bool exact_inverse = false;     ///< and stays there in fp64, whatever else is
  std::string why;
  std::vector<std::string> warnings;
  std::optional<Region> region;       ///< of route condensed
  std::vector<std::string> left_out;  ///< by that route, in words
  /// Of the intact body's factor, where the device has route factor; empty: there is no room for
  /// it, and an incomplete one preconditions conjugate gradients.
  std::shared_ptr<const fem::Analysis> analysis;

  /// Of a frame, as far as the plan knows it.
  [[nodiscard]] FrameShape shape(const Problem& problem, const Needs& needs) const;
};

/// Throws DeviceError for what the device does not offer (with what it does) or, apart from the
/// host, does not hold; InputError when the route asked for needs more memory than the host has, or
/// any does.
[[nodiscard]] Plan make_plan(const Problem& problem, const Needs& needs, const PlanDevice& device);

/// As in a scene: "inverse", "condensed", "factor", "cg".
[[nodiscard]] std::string name_of(Route route);
/// "eager", "deferred"; "matrix" for cg, whose only update is the matrix itself.
[[nodiscard]] std::string name_of_update(const Plan& plan);

}  // namespace sunder::solver
