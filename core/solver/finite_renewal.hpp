// SPDX-License-Identifier: Apache-2.0
// A base of the tangent at a given state, made by a thread beside the steps, and whether that state
// is stable. Who asks takes them at a count of steps and waits where they are not ready: what comes
// of it does not depend on the clock.
#pragma once

#include <atomic>
#include <chrono>
#include <future>
#include <memory>
#include <thread>
#include <vector>

#include "solver/finite_base.hpp"

namespace sunder::solver {

/// The base of the projected tangent at u with the inertia; where that has no factor, for a part
/// hangs on a hinge, with as little inertia as helps. Null: that helps neither. Throws
/// linear_algebra::Stopped.
[[nodiscard]] std::unique_ptr<FiniteBase> projected_base(
    const fem::HyperelasticBody& body, const std::vector<double>& u,
    const fem::TangentPattern& pattern, int& factors, const linear_algebra::FactorWork& work = {},
    const fem::Inertia& inertia = {});

/// The base of the eased tangent at a rest u; where that is not positive definite,
/// projected_base().
[[nodiscard]] std::unique_ptr<FiniteBase> base_at_rest(const fem::HyperelasticBody& body,
                                                       const std::vector<double>& u,
                                                       const fem::TangentPattern& pattern,
                                                       int& factors,
                                                       const linear_algebra::FactorWork& work = {});

/// Whether a rest is stable: the exact tangent is positive definite. Throws
/// linear_algebra::Stopped.
[[nodiscard]] bool is_stable(const fem::HyperelasticBody& body, const std::vector<double>& u,
                             const fem::TangentPattern& pattern,
                             const linear_algebra::FactorWork& work = {});

class FiniteRenewal {
 public:
  /// The thread sleeps for `rest` before each thing that it does; `inverse`: its bases keep one.
  FiniteRenewal(std::chrono::milliseconds rest, bool inverse) : rest_(rest), inverse_(inverse) {}
  ~FiniteRenewal() { give_up(); }
  FiniteRenewal(const FiniteRenewal&) = delete;
  FiniteRenewal& operator=(const FiniteRenewal&) = delete;

  /// Begins base_at_rest() of the body as it is now (with an inertia projected_base()),
  /// is_stable(), or the one and then the other. Problem, laws, order and masses must outlive it.
  /// What was asked before is given up.
  void ask(const fem::HyperelasticBody& body, const std::vector<double>& u,
           const fem::TangentPattern& pattern, bool base, bool judgement,
           const fem::Inertia& inertia = {});
  [[nodiscard]] bool base_asked() const { return base_.valid(); }
  [[nodiscard]] bool judgement_asked() const { return stable_.valid(); }
  /// Waits for the base that was asked for; null: there is none.
  [[nodiscard]] std::unique_ptr<FiniteBase> take_base() { return base_.get(); }
  /// Waits for the judgement that was asked for.
  [[nodiscard]] bool take_stable() { return stable_.get(); }
  void give_up();

 private:
  std::chrono::milliseconds rest_;
  bool inverse_;
  std::vector<std::uint8_t> out_;
  std::vector<double> u_;
  std::future<std::unique_ptr<FiniteBase>> base_;
  std::future<bool> stable_;
  std::atomic<bool> unwanted_{false};
  std::thread thread_;  // last: it uses all above
};

}  // namespace sunder::solver
