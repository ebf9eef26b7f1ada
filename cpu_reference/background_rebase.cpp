// SPDX-License-Identifier: Apache-2.0
#include "cpu_reference/background_rebase.hpp"

#include <exception>

#include "engine/factor_base.hpp"
#include "fem/assembly.hpp"

namespace sunder::cpu_reference {

Based based_on(const Problem& problem, std::span<const double> scale) {
  Based based;
  based.factor = std::make_unique<fem::Factor>(fem::assemble_lower(problem, scale));
  based.deferred = std::make_unique<engine::Deferred>(
      problem, std::make_unique<engine::FactorBase>(*based.factor));
  return based;
}

BackgroundRebase::BackgroundRebase(const Problem& problem, std::vector<double> scale)
    : problem_(problem), scale_(std::move(scale)), thread_([this] { run(); }) {}

BackgroundRebase::~BackgroundRebase() {
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
    Based based = based_on(problem_, scale_);
    std::vector<Index> elements;
    while (next(elements)) {
      if (!based.deferred->destroy(elements)) return;
    }
    result_ = std::move(based);
  } catch (const std::exception&) {
    // Out of memory or not definite: result_ stays empty, and the frame that takes it decides.
  }
}

}  // namespace sunder::cpu_reference
