// SPDX-License-Identifier: Apache-2.0
// Conjugate gradients, preconditioned by the intact factor.
#include "cpu_reference/conjugate_gradient.hpp"
#include "cpu_reference/routes.hpp"

namespace sunder::cpu_reference {
namespace {

// CG stops when the error's energy norm, measured in the intact body, is this share of the first
// guess's. Nine digits of stress along a crack need about 1e-11.
constexpr double kCgTolerance = 1e-12;
// For an error estimate two digits of the correction are enough (squared: an energy).
constexpr double kCorrection = 1e-4;

class ConjugateGradientRoute final : public InverseRoute {
 public:
  ConjugateGradientRoute(const DamagedBody& body, const IntactBody& intact)
      : body_(body), intact_(intact), grips_(body, intact) {}

  Applied solve(const Load& load, const Eigen::VectorXd& f, Eigen::VectorXd& u) override {
    // The intact solution is the first guess.
    intact_.solve(f, grips_.now(), load.displacements, u);
    body_.apply(u, product_);
    const double energy = u.dot(product_);
    Eigen::VectorXd r = f - product_, du;
    clear_grips(r);
    const CgResult cg = run(r, {.absolute = kCgTolerance * kCgTolerance * energy}, du);
    u += du;
    return {cg.iterations, cg.converged};
  }

  Applied apply(const Eigen::VectorXd& r, Eigen::VectorXd& u) override {
    const CgResult cg = run(r, {.relative = kCorrection}, u);
    return {cg.iterations, cg.converged};
  }

  void follow(const fem::Event&) override {}  // K u is computed element by element

  // It goes on from nothing.
  std::unique_ptr<solver::RouteState> state() const override {
    return std::make_unique<solver::RouteState>();
  }
  bool go_back(const solver::RouteState&, std::size_t) override { return true; }

  std::vector<BufferPlan> buffers() const override {
    return {{"conjugate gradient vectors (5 n)",
             5 * static_cast<std::size_t>(body_.problem().dof_count()) * sizeof(double)}};
  }

 private:
  CgResult run(const Eigen::VectorXd& r, const CgStop& stop, Eigen::VectorXd& x) {
    return conjugate_gradient(
        [this](const Eigen::VectorXd& in, Eigen::VectorXd& out) {
          body_.apply(in, out);
          clear_grips(out);
        },
        [this](const Eigen::VectorXd& in, Eigen::VectorXd& out) {
          intact_.solve(in, grips_.now(), {}, out);
        },
        r, stop, x);
  }

  void clear_grips(Eigen::VectorXd& v) const {
    for (Index d : body_.forms().gripped()) v[d] = 0;
  }

  const DamagedBody& body_;
  const IntactBody& intact_;
  PresentGrips grips_;
  Eigen::VectorXd product_;
};

}  // namespace

std::unique_ptr<InverseRoute> conjugate_gradient_route(const DamagedBody& body,
                                                       const IntactBody& intact) {
  return std::make_unique<ConjugateGradientRoute>(body, intact);
}

}  // namespace sunder::cpu_reference
