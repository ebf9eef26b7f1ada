// SPDX-License-Identifier: Apache-2.0
#include "app/input/input_support.hpp"
#include "app/input/mesh_import.hpp"
#include "app/input/msh_text.hpp"
#include "app/input/vtu_reader.hpp"
#include "app/mesh_board/board.hpp"
#include "app/mesh_board/msh_writer.hpp"
#include "app/mesh_board/structured_board.hpp"
#include "app/output/result_file.hpp"

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
          {"2.2 0 8", "3.0 0 8", F::unreadable_file, {"bad.msh:2", "\"3.0\"", "1, 2.2 and 4.1"}},
          {"2.2 0 8", "2.2 2 8", F::unreadable_file, {"file type is 2", "0 (ascii), 1 (binary)"}},
          {"2.2 0 8", "2.2 0 4", F::unreadable_file, {"data size is 4"}},
          {"$MeshFormat\n", "", F::unreadable_file, {"bad.msh:1", "section"}},
          {"$MeshFormat", "$NOD", F::unreadable_file, {"$NOD", "number of nodes", "\"2.2\""}},
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
          {"5 0 0 -1", "-7 0 0 -1", F::bad_id, {"bad.msh:15", "node number is -7", "allowed: 1"}},
          {"2 4 2 2 2 1 3 2 5", "-3 4 2 2 2 1 3 2 5", F::bad_id, {"element number is -3"}},
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
           {"1 solid element that is no tetrahedron", "Pyramid"}},
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
          {"4.1 0 8", "4.0 0 8", F::unreadable_file, {"\"4.0\"", "2.2 and 4.1", "-format msh41"}},
          {"$EndEntities\n",
           "$EndEntities\n$PartitionedEntities\n2\n1\n5 1\n0 0 0 9\n",
           F::unreadable_file,
           {"$PartitionedEntities"}},
          {"3 1 4 1\n",
           "3 8 4 1\n",
           F::bad_id,
           {"bad.msh:", "entity 8 of dimension 3", "$Entities"}},
          {"3 1 4 1\n", "2 1 4 1\n", F::unreadable_file, {"dimension 2", "allowed: 3"}},
          {"1 1 1 1 1 0", "1 1 1 1 -2147483648 0", F::bad_id, {"-2147483648"}},
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
          {"CELLS 1 5", "CELLS 1 6", F::unreadable_file, {"1 entry more"}},
          {"4 0 1 2 3", "4 0 1 2 4", F::bad_id, {"bad.vtk:11", "point 4", "0 to 3"}},
          {"4 0 1 2 3", "4 0 1 2 -1", F::bad_id, {"point -1"}},
          {"CELL_TYPES 1", "CELL_TYPES 2", F::unreadable_file, {"2 types for 1 cell"}},
          {"10\n", "12\n", F::no_tetrahedra, {"no tetrahedra"}},
          {"10\n", "71\n", F::unreadable_file, {"type 71", "save it as", ".vtu"}},
          {"CELL_DATA 1", "CELL_DATA 2", F::unreadable_file, {"2 cells"}},
          {"default\n3", "default\n-3", F::bad_id, {"region", "-3"}},
      });
}

TEST(BadMeshes, Msh1) {
  const std::string good =
      "$NOD\n4\n1 0 0 0\n2 1 0 0\n3 0 1 0\n4 0 0 1\n$ENDNOD\n"
      "$ELM\n2\n7 2 5 1 3 1 3 2\n9 4 8 1 4 1 2 3 4\n$ENDELM\n";
  expect_all(good, "bad.msh",
             {
                 {"$ENDNOD", "$EndNodes", F::unreadable_file, {"bad.msh:7", "$ENDNOD"}},
                 {"4\n1 0", "5\n1 0", F::unreadable_file, {"bad.msh:7", "$NOD"}},
                 {"4 0 0 1", "-3 0 0 1", F::bad_id, {"bad.msh:6", "node number is -3"}},
                 {"4 1 2 3 4", "4 1 2 3 6", F::bad_id, {"element 9 uses node 6", "$NOD"}},
                 {"1 4 1 2 3 4", "1 1 1 2 3 4", F::unreadable_file, {"has 1 node;", "allowed: 4"}},
                 {"$ELM\n2", "$ELM\n3", F::unreadable_file, {"bad.msh:"}},
                 {"$ENDELM\n", "", F::unreadable_file, {"$ENDELM"}},
                 {"$ELM\n2\n7 2 5 1 3 1 3 2\n9 4 8 1 4 1 2 3 4\n$ENDELM\n",
                  "",
                  F::unreadable_file,
                  {"$ELM", "missing"}},
             });
  const TemporaryFolder folder;
  const Mesh mesh = app::import_mesh(folder.write("good.msh", good));
  EXPECT_EQ(mesh.tets, (std::vector<std::array<Index, 4>>{{0, 1, 2, 3}}));
  EXPECT_EQ(mesh.volumes.at(0).name, "volume-8");
}

