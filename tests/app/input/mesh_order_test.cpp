// SPDX-License-Identifier: Apache-2.0
// Ids follow the file: gmsh sorts by entity, the importer puts back.
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

}  // namespace
}  // namespace sunder::test
