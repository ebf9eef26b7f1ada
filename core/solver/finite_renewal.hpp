// SPDX-License-Identifier: Apache-2.0
// A base of the tangent at a given state, made by a thread beside the steps. Who asks takes it at a
// count of steps and waits where it is not ready: what comes of it does not depend on the clock.
#pragma once

#include <atomic>
#include <chrono>
#include <memory>
#include <thread>
#include <vector>

#include "solver/finite_base.hpp"

namespace sunder::solver {

/// The base of the projected tangent at u; where that has no factor, for a part hangs on a hinge,
/// with as little inertia as helps. Null: that helps neither. Throws linear_algebra::Stopped.
[[nodiscard]] std::unique_ptr<FiniteBase> projected_base(
    const fem::HyperelasticBody& body, const std::vector<double>& u,
    const fem::TangentPattern& pattern, int& factors, const linear_algebra::FactorWork& work = {});

/// The base of a state at rest, and whether that rest is stable.
struct RenewedBase {
  std::unique_ptr<FiniteBase> base;  ///< projected_base()
  bool stable = true;                ///< the exact tangent is positive definite
  int factors = 0;
};
/// Throws linear_algebra::Stopped.
[[nodiscard]] RenewedBase make_base(const fem::HyperelasticBody& body, const std::vector<double>& u,
                                    const fem::TangentPattern& pattern,
                                    const linear_algebra::FactorWork& work = {});

class FiniteRenewal {
 public:
  /// The thread sleeps for `rest` before it begins; `inverse`: its bases keep one.
  FiniteRenewal(std::chrono::milliseconds rest, bool inverse) : rest_(rest), inverse_(inverse) {}
  ~FiniteRenewal() { give_up(); }
  FiniteRenewal(const FiniteRenewal&) = delete;
  FiniteRenewal& operator=(const FiniteRenewal&) = delete;

  /// Begins a base of the body as it is now; problem, laws and order must outlive it.
  void ask(const fem::HyperelasticBody& body, const std::vector<double>& u,
           const fem::TangentPattern& pattern);
  [[nodiscard]] bool asked() const { return thread_.joinable(); }
  /// Waits for it.
  [[nodiscard]] RenewedBase take();
  void give_up();

 private:
  std::chrono::milliseconds rest_;
  bool inverse_;
  std::vector<std::uint8_t> out_;
  std::vector<double> u_;
  RenewedBase made_;
  std::atomic<bool> unwanted_{false};
  std::thread thread_;  // last: it uses all above
};

}  // namespace sunder::solver
