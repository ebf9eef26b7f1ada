// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <string>

namespace sunder::machine {

/// A library that is loaded by name while the program runs; unloaded with the object.
class SharedLibrary {
 public:
  /// Not loaded.
  SharedLibrary() = default;
  /// Loads a file, or what the system finds by a name without a folder. Throws nothing: where it
  /// cannot be loaded, loaded() is false and why() the system's sentence.
  explicit SharedLibrary(const std::filesystem::path& name);
  SharedLibrary(SharedLibrary&& other) noexcept;
  SharedLibrary& operator=(SharedLibrary&& other) noexcept;
  SharedLibrary(const SharedLibrary&) = delete;
  SharedLibrary& operator=(const SharedLibrary&) = delete;
  ~SharedLibrary();

  [[nodiscard]] bool loaded() const { return handle_ != nullptr; }
  [[nodiscard]] const std::string& why() const { return why_; }

  /// A function of it; null: it has none of this name, or is not loaded.
  template <class Function>
  [[nodiscard]] Function* function(const char* name) const {
    return reinterpret_cast<Function*>(address(name));
  }
  /// Leaves it loaded until the program ends.
  void keep() { handle_ = nullptr; }

 private:
  using Address = void (*)();
  [[nodiscard]] Address address(const char* name) const;

  void* handle_ = nullptr;
  std::string why_;
};

}  // namespace sunder::machine
