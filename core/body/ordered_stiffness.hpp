// SPDX-License-Identifier: Apache-2.0
// The stiffness in the order of a factor, kept up with damage. A new factor of the body takes order
// and elimination tree from the first one, and the entries that no destroyed element touches from
// the one before: on 1,944 elements that spares two thirds of it.
#pragma once

#include <memory>
#include <span>
#include <utility>
#include <vector>

#include "body/damaged_body.hpp"
#include "body/node_elements.hpp"
#include "linear_algebra/factor.hpp"
#include "sunder/problem.hpp"

namespace sunder::fem {

class OrderedStiffness {
 public:
  /// The intact stiffness as linear_algebra::FactorWork::ordered has received it, and where its
  /// rows are. The problem must outlive it.
  OrderedStiffness(const Problem& problem, std::shared_ptr<const linear_algebra::Supernodes> nodes,
                   const linear_algebra::SparseMatrix& intact);

  /// Takes up what every element is now; the body has no other matter than the mesh. Entries that
  /// change are summed anew: there is no difference between large numbers, and the bits are those
  /// of the body as it is, whatever it was before.
  void follow(const DamagedBody& body);
  /// Throws as linear_algebra::Factor's constructors do.
  [[nodiscard]] linear_algebra::Factor factor(const linear_algebra::FactorWork& work = {}) const;
  /// Lower triangle, rows in the order of the factor.
  [[nodiscard]] const linear_algebra::SparseMatrix& matrix() const { return matrix_; }
  [[nodiscard]] std::size_t bytes() const;

 private:
  [[nodiscard]] Index entry(Index dof, Index other) const;
  void begin_anew();
  void clear(Index element);
  void add(Index element, double scale);
  void add_anchors();

  const Problem& problem_;
  std::shared_ptr<const linear_algebra::Supernodes> nodes_;
  NodeElements around_;
  linear_algebra::SparseMatrix matrix_;  // rows of a column ascending
  std::vector<double> scale_;            // of the elements that matrix_ holds
  static constexpr std::uint8_t kNow = 1, kEver = 2;
  std::vector<std::uint8_t> changed_;             // per entry of matrix_; kNow: in the call at work
  std::vector<Index> entries_;                    // that have changed in it
  std::vector<std::pair<Index, double>> intact_;  // entries that have ever changed, as they were
};

}  // namespace sunder::fem
