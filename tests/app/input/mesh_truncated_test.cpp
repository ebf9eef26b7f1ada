// SPDX-License-Identifier: Apache-2.0
// Half a file is never taken for a whole one.
#include "app/input/input_support.hpp"
#include "app/input/mesh_import.hpp"
#include "app/input/msh_reader.hpp"
#include "app/input/msh_text.hpp"
#include "app/input/vtk_check.hpp"
#include "app/mesh_board/board.hpp"
#include "app/mesh_board/msh_writer.hpp"
#include "app/mesh_board/structured_board.hpp"

namespace sunder::test {
namespace {

struct Format {
  std::string name, bytes;
};

std::vector<Format> formats(const Mesh& mesh) {
  return {{"2.2 ascii", to_msh22_ascii(mesh)},
          {"2.2 binary", to_msh22_binary(mesh)},
          {"4.1 ascii", app::to_msh(mesh, true)},
          {"4.1 binary", app::to_msh(mesh, false)}};
}

// Behind each section's first line, in the middle of its body, before its end mark, within it, and
// behind it: where a full disk or a broken transfer may cut.
std::vector<std::size_t> cuts_of_sections(const std::string& bytes) {
  std::vector<std::size_t> cuts;
  std::size_t at = 0;
  while ((at = bytes.find('$', at)) != std::string::npos) {
    const std::string name = bytes.substr(at + 1, bytes.find('\n', at) - at - 1);
    const std::size_t end = bytes.find("$End" + name, at);
    for (const std::size_t cut :
         {at + 3, bytes.find('\n', at) + 1, (at + end) / 2, end, end + 4, end + name.size() + 4})
      cuts.push_back(cut);
    at = end + 4;
  }
  cuts.pop_back();  // behind the last section the file is whole
  return cuts;
}

TEST(MeshTruncated, AtEverySectionThroughTheWholeImport) {
  const TemporaryFolder folder;
  const Mesh mesh = app::structured_board({2, 4, 1}, 2.0);
  for (const Format& format : formats(mesh)) {
    EXPECT_EQ(app::import_mesh(folder.write("whole.msh", format.bytes)).tets, mesh.tets);
    const std::vector<std::size_t> cuts = cuts_of_sections(format.bytes);
    EXPECT_GE(cuts.size(), 23U);
    for (const std::size_t cut : cuts) {
      SCOPED_TRACE(format.name + " cut at " + std::to_string(cut));
      const auto path = folder.write("cut.msh", format.bytes.substr(0, cut));
      expect_input_error([&] { static_cast<void>(app::import_mesh(path)); },
                         InputFault::unreadable_file, {"cut.msh"});
    }
  }
}

TEST(MeshTruncated, Version1AtEveryByte) {
  const std::string whole =
      "$NOD\n4\n1 0 0 0\n2 1 0 0\n3 0 1 0\n4 0 0 1\n$ENDNOD\n$ELM\n1\n1 4 7 1 4 1 2 3 4\n$ENDELM";
  EXPECT_NO_THROW(static_cast<void>(app::read_msh(whole, "whole.msh")));
  for (std::size_t cut = 0; cut < whole.size(); ++cut) {
    SCOPED_TRACE(cut);
    EXPECT_THROW(static_cast<void>(app::read_msh(whole.substr(0, cut), "cut.msh")), InputError);
  }
}

TEST(MeshTruncated, AtEveryByte) {
  const Mesh mesh = app::structured_board({1, 4, 1}, 2.0);
  for (const Format& format : formats(mesh)) {
    const std::size_t whole = format.bytes.rfind("$EndElements") + 12;
    for (std::size_t cut = 0; cut < whole; ++cut) {
      ASSERT_THROW(
          static_cast<void>(app::read_msh(std::string_view(format.bytes).substr(0, cut), "m")),
          InputError)
          << format.name << " cut at " << cut;
    }
    EXPECT_EQ(app::read_msh(format.bytes, "m").tet_tags.size(), mesh.tets.size());
  }
}

TEST(MeshTruncated, VtkAtEveryByte) {
  const TemporaryFolder folder;
  app::BoardOptions options;
  options.nx = 1;
  options.ny = 4;
  options.nz = 1;
  static_cast<void>(app::write_board(options, folder.file("board.vtk")));
  const std::string bytes = read_bytes(folder.file("board.vtk"));
  const std::size_t cells_end = bytes.find("CELL_DATA");
  ASSERT_NE(cells_end, std::string::npos);
  EXPECT_EQ(app::check_vtk(bytes, "m").tetrahedra, 20U);
  EXPECT_EQ(app::check_vtk(bytes, "m").tet_tags.size(), 20U);
  // The last type of the cells may lose its line's end but not its digits.
  const std::size_t whole = bytes.find_last_not_of(" \n", cells_end - 1);
  for (std::size_t cut = 0; cut < whole; ++cut)
    ASSERT_THROW(static_cast<void>(app::check_vtk(std::string_view(bytes).substr(0, cut), "m")),
                 InputError)
        << "cut at " << cut;
}

TEST(MeshTruncated, FormatsWithAnEndMark) {
  const TemporaryFolder folder;
  app::BoardOptions options;
  options.tets = 500;
  for (const char* name : {"board.mesh", "board.unv", "board.bdf"}) {
    SCOPED_TRACE(name);
    static_cast<void>(app::write_board(options, folder.file(name)));
    const std::string bytes = read_bytes(folder.file(name));
    EXPECT_EQ(app::import_mesh(folder.file(name)).tet_count(), 500);
    for (const double part : {0.1, 0.3, 0.5, 0.7, 0.9}) {
      const auto size = static_cast<std::size_t>(part * static_cast<double>(bytes.size()));
      const auto path = folder.write(std::string("cut-") + name, bytes.substr(0, size));
      expect_input_error([&] { static_cast<void>(app::import_mesh(path)); },
                         InputFault::unreadable_file, {"cut-", "truncated"});
    }
  }
}

}  // namespace
}  // namespace sunder::test