const std::string kGoodVtu =
    "<?xml version=\"1.0\"?>\n<VTKFile type=\"UnstructuredGrid\" byte_order=\"LittleEndian\">\n"
    "<UnstructuredGrid><FieldData>\n"
    "<DataArray type=\"Int32\" Name=\"organ\" format=\"ascii\">3</DataArray></FieldData>\n"
    "<Piece NumberOfPoints=\"4\" NumberOfCells=\"1\">\n<Points>\n"
    "<DataArray type=\"Float64\" NumberOfComponents=\"3\" format=\"ascii\">0 0 0 1 0 0 0 1 0 0 0 1"
    "</DataArray></Points><Cells>\n"
    "<DataArray type=\"Int32\" Name=\"connectivity\" format=\"ascii\">0 1 2 3</DataArray>\n"
    "<DataArray type=\"Int64\" Name=\"offsets\" format=\"binary\">CAAAAAQAAAAAAAAA</DataArray>\n"
    "<DataArray type=\"UInt8\" Name=\"types\" format=\"appended\" offset=\"0\"/></Cells>\n"
    "<CellData><DataArray type=\"Int32\" Name=\"volume\" "
    "format=\"ascii\">3</DataArray></CellData>\n"
    "</Piece></UnstructuredGrid>\n<AppendedData encoding=\"base64\">_AQAAAAo=</AppendedData>\n"
    "</VTKFile>\n";

TEST(BadMeshes, VtuCutAnywhere) {
  for (std::size_t cut = 0; cut + 1 < kGoodVtu.size(); ++cut) {
    SCOPED_TRACE(cut);
    expect_input_error(
        [&] { static_cast<void>(app::read_vtu(std::string_view(kGoodVtu).substr(0, cut), "cut")); },
        F::unreadable_file, {"cut"});
  }
}

TEST(BadMeshes, Vtu) {
  expect_all(
      kGoodVtu, "bad.vtu",
      {
          {"<VTKFile", "<VTK", F::unreadable_file, {"<VTKFile>"}},
          {"\"UnstructuredGrid\"", "\"PolyData\"", F::unreadable_file, {"\"PolyData\""}},
          {"LittleEndian\"", "Middle\"", F::unreadable_file, {"\"Middle\"", "BigEndian"}},
          {"\"LittleEndian\"",
           "\"LittleEndian\" compressor=\"vtkLZ4DataCompressor\"",
           F::unreadable_file,
           {"vtkLZ4DataCompressor", "without compression"}},
          {"NumberOfCells=\"1\"", "NumberOfCells=\"2\"", F::unreadable_file, {"1 value;", "2"}},
          {"NumberOfPoints=\"4\"", "NumberOfPoints=\"-4\"", F::unreadable_file, {"bad.vtu:5"}},
          {"NumberOfPoints=\"4\"", "NumberOfPoints=\"5\"", F::unreadable_file, {"12 values", "15"}},
          {"0 0 1</Data",
           "0 0 nan</Data",
           F::out_of_range,
           {"point 3 ", "is not a number", "finite"}},
          {"0 1 2 3<", "0 1 2 4<", F::bad_id, {"cell 0 uses point 4", "0 to 3"}},
          {"0 1 2 3<", "0 1 2 -1<", F::bad_id, {"point -1"}},
          {"0 1 2 3<", "0 1 two 3<", F::unreadable_file, {"connectivity", "\"two\""}},
          {"CAAAAAQAAAAAAAAA", "CAAAAAQAAAA=", F::unreadable_file, {"offsets", "truncated"}},
          {"CAAAAAQAAAAAAAAA", "CAAAA*QAAAAAAAAA", F::unreadable_file, {"offsets", "base64"}},
          {"CAAAAAQAAAAAAAAA", "CAAAAAUAAAAAAAAA", F::unreadable_file, {"offset of cell 0 is 5"}},
          {"_AQAAAAo=", "_AQAAAAw=", F::no_tetrahedra, {"1 solid element that is no tetrahedron"}},
          {"_AQAAAAo=", "_AQAAABg=", F::unreadable_file, {"type 24 has 4 points"}},
          {"offset=\"0\"", "offset=\"99\"", F::unreadable_file, {"types", "truncated"}},
          {"encoding=\"base64\"", "encoding=\"hex\"", F::unreadable_file, {"\"hex\""}},
          {">3</DataArray></CellData>", ">-3</DataArray></CellData>", F::bad_id, {"volume", "-3"}},
          {"</VTKFile>", "</VTK", F::unreadable_file, {"</VTKFile>", "truncated"}},
          {"Name=\"offsets\"", "Name=\"ends\"", F::unreadable_file, {"no array \"offsets\""}},
      });
}

