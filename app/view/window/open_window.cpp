// SPDX-License-Identifier: Apache-2.0
#include "app/view/window/open_window.hpp"

#include <dlfcn.h>

#include <filesystem>
#include <system_error>

#include "sunder/error.hpp"

namespace sunder::app {
namespace {

constexpr const char* kInstead = "; with --headless sunder view writes pictures instead";

}  // namespace

void open_window(const WindowPlan& plan) {
#ifdef SUNDER_WINDOW_BUILT
  std::error_code ignored;
  const std::filesystem::path program = std::filesystem::read_symlink("/proc/self/exe", ignored);
  for (const std::filesystem::path& path :
       {program.parent_path() / SUNDER_WINDOW_BESIDE, std::filesystem::path(SUNDER_WINDOW_BUILT)}) {
    if (!std::filesystem::exists(path, ignored)) continue;
    void* module = ::dlopen(path.c_str(), RTLD_NOW | RTLD_LOCAL);
    auto* open = module ? reinterpret_cast<OpenWindow*>(::dlsym(module, kOpenWindow)) : nullptr;
    if (!open) {
      throw DeviceError(std::string("the window cannot be loaded: ") + ::dlerror() +
                        "; install libglfw3 and libvulkan1" + kInstead);
    }
    open(plan);
    return;
  }
  throw DeviceError(std::string("the window's module sunder-window.so is missing") + kInstead);
#else
  static_cast<void>(plan);
  throw DeviceError(
      std::string("this build opens no window: install libglfw3-dev and libimgui-dev, then "
                  "configure and build again") +
      kInstead);
#endif
}

}  // namespace sunder::app
