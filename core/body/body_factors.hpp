// SPDX-License-Identifier: Apache-2.0
// Factors of a body as it changes: the order of elimination and where entries lie are found once,
// for the intact body, which is half the time of a factor of 30,000 tetrahedra.
#pragma once

#include <atomic>
#include <memory>
#include <optional>
#include <utility>

#include "body/damaged_body.hpp"
#include "body/ordered_stiffness.hpp"
#include "linear_algebra/factor.hpp"
#include "sunder/problem.hpp"

namespace sunder::fem {

class BodyFactors {
 public:
  /// `nodes`: of the intact body's factor; the first factor assembles its stiffness. The problem
  /// must outlive it.
  BodyFactors(const Problem& problem, std::shared_ptr<const linear_algebra::Supernodes> nodes)
      : problem_(problem), nodes_(std::move(nodes)) {}
  /// With that stiffness in the order of `nodes`, lower triangle.
  BodyFactors(const Problem& problem, std::shared_ptr<const linear_algebra::Supernodes> nodes,
              const linear_algebra::SparseMatrix& intact);

  /// Of the body as it is, without new nodes; by one thread at a time. Throws as
  /// linear_algebra::Factor's constructors do.
  [[nodiscard]] std::shared_ptr<const linear_algebra::Factor> of(
      const DamagedBody& body, const linear_algebra::FactorWork& work);
  /// Of what it holds, by any thread.
  [[nodiscard]] std::size_t bytes() const { return bytes_; }

 private:
  void hold(const linear_algebra::SparseMatrix& intact);

  const Problem& problem_;
  std::shared_ptr<const linear_algebra::Supernodes> nodes_;
  std::optional<OrderedStiffness> stiffness_;
  std::atomic<std::size_t> bytes_{0};
};

}  // namespace sunder::fem
