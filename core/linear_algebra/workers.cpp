// SPDX-License-Identifier: Apache-2.0
#include "linear_algebra/workers.hpp"

#include <algorithm>

namespace sunder {

Workers::Workers(int count) {
  threads_.reserve(static_cast<std::size_t>(std::max(count - 1, 0)));
  try {
    for (int w = 1; w < count; ++w) threads_.emplace_back([this, w] { work(w); });
  } catch (const std::exception&) {
    // Out of threads or of memory for one: those that there are share the work.
  }
}

Workers::~Workers() {
  start(nullptr, nullptr);
  for (std::thread& thread : threads_) thread.join();
}

void Workers::start(Call call, void* body) {
  call_ = call;
  body_ = body;
  working_.store(static_cast<std::uint32_t>(threads_.size()), std::memory_order_relaxed);
  round_.fetch_add(1, std::memory_order_release);
  notify(round_);
}

void Workers::finish() {
  auto left = working_.load(std::memory_order_acquire);
  while (left != 0) left = wait(working_, left);
  if (thrown_) std::rethrow_exception(std::exchange(thrown_, nullptr));
}

void Workers::keep_exception() noexcept {
  const std::lock_guard lock(throwing_);
  if (!thrown_) thrown_ = std::current_exception();
}

void Workers::work(int worker) {
  for (std::uint32_t seen = 0;; ++seen) {
    wait(round_, seen);
    if (!call_) return;
    try {
      call_(body_, worker);
    } catch (...) {
      keep_exception();
    }
    if (working_.fetch_sub(1, std::memory_order_acq_rel) == 1) notify(working_);
  }
}

#ifdef _WIN32

// Without a futex libstdc++ 12 loses wake-ups of std::atomic::wait: threads that wait for ever.

std::uint32_t Workers::wait(std::atomic<std::uint32_t>& value, std::uint32_t seen) {
  std::unique_lock lock(changing_);
  changed_.wait(lock, [&] { return value.load(std::memory_order_acquire) != seen; });
  return value.load(std::memory_order_acquire);
}

void Workers::notify(std::atomic<std::uint32_t>& /*value*/) {
  { const std::lock_guard lock(changing_); }  // not between a look and the sleep that follows it
  changed_.notify_all();
}

#else

std::uint32_t Workers::wait(std::atomic<std::uint32_t>& value, std::uint32_t seen) {
  value.wait(seen, std::memory_order_acquire);
  return value.load(std::memory_order_acquire);
}

void Workers::notify(std::atomic<std::uint32_t>& value) { value.notify_all(); }

#endif

}  // namespace sunder
