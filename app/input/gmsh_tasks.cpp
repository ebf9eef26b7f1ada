// SPDX-License-Identifier: Apache-2.0
#include "app/input/gmsh_tasks.hpp"

#include <dlfcn.h>

#include <filesystem>
#include <system_error>

namespace sunder::app {
namespace {

using Task = void(const std::string&, const std::vector<std::string>&, std::string&);

/// Beside an installed program, or where it was built.
std::vector<std::filesystem::path> places_of_module() {
  std::error_code ignored;
  const std::filesystem::path program = std::filesystem::read_symlink("/proc/self/exe", ignored);
  return {program.parent_path() / SUNDER_GMSH_BESIDE, SUNDER_GMSH_BUILT};
}

}  // namespace

bool has_gmsh() noexcept { return true; }

std::string gmsh_task(const std::string& task, const std::vector<std::string>& arguments) {
  std::string why;
  for (const std::filesystem::path& path : places_of_module()) {
    std::error_code ignored;
    if (!std::filesystem::exists(path, ignored)) {
      why += (why.empty() ? "no " : " and no ") + path.string();
      continue;
    }
    void* module = ::dlopen(path.c_str(), RTLD_NOW | RTLD_LOCAL);
    auto* run = module ? reinterpret_cast<Task*>(::dlsym(module, "sunder_gmsh_task")) : nullptr;
    if (!run) return std::string("Ethe module that calls gmsh cannot be loaded: ") + ::dlerror();
    std::string answer;
    run(task, arguments, answer);
    return answer;
  }
  return "Ethe module that calls gmsh is missing: " + why;
}

}  // namespace sunder::app
