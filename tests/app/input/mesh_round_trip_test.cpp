// SPDX-License-Identifier: Apache-2.0
// The same mesh through every format, written by gmsh and by ourselves.
#include <gmsh.h>
#include <zlib.h>

#include <cmath>

#include "app/input/child_process.hpp"
#include "app/input/input_support.hpp"
#include "app/input/mesh_import.hpp"
#include "app/input/msh_text.hpp"
#include "app/input/same_mesh.hpp"
#include "app/mesh_board/msh_writer.hpp"
#include "app/mesh_board/structured_board.hpp"
#include "app/output/result_file.hpp"
#include "app/output/vtu.hpp"
#include "sunder/problem.hpp"

namespace sunder::test {
namespace {

const std::string kBoard = std::string(SUNDER_SCENES) + "/meshes/board1954_notch.msh";

// gmsh is let into a child only: it keeps state and ends processes.
void rewrite_with_gmsh(const std::string& from, const std::string& to, double version,
                       bool binary) {
  const auto work = [&]() -> std::string {
    gmsh::initialize(0, nullptr, false);
    gmsh::option::setNumber("Mesh.MshFileVersion", version);
    gmsh::option::setNumber("Mesh.Binary", binary ? 1 : 0);
    gmsh::open(from);
    gmsh::write(to);
    return "written";
  };
  ASSERT_EQ(app::run_in_child(work, {}).result, "written");
}

// The notched board in the order in which gmsh writes nodes and elements, so that copies keep it.
std::string ordered_board(const TemporaryFolder& folder) {
  const std::string file = folder.file("ordered.msh");
  rewrite_with_gmsh(kBoard, file, 2.2, false);
  return file;
}

TEST(MeshRoundTrip, MshOfBothVersionsAsciiAndBinary) {
  const TemporaryFolder folder;
  const std::string board = ordered_board(folder);
  const Mesh original = app::import_mesh(board);
  for (const double version : {2.2, 4.1}) {
    for (const bool binary : {false, true}) {
      SCOPED_TRACE(std::to_string(version) + (binary ? " binary" : " ascii"));
      const std::string file = folder.file("copy.msh");
      rewrite_with_gmsh(board, file, version, binary);
      expect_same_mesh(app::import_mesh(file), original);
    }
  }
}

TEST(MeshRoundTrip, VtkKeepsTagsButNotNames) {
  const TemporaryFolder folder;
  const std::string board = ordered_board(folder);
  Mesh expected = app::import_mesh(board);
  for (NamedVolume& volume : expected.volumes) volume.name = "volume-" + std::to_string(volume.tag);
  for (const bool binary : {false, true}) {
    SCOPED_TRACE(binary ? "binary" : "ascii");
    const std::string file = folder.file("copy.vtk");
    rewrite_with_gmsh(board, file, 4.1, binary);
    expect_same_mesh(app::import_mesh(file), expected);
  }
}

// .unv, .mesh and .bdf round coordinates; the rest must agree.
TEST(MeshRoundTrip, FormatsThatRoundCoordinates) {
  const TemporaryFolder folder;
  const std::string board = ordered_board(folder);
  const Mesh original = app::import_mesh(board);
  for (const char* name : {"copy.unv", "copy.mesh", "copy.bdf"}) {
    SCOPED_TRACE(name);
    rewrite_with_gmsh(board, folder.file(name), 4.1, false);
    const Mesh copy = app::import_mesh(folder.file(name));
    EXPECT_EQ(copy.tets, original.tets);
    EXPECT_EQ(copy.volume_of, original.volume_of);
    ASSERT_EQ(copy.nodes.size(), original.nodes.size());
    // .bdf cuts 50 mm off to fields of eight characters: under 1e-5 in each coordinate.
    for (std::size_t i = 0; i < copy.nodes.size(); ++i)
      ASSERT_TRUE((copy.nodes[i] - original.nodes[i]).norm() <= 2e-5) << i;
  }
}

TEST(MeshRoundTrip, OurOwnWriters) {
  const TemporaryFolder folder;
  const Mesh board = app::structured_board({3, 5, 2}, 2.0);
  for (const std::string& bytes : {app::to_msh(board, true), app::to_msh(board, false),
                                   to_msh22_ascii(board), to_msh22_binary(board)})
    expect_same_mesh(app::import_mesh(folder.write("own.msh", bytes)), board);
}

// Byte order of the other kind: swap every word of a binary file of version 2.2.
TEST(MeshRoundTrip, SwappedBytes) {
  const Mesh board = app::structured_board({1, 4, 1}, 2.0);
  std::string bytes = to_msh22_binary(board);
  const auto swap_words = [&](std::size_t at, std::size_t count, std::size_t size) {
    for (std::size_t i = 0; i < count; ++i)
      std::reverse(bytes.begin() + static_cast<std::ptrdiff_t>(at + i * size),
                   bytes.begin() + static_cast<std::ptrdiff_t>(at + (i + 1) * size));
  };
  swap_words(bytes.find("2.2 1 8\n") + 8, 1, 4);
  std::size_t at = bytes.find("$Nodes\n") + 7;
  at = bytes.find('\n', at) + 1;
  for (std::size_t i = 0; i < board.nodes.size(); ++i) {
    swap_words(at, 1, 4);
    swap_words(at + 4, 3, 8);
    at += 28;
  }
  at = bytes.find("$Elements\n") + 10;
  at = bytes.find('\n', at) + 1;
  swap_words(at, 3 + board.tets.size() * 7, 4);
  const TemporaryFolder folder;
  expect_same_mesh(app::import_mesh(folder.write("swapped.msh", bytes)), board);
}

// result.vtu, as `sunder run` writes it, is a mesh file too: names, tags, ids, every bit.
TEST(MeshRoundTrip, ResultFilesOfSunder) {
  Scene scene;
  scene.mesh = app::structured_board({2, 4, 1}, 2.0);
  for (const NamedVolume& volume : scene.mesh.volumes) scene.materials[volume.name] = {5, 0.3, {}};
  scene.supports.push_back({Box{Vec3(-1, 49, -1), Vec3(51, 51, 3)}, Axes{7}});
  const Problem problem(std::move(scene));
  app::State state;
  state.displacement.assign(problem.mesh().nodes.size(), Vec3(1, 2, 3));
  state.destroyed.assign(problem.mesh().tets.size(), 0);
  const TemporaryFolder folder;
  app::ResultFile file(folder.file("result.vtu"));
  app::write_vtu(file, problem, state);
  file.commit();
  expect_same_mesh(app::import_mesh(folder.file("result.vtu")), problem.mesh());
}

// Directions of fibres that a run has written are a field for the next.
TEST(MeshRoundTrip, DirectionsOfFibresComeBack) {
  Scene scene;
  scene.mesh = app::structured_board({2, 4, 1}, 2.0);
  for (const NamedVolume& volume : scene.mesh.volumes) {
    Material& m = scene.materials[volume.name] = {5, 0.3, {}, MaterialLaw::corotated};
    Fibres f;
    f.k1 = f.k2 = 1;
    f.direction = AroundAxis{Vec3(-9, 3, 0), Vec3(0, 0, 2)};
    m.fibres.push_back(f);
    f.direction = Vec3(0, 3, 4);
    m.fibres.push_back(f);
  }
  scene.supports.push_back({Box{Vec3(-1, 49, -1), Vec3(51, 51, 3)}, Axes{7}});
  const Problem first(scene);
  app::State state;
  state.displacement.assign(first.mesh().nodes.size(), Vec3(1, 2, 3));
  state.destroyed.assign(first.mesh().tets.size(), 0);
  const TemporaryFolder folder;
  app::ResultFile file(folder.file("result.vtu"));
  app::write_vtu(file, first, state);
  file.commit();
  scene.mesh = app::import_mesh(folder.file("result.vtu"));
  ASSERT_TRUE(scene.mesh.fields.contains("fibres"));
  for (auto& [name, material] : scene.materials) {
    material.fibres[0].direction = FieldName{"fibres"};
    material.fibres[1].direction = FieldName{"fibres_2"};
  }
  const Problem second(scene);
  for (Index e = 0; e < first.tet_count(); ++e) {
    for (const int family : {0, 1}) {
      EXPECT_LT((second.fibre_direction(e, family) - first.fibre_direction(e, family)).norm(),
                1e-15);
    }
  }
  EXPECT_EQ(second.fibre_direction(0, 1), Vec3(0, 0.6, 0.8));
}

// As VTK's own writer does it (vtkXMLUnstructuredGridWriter, appended raw, zlib, UInt32): one
// tetrahedron of float coordinates, big-endian and little-endian.
TEST(MeshRoundTrip, CompressedRawAppendedVtu) {
  for (const bool big : {false, true}) {
    const auto word = [&](auto value) {
      std::string bytes;
      append_raw(bytes, value);
      if (big) std::reverse(bytes.begin(), bytes.end());
      return bytes;
    };
    std::string appended;
    const auto append = [&](const std::string& bytes) {
      const std::size_t at = appended.size();
      std::string packed(bytes.size() + 100, '\0');
      uLongf size = static_cast<uLongf>(packed.size());
      ::compress(reinterpret_cast<Bytef*>(packed.data()), &size,
                 reinterpret_cast<const Bytef*>(bytes.data()), static_cast<uLong>(bytes.size()));
      for (const std::size_t n :
           {std::size_t{1}, std::size_t{32768}, bytes.size(), std::size_t{size}})
        appended += word(static_cast<std::uint32_t>(n));
      appended += packed.substr(0, size);
      return std::to_string(at);
    };
    std::string points, nodes;
    for (const float x : {0.f, 0.f, 0.f, 1.f, 0.f, 0.f, 0.f, 1.f, 0.f, 0.f, 0.f, 1.f})
      points += word(x);
    for (const std::int64_t n : {0, 1, 2, 3}) nodes += word(n);
    const std::string at_points = append(points), at_nodes = append(nodes);
    const std::string at_offsets = append(word(std::int64_t{4}));
    const std::string at_types = append(std::string(1, '\x0a'));
    const std::string head =
        std::string("<VTKFile type=\"UnstructuredGrid\" byte_order=\"") +
        (big ? "BigEndian" : "LittleEndian") +
        "\" header_type=\"UInt32\" compressor=\"vtkZLibDataCompressor\"><UnstructuredGrid><Piece "
        "NumberOfPoints=\"4\" NumberOfCells=\"1\"><Points><DataArray type=\"Float32\" "
        "NumberOfComponents=\"3\" format=\"appended\" offset=\"" +
        at_points +
        "\"/></Points><Cells><DataArray type=\"Int64\" Name=\"connectivity\" format=\"appended\" "
        "offset=\"" +
        at_nodes + "\"/><DataArray type=\"Int64\" Name=\"offsets\" format=\"appended\" offset=\"" +
        at_offsets + "\"/><DataArray type=\"UInt8\" Name=\"types\" format=\"appended\" offset=\"" +
        at_types + "\"/></Cells></Piece></UnstructuredGrid><AppendedData encoding=\"raw\">_";
    const TemporaryFolder folder;
    const std::string tail = "</AppendedData></VTKFile>";
    const Mesh mesh = app::import_mesh(folder.write("vtk.vtu", head + appended + tail));
    EXPECT_EQ(mesh.nodes.at(3), Vec3(0, 0, 1));
    EXPECT_EQ(mesh.tets, (std::vector<std::array<Index, 4>>{{0, 1, 2, 3}}));
    appended[appended.size() - 6] = static_cast<char>(appended[appended.size() - 6] ^ 0x55);
    expect_input_error(
        [&] {
          static_cast<void>(app::import_mesh(folder.write("bad.vtu", head + appended + tail)));
        },
        InputFault::unreadable_file, {"bad.vtu", "types", "compressed block"});
  }
}

TEST(MeshRoundTrip, SurfacesCurvedTetsAndUnusedNodes) {
  const std::string text =
      "$MeshFormat\n2.2 0 8\n$EndMeshFormat\n$PhysicalNames\n2\n2 4 \"base\"\n3 7 \"body\"\n"
      "$EndPhysicalNames\n$Nodes\n11\n1 0 0 0\n2 1 0 0\n3 0 1 0\n4 0 0 1\n5 .5 0 0\n6 .5 .5 0\n"
      "7 0 .5 0\n8 0 0 .5\n9 .5 0 .5\n10 0 .5 .5\n11 9 9 9\n$EndNodes\n$Elements\n2\n"
      "1 2 2 4 1 1 3 2\n2 11 2 7 1 1 2 3 4 5 6 7 8 10 9\n$EndElements\n";
  const TemporaryFolder folder;
  std::vector<std::string> warnings;
  const Mesh mesh = app::import_mesh(folder.write("curved.msh", text), &warnings);
  EXPECT_EQ(mesh.node_count(), 4);
  ASSERT_EQ(mesh.tet_count(), 1);
  EXPECT_EQ(mesh.tets[0], (std::array<Index, 4>{0, 1, 2, 3}));
  EXPECT_EQ(mesh.volumes.at(0).name, "body");
  ASSERT_EQ(mesh.surfaces.size(), 1U);
  EXPECT_EQ(mesh.surfaces[0].name, "base");
  EXPECT_EQ(mesh.surfaces[0].triangles.at(0), (std::array<Index, 3>{0, 2, 1}));
  ASSERT_EQ(warnings.size(), 2U);
  EXPECT_NE(warnings[0].find("7 nodes"), std::string::npos) << warnings[0];
  EXPECT_NE(warnings[1].find("higher order"), std::string::npos) << warnings[1];
}

TEST(MeshRoundTrip, VolumesWithoutNameOrGroup) {
  const TemporaryFolder folder;
  const Mesh board = app::structured_board({1, 4, 1}, 2.0);
  std::string text = to_msh22_ascii(board);
  const std::size_t names = text.find("$PhysicalNames");
  text.erase(names, text.find("$Nodes") - names);
  const Mesh unnamed = app::import_mesh(folder.write("unnamed.msh", text));
  ASSERT_EQ(unnamed.volumes.size(), 4U);
  EXPECT_EQ(unnamed.volumes[1].name, "volume-2");

  const std::string one =
      "$MeshFormat\n2.2 0 8\n$EndMeshFormat\n$Nodes\n4\n1 0 0 0\n2 1 0 0\n3 0 1 0\n4 0 0 1\n"
      "$EndNodes\n$Elements\n1\n1 4 2 0 1 1 2 3 4\n$EndElements\n";
  const Mesh groupless = app::import_mesh(folder.write("one.msh", one));
  ASSERT_EQ(groupless.volumes.size(), 1U);
  EXPECT_EQ(groupless.volumes[0].name, "volume");
  EXPECT_EQ(groupless.volumes[0].tag, 0);
}

}  // namespace
}  // namespace sunder::test
