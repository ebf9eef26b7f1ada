// SPDX-License-Identifier: Apache-2.0
// Ids follow the file, whatever its numbers and entities are.
#include <algorithm>
#include <random>

#include "app/input/input_support.hpp"
#include "app/input/mesh_import.hpp"
#include "app/input/same_mesh.hpp"
#include "support/msh_reader.hpp"

namespace sunder::test {
namespace {

const std::string kMeshes = std::string(SUNDER_SCENES) + "/meshes/";

TEST(MeshOrder, BoardsAsInTheirFiles) {
  for (const char* name : {"board1954.msh", "board1954_notch.msh"}) {
    SCOPED_TRACE(name);
    std::vector<std::string> warnings;
    expect_same_mesh(app::import_mesh(kMeshes + name, &warnings), read_msh22(kMeshes + name));
    EXPECT_TRUE(warnings.empty());
  }
}

// Numbers neither consecutive nor ascending, elements of volumes and a surface mixed, an entity
// with two groups: everything at which sorting by number or entity would show.
TEST(MeshOrder, ShuffledNumbersMixedElements) {
  const Mesh board = read_msh22(kMeshes + "board1954.msh");
  std::mt19937 random(7);
  std::vector<int> node_number(board.nodes.size()), element_number(board.tets.size() + 2);
  for (std::size_t i = 0; i < node_number.size(); ++i)
    node_number[i] = 11 + 3 * static_cast<int>(i);
  for (std::size_t e = 0; e < element_number.size(); ++e)
    element_number[e] = 5 + 2 * static_cast<int>(e);
  std::shuffle(node_number.begin(), node_number.end(), random);
  std::shuffle(element_number.begin(), element_number.end(), random);
  std::vector<std::size_t> order(board.tets.size());
  for (std::size_t e = 0; e < order.size(); ++e) order[e] = e;
  std::shuffle(order.begin(), order.end(), random);

  std::ostringstream out;
  out.precision(17);
  out << "$MeshFormat\n2.2 0 8\n$EndMeshFormat\n$PhysicalNames\n5\n2 9 \"skin\"\n";
  for (const NamedVolume& v : board.volumes) out << "3 " << v.tag << " \"" << v.name << "\"\n";
  out << "$EndPhysicalNames\n$Nodes\n" << board.nodes.size() << '\n';
  for (std::size_t i = 0; i < board.nodes.size(); ++i)
    out << node_number[i] << ' ' << board.nodes[i].transpose() << '\n';
  out << "$EndNodes\n$Elements\n" << element_number.size() << '\n';
  Mesh expected = board;
  for (std::size_t k = 0; k < order.size(); ++k) {
    const auto& tet = board.tets[order[k]];
    if (k == 100 || k == 900) {  // triangles between the tetrahedra
      out << element_number[order.size() + (k == 900)] << " 2 2 9 1";
      for (int c = 0; c < 3; ++c) out << ' ' << node_number[static_cast<std::size_t>(tet[c])];
      out << '\n';
      if (expected.surfaces.empty()) expected.surfaces.push_back({"skin", 9, {}});
      expected.surfaces[0].triangles.push_back({tet[0], tet[1], tet[2]});
    }
    // All of one elementary entity: the groups are told by the elements alone.
    const Index volume = board.volume_of[order[k]];
    out << element_number[k] << " 4 2 " << board.volumes[static_cast<std::size_t>(volume)].tag
        << " 1";
    for (const Index node : tet) out << ' ' << node_number[static_cast<std::size_t>(node)];
    out << '\n';
    expected.tets[k] = tet;
    expected.volume_of[k] = volume;
  }
  out << "$EndElements\n";
  const TemporaryFolder folder;
  expect_same_mesh(app::import_mesh(folder.write("shuffled.msh", out.str())), expected);
}

// Three volumes side by side, a surface below; the entities of version 4.1 by their lines.
std::string three_tets_41(const std::string& entities, const std::string& names,
                          const std::string& third = "3") {
  return "$MeshFormat\n4.1 0 8\n$EndMeshFormat\n" + names + entities +
         "$Nodes\n1 6 1 6\n3 1 1 6\n1\n2\n3\n4\n5\n6\n0 0 0 0 0 0\n1 0 0 0 0 0\n0 1 0 0 0 0\n"
         "0 0 1 0 0 0\n0 0 -1 0 0 0\n1 1 1 0 0 0\n$EndNodes\n$Elements\n4 4 1 9\n3 2 4 1\n"
         "9 1 3 2 5\n3 1 4 1\n7 1 2 3 4\n2 5 2 1\n4 1 3 2\n3 " +
         third + " 4 1\n1 2 3 4 6\n$EndElements\n";
}

std::vector<std::pair<std::string, int>> volumes(const Mesh& mesh) {
  std::vector<std::pair<std::string, int>> found;
  for (const Index v : mesh.volume_of) {
    const NamedVolume& volume = mesh.volumes[static_cast<std::size_t>(v)];
    found.emplace_back(volume.name, volume.tag);
  }
  return found;
}

using Named = std::vector<std::pair<std::string, int>>;
const std::string kNames =
    "$PhysicalNames\n3\n3 8 \"left \" inner\n3 2 \"right\"\n2 6 \"skin\"\n$EndPhysicalNames\n";

// Version 4.1 tells groups by entity: of several the smallest counts, a sign is an orientation, an
// element belongs to each surface of its entity.
TEST(MeshOrder, GroupsOfEntities) {
  const TemporaryFolder folder;
  const std::string entities =
      "$Entities\n0 0 1 3\n5 0 0 0 1 1 0 2 -6 7 0\n1 0 0 0 1 1 1 2 8 9 1 5\n"
      "2 0 0 0 1 1 1 1 -2 0\n3 0 0 0 1 1 1 0 0\n$EndEntities\n";
  const Mesh mesh = app::import_mesh(folder.write("groups.msh", three_tets_41(entities, kNames)));
  EXPECT_EQ(volumes(mesh), (Named{{"right", 2}, {"left ", 8}, {"volume", 0}}));
  ASSERT_EQ(mesh.surfaces.size(), 2U);
  EXPECT_EQ(mesh.surfaces[0].name, "skin");
  EXPECT_EQ(mesh.surfaces[1].name, "surface-7");
  for (const NamedSurface& surface : mesh.surfaces)
    EXPECT_EQ(surface.triangles, (std::vector<std::array<Index, 3>>{{0, 2, 1}}));
}

// Without groups the entities are the volumes; a name of a group that nobody has names none.
TEST(MeshOrder, EntitiesWithoutGroups) {
  const TemporaryFolder folder;
  const std::string entities =
      "$Entities\n0 0 1 3\n5 0 0 0 1 1 0 0 0\n1 0 0 0 1 1 1 0 0\n2 0 0 0 1 1 1 0 0\n"
      "3 0 0 0 1 1 1 0 0\n$EndEntities\n";
  for (const std::string& listed : {entities, std::string()}) {
    const Mesh mesh = app::import_mesh(folder.write("none.msh", three_tets_41(listed, kNames)));
    EXPECT_EQ(volumes(mesh), (Named{{"volume-2", 2}, {"volume-1", 1}, {"volume-3", 3}}));
    EXPECT_TRUE(mesh.surfaces.empty());
  }
}

// A partitioned mesh has its elements on parts of entities, which name their groups.
TEST(MeshOrder, GroupsOfPartitionedEntities) {
  const TemporaryFolder folder;
  const std::string entities =
      "$Entities\n0 0 1 2\n5 0 0 0 1 1 0 1 6 0\n1 0 0 0 1 1 1 1 8 0\n2 0 0 0 1 1 1 1 2 0\n"
      "$EndEntities\n$PartitionedEntities\n2\n1\n40 2\n0 0 0 1\n"
      "31 3 1 1 2 0 0 0 1 1 1 1 8 1 5\n$EndPartitionedEntities\n";
  const Mesh mesh =
      app::import_mesh(folder.write("parts.msh", three_tets_41(entities, kNames, "31")));
  EXPECT_EQ(volumes(mesh), (Named{{"right", 2}, {"left ", 8}, {"left ", 8}}));
}

// Version 2.2 tells groups by element: elements of one entity need not share theirs.
TEST(MeshOrder, SurfacesOfOneEntity) {
  const TemporaryFolder folder;
  const Mesh mesh = app::import_mesh(folder.write(
      "surfaces.msh",
      "$MeshFormat\n2.2 0 8\n$EndMeshFormat\n$Nodes\n4\n1 0 0 0\n2 1 0 0\n3 0 1 0\n4 0 0 1\n"
      "$EndNodes\n$Elements\n4\n1 2 2 5 1 1 3 2\n2 2 2 -6 1 1 2 4\n3 2 1 0 1 4 3\n"
      "4 4 4 0 1 1 2 1 2 3 4\n$EndElements\n"));
  ASSERT_EQ(mesh.surfaces.size(), 2U);
  EXPECT_EQ(mesh.surfaces[0].name, "surface-5");
  EXPECT_EQ(mesh.surfaces[0].triangles, (std::vector<std::array<Index, 3>>{{0, 2, 1}}));
  EXPECT_EQ(mesh.surfaces[1].name, "surface-6");
  EXPECT_EQ(mesh.surfaces[1].triangles, (std::vector<std::array<Index, 3>>{{0, 1, 3}}));
}

}  // namespace
}  // namespace sunder::test
