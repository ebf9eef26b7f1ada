// SPDX-License-Identifier: Apache-2.0
// The mesh readers, checks and the conversion in this process: .msh, .vtk, .vtu, the end marks, and
// what comes out of the pipe. The first byte chooses the reader.
#include <cstdint>
#include <cstdlib>
#include <string>
#include <string_view>

#include "app/input/end_check.hpp"
#include "app/input/msh_reader.hpp"
#include "app/input/raw_mesh.hpp"
#include "app/input/vtk_check.hpp"
#include "app/input/vtu_reader.hpp"
#include "sunder/error.hpp"

namespace {

using namespace sunder::app;

// A mesh that is read must survive the pipe; whether it can be computed with is to_mesh()'s to say.
void convert(const RawMesh& raw) {
  if (!from_bytes(to_bytes(raw))) std::abort();
  static_cast<void>(to_mesh(raw, "fuzz", nullptr));
}

void read_vtk(std::string_view bytes) {
  const VtkContents contents = check_vtk(bytes, "fuzz.vtk");
  if (!contents.tet_tags.empty() && contents.tet_tags.size() != contents.tetrahedra) std::abort();
}

void read_pipe(std::string_view bytes) {
  const auto raw = from_bytes(bytes);
  if (!raw) return;
  const sunder::Mesh mesh = to_mesh(*raw, "fuzz", nullptr);
  if (mesh.tets.size() != raw->tet_tags.size() || mesh.volume_of.size() != mesh.tets.size())
    std::abort();
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  if (size == 0) return 0;
  std::string text(size - 1, '\0');
  for (std::size_t i = 1; i < size; ++i) text[i - 1] = static_cast<char>(data[i]);
  try {
    switch (data[0]) {
      case 'm':
        convert(read_msh(text, "fuzz.msh"));
        break;
      case 'v':
        read_vtk(text);
        break;
      case 'x':
        convert(read_vtu(text, "fuzz.vtu"));
        break;
      case 'p':
        read_pipe(text);
        break;
      case 'u':
        check_end(text, ".unv", "fuzz.unv");
        break;
      case 'b':
        check_end(text, ".bdf", "fuzz.bdf");
        break;
      case 'e':
        check_end(text, ".mesh", "fuzz.mesh");
        break;
      default:
        break;
    }
  } catch (const sunder::InputError& error) {
    if (std::string_view(error.what()).empty()) std::abort();
  }
  return 0;
}
