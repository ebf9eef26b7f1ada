// SPDX-License-Identifier: Apache-2.0
// A few threads that wait for loops to share. Starting a loop allocates nothing.
#pragma once

#include <atomic>
#include <condition_variable>
#include <cstdint>
#include <exception>
#include <mutex>
#include <thread>
#include <utility>
#include <vector>

namespace sunder {

class Workers {
 public:
  /// `count` threads share a loop, the caller's among them; at least one, and fewer where the
  /// system has no more.
  explicit Workers(int count);
  ~Workers();
  Workers(const Workers&) = delete;
  Workers& operator=(const Workers&) = delete;

  [[nodiscard]] int count() const { return static_cast<int>(threads_.size()) + 1; }

  /// Calls body(worker) once for each worker 0 ... count() - 1 and returns when all are done.
  /// Throws what the body has thrown, of several one.
  template <class Body>
  void run(Body&& body) {
    if (threads_.empty()) {
      body(0);
      return;
    }
    start([](void* b, int worker) { (*static_cast<std::remove_reference_t<Body>*>(b))(worker); },
          &body);
    try {
      body(0);
    } catch (...) {
      keep_exception();
    }
    finish();
  }

 private:
  using Call = void (*)(void* body, int worker);
  void start(Call call, void* body);
  void finish();
  void work(int worker);
  void keep_exception() noexcept;

  /// Until `value` is no longer `seen`; what it is then.
  std::uint32_t wait(std::atomic<std::uint32_t>& value, std::uint32_t seen);
  void notify(std::atomic<std::uint32_t>& value);

  std::vector<std::thread> threads_;
  std::atomic<std::uint32_t> round_{0}, working_{0};
#ifdef _WIN32
  std::mutex changing_;
  std::condition_variable changed_;
#endif
  Call call_ = nullptr;  // nullptr: the end
  void* body_ = nullptr;
  std::mutex throwing_;  // guards thrown_ while a loop runs
  std::exception_ptr thrown_;
};

}  // namespace sunder
