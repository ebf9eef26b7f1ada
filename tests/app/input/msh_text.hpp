// SPDX-License-Identifier: Apache-2.0
// Writers of .msh 2.2 for tests: what other programs write and the board generator does not.
#pragma once

#include <cstring>
#include <sstream>
#include <string>

#include "sunder/mesh.hpp"

namespace sunder::test {

template <class Word>
void append_raw(std::string& bytes, Word word) {
  char buffer[sizeof(Word)];
  std::memcpy(buffer, &word, sizeof(Word));
  bytes.append(buffer, sizeof(Word));
}

inline std::string msh22_names(const Mesh& mesh) {
  std::ostringstream out;
  out << "$PhysicalNames\n" << mesh.volumes.size() << '\n';
  for (const NamedVolume& volume : mesh.volumes)
    out << "3 " << volume.tag << " \"" << volume.name << "\"\n";
  out << "$EndPhysicalNames\n";
  return out.str();
}

inline std::string to_msh22_ascii(const Mesh& mesh) {
  std::ostringstream out;
  out.precision(17);
  out << "$MeshFormat\n2.2 0 8\n$EndMeshFormat\n" << msh22_names(mesh);
  out << "$Nodes\n" << mesh.nodes.size() << '\n';
  for (std::size_t i = 0; i < mesh.nodes.size(); ++i)
    out << i + 1 << ' ' << mesh.nodes[i].transpose() << '\n';
  out << "$EndNodes\n$Elements\n" << mesh.tets.size() << '\n';
  for (std::size_t e = 0; e < mesh.tets.size(); ++e) {
    const int tag = mesh.volumes[static_cast<std::size_t>(mesh.volume_of[e])].tag;
    out << e + 1 << " 4 2 " << tag << ' ' << tag;
    for (const Index node : mesh.tets[e]) out << ' ' << node + 1;
    out << '\n';
  }
  out << "$EndElements\n";
  return out.str();
}

inline std::string to_msh22_binary(const Mesh& mesh) {
  std::string out = "$MeshFormat\n2.2 1 8\n";
  append_raw(out, 1);
  out += "\n$EndMeshFormat\n" + msh22_names(mesh);
  out += "$Nodes\n" + std::to_string(mesh.nodes.size()) + "\n";
  for (std::size_t i = 0; i < mesh.nodes.size(); ++i) {
    append_raw(out, static_cast<int>(i + 1));
    for (int axis = 0; axis < 3; ++axis) append_raw(out, mesh.nodes[i][axis]);
  }
  out += "\n$EndNodes\n$Elements\n" + std::to_string(mesh.tets.size()) + "\n";
  append_raw(out, 4);
  append_raw(out, static_cast<int>(mesh.tets.size()));
  append_raw(out, 2);
  for (std::size_t e = 0; e < mesh.tets.size(); ++e) {
    const int tag = mesh.volumes[static_cast<std::size_t>(mesh.volume_of[e])].tag;
    append_raw(out, static_cast<int>(e + 1));
    append_raw(out, tag);
    append_raw(out, tag);
    for (const Index node : mesh.tets[e]) append_raw(out, node + 1);
  }
  out += "\n$EndElements\n";
  return out;
}

}  // namespace sunder::test
