// SPDX-License-Identifier: Apache-2.0
// The plain yardstick of the routes: a dense inverse into which every event is worked.
#include "body/stiffness_factor.hpp"
#include "cpu_reference/low_rank.hpp"
#include "cpu_reference/routes.hpp"

namespace sunder::cpu_reference {
namespace {

class DenseInverseRoute final : public InverseRoute {
 public:
  DenseInverseRoute(const DamagedBody& body, const IntactBody& intact)
      : body_(body), grips_(intact.grips.dofs()), x_(intact.factor.inverse()), update_(x_.rows()) {
    grips_.read(x_);
  }

  Applied solve(const Load& load, const Eigen::VectorXd&, Eigen::VectorXd& u) override {
    u.setZero(x_.rows());
    for (std::size_t i = 0; i < load.forces.size(); ++i) {
      u += load.forces[i] * x_.col(load.force_dofs[i]);  // u = X f, loaded columns only
    }
    grips_.hold(u, load.displacements);
    return {};
  }

  Applied apply(const Eigen::VectorXd& r, Eigen::VectorXd& u) override {
    u.noalias() = x_ * r;
    grips_.hold(u, {});
    return {};
  }

  void follow(const fem::Event& event) override {
    if (event.of_grips()) {
      grips_ = Grips(body_.forms().gripped());
      grips_.read(x_);
      return;
    }
    if (body_.forms().came().empty() && !body_.problem().pools()) {
      update_.gather(body_.problem(), event.leave);
      if (update_.apply(x_)) {
        grips_.read(x_);
        return;
      }
    }
    rebase();  // rounding has made I - W^T X W indefinite, or the update is of another kind
  }

  bool rebase() override {
    x_ = fem::factor_stiffness(body_).inverse();
    grips_.read(x_);
    return true;
  }

  std::vector<BufferPlan> buffers() const override {
    std::vector<BufferPlan> plan{
        {"inverse (dense, n x n)", static_cast<std::size_t>(x_.size()) * sizeof(double)}};
    if (update_.bytes() > 0) plan.push_back({"room of the largest update", update_.bytes()});
    return plan;
  }

 private:
  const DamagedBody& body_;
  Grips grips_;
  Eigen::MatrixXd x_;
  InverseUpdate update_;
};

}  // namespace

std::unique_ptr<InverseRoute> dense_inverse_route(const DamagedBody& body,
                                                  const IntactBody& intact) {
  return std::make_unique<DenseInverseRoute>(body, intact);
}

}  // namespace sunder::cpu_reference
