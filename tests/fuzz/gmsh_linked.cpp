// SPDX-License-Identifier: Apache-2.0
// gmsh_task() with the module linked in, so that it is instrumented as well.
#include "app/input/gmsh_tasks.hpp"

extern "C" void sunder_gmsh_task(const std::string& task, const std::vector<std::string>& given,
                                 std::string& answer);

namespace sunder::app {

std::string gmsh_task(const std::string& task, const std::vector<std::string>& arguments) {
  std::string answer;
  sunder_gmsh_task(task, arguments, answer);
  return answer;
}

}  // namespace sunder::app
