// SPDX-License-Identifier: Apache-2.0
// Displacement and stress of a condensed body outside its region: a frame does not compute them; a
// picture or a file that asks for them pays one solve with the factor.
#pragma once

#include <span>
#include <vector>

#include "body/damaged_body.hpp"
#include "solver/inverse_route.hpp"
#include "solver/region.hpp"
#include "solver/whole_solution.hpp"

namespace sunder::solver {

class CondensedFields {
 public:
  /// The body must outlive it.
  CondensedFields(const fem::DamagedBody& body, Region region);
  /// Makes room now: frames will ask, such as a criterion that looks around a tip.
  void make_room(bool stress);
  [[nodiscard]] const Region& region() const { return region_; }

  /// A solution of the route on the region.
  void take(const InverseRoute& route);
  /// A solution that is known at all nodes (3 * nodes).
  void take(std::span<const double> nodal);
  /// The stress of the last solution is now what stress() says.
  void publish_stress();

  /// Fills the entries outside the region.
  void complete(std::span<double> nodal);
  /// Stress at all elements, each scaled as the body was when it was published; inside the region a
  /// frame has its own, which counts.
  [[nodiscard]] std::span<const Voigt> stress();

  [[nodiscard]] std::size_t bytes() const;

 private:
  struct Solution {
    Equilibrium of;
    std::vector<double> nodal;
    bool everywhere = false;  // `nodal` is filled
  };

 public:
  /// What stands behind what is published, to go back to.
  struct State {
    Solution displacement, of_stress;
    std::size_t events = 0;
  };
  [[nodiscard]] State state() const { return {displacement_, of_stress_, events_}; }
  void restore(const State& state);

 private:
  void solve(Solution& solution);

  const fem::DamagedBody& body_;
  const Problem& problem_;
  Region region_;
  Solution displacement_, of_stress_;
  std::vector<Voigt> stress_;
  bool stress_known_ = false;
  std::size_t events_ = 0;  // of the body when its stress was published
  WholeRoom room_;
  Eigen::VectorXd u_;
};

}  // namespace sunder::solver
