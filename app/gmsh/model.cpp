// SPDX-License-Identifier: Apache-2.0
#include "app/gmsh/model.hpp"

#include <gmsh.h>

#include <map>

namespace sunder::app {
namespace {

struct ElementType {
  std::string name;
  int dimension = 0;
  int nodes = 0;
  int corners = 0;
};

ElementType element_type(int type) {
  ElementType result;
  int order = 0;
  std::vector<double> local;
  gmsh::model::mesh::getElementProperties(type, result.name, result.dimension, order, result.nodes,
                                          local, result.corners);
  return result;
}

// Entity tag -> physical tags, of one dimension.
std::map<int, std::vector<int>> groups_by_entity(int dimension, RawMesh& mesh) {
  std::map<int, std::vector<int>> result;
  gmsh::vectorpair groups;
  gmsh::model::getPhysicalGroups(groups, dimension);
  for (const auto& [dim, tag] : groups) {
    RawGroup group{dim, tag, ""};
    gmsh::model::getPhysicalName(dim, tag, group.name);
    mesh.groups.push_back(group);
    std::vector<int> entities;
    gmsh::model::getEntitiesForPhysicalGroup(dim, tag, entities);
    for (const int entity : entities) result[entity].push_back(tag);
  }
  return result;
}

void append_corners(const std::vector<std::size_t>& nodes, const ElementType& type,
                    std::size_t count, std::vector<std::uint64_t>& to) {
  const auto stride = static_cast<std::size_t>(type.nodes);
  for (std::size_t e = 0; e < count; ++e) {
    for (std::size_t c = 0; c < static_cast<std::size_t>(type.corners); ++c)
      to.push_back(nodes.at(e * stride + c));
  }
}

struct Elements {
  std::vector<int> types;
  std::vector<std::vector<std::size_t>> tags, nodes;
  Elements(int dimension, int entity) {
    gmsh::model::mesh::getElements(types, tags, nodes, dimension, entity);
  }
};

void read_volume(int entity, const std::vector<int>& groups, RawMesh& mesh) {
  const Elements elements(3, entity);
  for (std::size_t i = 0; i < elements.types.size(); ++i) {
    const ElementType type = element_type(elements.types[i]);
    const std::size_t count = elements.tags[i].size();
    if (type.corners != 4) {
      if (mesh.other_solids == 0) mesh.other_name = type.name;
      mesh.other_solids += count;
      continue;
    }
    if (type.nodes > 4) mesh.curved += count;
    mesh.tet_tags.insert(mesh.tet_tags.end(), elements.tags[i].begin(), elements.tags[i].end());
    append_corners(elements.nodes[i], type, count, mesh.tet_nodes);
    mesh.tet_group.insert(mesh.tet_group.end(), count, groups.empty() ? 0 : groups.front());
  }
}

void read_surface(int entity, const std::vector<int>& groups, RawMesh& mesh) {
  const Elements elements(2, entity);
  for (std::size_t i = 0; i < elements.types.size(); ++i) {
    const ElementType type = element_type(elements.types[i]);
    if (type.corners != 3) continue;
    const std::size_t count = elements.tags[i].size();
    for (const int group : groups) {
      mesh.triangle_tags.insert(mesh.triangle_tags.end(), elements.tags[i].begin(),
                                elements.tags[i].end());
      append_corners(elements.nodes[i], type, count, mesh.triangle_nodes);
      mesh.triangle_group.insert(mesh.triangle_group.end(), count, group);
    }
  }
}

}  // namespace

RawMesh read_model() {
  RawMesh mesh;
  std::vector<std::size_t> tags;
  std::vector<double> parameters;
  gmsh::model::mesh::getNodes(tags, mesh.coordinates, parameters);
  mesh.node_tags.assign(tags.begin(), tags.end());
  for (const int dimension : {3, 2}) {
    const auto groups = groups_by_entity(dimension, mesh);
    gmsh::vectorpair entities;
    gmsh::model::getEntities(entities, dimension);
    // Formats without groups (.mesh, .bdf) tell their regions by entity.
    const bool by_entity = dimension == 3 && groups.empty() && entities.size() > 1;
    for (const auto& [dim, entity] : entities) {
      const auto found = groups.find(entity);
      std::vector<int> own = found == groups.end() ? std::vector<int>{} : found->second;
      if (by_entity) own = {entity};
      dim == 3 ? read_volume(entity, own, mesh) : read_surface(entity, own, mesh);
    }
  }
  return mesh;
}

}  // namespace sunder::app
