// SPDX-License-Identifier: Apache-2.0
#include "app/input/msh_sections.hpp"

#include <algorithm>
#include <array>
#include <cstdlib>
#include <limits>
#include <set>
#include <span>

#include "app/input/tag_index.hpp"
#include "sunder/words.hpp"

namespace sunder::app {
namespace {

/// A node or element tag; fails outside 1 ... 2^31 - 1.
std::uint64_t checked_tag(const MshCursor& cursor, std::uint64_t tag, const char* what) {
  constexpr std::uint64_t kLargest = std::numeric_limits<std::int32_t>::max();
  if (tag < 1 || tag > kLargest)
    cursor.fail(std::string(what) + " is " + std::to_string(tag) + "; allowed: 1 to " +
                    std::to_string(kLargest),
                InputFault::bad_id);
  return tag;
}

std::uint64_t checked_tag(const MshCursor& cursor, std::int64_t tag, const char* what) {
  if (tag < 0)
    cursor.fail(std::string(what) + " is " + std::to_string(tag) + "; allowed: 1 to " +
                    std::to_string(std::numeric_limits<std::int32_t>::max()),
                InputFault::bad_id);
  return checked_tag(cursor, static_cast<std::uint64_t>(tag), what);
}

/// Fails when a tag occurs twice.
void check_unique(const MshCursor& cursor, const std::vector<std::uint64_t>& tags,
                  const char* what) {
  if (const auto twice = TagIndex(tags).duplicate())
    cursor.fail(std::string(what) + " " + std::to_string(*twice) + " occurs twice",
                InputFault::bad_id);
}

MshType type_of(const MshCursor& cursor, int number) {
  const MshType* type = msh_type(number);
  if (!type)
    cursor.fail("element type " + std::to_string(number) + " is not known; allowed: 1 to " +
                std::to_string(kLastMshType));
  return *type;
}

/// Its sign tells an orientation, which makes no difference here.
int group_of(const MshCursor& cursor, int tag) {
  if (tag == std::numeric_limits<int>::min())
    cursor.fail("a physical group is " + std::to_string(tag) + ", too large a number",
                InputFault::bad_id);
  return std::abs(tag);
}

using ElementNodes = std::array<std::uint64_t, kMostMshNodes>;

std::uint64_t read_tag(MshCursor& cursor, const char* what) {
  return checked_tag(cursor, cursor.size(what), what);
}

// All must have been declared.
std::span<const std::uint64_t> read_element_nodes_2(MshCursor& cursor, const TagIndex& nodes,
                                                    std::uint64_t element, int count,
                                                    const char* section, ElementNodes& read) {
  for (std::size_t i = 0; i < static_cast<std::size_t>(count); ++i) {
    const int node = cursor.int32("a node of an element");
    if (node < 1 || !nodes.find(static_cast<std::uint64_t>(node)))
      cursor.fail("element " + std::to_string(element) + " uses node " + std::to_string(node) +
                      ", which " + section + " does not have",
                  InputFault::bad_id);
    read[i] = static_cast<std::uint64_t>(node);
  }
  return {read.data(), static_cast<std::size_t>(count)};
}

/// With its group, 0: none.
void add_2(MshContents& contents, MshElement element, int group) {
  if (group != 0) {
    element.groups = {&group, 1};
    contents.grouped = true;
  }
  contents.add(element);
}

struct Header2 {
  int type = 0;
  int tags = 0;
};

void check_header_2(const MshCursor& cursor, const Header2& header) {
  if (header.tags < 0 || header.tags > 1000)
    cursor.fail("an element has " + std::to_string(header.tags) + " tags; allowed: 0 to 1000");
}

// The first tag is the physical group, the second the entity.
void read_element_2(MshCursor& cursor, const TagIndex& nodes, MshContents& contents,
                    std::uint64_t number, const Header2& header) {
  int group = 0;
  MshElement element{number, {}, {}, {}, 1};
  for (int i = 0; i < header.tags; ++i) {
    const int tag = cursor.int32("a tag of an element");
    if (i == 0) group = group_of(cursor, tag);
    if (i == 1) element.entity = tag;
  }
  element.type = type_of(cursor, header.type);
  ElementNodes read;
  element.nodes = read_element_nodes_2(cursor, nodes, number, element.type.nodes, "$Nodes", read);
  add_2(contents, element, group);
}

std::uint64_t element_number_2(MshCursor& cursor) {
  return checked_tag(cursor, std::int64_t{cursor.int32("an element number")}, "an element number");
}

// Binary elements come in runs of one type.
void read_runs_2(MshCursor& cursor, const TagIndex& nodes, MshContents& contents,
                 std::uint64_t count) {
  while (contents.element_tags.size() < count) {
    Header2 header;
    header.type = cursor.int32("an element type");
    const int run = cursor.int32("a number of elements");
    header.tags = cursor.int32("a number of tags");
    check_header_2(cursor, header);
    if (run < 1 || static_cast<std::uint64_t>(run) > count - contents.element_tags.size())
      cursor.fail("a run of " + count_of(run, "element") + " does not fit the " +
                  std::to_string(count) + " declared");
    for (int i = 0; i < run; ++i)
      read_element_2(cursor, nodes, contents, element_number_2(cursor), header);
  }
}

template <class Use>
void read_tags_4(MshCursor& cursor, const char* what, const Use& use) {
  const std::uint64_t count = cursor.size("a number of tags");
  if (count > cursor.remaining())
    cursor.fail("an entity has " + count_of(static_cast<long long>(count), "tag") +
                ", more than the file can hold");
  for (std::uint64_t i = 0; i < count; ++i) use(cursor.int32(what));
}

constexpr auto kSkip = [](int) {};

void read_entity_4(MshCursor& cursor, MshContents& contents, int dimension, bool part) {
  const int tag = cursor.int32("an entity tag");
  if (part) {
    static_cast<void>(cursor.int32("the dimension of a parent entity"));
    static_cast<void>(cursor.int32("the tag of a parent entity"));
    read_tags_4(cursor, "a partition", kSkip);
  }
  const int bounds = dimension == 0 ? 3 : 6;  // a point's place, or a bounding box
  for (int i = 0; i < bounds; ++i) static_cast<void>(cursor.real("an entity's bound"));
  std::set<int> groups;
  read_tags_4(cursor, "a physical tag", [&](int group) { groups.insert(group_of(cursor, group)); });
  if (dimension > 0) read_tags_4(cursor, "a bounding entity", kSkip);
  contents.groups_of_entity[{dimension, tag}].assign(groups.begin(), groups.end());
  if (dimension < 3) return;
  contents.volume_entities.insert(tag);
  if (!groups.empty()) contents.grouped = true;
}

void read_all_entities_4(MshCursor& cursor, MshContents& contents, bool parts) {
  std::array<std::uint64_t, 4> counts{};
  for (std::uint64_t& count : counts) {
    count = cursor.size("a number of entities");
    if (count > cursor.remaining())
      cursor.fail("declares " + std::to_string(count) + " entities, more than the file can hold");
  }
  for (int dimension = 0; dimension < 4; ++dimension) {
    for (std::uint64_t i = 0; i < counts[static_cast<std::size_t>(dimension)]; ++i)
      read_entity_4(cursor, contents, dimension, parts);
  }
}

struct Block {
  int dimension = 0;
  int entity = 0;
  int flag = 0;  // $Nodes: parametric; $Elements: element type
  std::uint64_t count = 0;
};

Block read_block_4(MshCursor& cursor, const char* flag_name, const char* what, std::uint64_t room) {
  Block block;
  block.dimension = cursor.int32("an entity dimension");
  if (block.dimension < 0 || block.dimension > 3)
    cursor.fail("an entity has dimension " + std::to_string(block.dimension) + "; allowed: 0 to 3");
  block.entity = cursor.int32("an entity tag");
  block.flag = cursor.int32(flag_name);
  block.count = cursor.size("a number of entries in a block");
  if (block.count > room)
    cursor.fail("a block of " + std::to_string(block.count) + " " + what +
                " is more than the section declares");
  static_cast<void>(cursor.check_count(static_cast<std::int64_t>(block.count), 8, what));
  return block;
}

struct Totals {
  std::uint64_t blocks = 0, count = 0;
};

Totals read_totals_4(MshCursor& cursor, const char* what) {
  Totals totals;
  totals.blocks = cursor.size("a number of blocks");
  totals.count = cursor.size("a number of entries");
  static_cast<void>(cursor.size("the smallest tag"));
  static_cast<void>(cursor.size("the largest tag"));
  constexpr auto kMost = static_cast<std::uint64_t>(std::numeric_limits<std::int64_t>::max());
  static_cast<void>(
      cursor.check_count(static_cast<std::int64_t>(std::min(totals.blocks, kMost)), 20, "blocks"));
  static_cast<void>(
      cursor.check_count(static_cast<std::int64_t>(std::min(totals.count, kMost)), 8, what));
  return totals;
}

void check_total(const MshCursor& cursor, std::uint64_t found, std::uint64_t declared,
                 const char* what) {
  if (found != declared)
    cursor.fail("declares " + std::to_string(declared) + " " + what + " but its blocks hold " +
                std::to_string(found));
}

/// None where the file has no $Entities.
std::span<const int> groups_of(const MshCursor& cursor, const Block& block,
                               const MshContents& contents) {
  if (contents.groups_of_entity.empty()) return {};
  const auto found = contents.groups_of_entity.find({block.dimension, block.entity});
  if (found == contents.groups_of_entity.end())
    cursor.fail("a block belongs to entity " + std::to_string(block.entity) + " of dimension " +
                    std::to_string(block.dimension) + ", which $Entities does not have",
                InputFault::bad_id);
  return found->second;
}

void read_element_4(MshCursor& cursor, const TagIndex& nodes, MshContents& contents,
                    MshElement element) {
  element.tag = read_tag(cursor, "an element tag");
  ElementNodes read;
  const auto count = static_cast<std::size_t>(element.type.nodes);
  for (std::size_t n = 0; n < count; ++n) {
    read[n] = cursor.size("a node of an element");
    if (!nodes.find(read[n]))
      cursor.fail("element " + std::to_string(element.tag) + " uses node " +
                      std::to_string(read[n]) + ", which $Nodes does not have",
                  InputFault::bad_id);
  }
  element.nodes = {read.data(), count};
  contents.add(element);
}

}  // namespace

void read_nodes_1(MshCursor& cursor, MshContents& contents) { read_nodes_2(cursor, contents); }

// number type physical-group entity node-count nodes...
void read_elements_1(MshCursor& cursor, MshContents& contents) {
  const std::uint64_t count =
      cursor.check_count(cursor.text_integer("the number of elements"), 8, "elements");
  const TagIndex nodes(contents.mesh.node_tags);
  for (std::uint64_t i = 0; i < count; ++i) {
    MshElement element{element_number_2(cursor), {}, {}, {}, 0};
    const int type = cursor.int32("an element type");
    const int group = group_of(cursor, cursor.int32("a physical group"));
    element.entity = cursor.int32("an entity");
    const int count_of_nodes = cursor.int32("a number of nodes");
    element.type = type_of(cursor, type);
    if (count_of_nodes != element.type.nodes)
      cursor.fail("element " + std::to_string(element.tag) + " of type " + std::to_string(type) +
                  " has " + count_of(count_of_nodes, "node") +
                  "; allowed: " + std::to_string(element.type.nodes));
    ElementNodes read;
    element.nodes =
        read_element_nodes_2(cursor, nodes, element.tag, element.type.nodes, "$NOD", read);
    add_2(contents, element, group);
  }
  check_unique(cursor, contents.element_tags, "element");
}

void read_nodes_2(MshCursor& cursor, MshContents& contents) {
  const std::uint64_t count =
      cursor.check_count(cursor.text_integer("the number of nodes"), 28, "nodes");
  cursor.begin_binary_body();
  contents.mesh.node_tags.reserve(count);
  contents.mesh.coordinates.reserve(3 * count);
  for (std::uint64_t i = 0; i < count; ++i) {
    contents.mesh.node_tags.push_back(
        checked_tag(cursor, std::int64_t{cursor.int32("a node number")}, "a node number"));
    for (int axis = 0; axis < 3; ++axis)
      contents.mesh.coordinates.push_back(cursor.real("a node's coordinate"));
  }
  check_unique(cursor, contents.mesh.node_tags, "node");
}

void read_elements_2(MshCursor& cursor, MshContents& contents) {
  const std::uint64_t count =
      cursor.check_count(cursor.text_integer("the number of elements"), 8, "elements");
  cursor.begin_binary_body();
  contents.element_tags.reserve(count);
  const TagIndex nodes(contents.mesh.node_tags);
  if (cursor.binary()) {
    read_runs_2(cursor, nodes, contents, count);
  } else {
    for (std::uint64_t i = 0; i < count; ++i) {
      const std::uint64_t element = element_number_2(cursor);
      Header2 header;
      header.type = cursor.int32("an element type");
      header.tags = cursor.int32("a number of tags");
      check_header_2(cursor, header);
      read_element_2(cursor, nodes, contents, element, header);
    }
  }
  check_unique(cursor, contents.element_tags, "element");
}

void read_entities_4(MshCursor& cursor, MshContents& contents) {
  cursor.begin_binary_body();
  read_all_entities_4(cursor, contents, false);
}

void read_partitioned_entities_4(MshCursor& cursor, MshContents& contents) {
  cursor.begin_binary_body();
  static_cast<void>(cursor.size("a number of partitions"));
  const std::uint64_t ghosts = cursor.size("a number of ghost entities");
  if (ghosts > cursor.remaining())
    cursor.fail("declares " + std::to_string(ghosts) +
                " ghost entities, more than the file can hold");
  for (std::uint64_t i = 0; i < ghosts; ++i) {
    static_cast<void>(cursor.int32("the tag of a ghost entity"));
    static_cast<void>(cursor.int32("the partition of a ghost entity"));
  }
  read_all_entities_4(cursor, contents, true);
}

void read_nodes_4(MshCursor& cursor, MshContents& contents) {
  cursor.begin_binary_body();
  const Totals totals = read_totals_4(cursor, "nodes");
  contents.mesh.node_tags.reserve(totals.count);
  contents.mesh.coordinates.reserve(3 * totals.count);
  for (std::uint64_t b = 0; b < totals.blocks; ++b) {
    const Block block = read_block_4(cursor, "the parametric flag", "nodes",
                                     totals.count - contents.mesh.node_tags.size());
    for (std::uint64_t i = 0; i < block.count; ++i)
      contents.mesh.node_tags.push_back(read_tag(cursor, "a node tag"));
    const int reals = 3 + (block.flag != 0 ? block.dimension : 0);
    for (std::uint64_t i = 0; i < block.count; ++i) {
      for (int axis = 0; axis < reals; ++axis) {  // behind x, y, z: parameters
        const double value = cursor.real("a node's coordinate");
        if (axis < 3) contents.mesh.coordinates.push_back(value);
      }
    }
  }
  check_total(cursor, contents.mesh.node_tags.size(), totals.count, "nodes");
  check_unique(cursor, contents.mesh.node_tags, "node");
}

void read_elements_4(MshCursor& cursor, MshContents& contents) {
  cursor.begin_binary_body();
  const Totals totals = read_totals_4(cursor, "elements");
  contents.element_tags.reserve(totals.count);
  const TagIndex nodes(contents.mesh.node_tags);
  for (std::uint64_t b = 0; b < totals.blocks; ++b) {
    const Block block = read_block_4(cursor, "an element type", "elements",
                                     totals.count - contents.element_tags.size());
    MshElement element{0, type_of(cursor, block.flag), {}, {}, block.entity};
    if (element.type.solid() && block.dimension != 3)
      cursor.fail("a block of solids (element type " + std::to_string(block.flag) +
                  ") belongs to an entity of dimension " + std::to_string(block.dimension) +
                  "; allowed: 3");
    element.groups = groups_of(cursor, block, contents);
    for (std::uint64_t i = 0; i < block.count; ++i)
      read_element_4(cursor, nodes, contents, element);
  }
  check_total(cursor, contents.element_tags.size(), totals.count, "elements");
  check_unique(cursor, contents.element_tags, "element");
}

}  // namespace sunder::app
