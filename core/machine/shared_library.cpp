// SPDX-License-Identifier: Apache-2.0
#include "machine/shared_library.hpp"

#include <utility>

#if defined(_WIN32)
#include "machine/windows_api.hpp"

#include <system_error>
#else
#include <dlfcn.h>
#endif

namespace sunder::machine {

#if defined(_WIN32)

namespace {

/// Unloading this library would take their code from threads that still run: it stays, as
/// `-z nodelete` has it stay elsewhere.
[[maybe_unused]] const bool kStays = [] {
  static const char here = 0;
  HMODULE module = nullptr;
  return GetModuleHandleExW(GET_MODULE_HANDLE_EX_FLAG_PIN | GET_MODULE_HANDLE_EX_FLAG_FROM_ADDRESS,
                            reinterpret_cast<LPCWSTR>(&here), &module) != 0;
}();

}  // namespace

SharedLibrary::SharedLibrary(const std::filesystem::path& name)
    : handle_(LoadLibraryW(name.wstring().c_str())) {
  if (!handle_) {
    const auto code = static_cast<int>(GetLastError());
    why_ = name.string() + ": " + std::system_category().message(code);
  }
}

SharedLibrary::~SharedLibrary() {
  if (handle_) FreeLibrary(static_cast<HMODULE>(handle_));
}

SharedLibrary::Address SharedLibrary::address(const char* name) const {
  if (!handle_) return nullptr;
  return reinterpret_cast<Address>(GetProcAddress(static_cast<HMODULE>(handle_), name));
}

#else

SharedLibrary::SharedLibrary(const std::filesystem::path& name)
    : handle_(::dlopen(name.c_str(), RTLD_NOW | RTLD_LOCAL)) {
  if (!handle_) why_ = ::dlerror();
}

SharedLibrary::~SharedLibrary() {
  if (handle_) ::dlclose(handle_);
}

SharedLibrary::Address SharedLibrary::address(const char* name) const {
  return handle_ ? reinterpret_cast<Address>(::dlsym(handle_, name)) : nullptr;
}

#endif

SharedLibrary::SharedLibrary(SharedLibrary&& other) noexcept
    : handle_(std::exchange(other.handle_, nullptr)), why_(std::move(other.why_)) {}

SharedLibrary& SharedLibrary::operator=(SharedLibrary&& other) noexcept {
  std::swap(handle_, other.handle_);
  std::swap(why_, other.why_);
  return *this;
}

}  // namespace sunder::machine