// What is odd but can be used is used, and said.
TEST(BadMeshes, TurnedAndDuplicateElementsAreWarnings) {
  const TemporaryFolder folder;
  std::vector<std::string> warnings;
  const Mesh mesh = app::import_mesh(
      folder.write("turned.msh", with(kGood2, "2 4 2 2 2 1 3 2 5", "2 4 2 2 2 1 2 3 5")),
      &warnings);
  EXPECT_EQ(mesh.tets.at(0), (std::array<Index, 4>{0, 1, 2, 3}));
  EXPECT_TRUE(std::is_permutation(mesh.tets.at(1).begin(), mesh.tets.at(1).end(),
                                  std::array<Index, 4>{0, 1, 2, 4}.begin()));
  EXPECT_NO_THROW(validate(mesh, "turned.msh"));
  ASSERT_EQ(warnings.size(), 1U);
  EXPECT_NE(warnings[0].find("1 element of negative volume was turned"), std::string::npos)
      << warnings[0];
  const Mesh twice = app::import_mesh(
      folder.write("twice.msh", with(kGood2, "2 4 2 2 2 1 3 2 5", "2 4 2 2 2 1 2 3 4")));
  EXPECT_EQ(twice.tet_count(), 2);  // Problem warns
}

TEST(BadMeshes, SecondOrderVtkBesideFirstOrder) {
  const TemporaryFolder folder;
  const auto path = folder.write(
      "mixed.vtk",
      "# vtk DataFile Version 2.0\nt\nASCII\nDATASET UNSTRUCTURED_GRID\nPOINTS 10 double\n"
      "0 0 0 1 0 0 0 1 0 0 0 1 .5 0 0 .5 .5 0 0 .5 0 0 0 .5 .5 0 .5 0 .5 .5\n"
      "CELLS 2 16\n10 0 1 2 3 4 5 6 7 8 9\n4 0 1 2 3\nCELL_TYPES 2\n24\n10\n");
  expect_input_error([&] { static_cast<void>(app::import_mesh(path)); }, F::unreadable_file,
                     {"mixed.vtk", "first and of second order", ".vtu"});
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
  expect_input_error(read(folder.write("abaqus.inp", "*NODE")), F::unreadable_file,
                     {"extension \".inp\"", "does not read it", "convert"});
  expect_input_error(read(folder.file(std::string(300, 'n') + ".msh")), F::unreadable_file,
                     {"nnn...\"", "304 bytes", "up to 255"});
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
  options.tets = 20'000;
  static_cast<void>(app::write_board(options, folder.file("big.mesh")));
  app::ImportLimits hasty;
  hasty.timeout = std::chrono::milliseconds(1);
  expect_input_error(
      [&] { static_cast<void>(app::import_mesh(folder.file("big.mesh"), nullptr, hasty)); },
      F::unreadable_file, {"big.mesh", "took longer than"});
  // What gmsh may not take does not hold up a file that is read without it.
  app::write_file(folder.file("big.msh"), app::to_msh(app::make_board(options), true));
  EXPECT_GT(app::import_mesh(folder.file("big.msh"), nullptr, hasty).tet_count(), 19'000);
}

}  // namespace
}  // namespace sunder::test
