// SPDX-License-Identifier: Apache-2.0
#include "solver/finite_renewal.hpp"

#include <algorithm>
#include <cmath>
#include <exception>

#include "material/fibres.hpp"
#include "sunder/error.hpp"

namespace sunder::solver {

namespace {

// Of the largest modulus times the mean size of an element: springs that turn no base astray.
constexpr double kLeastInertia = 1e-8, kMostInertia = 1e-2, kMoreInertia = 100;

std::unique_ptr<FiniteBase> base_of(const fem::HyperelasticBody& body, const std::vector<double>& u,
                                    fem::Tangent kind, const fem::TangentPattern& pattern,
                                    const fem::Inertia& inertia,
                                    const linear_algebra::FactorWork& work) {
  try {
    return std::make_unique<FiniteBase>(body, u, kind, pattern, inertia, work);
  } catch (const NumericalError&) {
    return nullptr;
  }
}

double stiffness_scale(const Problem& problem) {
  double most = 0, volume = 0;
  for (Index e = 0; e < problem.tet_count(); ++e) {
    most = std::max(most, shear_scale(problem.small_strain(e)));
    volume += problem.shape(e).volume;
  }
  return most * std::cbrt(volume / std::max(1, problem.tet_count()));
}

}  // namespace

std::unique_ptr<FiniteBase> projected_base(const fem::HyperelasticBody& body,
                                           const std::vector<double>& u,
                                           const fem::TangentPattern& pattern, int& factors,
                                           const linear_algebra::FactorWork& work,
                                           const fem::Inertia& inertia) {
  ++factors;
  auto base = base_of(body, u, fem::Tangent::projected, pattern, inertia, work);
  if (inertia.factor > 0) return base;
  const double scale = stiffness_scale(body.problem);
  for (double part = kLeastInertia; !base && part <= kMostInertia; part *= kMoreInertia) {
    ++factors;
    base = base_of(body, u, fem::Tangent::projected, pattern, {part * scale}, work);
  }
  return base;
}

std::unique_ptr<FiniteBase> base_at_rest(const fem::HyperelasticBody& body,
                                         const std::vector<double>& u,
                                         const fem::TangentPattern& pattern, int& factors,
                                         const linear_algebra::FactorWork& work) {
  ++factors;
  auto base = base_of(body, u, fem::Tangent::eased, pattern, {}, work);
  return base ? std::move(base) : projected_base(body, u, pattern, factors, work);
}

bool is_stable(const fem::HyperelasticBody& body, const std::vector<double>& u,
               const fem::TangentPattern& pattern, const linear_algebra::FactorWork& work) {
  return base_of(body, u, fem::Tangent::exact, pattern, {}, work) != nullptr;
}

void FiniteRenewal::ask(const fem::HyperelasticBody& body, const std::vector<double>& u,
                        const fem::TangentPattern& pattern, bool base, bool judgement,
                        const fem::Inertia& inertia) {
  give_up();
  unwanted_ = false;
  u_ = u;
  out_.assign(body.destroyed.begin(), body.destroyed.end());
  std::promise<std::unique_ptr<FiniteBase>> made;
  std::promise<bool> stable;
  if (base) base_ = made.get_future();
  if (judgement) stable_ = stable.get_future();
  thread_ = std::thread(
      [this, &pattern, base, judgement, inertia, made = std::move(made), stable = std::move(stable),
       of = fem::HyperelasticBody{body.problem, body.law_of_volume, out_, body.split}]() mutable {
        const linear_algebra::FactorWork work = linear_algebra::work_beside(unwanted_);
        // Out of memory or unwanted: the old base goes on.
        const auto keep = [&](auto& promise, auto make, auto otherwise) {
          if (rest_.count() > 0) std::this_thread::sleep_for(rest_);
          try {
            promise.set_value(make());
          } catch (const std::exception&) {
            promise.set_value(std::move(otherwise));
          }
        };
        const auto make_base = [&] {
          int factors = 0;
          auto one = inertia.factor > 0 ? projected_base(of, u_, pattern, factors, work, inertia)
                                        : base_at_rest(of, u_, pattern, factors, work);
          if (inverse_ && one) one->keep_inverse(work);
          return one;
        };
        if (base) keep(made, make_base, std::unique_ptr<FiniteBase>());
        if (judgement)
          keep(
              stable, [&] { return is_stable(of, u_, pattern, work); }, true);
      });
}

void FiniteRenewal::give_up() {
  unwanted_ = true;
  if (thread_.joinable()) thread_.join();
  base_ = {};
  stable_ = {};
}

}  // namespace sunder::solver
