// SPDX-License-Identifier: Apache-2.0
// A body in two: the region that a frame looks at, as a Problem of its own, and the rest, of which
// only the stiffness that it lends the region stays (static condensation). Solutions on the region
// are those of the whole body, exactly; what the rest does is solved for when somebody asks.
#pragma once

#include <Eigen/SparseCore>
#include <memory>
#include <optional>
#include <span>
#include <vector>

#include "engine/region.hpp"
#include "fem/factor.hpp"

namespace sunder::engine {

class Substructure {
 public:
  /// Cost: a factor of the rest, and a solve for every unknown of it next to the region.
  Substructure(const Problem& whole, Region region);

  [[nodiscard]] const Region& region() const { return region_; }
  /// The region with its surroundings. Unknown i of it is region().dofs[i], element i
  /// region().elements[i].
  [[nodiscard]] const std::shared_ptr<const Problem>& part() const { return part_; }
  /// Place of an element of the body in the part, kNone: outside.
  [[nodiscard]] Index element(Index of_body) const { return element_[of_body]; }
  /// Of a node; kNone also for one that is held and belongs to no element of the part.
  [[nodiscard]] Index node(Index of_body) const { return node_[of_body]; }

  /// The same load for the part. Forces on the rest cost a solve.
  [[nodiscard]] Load load(const Load& of_body);
  /// Displacement at all nodes of the body (3 * nodes) from that of the part's nodes, under the
  /// load that `of_body` is.
  void expand(const Load& of_body, std::span<const double> of_part,
              std::span<double> displacement) const;
  /// Stress a_e D B u of the elements outside, none of them destroyed; `stress`: of all.
  void stress_outside(std::span<const double> displacement, std::span<Voigt> stress) const;
  /// The largest norm of such a stress.
  [[nodiscard]] double largest_outside(std::span<const double> displacement) const;

  [[nodiscard]] std::size_t bytes() const;

 private:
  void number();
  [[nodiscard]] Voigt stress_of(Index element, std::span<const double> displacement) const;
  void find_touched();
  [[nodiscard]] Eigen::MatrixXd split_stiffness();
  [[nodiscard]] Eigen::MatrixXd condense();
  [[nodiscard]] Eigen::VectorXd rest_of(const Load& of_body) const;

  const Problem& whole_;
  Region region_;
  std::vector<Index> node_, element_;
  std::vector<Index> inner_, outer_;  // of each unknown: place in the part, in the rest
  std::vector<Index> rest_;           // unknowns of the rest, ascending
  std::vector<Index> touched_;        // of the part's unknowns: those that the rest touches
  PartOfBody nodes_and_elements_;
  std::optional<fem::Factor> factor_;     // of K_RR; none: there is no rest
  Eigen::SparseMatrix<double> coupling_;  // K_RS, shape (rest x part)
  std::shared_ptr<const Problem> part_;
};

}  // namespace sunder::engine
