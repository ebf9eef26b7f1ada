// SPDX-License-Identifier: Apache-2.0
// In place of gmsh_tasks.cpp and child_process.cpp in a build without gmsh (SUNDER_GMSH=OFF):
// nothing is called that could crash, so there is no child either.
#include "app/input/child_process.hpp"
#include "app/input/gmsh_tasks.hpp"

namespace sunder::app {

const bool kLimitsMemory = false;

bool has_gmsh() noexcept { return false; }

std::string gmsh_task(const std::string&, const std::vector<std::string>&) {
  return "Ethis build has no gmsh (SUNDER_GMSH=OFF)";
}

ChildOutcome run_in_child(const std::function<std::string()>& work, const ChildLimits&) {
  return {ChildOutcome::End::done, 0, work(), ""};
}

}  // namespace sunder::app
