// SPDX-License-Identifier: Apache-2.0
#include "solver/finite_renewal.hpp"

#include <algorithm>
#include <cmath>
#include <exception>

#include "sunder/error.hpp"

namespace sunder::solver {

namespace {

// Of the largest modulus times the mean size of an element: springs that turn no base astray.
constexpr double kLeastInertia = 1e-8, kMostInertia = 1e-2, kMoreInertia = 100;

std::unique_ptr<FiniteBase> base_of(const fem::HyperelasticBody& body, const std::vector<double>& u,
                                    fem::Tangent kind, const fem::TangentPattern& pattern,
                                    double inertia, const linear_algebra::FactorWork& work) {
  try {
    return std::make_unique<FiniteBase>(body, u, kind, pattern, inertia, work);
  } catch (const NumericalError&) {
    return nullptr;
  }
}

double stiffness_scale(const Problem& problem) {
  double most = 0, volume = 0;
  for (Index e = 0; e < problem.tet_count(); ++e) {
    most = std::max(most, problem.small_strain(e).mu);
    volume += problem.shape(e).volume;
  }
  return most * std::cbrt(volume / std::max(1, problem.tet_count()));
}

}  // namespace

std::unique_ptr<FiniteBase> projected_base(const fem::HyperelasticBody& body,
                                           const std::vector<double>& u,
                                           const fem::TangentPattern& pattern, int& factors,
                                           const linear_algebra::FactorWork& work) {
  ++factors;
  auto base = base_of(body, u, fem::Tangent::projected, pattern, 0, work);
  const double scale = stiffness_scale(body.problem);
  for (double part = kLeastInertia; !base && part <= kMostInertia; part *= kMoreInertia) {
    ++factors;
    base = base_of(body, u, fem::Tangent::projected, pattern, part * scale, work);
  }
  return base;
}

RenewedBase make_base(const fem::HyperelasticBody& body, const std::vector<double>& u,
                      const fem::TangentPattern& pattern, const linear_algebra::FactorWork& work) {
  RenewedBase made;
  made.base = projected_base(body, u, pattern, made.factors, work);
  ++made.factors;
  made.stable = base_of(body, u, fem::Tangent::exact, pattern, 0, work) != nullptr;
  return made;
}

void FiniteRenewal::ask(const fem::HyperelasticBody& body, const std::vector<double>& u,
                        const fem::TangentPattern& pattern) {
  give_up();
  unwanted_ = false;
  u_ = u;
  out_.assign(body.destroyed.begin(), body.destroyed.end());
  made_ = {};
  thread_ = std::thread(
      [this, of = fem::HyperelasticBody{body.problem, body.law_of_volume, out_}, &pattern] {
        if (rest_.count() > 0) std::this_thread::sleep_for(rest_);
        try {
          made_ = make_base(of, u_, pattern, {.stop = &unwanted_});
          if (inverse_ && made_.base) made_.base->keep_inverse();
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
