// SPDX-License-Identifier: Apache-2.0
// Meshes out of VTK's XML files of unstructured grids (.vtu), those that Sunder writes among them.
#pragma once

#include <string>
#include <string_view>

#include "app/input/raw_mesh.hpp"

namespace sunder::app {

/// Points, tetrahedra and their volumes; ascii, base64 and appended data, plain or compressed by
/// zlib, either byte order, one piece. Volumes come from the first integer cell data of a name
/// that names_volumes() knows; integer field data of one value names the volume of that tag (as
/// result.vtu has it). Throws InputError; `name` begins messages.
[[nodiscard]] RawMesh read_vtu(std::string_view bytes, const std::string& name);

}  // namespace sunder::app
