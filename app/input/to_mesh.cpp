// SPDX-License-Identifier: Apache-2.0
#include <limits>
#include <map>

#include "app/input/raw_mesh.hpp"
#include "app/input/tag_index.hpp"
#include "sunder/error.hpp"
#include "sunder/words.hpp"

namespace sunder::app {
namespace {

class Converter {
 public:
  Converter(const RawMesh& raw, const std::string& name)
      : raw_(raw), name_(name), nodes_(raw.node_tags) {}

  Mesh convert() {
    check_solids();
    place_nodes();
    place_volumes();
    place_tets();
    place_surfaces();
    mesh_.fields = raw_.fields;
    return std::move(mesh_);
  }

 private:
  [[noreturn]] void fail(InputFault fault, const std::string& message) const {
    throw InputError(fault, name_ + ": " + message);
  }

  static std::string solids(std::uint64_t count) {
    return count_of(static_cast<long long>(count), "solid element that is no tetrahedron",
                    "solid elements that are no tetrahedra");
  }

  void check_solids() const {
    if (raw_.other_solids > 0) {
      fail(raw_.tet_tags.empty() ? InputFault::no_tetrahedra : InputFault::unreadable_file,
           "has " + solids(raw_.other_solids) + " (" + raw_.other_name + "); allowed: tetrahedra");
    }
    if (raw_.tet_tags.empty()) fail(InputFault::no_tetrahedra, "has no tetrahedra");
    constexpr std::size_t kMost = std::numeric_limits<Index>::max() / 4;
    if (raw_.tet_tags.size() > kMost || raw_.node_tags.size() > kMost)
      fail(InputFault::too_large,
           "has more than " + std::to_string(kMost) + " nodes or tetrahedra");
  }

  void place_nodes() {
    mesh_.nodes.reserve(raw_.node_tags.size());
    for (std::size_t i = 0; i < raw_.coordinates.size(); i += 3)
      mesh_.nodes.emplace_back(raw_.coordinates[i], raw_.coordinates[i + 1],
                               raw_.coordinates[i + 2]);
  }

  [[nodiscard]] std::string group_name(int dimension, int tag, const std::string& kind) const {
    for (const RawGroup& group : raw_.groups) {
      if (group.dimension == dimension && group.tag == tag && !group.name.empty())
        return group.name;
    }
    return tag == 0 ? kind : kind + "-" + std::to_string(tag);
  }

  void place_volumes() {
    for (const int tag : raw_.tet_group) volume_of_tag_[tag] = 0;
    for (auto& [tag, index] : volume_of_tag_) {
      index = static_cast<Index>(mesh_.volumes.size());
      mesh_.volumes.push_back({group_name(3, tag, "volume"), tag});
    }
  }

  [[nodiscard]] Index node(std::uint64_t tag, std::uint64_t element) const {
    const auto raw = nodes_.find(tag);
    if (!raw)
      fail(InputFault::bad_id, "element " + std::to_string(element) + " uses node " +
                                   std::to_string(tag) + ", which the file does not have");
    return static_cast<Index>(*raw);
  }

  void place_tets() {
    for (std::size_t e = 0; e < raw_.tet_tags.size(); ++e) {
      std::array<Index, 4> tet{};
      for (std::size_t corner = 0; corner < 4; ++corner)
        tet[corner] = node(raw_.tet_nodes[4 * e + corner], raw_.tet_tags[e]);
      mesh_.tets.push_back(tet);
      mesh_.volume_of.push_back(volume_of_tag_.at(raw_.tet_group[e]));
    }
  }

  void place_surfaces() {
    std::map<int, NamedSurface> surfaces;
    for (std::size_t t = 0; t < raw_.triangle_tags.size(); ++t) {
      NamedSurface& surface = surfaces[raw_.triangle_group[t]];
      std::array<Index, 3> corners{};
      for (std::size_t corner = 0; corner < 3; ++corner)
        corners[corner] = node(raw_.triangle_nodes[3 * t + corner], raw_.triangle_tags[t]);
      surface.triangles.push_back(corners);
    }
    for (auto& [tag, surface] : surfaces) {
      surface.name = group_name(2, tag, "surface");
      surface.tag = tag;
      mesh_.surfaces.push_back(std::move(surface));
    }
  }

  const RawMesh& raw_;
  const std::string& name_;
  TagIndex nodes_;  // tag -> id
  std::map<int, Index> volume_of_tag_;
  Mesh mesh_;
};

}  // namespace

Mesh to_mesh(const RawMesh& raw, const std::string& name, std::vector<std::string>* warnings) {
  Mesh mesh = Converter(raw, name).convert();
  const Turned turned = turn_inverted(mesh);
  validate(mesh, name);
  if (warnings && turned.count > 0) warnings->push_back(name + ": " + sentence(turned));
  drop_unused_nodes(mesh);
  if (warnings && raw.node_tags.size() > mesh.nodes.size()) {
    const auto dropped = static_cast<long long>(raw.node_tags.size() - mesh.nodes.size());
    warnings->push_back(name + ": dropped " + count_of(dropped, "node") +
                        " that no tetrahedron uses");
  }
  if (warnings && raw.curved > 0) {
    warnings->push_back(name + ": " +
                        count_of(static_cast<long long>(raw.curved),
                                 "tetrahedron of higher order is used with its",
                                 "tetrahedra of higher order are used with their") +
                        " four corner nodes only");
  }
  return mesh;
}

}  // namespace sunder::app
