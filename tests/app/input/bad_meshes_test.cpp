// SPDX-License-Identifier: Apache-2.0
#include "app/input/input_support.hpp"
#include "app/input/mesh_import.hpp"
#include "app/input/msh_text.hpp"
#include "app/mesh_board/board.hpp"
#include "app/mesh_board/structured_board.hpp"

namespace sunder::test {
namespace {

using F = InputFault;

// Two tetrahedra on a common face; line numbers: $Nodes 9, node 1 11, $Elements 17, element 1 19.
const std::string kGood2 =
    "$MeshFormat\n2.2 0 8\n$EndMeshFormat\n$PhysicalNames\n2\n3 1 \"lower\"\n3 2 \"upper\"\n"
    "$EndPhysicalNames\n$Nodes\n5\n1 0 0 0\n2 1 0 0\n3 0 1 0\n4 0 0 1\n5 0 0 -1\n$EndNodes\n"
    "$Elements\n2\n1 4 2 1 1 1 2 3 4\n2 4 2 2 2 1 3 2 5\n$EndElements\n";

const std::string kGood4 =
    "$MeshFormat\n4.1 0 8\n$EndMeshFormat\n$PhysicalNames\n1\n3 1 \"body\"\n$EndPhysicalNames\n"
    "$Entities\n0 0 0 1\n1 0 0 0 1 1 1 1 1 0\n$EndEntities\n"
    "$Nodes\n1 4 1 4\n3 1 0 4\n1\n2\n3\n4\n0 0 0\n1 0 0\n0 1 0\n0 0 1\n$EndNodes\n"
    "$Elements\n1 1 1 1\n3 1 4 1\n1 1 2 3 4\n$EndElements\n";

const std::string kGoodVtk =
    "# vtk DataFile Version 2.0\ntitle\nASCII\nDATASET UNSTRUCTURED_GRID\nPOINTS 4 double\n"
    "0 0 0\n1 0 0\n0 1 0\n0 0 1\nCELLS 1 5\n4 0 1 2 3\nCELL_TYPES 1\n10\n"
    "CELL_DATA 1\nSCALARS region int 1\nLOOKUP_TABLE default\n3\n";

struct Case {
  std::string from, to;
  InputFault fault;
  std::vector<std::string> parts;
};

void expect_all(const std::string& base, const std::string& name, const std::vector<Case>& cases) {
  const TemporaryFolder folder;
  EXPECT_NO_THROW(static_cast<void>(app::import_mesh(folder.write(name, base))));
  for (const Case& bad : cases) {
    SCOPED_TRACE("\"" + bad.from + "\" -> \"" + bad.to + "\"");
    const auto path = folder.write(name, with(base, bad.from, bad.to));
    std::vector<std::string> parts = bad.parts;
    parts.push_back(name);
    expect_input_error([&] { static_cast<void>(app::import_mesh(path)); }, bad.fault, parts);
  }
}

TEST(BadMeshes, Msh22) {
  expect_all(
      kGood2, "bad.msh",
      {
          {"2.2 0 8", "3.0 0 8", F::unreadable_file, {"bad.msh:2", "\"3.0\"", "2.2 and 4.1"}},
          {"2.2 0 8", "2.2 2 8", F::unreadable_file, {"file type is 2", "0 (ascii), 1 (binary)"}},
          {"2.2 0 8", "2.2 0 4", F::unreadable_file, {"data size is 4"}},
          {"$MeshFormat\n", "", F::unreadable_file, {"bad.msh:1", "section"}},
          {"$MeshFormat", "$NOD", F::unreadable_file, {"$MeshFormat"}},
          {"3 2 \"upper\"",
           "3 2 \"lower\"",
           F::duplicate_name,
           {"bad.msh:", "the volume \"lower\" is named twice", "1 and 2"}},
          {"3 2 \"upper\"", "3 1 \"upper\"", F::duplicate_name, {"tag 1 has two names"}},
          {"3 2 \"upper\"", "3 2 upper", F::unreadable_file, {"quotes"}},
          {"$Nodes\n5", "$Nodes\n6", F::unreadable_file, {"bad.msh:16", "$Nodes", "$EndNodes"}},
          {"$Nodes\n5", "$Nodes\n4", F::unreadable_file, {"$EndNodes", "count"}},
          {"$Nodes\n5", "$Nodes\n-5", F::unreadable_file, {"bad.msh:10", "-5 nodes"}},
          {"$Nodes\n5", "$Nodes\n4611686018427387904", F::unreadable_file, {"bad.msh:10", "nodes"}},
          {"$Nodes\n5", "$Nodes\nfive", F::unreadable_file, {"bad.msh:10", "\"five\""}},
          {"1 0 0 0", "1 nan 0 0", F::out_of_range, {"bad.msh:11", "\"nan\"", "finite"}},
          {"1 0 0 0", "1 0 inf 0", F::out_of_range, {"bad.msh:11", "\"inf\""}},
          {"1 0 0 0", "1 0 1e999 0", F::out_of_range, {"bad.msh:11", "\"1e999\""}},
          {"1 0 0 0", "1 0 0,5 0", F::unreadable_file, {"bad.msh:11", "\"0,5\""}},
          {"5 0 0 -1", "4 0 0 -1", F::bad_id, {"node 4 occurs twice"}},
          {"5 0 0 -1", "0 0 0 -1", F::bad_id, {"bad.msh:15", "node number is 0", "allowed"}},
          {"5 0 0 -1", "-7 0 0 -1", F::bad_id, {"bad.msh:15"}},
          {"5 0 0 -1", "99999999999 0 0 -1", F::bad_id, {"bad.msh:15", "99999999999"}},
          {"5 0 0 -1", "99999999999999999999 0 0 -1", F::bad_id, {"99999999999999999999"}},
          {"2 4 2 2 2 1 3 2 5", "1 4 2 2 2 1 3 2 5", F::bad_id, {"element 1 occurs twice"}},
          {"2 4 2 2 2 1 3 2 5",
           "2 4 2 2 2 1 3 2 6",
           F::bad_id,
           {"bad.msh:20", "element 2 uses node 6"}},
          {"2 4 2 2 2 1 3 2 5", "2 4 2 2 2 1 3 2 2147483647", F::bad_id, {"2147483647"}},
          {"2 4 2 2 2 1 3 2 5", "2 4 2 2 2 1 3 2", F::unreadable_file, {"$EndElements"}},
          {"2 4 2 2 2 1 3 2 5",
           "2 99 2 2 2 1 3 2 5",
           F::unreadable_file,
           {"bad.msh:20", "element type 99"}},
          {"2 4 2 2 2 1 3 2 5", "2 4 -1 1 3 2 5", F::unreadable_file, {"-1 tags"}},
          {"2 4 2 2 2 1 3 2 5", "2 4 2000000000 1 3 2 5", F::unreadable_file, {"2000000000 tags"}},
          {"2 4 2 2 2 1 3 2 5",
           "2 4 2 2 2 1 2 3 4",
           F::degenerate_element,
           {"elements 0 and 1", "same four nodes"}},
          {"2 4 2 2 2 1 3 2 5", "2 4 2 2 2 1 2 3 5", F::inverted_element, {"element 1"}},
          {"2 4 2 2 2 1 3 2 5", "2 4 2 2 2 1 3 2 2", F::degenerate_element, {"element 1"}},
          {"5 0 0 -1", "5 1 1 0", F::degenerate_element, {"element 1"}},
          {"1 4 2 1 1 1 2 3 4\n2 4 2 2 2 1 3 2 5",
           "1 2 2 1 1 1 2 3\n2 2 2 2 2 1 3 2",
           F::no_tetrahedra,
           {"no tetrahedra"}},
          {"2\n1 4 2 1 1 1 2 3 4\n2 4 2 2 2 1 3 2 5\n", "0\n", F::no_tetrahedra, {"no tetrahedra"}},
          {"2 4 2 2 2 1 3 2 5",
           "2 7 2 2 2 1 2 3 4 5",
           F::unreadable_file,
           {"1 solid elements that are no tetrahedra", "Pyramid"}},
          {"$Elements\n2\n", "$Nodes\n", F::unreadable_file, {"$Nodes", "twice"}},
          {"$EndElements\n", "$EndElements\nrubbish\n", F::unreadable_file, {"bad.msh:22"}},
          {"$EndElements\n",
           "$EndElements\n$NodeData\n1\n",
           F::unreadable_file,
           {"$NodeData", "$EndNodeData", "truncated"}},
      });
}

TEST(BadMeshes, Msh41) {
  expect_all(
      kGood4, "bad.msh",
      {
          {"4.1 0 8", "4.0 0 8", F::unreadable_file, {"\"4.0\"", "2.2 and 4.1"}},
          {"0 0 0 1\n", "0 0 0 2\n", F::unreadable_file, {"$Entities"}},
          {"0 0 0 1\n", "0 0 0 999999999999\n", F::unreadable_file, {"999999999999 entities"}},
          {"1 1 1 1 1 0", "1 1 1 99999999 1 0", F::unreadable_file, {"99999999 tags"}},
          {"1 4 1 4", "2 4 1 4", F::unreadable_file, {"$Nodes"}},
          {"1 4 1 4", "1 5 1 5", F::unreadable_file, {"declares 5 nodes", "hold 4"}},
          {"3 1 0 4", "3 1 0 5", F::unreadable_file, {"block of 5 nodes"}},
          {"3 1 0 4", "7 1 0 4", F::unreadable_file, {"dimension 7", "0 to 3"}},
          {"3 1 0 4", "3 1 0 -4", F::bad_id, {"-4"}},
          {"0 0 0\n1 0 0\n", "0 0 nan\n1 0 0\n", F::out_of_range, {"nan", "finite"}},
          {"1\n2\n3\n4\n0", "1\n2\n3\n3\n0", F::bad_id, {"node 3 occurs twice"}},
          {"1 1 1 1\n3", "1 2 1 2\n3", F::unreadable_file, {"declares 2 elements", "hold 1"}},
          {"3 1 4 1\n", "3 1 77 1\n", F::unreadable_file, {"element type 77"}},
          {"1 1 2 3 4\n", "1 1 2 3 40\n", F::bad_id, {"element 1 uses node 40"}},
          {"1 1 2 3 4\n", "1 1 2 3 18446744073709551615\n", F::bad_id, {"18446744073709551615"}},
          {"1 1 2 3 4\n", "0 1 2 3 4\n", F::bad_id, {"element tag is 0"}},
          {"1 1 2 3 4\n", "1 2 1 3 4\n", F::inverted_element, {"element 0"}},
      });
}

TEST(BadMeshes, Vtk) {
  expect_all(
      kGoodVtk, "bad.vtk",
      {
          {"# vtk", "# vtx", F::unreadable_file, {"bad.vtk", "# vtk DataFile Version"}},
          {"Version 2.0", "Version 5.1", F::unreadable_file, {"\"5.1\"", "1.0 to 4.2"}},
          {"ASCII", "TEXT", F::unreadable_file, {"\"TEXT\"", "ASCII and BINARY"}},
          {"UNSTRUCTURED_GRID",
           "POLYDATA",
           F::unreadable_file,
           {"\"POLYDATA\"", "UNSTRUCTURED_GRID"}},
          {"POINTS 4 double", "POINTS 4 int", F::unreadable_file, {"float or double"}},
          {"POINTS 4 double", "POINTS 4 quad", F::unreadable_file, {"\"quad\""}},
          {"POINTS 4 double", "POINTS 99999999 double", F::unreadable_file, {"99999999 points"}},
          {"0 0 1\n", "0 0 nan\n", F::out_of_range, {"bad.vtk:9", "finite"}},
          {"CELLS 1 5", "CELLS 1 4", F::unreadable_file, {"cell 0 with 4 points"}},
          {"CELLS 1 5", "CELLS 1 6", F::unreadable_file, {"1 entries more"}},
          {"4 0 1 2 3", "4 0 1 2 4", F::bad_id, {"bad.vtk:11", "point 4", "0 to 3"}},
          {"4 0 1 2 3", "4 0 1 2 -1", F::bad_id, {"point -1"}},
          {"CELL_TYPES 1", "CELL_TYPES 2", F::unreadable_file, {"2 types for 1 cells"}},
          {"10\n", "12\n", F::no_tetrahedra, {"no tetrahedra"}},
          {"CELL_DATA 1", "CELL_DATA 2", F::unreadable_file, {"2 cells"}},
          {"default\n3", "default\n-3", F::bad_id, {"region", "-3"}},
      });
}

TEST(BadMeshes, FilesThatAreNone) {
  const TemporaryFolder folder;
  const auto read = [](const std::filesystem::path& path) {
    return [path] { static_cast<void>(app::import_mesh(path)); };
  };
  std::filesystem::create_directory(folder.file("folder.msh"));
  expect_input_error(read(folder.file("none.msh")), F::unreadable_file,
                     {"none.msh", "no such file"});
  expect_input_error(read(folder.file("folder.msh")), F::unreadable_file, {"is a directory"});
  expect_input_error(read(folder.write("empty.msh", "")), F::unreadable_file, {"is empty"});
  expect_input_error(read(folder.write("space.msh", " \n")), F::unreadable_file, {"$MeshFormat"});
  expect_input_error(read(folder.write("zeros.msh", std::string(1000, '\0'))), F::unreadable_file,
                     {"zeros.msh"});
  expect_input_error(read(folder.write("script.geo", "Point(1)={0,0,0};")), F::unreadable_file,
                     {"extension \".geo\"", "\".msh\""});
  expect_input_error(read(folder.write("noextension", "x")), F::unreadable_file,
                     {"extension \"\""});
  if (::geteuid() != 0) {  // root may read everything
    const auto path = folder.write("secret.msh", kGood2);
    std::filesystem::permissions(path, std::filesystem::perms::none);
    expect_input_error(read(path), F::unreadable_file, {"secret.msh", "ermission"});
  }
}

// What the checks let pass is gmsh's to refuse: its own words are handed on.
TEST(BadMeshes, GmshsOwnWords) {
  const TemporaryFolder folder;
  const auto path = folder.write(
      "bad.bdf",
      "GRID,1,,0,0,0\nGRID,2,,1,0,0\nGRID,3,,0,1,0\nGRID,4,,0,0,1\nCTETRA,1,1,1,2,3,9\nENDDATA\n");
  expect_input_error([&] { static_cast<void>(app::import_mesh(path)); }, F::unreadable_file,
                     {"bad.bdf", "gmsh: Wrong node index 9"});
}

TEST(BadMeshes, LimitsOfTimeAndMemory) {
  const TemporaryFolder folder;
  app::BoardOptions options;
  options.tets = 200'000;
  options.ascii = true;
  static_cast<void>(app::write_board(options, folder.file("big.msh")));
  app::ImportLimits hasty;
  hasty.timeout = std::chrono::milliseconds(1);
  expect_input_error(
      [&] { static_cast<void>(app::import_mesh(folder.file("big.msh"), nullptr, hasty)); },
      F::unreadable_file, {"big.msh", "took longer than"});
}

}  // namespace
}  // namespace sunder::test
