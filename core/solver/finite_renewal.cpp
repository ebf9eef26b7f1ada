// SPDX-License-Identifier: Apache-2.0
#include "solver/finite_renewal.hpp"

#include <exception>

#include "sunder/error.hpp"

namespace sunder::solver {

RenewedBase make_base(const fem::HyperelasticBody& body, const std::vector<double>& u,
                      const std::vector<Index>& order, const linear_algebra::FactorWork& work) {
  RenewedBase made;
  const auto factor = [&](fem::Tangent kind) -> std::unique_ptr<FiniteBase> {
    ++made.factors;
    try {
      return std::make_unique<FiniteBase>(body, u, kind, order, 0, work);
    } catch (const NumericalError&) {
      return nullptr;
    }
  };
  made.base = factor(fem::Tangent::projected);
  made.stable = factor(fem::Tangent::exact) != nullptr;
  return made;
}

void FiniteRenewal::ask(const fem::HyperelasticBody& body, const std::vector<double>& u,
                        const std::vector<Index>& order) {
  give_up();
  unwanted_ = false;
  u_ = u;
  out_.assign(body.destroyed.begin(), body.destroyed.end());
  made_ = {};
  thread_ = std::thread(
      [this, of = fem::HyperelasticBody{body.problem, body.law_of_volume, out_}, &order] {
        if (rest_.count() > 0) std::this_thread::sleep_for(rest_);
        try {
          made_ = make_base(of, u_, order, {.stop = &unwanted_});
        } catch (const std::exception&) {
          made_ = {};  // out of memory or unwanted: the old base goes on
        }
      });
}

RenewedBase FiniteRenewal::take() {
  thread_.join();
  return std::move(made_);
}

void FiniteRenewal::give_up() {
  unwanted_ = true;
  if (thread_.joinable()) thread_.join();
}

}  // namespace sunder::solver
