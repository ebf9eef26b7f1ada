// SPDX-License-Identifier: Apache-2.0
#include "c/handles.hpp"

#include <condition_variable>
#include <cstring>
#include <list>
#include <thread>

namespace sunder::c {

void Object::set_error(const char* text) noexcept {
  const std::lock_guard lock(error_mutex_);
  std::strncpy(error_.data(), text, error_.size() - 1);
}

std::string Object::error() const {
  const std::lock_guard lock(error_mutex_);
  return error_.data();
}

Registry& Registry::instance() {
  // Never destroyed: a host may destroy its handles when the process ends.
  static Registry& registry = *new Registry;
  return registry;
}

std::uintptr_t Registry::add(std::shared_ptr<Object> object) {
  const std::lock_guard lock(mutex_);
  const std::uintptr_t handle = next_;
  objects_.emplace(handle, std::move(object));
  next_ += 16;
  return handle;
}

void Registry::remove(std::uintptr_t handle) {
  const std::lock_guard lock(mutex_);
  objects_.erase(handle);
}

std::shared_ptr<Object> Registry::find(std::uintptr_t handle) const {
  const std::shared_lock lock(mutex_);
  const auto it = objects_.find(handle);
  return it == objects_.end() ? nullptr : it->second;
}

namespace {

/// Threads that let objects go; the end of the process waits for them.
class Disposals {
 public:
  ~Disposals() {
    for (Disposal& disposal : disposals_) disposal.thread.join();
  }

  void take(std::shared_ptr<Object> object, std::chrono::steady_clock::time_point until) {
    std::unique_lock lock(mutex_);
    disposals_.remove_if([](Disposal& disposal) {
      if (!disposal.done) return false;
      disposal.thread.join();
      return true;
    });
    Disposal& disposal = disposals_.emplace_back();
    disposal.thread = std::thread([this, &disposal, object = std::move(object)]() mutable {
      object.reset();
      const std::lock_guard done(mutex_);
      disposal.done = true;
      all_.notify_all();
    });
    all_.wait_until(lock, until, [&] { return disposal.done; });
  }

 private:
  struct Disposal {
    std::thread thread;
    bool done = false;
  };
  std::mutex mutex_;
  std::condition_variable all_;
  std::list<Disposal> disposals_;
};

}  // namespace

void dispose(std::shared_ptr<Object> object, std::chrono::steady_clock::time_point until) {
  static Disposals disposals;
  disposals.take(std::move(object), until);
}

}  // namespace sunder::c
