// SPDX-License-Identifier: Apache-2.0
#include "app/mesh_board/msh_writer.hpp"

#include <Eigen/Geometry>

#include <algorithm>
#include <charconv>
#include <cstring>
#include <limits>
#include <numeric>

namespace sunder::app {
namespace {

// Appends numbers: text with separators, or machine words.
class Out {
 public:
  explicit Out(bool ascii) : ascii_(ascii) {}

  void text(std::string_view words) { bytes_ += words; }
  void integer(int value) { ascii_ ? number(value) : raw(value); }
  void size(std::uint64_t value) { ascii_ ? number(value) : raw(value); }
  void real(double value) { ascii_ ? number(value) : raw(value); }
  void end_line() {
    if (ascii_) bytes_.back() = '\n';
  }
  void end_body() {
    if (!ascii_) bytes_ += '\n';
  }
  std::string take() { return std::move(bytes_); }

 private:
  template <class Number>
  void number(Number value) {
    char buffer[32];
    const auto end = std::to_chars(buffer, buffer + sizeof buffer, value).ptr;
    bytes_.append(buffer, end);
    bytes_ += ' ';
  }
  template <class Word>
  void raw(Word value) {
    char buffer[sizeof(Word)];
    std::memcpy(buffer, &value, sizeof(Word));
    bytes_.append(buffer, sizeof(Word));
  }

  std::string bytes_;
  bool ascii_;
};

// The first volume (in their order) that uses each node; a node belongs to one block.
std::vector<Index> volume_of_node(const Mesh& mesh) {
  std::vector<Index> result(mesh.nodes.size(), std::numeric_limits<Index>::max());
  for (std::size_t e = 0; e < mesh.tets.size(); ++e) {
    for (const Index node : mesh.tets[e]) {
      Index& volume = result[static_cast<std::size_t>(node)];
      volume = std::min(volume, mesh.volume_of[e]);
    }
  }
  return result;
}

// Positions by volume, stable.
std::vector<std::vector<Index>> by_volume(const std::vector<Index>& volume_of, std::size_t count) {
  std::vector<std::vector<Index>> result(count);
  for (std::size_t i = 0; i < volume_of.size(); ++i) {
    if (volume_of[i] < static_cast<Index>(count))
      result[static_cast<std::size_t>(volume_of[i])].push_back(static_cast<Index>(i));
  }
  return result;
}

void write_names(Out& out, const Mesh& mesh) {
  out.text("$PhysicalNames\n" + std::to_string(mesh.volumes.size()) + "\n");
  for (const NamedVolume& volume : mesh.volumes)
    out.text("3 " + std::to_string(volume.tag) + " \"" + volume.name + "\"\n");
  out.text("$EndPhysicalNames\n");
}

// One volume entity per named volume, without a boundary; tag = physical tag.
void write_entities(Out& out, const Mesh& mesh) {
  out.text("$Entities\n");
  for (const std::size_t count :
       {std::size_t{0}, std::size_t{0}, std::size_t{0}, mesh.volumes.size()})
    out.size(count);
  out.end_line();
  for (std::size_t v = 0; v < mesh.volumes.size(); ++v) {
    Eigen::AlignedBox3d box;
    for (std::size_t e = 0; e < mesh.tets.size(); ++e) {
      if (mesh.volume_of[e] != static_cast<Index>(v)) continue;
      for (const Index node : mesh.tets[e]) box.extend(mesh.nodes[static_cast<std::size_t>(node)]);
    }
    out.integer(mesh.volumes[v].tag);
    for (int axis = 0; axis < 3; ++axis) out.real(box.min()[axis]);
    for (int axis = 0; axis < 3; ++axis) out.real(box.max()[axis]);
    out.size(1);
    out.integer(mesh.volumes[v].tag);
    out.size(0);
    out.end_line();
  }
  out.end_body();
  out.text("$EndEntities\n");
}

void write_block_head(Out& out, int tag, int flag, std::size_t count) {
  out.integer(3);
  out.integer(tag);
  out.integer(flag);
  out.size(count);
  out.end_line();
}

void write_totals(Out& out, std::size_t blocks, std::size_t count) {
  out.size(blocks);
  out.size(count);
  out.size(1);
  out.size(count);
  out.end_line();
}

void write_nodes(Out& out, const Mesh& mesh) {
  const auto blocks = by_volume(volume_of_node(mesh), mesh.volumes.size());
  out.text("$Nodes\n");
  write_totals(out, blocks.size(), mesh.nodes.size());
  for (std::size_t v = 0; v < blocks.size(); ++v) {
    write_block_head(out, mesh.volumes[v].tag, 0, blocks[v].size());
    for (const Index node : blocks[v]) {
      out.size(static_cast<std::uint64_t>(node) + 1);
      out.end_line();
    }
    for (const Index node : blocks[v]) {
      for (int axis = 0; axis < 3; ++axis)
        out.real(mesh.nodes[static_cast<std::size_t>(node)][axis]);
      out.end_line();
    }
  }
  out.end_body();
  out.text("$EndNodes\n");
}

void write_elements(Out& out, const Mesh& mesh) {
  constexpr int kTetrahedron = 4;
  const auto blocks = by_volume(mesh.volume_of, mesh.volumes.size());
  out.text("$Elements\n");
  write_totals(out, blocks.size(), mesh.tets.size());
  for (std::size_t v = 0; v < blocks.size(); ++v) {
    write_block_head(out, mesh.volumes[v].tag, kTetrahedron, blocks[v].size());
    for (const Index element : blocks[v]) {
      out.size(static_cast<std::uint64_t>(element) + 1);
      for (const Index node : mesh.tets[static_cast<std::size_t>(element)])
        out.size(static_cast<std::uint64_t>(node) + 1);
      out.end_line();
    }
  }
  out.end_body();
  out.text("$EndElements\n");
}

}  // namespace

std::string to_msh(const Mesh& mesh, bool ascii) {
  Out out(ascii);
  out.text(ascii ? "$MeshFormat\n4.1 0 8\n" : "$MeshFormat\n4.1 1 8\n");
  if (!ascii) {
    out.integer(1);  // tells the byte order
    out.end_body();
  }
  out.text("$EndMeshFormat\n");
  write_names(out, mesh);
  write_entities(out, mesh);
  write_nodes(out, mesh);
  write_elements(out, mesh);
  return out.take();
}

void order_by_volume(Mesh& mesh) {
  std::vector<Index> new_id(mesh.nodes.size());
  std::vector<Vec3> nodes;
  for (const auto& block : by_volume(volume_of_node(mesh), mesh.volumes.size())) {
    for (const Index node : block) {
      new_id[static_cast<std::size_t>(node)] = static_cast<Index>(nodes.size());
      nodes.push_back(mesh.nodes[static_cast<std::size_t>(node)]);
    }
  }
  Mesh ordered;
  ordered.nodes = std::move(nodes);
  ordered.volumes = mesh.volumes;
  for (const auto& block : by_volume(mesh.volume_of, mesh.volumes.size())) {
    for (const Index element : block) {
      std::array<Index, 4> tet = mesh.tets[static_cast<std::size_t>(element)];
      for (Index& node : tet) node = new_id[static_cast<std::size_t>(node)];
      ordered.tets.push_back(tet);
      ordered.volume_of.push_back(mesh.volume_of[static_cast<std::size_t>(element)]);
    }
  }
  mesh = std::move(ordered);
}

}  // namespace sunder::app
