// SPDX-License-Identifier: Apache-2.0
// What gmsh is asked for. It is loaded at the first task, so that a program which reads no mesh
// does not load its CAD kernel; call it in a child process (child_process.hpp).
#pragma once

#include <string>
#include <vector>

namespace sunder::app {

/// False in a build without gmsh, where every task is answered by 'E' and a sentence.
[[nodiscard]] bool has_gmsh() noexcept;

/// "read" FILE, "mesh" FILE.geo, "board" TETS THICKNESS: 'M' and the bytes of a RawMesh;
/// "convert" FROM TO: 'M'. What goes wrong: 'E' and gmsh's words.
[[nodiscard]] std::string gmsh_task(const std::string& task,
                                    const std::vector<std::string>& arguments);

}  // namespace sunder::app
