// SPDX-License-Identifier: Apache-2.0
// Handles: numbers that look like pointers to a C compiler and are looked up here, never followed.
// A number is given once, so a destroyed handle stays invalid.
#pragma once

#include <array>
#include <atomic>
#include <chrono>
#include <cstdint>
#include <memory>
#include <mutex>
#include <shared_mutex>
#include <unordered_map>

#include "c/failure.hpp"
#include "c/status.hpp"

namespace sunder::c {

/// What stands behind a handle.
class Object {
 public:
  virtual ~Object() = default;
  Object() = default;
  Object(const Object&) = delete;
  Object& operator=(const Object&) = delete;

  [[nodiscard]] bool take() noexcept { return !busy_.exchange(true, std::memory_order_acquire); }
  void release() noexcept { busy_.store(false, std::memory_order_release); }

  /// Destroyed by the host, though a call of another thread may hold it a little longer. Returns
  /// whether it was before.
  bool close() noexcept { return closed_.exchange(true); }
  [[nodiscard]] bool closed() const noexcept { return closed_.load(); }

  void set_error(const char* text) noexcept;
  [[nodiscard]] std::string error() const;

 private:
  std::atomic<bool> busy_{false}, closed_{false};
  mutable std::mutex error_mutex_;
  std::array<char, kErrorText> error_{};
};

class Registry {
 public:
  /// The one of this process.
  [[nodiscard]] static Registry& instance();

  [[nodiscard]] std::uintptr_t add(std::shared_ptr<Object> object);
  void remove(std::uintptr_t handle);
  /// Null when there is none.
  [[nodiscard]] std::shared_ptr<Object> find(std::uintptr_t handle) const;

 private:
  mutable std::shared_mutex mutex_;
  std::unordered_map<std::uintptr_t, std::shared_ptr<Object>> objects_;
  std::uintptr_t next_ = 16;
};

[[noreturn]] inline void refuse_handle(const char* what) {
  throw Failure(SUNDER_ERROR_HANDLE,
                std::string("the handle is not that of a ") + what + ", or was destroyed");
}

/// The object of type T behind a handle; `what` names the kind. Throws SUNDER_ERROR_HANDLE.
template <class T>
[[nodiscard]] std::shared_ptr<T> find(const void* handle, const char* what) {
  auto object = std::dynamic_pointer_cast<T>(
      Registry::instance().find(reinterpret_cast<std::uintptr_t>(handle)));
  if (!object) refuse_handle(what);
  return object;
}

/// Keeps an object for one call. Throws SUNDER_ERROR_BUSY.
class Hold {
 public:
  explicit Hold(Object& object) : object_(object) {
    if (!object.take()) {
      throw Failure(SUNDER_ERROR_BUSY, "the handle is in use by another call");
    }
  }
  ~Hold() { object_.release(); }
  Hold(const Hold&) = delete;
  Hold& operator=(const Hold&) = delete;

 private:
  Object& object_;
};

/// One call on one object: looks it up, holds it, runs body(T&); a failure is also kept by the
/// handle. T::kName names the kind.
template <class T, class Body>
[[nodiscard]] sunder_status call(const void* handle, Body&& body) noexcept {
  return guarded([&] {
    const auto object = find<T>(handle, T::kName);
    const Hold hold(*object);
    if (object->closed()) refuse_handle(T::kName);  // since it was found
    try {
      body(*object);
    } catch (...) {
      static_cast<void>(status_of_exception());
      object->set_error(last_text_of_thread());
      throw;
    }
  });
}

/// No call finds the object from now on.
inline void forget(const void* handle) {
  Registry::instance().remove(reinterpret_cast<std::uintptr_t>(handle));
}

template <class T>
[[nodiscard]] sunder_status destroy(const void* handle) noexcept {
  return call<T>(handle, [&](T&) { forget(handle); });
}

/// Lets an object go on a thread of its own, and waits for that no longer than `until`: what is
/// being prepared beside the frames may take its time to give up.
void dispose(std::shared_ptr<Object> object, std::chrono::steady_clock::time_point until);

/// A new handle for an object.
template <class Handle>
[[nodiscard]] Handle new_handle(std::shared_ptr<Object> object) {
  return reinterpret_cast<Handle>(Registry::instance().add(std::move(object)));
}

}  // namespace sunder::c
