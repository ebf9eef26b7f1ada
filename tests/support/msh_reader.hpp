// SPDX-License-Identifier: Apache-2.0
// Reads the .msh 2.2 ascii meshes of scenes/ without gmsh: nodes, tetrahedra, named volumes.
#pragma once

#include <fstream>
#include <map>
#include <stdexcept>
#include <string>

#include "sunder/mesh.hpp"

namespace sunder::test {

inline Mesh read_msh22(const std::string& file) {
  std::ifstream in(file);
  if (!in) throw std::runtime_error("cannot open " + file);
  Mesh mesh;
  std::map<long, Index> node_of, volume_of_tag;
  std::string word;
  const auto expect = [&](const char* section) {
    while (in >> word)
      if (word == section) return;
    throw std::runtime_error(file + " has no " + section);
  };
  expect("$MeshFormat");
  double version = 0;
  int binary = 1;
  in >> version >> binary;
  if (version != 2.2 || binary != 0) throw std::runtime_error(file + " is not .msh 2.2 ascii");
  expect("$PhysicalNames");
  std::size_t count = 0;
  in >> count;
  for (std::size_t i = 0; i < count; ++i) {
    int dimension = 0, tag = 0;
    in >> dimension >> tag >> word;
    if (dimension != 3) continue;
    volume_of_tag[tag] = static_cast<Index>(mesh.volumes.size());
    mesh.volumes.push_back({word.substr(1, word.size() - 2), tag});
  }
  expect("$Nodes");
  in >> count;
  for (std::size_t i = 0; i < count; ++i) {
    long id = 0;
    Vec3 x;
    in >> id >> x[0] >> x[1] >> x[2];
    node_of[id] = static_cast<Index>(i);
    mesh.nodes.push_back(x);
  }
  expect("$Elements");
  in >> count;
  for (std::size_t i = 0; i < count; ++i) {
    long id = 0, tag = 0, ignored = 0;
    int type = 0, tags = 0;
    in >> id >> type >> tags >> tag;
    for (int t = 1; t < tags; ++t) in >> ignored;
    if (type != 4) {
      std::getline(in, word);
      continue;
    }
    std::array<Index, 4> tet{};
    for (Index& n : tet) {
      in >> id;
      n = node_of.at(id);
    }
    mesh.tets.push_back(tet);
    mesh.volume_of.push_back(volume_of_tag.at(tag));
  }
  if (!in) throw std::runtime_error(file + " is truncated");
  return mesh;
}

}  // namespace sunder::test
