// SPDX-License-Identifier: Apache-2.0
#include "body/body_factors.hpp"

#include "body/assembly.hpp"
#include "body/stiffness_factor.hpp"

namespace sunder::fem {

BodyFactors::BodyFactors(const Problem& problem,
                         std::shared_ptr<const linear_algebra::Supernodes> nodes,
                         const linear_algebra::SparseMatrix& intact)
    : BodyFactors(problem, std::move(nodes)) {
  hold(intact);
}

void BodyFactors::hold(const linear_algebra::SparseMatrix& intact) {
  stiffness_.emplace(problem_, nodes_, intact);
  bytes_ = stiffness_->bytes();
}

std::shared_ptr<const linear_algebra::Factor> BodyFactors::of(
    const DamagedBody& body, const linear_algebra::FactorWork& work) {
  // Entries that the intact body's stiffness has no place for, or patches' pressures.
  if (!body.others().empty() || problem_.pools()) {
    return std::make_shared<const linear_algebra::Factor>(factor_stiffness(body, work));
  }
  if (!stiffness_) hold(linear_algebra::permute_lower(assemble_lower(problem_, {}), nodes_->place));
  try {
    stiffness_->follow(body);
  } catch (...) {  // out of memory, half way: the next one begins anew
    stiffness_.reset();
    bytes_ = 0;
    throw;
  }
  return std::make_shared<const linear_algebra::Factor>(stiffness_->factor(work));
}

}  // namespace sunder::fem
