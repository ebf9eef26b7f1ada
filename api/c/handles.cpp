// SPDX-License-Identifier: Apache-2.0
#include "c/handles.hpp"

#include <cstring>

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

}  // namespace sunder::c
