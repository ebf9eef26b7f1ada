// SPDX-License-Identifier: Apache-2.0
#include "linear_algebra/workers.hpp"

namespace sunder {

Workers::Workers(int count) {
  for (int w = 1; w < count; ++w) threads_.emplace_back([this, w] { work(w); });
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
  round_.notify_all();
}

void Workers::finish() {
  for (auto left = working_.load(std::memory_order_acquire); left != 0;
       left = working_.load(std::memory_order_acquire)) {
    working_.wait(left, std::memory_order_acquire);
  }
}

void Workers::work(int worker) {
  for (std::uint32_t seen = 0;; ++seen) {
    round_.wait(seen, std::memory_order_acquire);
    if (!call_) return;
    call_(body_, worker);
    if (working_.fetch_sub(1, std::memory_order_acq_rel) == 1) working_.notify_one();
  }
}

}  // namespace sunder
