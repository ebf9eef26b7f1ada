// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <string_view>

namespace sunder::app {

/// Do formats that close with a mark have theirs? .mesh: "End"; .bdf, .nas: "ENDDATA"; .unv: every
/// data set opened and closed by -1. gmsh reads them without and takes half a file for a whole
/// one. Throws InputError (unreadable_file).
void check_end(std::string_view bytes, const std::string& extension, const std::string& name);

}  // namespace sunder::app
