// SPDX-License-Identifier: Apache-2.0
#include <Eigen/Eigenvalues>
#include <algorithm>
#include <optional>
#include <utility>

#include "cpu_reference/plain/finite.hpp"
#include "sunder/error.hpp"
#include "sunder/fracture_model.hpp"

namespace sunder::plain {
namespace {

Real3x3 tensor_of(const Voigt& s) {
  Real3x3 tensor;
  tensor << s[0], s[3], s[5], s[3], s[1], s[4], s[5], s[4], s[2];
  return tensor;
}

Real strength(const Voigt& s, YieldMeasure measure) {
  const auto p = principal_values(tensor_of(s));
  if (measure == YieldMeasure::principal) return p[2];
  return measure == YieldMeasure::tresca ? p[2] - p[0] : (p[2] - p[0]) / 2;
}

/// Over the yield, which fibres may have another of across: the largest x of det(t - x M) = 0, t
/// the stress (less s3 I by shear), M = yield a a^T + yield_across (I - a a^T).
Real yield_ratio(const Problem& problem, Index e, const Voigt& s, YieldMeasure measure) {
  const Material& m = problem.material(e);
  if (m.fibres.empty() || !m.fibres.front().yield_across) {
    return strength(s, measure) / problem.yield(e);
  }
  const Eigen::Matrix<Real, 3, 1> a = problem.fibre_direction(e, 0).cast<Real>();
  const Real3x3 one = Real3x3::Identity(), along = a * a.transpose();
  Real3x3 t = tensor_of(s);
  if (measure != YieldMeasure::principal) t -= principal_values(t)[0] * one;
  const Real3x3 strengths =
      problem.yield(e) * along + *m.fibres.front().yield_across * (one - along);
  const Eigen::GeneralizedSelfAdjointEigenSolver<Real3x3> of(t, strengths, Eigen::EigenvaluesOnly);
  return of.eigenvalues()[2] / (measure == YieldMeasure::max_shear ? 2 : 1);
}

class PlainBackend final : public Backend {
 public:
  PlainBackend(std::shared_ptr<const Problem> problem, Needs needs)
      : Backend(problem, std::move(needs)),
        body_(*problem),
        excluded_(problem->mesh().tets.size(), 0),
        cut_off_(excluded_) {}

  BackendInfo info() const override { return {"plain", "", "", "fp64", "LDL^T", "anew", "judge"}; }
  std::vector<BufferPlan> buffers() const override { return {}; }
  std::vector<KernelPlan> kernels() const override { return {}; }

 private:
  void do_set_load(const Load& load) override { load_ = load; }
  SolveReport do_solve() override {
    if (by_laws()) return solve_finite();
    solution_ = body_.solve(load_);
    if (!(solution_.error <= problem().scene().solver.tolerance)) {
      throw NumericalError("the yardstick cannot be refined under the tolerance");
    }
    return {.residual = solution_.residual, .error = solution_.error};
  }
  [[nodiscard]] bool by_laws() const { return problem().finite() || problem().fibrous(); }
  /// From the last solution on.
  SolveReport solve_finite() {
    const FiniteBody body(problem(), destroyed());
    solution_ = body.solve(load_, solution_.displacement);
    solution_.stress = body.stress(solution_.displacement, problem().scene().fracture.stress);
    return {.residual = solution_.residual};
  }
  StressSummary do_stress() override {
    stress_ = solution_.stress;
    const YieldMeasure measure = strength_measure(problem().scene().fracture);
    std::optional<FiniteBody> layers;
    if (problem().interfaces()) layers.emplace(problem(), destroyed());
    StressSummary summary;
    for (Index e = 0; e < problem().tet_count(); ++e) {
      if (destroyed()[e] || !problem().breakable(e)) continue;
      const auto ratio = static_cast<double>(problem().in_interface(e)
                                                 ? layers->parting_ratio(e, solution_.displacement)
                                                 : yield_ratio(problem(), e, stress_[e], measure));
      if (ratio > summary.any.ratio) summary.any = {e, ratio};
      if (ratio > summary.candidate.ratio && !excluded_[e]) summary.candidate = {e, ratio};
      summary.over += ratio >= 1;
    }
    return summary;
  }
  Deformation do_deformation() override {
    return by_laws()
               ? FiniteBody(problem(), destroyed()).deformation(solution_.displacement, cut_off_)
               : body_.deformation(solution_.displacement, cut_off_);
  }
  void do_cut_off(std::span<const Index> elements) override {
    for (Index e : elements) cut_off_[e] = 1;
  }
  void do_destroy(std::span<const Index> elements) override { body_.destroy(elements); }
  void do_exclude_candidates(std::span<const Index> elements) override {
    for (Index e : elements) excluded_[e] = 1;
  }
  void do_solve_pristine(const Load& load, std::span<double> u) override {
    if (by_laws()) {
      pristine_ = FiniteBody(problem()).solve(load, pristine_).displacement;
    } else {
      pristine_ = Body(problem()).solve(load).displacement;
    }
    std::ranges::copy(pristine_, u.begin());
  }
  void do_read_displacement(std::span<double> u) const override {
    std::ranges::copy(solution_.displacement, u.begin());
  }
  void do_read_displacement(std::span<const Index> nodes, std::span<Vec3> u) const override {
    for (std::size_t i = 0; i < nodes.size(); ++i)
      u[i] = Vec3(&solution_.displacement[3 * nodes[i]]);
  }
  void do_read_stress(std::span<Voigt> s) const override { std::ranges::copy(stress_, s.begin()); }
  Voigt do_read_stress(Index element) const override { return stress_[element]; }
  void do_read_reactions(std::span<double> reactions) const override {
    std::ranges::copy(solution_.reactions, reactions.begin());
  }

  Body body_;
  Load load_;
  Solution solution_;
  std::vector<double> pristine_;  // of the last solve_pristine()
  std::vector<Voigt> stress_;     // of the last stress()
  std::vector<std::uint8_t> excluded_, cut_off_;
};

}  // namespace

std::unique_ptr<Backend> create(std::shared_ptr<const Problem> problem, Needs needs) {
  if (problem->pools()) throw DeviceError("the yardstick does not pool volume; use backend cpu");
  return std::make_unique<PlainBackend>(std::move(problem), std::move(needs));
}

}  // namespace sunder::plain
