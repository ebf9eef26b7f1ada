// SPDX-License-Identifier: Apache-2.0
// The routes there are, a row each: what makes one possible, what memory it takes, when `auto`
// takes it and what its frames cost.
#pragma once

#include <array>
#include <span>

#include "solver/plan.hpp"

namespace sunder::solver {

/// A scene on a device, as the rows are asked about it.
struct Question {
  const Problem& problem;
  const Needs& needs;
  const PlanDevice& device;
  bool asked = false;              ///< the scene names the route, or an update that one has
  std::size_t real_bytes = 8;      ///< of a value in the precision of a device apart
  bool open_precision = false;     ///< nobody has asked for one
  std::size_t factor_bytes = 0;    ///< of the host's factors, where it counts them
  std::size_t factor_entries = 0;  ///< of one of them

  [[nodiscard]] std::size_t unknowns() const;
  /// Whether the device computes a dense inverse of this size itself.
  [[nodiscard]] bool device_inverts() const;
  /// Of a value of that on a device apart: what it has computed in fp64 stays so unless fp32 was
  /// asked for, since new exact columns are then at hand.
  [[nodiscard]] std::size_t inverse_bytes() const;
  /// Found once, when first asked for.
  [[nodiscard]] const Region& region() const;
  mutable std::optional<Region> found = {};
};

struct RouteRow {
  Route route;
  const char* name;
  enum class Updates { none, deferred, both } updates;
  /// Why the scene cannot have it on the device; empty: it can.
  std::string (*against)(const Question&);
  /// Bytes of the device that it takes, those of the host's factors left out.
  std::size_t (*bytes)(const Question&);
  /// Whether `auto` takes it where it fits, those above having been left out.
  bool (*pays)(const Question&);
  std::string (*why)(const Question&);
  // What a frame does for it: the displacement; what follows an event.
  void (*solution)(FrameWork&, const FrameShape&, bool torn);
  void (*update)(FrameWork&, const FrameShape&);
};

/// In the order in which `auto` goes through them.
[[nodiscard]] const std::array<RouteRow, 4>& routes();
[[nodiscard]] const RouteRow& row_of(Route route);

/// Columns of the damage, a multiple of 64, from which on a solution by its small matrices takes a
/// device apart less time than the host; none: it never does.
[[nodiscard]] std::optional<Index> columns_worth_a_device(const FrameRates& rates);

/// "660 unknowns".
[[nodiscard]] std::string unknowns_of(const Question& question);

}  // namespace sunder::solver
