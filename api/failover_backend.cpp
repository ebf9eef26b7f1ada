// SPDX-License-Identifier: Apache-2.0
#include "failover_backend.hpp"

#include <algorithm>
#include <iterator>
#include <optional>
#include <string>
#include <utility>

#include "sunder/error.hpp"

namespace sunder {
namespace {

class FailoverBackend final : public Backend {
 public:
  FailoverBackend(std::shared_ptr<const Problem> problem, std::unique_ptr<Backend> primary,
                  std::function<std::unique_ptr<Backend>()> replacement)
      : Backend(std::move(problem), primary->needs()),
        current_(std::move(primary)),
        replacement_(std::move(replacement)) {}

  BackendInfo info() const override {
    BackendInfo info = current_->info();
    if (!lost_.empty()) info.why += "; took over from backend vulkan: " + lost_;
    return info;
  }
  std::vector<BufferPlan> buffers() const override { return current_->buffers(); }
  std::vector<KernelPlan> kernels() const override { return current_->kernels(); }
  std::vector<std::string> warnings() const override {
    std::vector<std::string> all = current_->warnings();
    if (!lost_.empty()) {
      all.push_back("backend vulkan failed in mid-run, cpu took over from the last frame: " +
                    lost_ + "; look for a driver's reset in the system log, or use backend cpu");
    }
    return all;
  }
  bool prepares() const override { return current_->prepares(); }
  PreparationReport preparation() const override { return current_->preparation(); }
  std::string why_no_grasp() const override { return current_->why_no_grasp(); }
  void time_passes(bool on) override { current_->time_passes(on); }
  std::vector<PassTime> take_pass_times() override { return current_->take_pass_times(); }
  NewBases take_new_bases() override { return current_->take_new_bases(); }
  std::shared_ptr<InstrumentForces> instrument_forces() override {
    return instruments_ = current_->instrument_forces();
  }

 private:
  void do_set_load(const Load& load) override {
    load_ = load;
    const auto own = own_gripped_dofs(), grasped = gripped_dofs().subspan(own.size());
    grasped_.assign(grasped.begin(), grasped.end());
    let_go_.clear();
    const auto all = problem().gripped_dofs();
    std::set_difference(all.begin(), all.end(), own.begin(), own.end(),
                        std::back_inserter(let_go_));
    grips_since_.clear();
    attempt([&] { current_->set_load(load); });
  }
  SolveReport do_solve() override {
    SolveReport report;
    attempt([&] { report = current_->solve(); });
    solved_ = true;
    return report;
  }
  StressSummary do_stress() override {
    StressSummary summary;
    attempt([&] { summary = current_->stress(); });
    stressed_ = true;
    return summary;
  }
  Deformation do_deformation() override {
    Deformation deformation;
    attempt([&] { deformation = current_->deformation(); });
    return deformation;
  }
  void do_cut_off(std::span<const Index> elements) override {
    attempt([&] { current_->cut_off(elements); });
    cut_off_.insert(cut_off_.end(), elements.begin(), elements.end());
  }
  void do_destroy(std::span<const Index> elements) override {
    attempt([&] { current_->destroy(elements); });
    events_.insert(events_.end(), elements.begin(), elements.end());
    solved_ = stressed_ = false;
  }
  void do_grip(const GripChange& change) override {
    const Grips now{{change.grasp.begin(), change.grasp.end()},
                    {change.release.begin(), change.release.end()}};
    attempt([&] { now.tell(*current_); });
    grips_since_.push_back(now);
  }
  void do_prepare(std::span<const Index> elements) override {
    prepared_.assign(elements.begin(), elements.end());
    attempt([&] { current_->prepare(elements); });
  }
  void do_exclude_candidates(std::span<const Index> elements) override {
    attempt([&] { current_->exclude_candidates(elements); });
    excluded_.insert(excluded_.end(), elements.begin(), elements.end());
  }
  void do_solve_pristine(const Load& load, std::span<double> displacement) override {
    attempt([&] { current_->solve_pristine(load, displacement); });
  }
  void do_read_displacement(std::span<double> displacement) const override {
    attempt([&] { current_->read_displacement(displacement); });
  }
  void do_read_displacement(std::span<const Index> nodes,
                            std::span<Vec3> displacement) const override {
    attempt([&] { current_->read_displacement(nodes, displacement); });
  }
  void do_read_stress(std::span<Voigt> stress) const override {
    attempt([&] { current_->read_stress(stress); });
  }
  Voigt do_read_stress(Index element) const override {
    Voigt stress;
    attempt([&] { stress = current_->read_stress(element); });
    return stress;
  }
  void do_read_reactions(std::span<double> reactions) const override {
    attempt([&] { current_->read_reactions(reactions); });
  }

  template <class Operation>
  void attempt(Operation&& operation) const {
    try {
      operation();
    } catch (const DeviceLost& error) {
      if (!lost_.empty()) throw;
      lost_ = error.what();
      take_over();
      operation();
    }
  }

  /// Brings the replacement to the state before the operation that failed.
  void take_over() const {
    current_ = replacement_();
    if (!events_.empty()) current_->destroy(events_);
    if (needs().yield) current_->exclude_candidates(excluded_);
    if (!cut_off_.empty()) current_->cut_off(cut_off_);
    current_->release(let_go_);
    current_->grasp(grasped_);
    if (load_) current_->set_load(*load_);
    if (solved_) current_->solve();
    if (stressed_) current_->stress();
    // Only now: what it has found so far is what they have been given already.
    if (instruments_) current_->take_over_instrument_forces(instruments_);
    for (const Grips& grips : grips_since_) grips.tell(*current_);
    if (!prepared_.empty()) current_->prepare(prepared_);
  }

  /// Unknowns grasped or let go at once.
  struct Grips {
    std::vector<Index> grasp, release;
    void tell(Backend& backend) const {
      backend.release(release);
      backend.grasp(grasp);
    }
  };

  mutable std::unique_ptr<Backend> current_;
  std::function<std::unique_ptr<Backend>()> replacement_;
  mutable std::string lost_;                       // why the primary is gone; empty: it is not
  std::shared_ptr<InstrumentForces> instruments_;  // as handed out
  std::vector<Index> events_, excluded_, cut_off_, prepared_;
  std::optional<Load> load_;
  std::vector<Index> grasped_, let_go_;  // beside the problem's own, and of these, under load_
  std::vector<Grips> grips_since_;       // since load_
  bool solved_ = false, stressed_ = false;
};

}  // namespace

std::unique_ptr<Backend> with_failover(std::shared_ptr<const Problem> problem,
                                       std::unique_ptr<Backend> primary,
                                       std::function<std::unique_ptr<Backend>()> replacement) {
  return std::make_unique<FailoverBackend>(std::move(problem), std::move(primary),
                                           std::move(replacement));
}

}  // namespace sunder
