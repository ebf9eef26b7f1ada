// SPDX-License-Identifier: Apache-2.0
// Is a .msh file whole? Reads all of versions 1, 2.2 and 4.1, ascii and binary: every section
// closed, every count met, every id in range, every referenced node there. It also notes what gmsh
// does not keep: the order of nodes and elements in the file.
#pragma once

#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

namespace sunder::app {

struct MshContents {
  std::vector<std::uint64_t> node_tags;     ///< in the order of the file
  std::vector<std::uint64_t> element_tags;  ///< all elements, in the order of the file
  /// Versions 1 and 2.2: physical tag per element (0: none). Version 4.1 has it per entity: empty.
  std::vector<int> element_physical;
  std::uint64_t tetrahedra = 0;
};

/// Throws InputError; `name` (the file) begins messages, with the line where there is one.
[[nodiscard]] MshContents check_msh(std::string_view bytes, const std::string& name);

}  // namespace sunder::app
