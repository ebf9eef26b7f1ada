// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <limits>
#include <map>
#include <numeric>

#include "app/input/raw_mesh.hpp"
#include "app/input/tag_index.hpp"
#include "sunder/error.hpp"
#include "sunder/words.hpp"

namespace sunder::app {
namespace {

class Converter {
 public:
  Converter(const RawMesh& raw, const MshContents* contents, const std::string& name)
      : raw_(raw),
        contents_(contents),
        name_(name),
        nodes_(raw.node_tags),
        elements_(contents ? std::span<const std::uint64_t>(contents->element_tags)
                           : std::span<const std::uint64_t>()) {}

  Mesh convert() {
    by_element_ = contents_ &&
                  std::any_of(contents_->element_physical.begin(),
                              contents_->element_physical.end(), [](int tag) { return tag != 0; });
    check_solids();
    place_nodes();
    place_volumes();
    place_tets();
    place_surfaces();
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
    if (contents_ && contents_->tetrahedra != raw_.tet_tags.size()) {
      fail(
          InputFault::unreadable_file,
          "holds " +
              count_of(static_cast<long long>(contents_->tetrahedra), "tetrahedron", "tetrahedra") +
              ", of which gmsh read " + std::to_string(raw_.tet_tags.size()));
    }
    constexpr std::size_t kMost = std::numeric_limits<Index>::max() / 4;
    if (raw_.tet_tags.size() > kMost || raw_.node_tags.size() > kMost)
      fail(InputFault::too_large,
           "has more than " + std::to_string(kMost) + " nodes or tetrahedra");
  }

  // Ids by position in the file; gmsh sorts nodes by the entity that they lie on.
  void place_nodes() {
    std::vector<std::size_t> order(raw_.node_tags.size());
    std::iota(order.begin(), order.end(), std::size_t{0});
    if (contents_) {
      const TagIndex in_file(contents_->node_tags);
      sort_by_file(order, raw_.node_tags, in_file);
    }
    node_id_.resize(order.size());
    for (const std::size_t from : order) {
      node_id_[from] = static_cast<Index>(mesh_.nodes.size());
      mesh_.nodes.emplace_back(raw_.coordinates[3 * from], raw_.coordinates[3 * from + 1],
                               raw_.coordinates[3 * from + 2]);
    }
  }

  static void sort_by_file(std::vector<std::size_t>& order, const std::vector<std::uint64_t>& tags,
                           const TagIndex& in_file) {
    const std::size_t behind = std::numeric_limits<std::size_t>::max();
    std::vector<std::size_t> position(tags.size());
    for (std::size_t i = 0; i < tags.size(); ++i)
      position[i] = in_file.find(tags[i]).value_or(behind);
    std::stable_sort(order.begin(), order.end(),
                     [&](std::size_t a, std::size_t b) { return position[a] < position[b]; });
  }

  // Physical tag of the raw tetrahedron i. In version 2.2 it belongs to the element; gmsh keeps
  // it by entity only, which mixes groups up when the entities do not follow them.
  [[nodiscard]] int group_of(std::size_t i) const {
    if (!by_element_) return raw_.tet_group[i];
    const auto position = elements_.find(raw_.tet_tags[i]);
    return position ? contents_->element_physical[*position] : raw_.tet_group[i];
  }

  [[nodiscard]] std::string group_name(int dimension, int tag, const std::string& kind) const {
    for (const RawGroup& group : raw_.groups) {
      if (group.dimension == dimension && group.tag == tag && !group.name.empty())
        return group.name;
    }
    return tag == 0 ? kind : kind + "-" + std::to_string(tag);
  }

  void place_volumes() {
    for (std::size_t i = 0; i < raw_.tet_tags.size(); ++i) volume_of_tag_[group_of(i)] = 0;
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
    return node_id_[*raw];
  }

  void place_tets() {
    std::vector<std::size_t> order(raw_.tet_tags.size());
    std::iota(order.begin(), order.end(), std::size_t{0});
    if (contents_) sort_by_file(order, raw_.tet_tags, elements_);
    for (const std::size_t from : order) {
      std::array<Index, 4> tet{};
      for (std::size_t corner = 0; corner < 4; ++corner)
        tet[corner] = node(raw_.tet_nodes[4 * from + corner], raw_.tet_tags[from]);
      mesh_.tets.push_back(tet);
      mesh_.volume_of.push_back(volume_of_tag_.at(group_of(from)));
    }
  }

  void place_surfaces() {
    std::vector<std::size_t> order(raw_.triangle_tags.size());
    std::iota(order.begin(), order.end(), std::size_t{0});
    if (contents_) sort_by_file(order, raw_.triangle_tags, elements_);
    std::map<int, NamedSurface> surfaces;
    for (const std::size_t from : order) {
      const int tag = raw_.triangle_group[from];
      NamedSurface& surface = surfaces[tag];
      std::array<Index, 3> corners{};
      for (std::size_t corner = 0; corner < 3; ++corner)
        corners[corner] = node(raw_.triangle_nodes[3 * from + corner], raw_.triangle_tags[from]);
      surface.triangles.push_back(corners);
    }
    for (auto& [tag, surface] : surfaces) {
      surface.name = group_name(2, tag, "surface");
      surface.tag = tag;
      mesh_.surfaces.push_back(std::move(surface));
    }
  }

  const RawMesh& raw_;
  const MshContents* contents_;
  const std::string& name_;
  bool by_element_ = false;  // the file gives groups by element
  TagIndex nodes_;           // tag -> raw position
  TagIndex elements_;        // tag -> position in the file
  std::vector<Index> node_id_;
  std::map<int, Index> volume_of_tag_;
  Mesh mesh_;
};

}  // namespace

Mesh to_mesh(const RawMesh& raw, const MshContents* contents, const std::string& name,
             std::vector<std::string>* warnings) {
  Mesh mesh = Converter(raw, contents, name).convert();
  const Turned turned = turn_inverted(mesh);
  validate(mesh, name);
  if (warnings && turned.count > 0) warnings->push_back(name + ": " + sentence(turned));
  drop_unused_nodes(mesh);
  const std::size_t declared = contents ? contents->node_tags.size() : raw.node_tags.size();
  if (warnings && declared > mesh.nodes.size()) {
    const auto dropped = static_cast<long long>(declared - mesh.nodes.size());
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
