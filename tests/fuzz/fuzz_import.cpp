// SPDX-License-Identifier: Apache-2.0
// The whole import, gmsh in its child included: a mesh that is valid, or an InputError. gmsh may
// crash on what passes the checks; this process may not.
#include <unistd.h>

#include <cstdint>
#include <filesystem>
#include <fstream>

#include "app/input/mesh_import.hpp"
#include "sunder/error.hpp"

namespace {

const char* extension(std::uint8_t choice) {
  switch (choice) {
    case 'v':
      return ".vtk";
    case 'x':
      return ".vtu";
    case 'u':
      return ".unv";
    case 'b':
      return ".bdf";
    case 'e':
      return ".mesh";
    default:
      return ".msh";
  }
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  if (size == 0) return 0;
  const std::filesystem::path path =
      std::filesystem::temp_directory_path() /
      ("sunder-fuzz-" + std::to_string(::getpid()) + extension(data[0]));
  std::ofstream out(path, std::ios::binary);
  for (std::size_t i = 1; i < size; ++i) out.put(static_cast<char>(data[i]));
  out.close();
  sunder::app::ImportLimits limits;
  limits.timeout = std::chrono::seconds(5);
  try {
    const sunder::Mesh mesh = sunder::app::import_mesh(path, nullptr, limits);
    sunder::validate(mesh, "fuzz");
  } catch (const sunder::InputError&) {
    // what bad files are for
  }
  std::filesystem::remove(path);
  return 0;
}
