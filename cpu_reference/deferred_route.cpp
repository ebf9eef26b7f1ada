// SPDX-License-Identifier: Apache-2.0
#include <numeric>

#include "cpu_reference/routes.hpp"
#include "engine/deferred.hpp"
#include "engine/factor_base.hpp"
#include "engine/inverse_base.hpp"
#include "fem/assembly.hpp"

namespace sunder::cpu_reference {
namespace {

// Columns of update vectors that may gather before events are made one, beyond twice what the
// last such event left; and the rank above which a new base is cheaper than carrying the damage.
constexpr Index kLooseRank = 300;
constexpr Index kRebaseRank = 500;

class DeferredRoute final : public InverseRoute {
 public:
  DeferredRoute(const DamagedBody& body, const IntactBody& intact, bool dense)
      : body_(body), dense_(dense), all_(static_cast<std::size_t>(body.problem().dof_count())) {
    std::iota(all_.begin(), all_.end(), 0);
    lay_over(intact.factor);
  }

  Applied solve(const Load& load, const Eigen::VectorXd&, Eigen::VectorXd& u) override {
    deferred_->solve({load.force_dofs, load.forces}, load.displacements, u);
    return {};
  }

  Applied apply(const Eigen::VectorXd& r, Eigen::VectorXd& u) override {
    deferred_->solve({all_, {r.data(), static_cast<std::size_t>(r.size())}}, {}, u);
    return {};
  }

  void destroy(std::span<const Index> elements) override {
    if (!deferred_->destroy(body_.problem(), elements)) {
      rebase();
      return;
    }
    if (deferred_->rank() <= 2 * compact_rank_ + kLooseRank) return;
    if (!deferred_->compact(body_.problem()) || deferred_->rank() > kRebaseRank) {
      rebase();
      return;
    }
    compact_rank_ = deferred_->rank();
  }

  bool rebase() override {
    deferred_.reset();
    damaged_ = std::make_unique<fem::Factor>(fem::assemble_lower(body_.problem(), body_.scale()));
    lay_over(*damaged_);
    return true;
  }

  std::vector<BufferPlan> buffers() const override {
    std::vector<BufferPlan> plan = deferred_->buffers();
    if (damaged_) plan.push_back({"damaged factor (sparse Cholesky)", damaged_->bytes()});
    return plan;
  }

 private:
  void lay_over(const fem::Factor& factor) {
    std::unique_ptr<engine::Base> base;
    if (dense_) {
      base = std::make_unique<engine::InverseBase>(factor);
    } else {
      base = std::make_unique<engine::FactorBase>(factor);
    }
    deferred_ = std::make_unique<engine::Deferred>(std::move(base), body_.problem().gripped_dofs());
    compact_rank_ = 0;
  }

  const DamagedBody& body_;
  bool dense_;
  std::vector<Index> all_;  // every unknown: the loads of a residual
  std::unique_ptr<fem::Factor> damaged_;
  std::unique_ptr<engine::Deferred> deferred_;
  Index compact_rank_ = 0;
};

}  // namespace

std::unique_ptr<InverseRoute> deferred_route(const DamagedBody& body, const IntactBody& intact,
                                             bool dense) {
  return std::make_unique<DeferredRoute>(body, intact, dense);
}

}  // namespace sunder::cpu_reference
