// SPDX-License-Identifier: Apache-2.0
#include "cpu_reference/background_rebase.hpp"

#include <exception>
#include <numeric>

#include "engine/factor_base.hpp"
#include "fem/assembly.hpp"

namespace sunder::cpu_reference {

Based based_on(const Problem& problem, std::span<const double> scale, const fem::FactorWork& work) {
  Based based;
  based.factor = std::make_shared<const fem::Factor>(problem, scale, work);
  based.deferred = std::make_unique<engine::Deferred>(
      problem, std::make_unique<engine::FactorBase>(*based.factor));
  return based;
}

void check_base(Based& based, const DamagedBody& body, const Load& load,
                const std::function<void(Eigen::VectorXd&)>& complete) {
  engine::Deferred& deferred = *based.deferred;
  const engine::Forces forces{load.force_dofs, load.forces};
  Eigen::VectorXd u, du, r;
  deferred.solve(forces, load.displacements, u);
  complete(u);
  body.apply(u, r);
  r = -r;
  for (std::size_t i = 0; i < load.forces.size(); ++i) r[load.force_dofs[i]] += load.forces[i];
  for (Index d : body.problem().gripped_dofs()) r[d] = 0;
  std::vector<Index> all(static_cast<std::size_t>(r.size()));
  std::iota(all.begin(), all.end(), 0);
  deferred.correct({all, {r.data(), all.size()}}, du);
  complete(du);
  const double stress = body.largest_stress(du), largest = body.largest_stress(u);
  based.check = {load, stress / r.norm(), stress == 0 ? 0.0 : stress / largest};
  deferred.solve(forces, load.displacements, u);
}

BackgroundRebase::BackgroundRebase(const DamagedBody& body, const Load& load, MakeBase make)
    : body_(body), load_(load), make_(std::move(make)), thread_([this] { run(); }) {}

BackgroundRebase::~BackgroundRebase() {
  unwanted_ = true;
  if (thread_.joinable()) static_cast<void>(take());
}

void BackgroundRebase::follow(std::span<const Index> elements) {
  ++followed_;
  {
    const std::lock_guard lock(mutex_);
    elements_.insert(elements_.end(), elements.begin(), elements.end());
    ends_.push_back(elements_.size());
  }
  changed_.notify_one();
}

Based BackgroundRebase::take() {
  {
    const std::lock_guard lock(mutex_);
    closed_ = true;
  }
  changed_.notify_one();
  thread_.join();
  return std::move(result_);
}

/// Waits for an event; false: there is none left and none will come.
bool BackgroundRebase::next(std::vector<Index>& elements) {
  std::unique_lock lock(mutex_);
  changed_.wait(lock, [this] { return closed_ || !ends_.empty(); });
  if (ends_.empty()) return false;
  const auto end = static_cast<std::ptrdiff_t>(ends_.front());
  elements.assign(elements_.begin(), elements_.begin() + end);
  elements_.erase(elements_.begin(), elements_.begin() + end);
  ends_.erase(ends_.begin());
  for (std::size_t& e : ends_) e -= static_cast<std::size_t>(end);
  return true;
}

void BackgroundRebase::run() {
  try {
    Based based = make_(body_, load_, {.stop = &unwanted_});
    std::vector<Index> elements;
    while (next(elements)) {
      if (!based.deferred->destroy(elements)) return;
    }
    result_ = std::move(based);
  } catch (const std::exception&) {
    // Out of memory, not definite or unwanted: result_ stays empty, and the frame that takes it
    // decides.
  }
}

}  // namespace sunder::cpu_reference
