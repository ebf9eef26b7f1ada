// SPDX-License-Identifier: Apache-2.0
#include "app/input/msh_contents.hpp"

#include <array>

namespace sunder::app {
namespace {

using S = MshType::Shape;

// By number from 1 (gmsh reference manual, "MSH file format").
constexpr std::array<MshType, kLastMshType> kTypes = {{
    {2, S::other},        {3, S::triangle},     {4, S::other},        {4, S::tetrahedron},
    {8, S::hexahedron},   {6, S::prism},        {5, S::pyramid},      {3, S::other},
    {6, S::triangle},     {9, S::other},        {10, S::tetrahedron}, {27, S::hexahedron},
    {18, S::prism},       {14, S::pyramid},     {1, S::other},        {8, S::other},
    {20, S::hexahedron},  {15, S::prism},       {13, S::pyramid},     {9, S::triangle},
    {10, S::triangle},    {12, S::triangle},    {15, S::triangle},    {15, S::triangle},
    {21, S::triangle},    {4, S::other},        {5, S::other},        {6, S::other},
    {20, S::tetrahedron}, {35, S::tetrahedron}, {56, S::tetrahedron},
}};

}  // namespace

std::string MshType::name() const {
  const char* word = shape == S::tetrahedron  ? "Tetrahedron "
                     : shape == S::hexahedron ? "Hexahedron "
                     : shape == S::prism      ? "Prism "
                                              : "Pyramid ";
  return word + std::to_string(nodes);
}

const MshType* msh_type(int number) {
  const bool known = number > 0 && number <= kLastMshType;
  return known ? &kTypes[static_cast<std::size_t>(number) - 1] : nullptr;
}

// Of elements of higher order the corners come first.
void MshContents::add(const MshElement& element) {
  element_tags.push_back(element.tag);
  if (element.type.solid()) volume_entities.insert(element.entity);
  if (element.type.shape == S::tetrahedron) {
    mesh.tet_tags.push_back(element.tag);
    mesh.tet_nodes.insert(mesh.tet_nodes.end(), element.nodes.begin(), element.nodes.begin() + 4);
    mesh.tet_group.push_back(element.groups.empty() ? 0 : element.groups.front());
    tet_entity.push_back(element.entity);
    if (element.nodes.size() > 4) ++mesh.curved;
  } else if (element.type.shape == S::triangle) {
    for (const int group : element.groups) {
      mesh.triangle_tags.push_back(element.tag);
      mesh.triangle_nodes.insert(mesh.triangle_nodes.end(), element.nodes.begin(),
                                 element.nodes.begin() + 3);
      mesh.triangle_group.push_back(group);
    }
  } else if (element.type.solid()) {
    if (mesh.other_solids++ == 0) mesh.other_name = element.type.name();
  }
}

void MshContents::finish() {
  if (grouped || volume_entities.size() < 2) return;
  mesh.tet_group = tet_entity;
  std::erase_if(mesh.groups, [](const RawGroup& group) { return group.dimension == 3; });
}

}  // namespace sunder::app
