// SPDX-License-Identifier: Apache-2.0
#include "app/input/msh_sections.hpp"

#include <array>
#include <limits>

#include "app/input/tag_index.hpp"
#include "sunder/words.hpp"

namespace sunder::app {
namespace {

// Nodes by element type number, 0: not known here (gmsh reference manual, "MSH file format").
constexpr std::array<int, 32> kNodesOfType = {0,  2,  3,  4,  4, 8, 6,  5,  3,  6, 9,
                                              10, 27, 18, 14, 1, 8, 20, 15, 13, 9, 10,
                                              12, 15, 15, 21, 4, 5, 6,  20, 35, 56};

std::uint64_t read_tag(MshCursor& cursor, const char* what) {
  return checked_tag(cursor, cursor.size(what), what);
}

// Node numbers of one element; all must have been declared.
void read_element_nodes_2(MshCursor& cursor, const TagIndex& nodes, std::uint64_t element,
                          int count, const char* section) {
  for (int i = 0; i < count; ++i) {
    const int node = cursor.int32("a node of an element");
    if (node < 1 || !nodes.find(static_cast<std::uint64_t>(node)))
      cursor.fail("element " + std::to_string(element) + " uses node " + std::to_string(node) +
                      ", which " + section + " does not have",
                  InputFault::bad_id);
  }
}

struct Header2 {
  int type = 0;
  int tags = 0;
};

void check_header_2(const MshCursor& cursor, const Header2& header) {
  if (header.tags < 0 || header.tags > 1000)
    cursor.fail("an element has " + std::to_string(header.tags) + " tags; allowed: 0 to 1000");
}

void read_element_2(MshCursor& cursor, const TagIndex& nodes, MshContents& contents,
                    std::uint64_t element, const Header2& header) {
  int physical = 0;
  for (int i = 0; i < header.tags; ++i) {
    const int tag = cursor.int32("a tag of an element");
    if (i == 0) physical = tag;
  }
  read_element_nodes_2(cursor, nodes, element, nodes_of_type(cursor, header.type), "$Nodes");
  contents.element_tags.push_back(element);
  contents.element_physical.push_back(physical);
  if (is_tetrahedron(header.type)) ++contents.tetrahedra;
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

void skip_tags_4(MshCursor& cursor, const char* what) {
  const std::uint64_t count = cursor.size("a number of tags");
  if (count > cursor.remaining())
    cursor.fail("an entity has " + count_of(static_cast<long long>(count), "tag") +
                ", more than the file can hold");
  for (std::uint64_t i = 0; i < count; ++i) static_cast<void>(cursor.int32(what));
}

void skip_entity_4(MshCursor& cursor, int dimension) {
  static_cast<void>(cursor.int32("an entity tag"));
  const int bounds = dimension == 0 ? 3 : 6;  // a point's place, or a bounding box
  for (int i = 0; i < bounds; ++i) static_cast<void>(cursor.real("an entity's bound"));
  skip_tags_4(cursor, "a physical tag");
  if (dimension > 0) skip_tags_4(cursor, "a bounding entity");
}

struct Block {
  int dimension = 0;
  int flag = 0;  // $Nodes: parametric; $Elements: element type
  std::uint64_t count = 0;
};

Block read_block_4(MshCursor& cursor, const char* flag_name, const char* what, std::uint64_t room) {
  Block block;
  block.dimension = cursor.int32("an entity dimension");
  if (block.dimension < 0 || block.dimension > 3)
    cursor.fail("an entity has dimension " + std::to_string(block.dimension) + "; allowed: 0 to 3");
  static_cast<void>(cursor.int32("an entity tag"));
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

}  // namespace

int nodes_of_type(const MshCursor& cursor, int type) {
  const bool known = type > 0 && type < static_cast<int>(kNodesOfType.size());
  if (!known)
    cursor.fail("element type " + std::to_string(type) + " is not known; allowed: 1 to 31");
  return kNodesOfType[static_cast<std::size_t>(type)];
}

bool is_tetrahedron(int type) {
  return type == 4 || type == 11 || type == 29 || type == 30 || type == 31;
}

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

void check_unique(const MshCursor& cursor, const std::vector<std::uint64_t>& tags,
                  const char* what) {
  if (const auto twice = TagIndex(tags).duplicate())
    cursor.fail(std::string(what) + " " + std::to_string(*twice) + " occurs twice",
                InputFault::bad_id);
}

void read_nodes_1(MshCursor& cursor, MshContents& contents) { read_nodes_2(cursor, contents); }

// number type physical-group entity node-count nodes...
void read_elements_1(MshCursor& cursor, MshContents& contents) {
  const std::uint64_t count =
      cursor.check_count(cursor.text_integer("the number of elements"), 8, "elements");
  const TagIndex nodes(contents.node_tags);
  for (std::uint64_t i = 0; i < count; ++i) {
    const std::uint64_t element = element_number_2(cursor);
    const int type = cursor.int32("an element type");
    const int physical = cursor.int32("a physical group");
    static_cast<void>(cursor.int32("an entity"));
    const int corners = cursor.int32("a number of nodes");
    if (corners != nodes_of_type(cursor, type))
      cursor.fail("element " + std::to_string(element) + " of type " + std::to_string(type) +
                  " has " + count_of(corners, "node") +
                  "; allowed: " + std::to_string(nodes_of_type(cursor, type)));
    read_element_nodes_2(cursor, nodes, element, corners, "$NOD");
    contents.element_tags.push_back(element);
    contents.element_physical.push_back(physical);
    if (is_tetrahedron(type)) ++contents.tetrahedra;
  }
  check_unique(cursor, contents.element_tags, "element");
}

void read_nodes_2(MshCursor& cursor, MshContents& contents) {
  const std::uint64_t count =
      cursor.check_count(cursor.text_integer("the number of nodes"), 28, "nodes");
  cursor.begin_binary_body();
  contents.node_tags.reserve(count);
  for (std::uint64_t i = 0; i < count; ++i) {
    contents.node_tags.push_back(
        checked_tag(cursor, std::int64_t{cursor.int32("a node number")}, "a node number"));
    for (int axis = 0; axis < 3; ++axis) static_cast<void>(cursor.real("a node's coordinate"));
  }
  check_unique(cursor, contents.node_tags, "node");
}

void read_elements_2(MshCursor& cursor, MshContents& contents) {
  const std::uint64_t count =
      cursor.check_count(cursor.text_integer("the number of elements"), 8, "elements");
  cursor.begin_binary_body();
  contents.element_tags.reserve(count);
  contents.element_physical.reserve(count);
  const TagIndex nodes(contents.node_tags);
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

void skip_entities_4(MshCursor& cursor) {
  cursor.begin_binary_body();
  std::array<std::uint64_t, 4> counts{};
  for (std::uint64_t& count : counts) {
    count = cursor.size("a number of entities");
    if (count > cursor.remaining())
      cursor.fail("declares " + std::to_string(count) + " entities, more than the file can hold");
  }
  for (int dimension = 0; dimension < 4; ++dimension) {
    for (std::uint64_t i = 0; i < counts[static_cast<std::size_t>(dimension)]; ++i)
      skip_entity_4(cursor, dimension);
  }
}

void read_nodes_4(MshCursor& cursor, MshContents& contents) {
  cursor.begin_binary_body();
  const Totals totals = read_totals_4(cursor, "nodes");
  contents.node_tags.reserve(totals.count);
  for (std::uint64_t b = 0; b < totals.blocks; ++b) {
    const Block block = read_block_4(cursor, "the parametric flag", "nodes",
                                     totals.count - contents.node_tags.size());
    for (std::uint64_t i = 0; i < block.count; ++i)
      contents.node_tags.push_back(read_tag(cursor, "a node tag"));
    const int reals = 3 + (block.flag != 0 ? block.dimension : 0);
    for (std::uint64_t i = 0; i < block.count; ++i) {
      for (int axis = 0; axis < reals; ++axis)
        static_cast<void>(cursor.real("a node's coordinate"));
    }
  }
  check_total(cursor, contents.node_tags.size(), totals.count, "nodes");
  check_unique(cursor, contents.node_tags, "node");
}

void read_elements_4(MshCursor& cursor, MshContents& contents) {
  cursor.begin_binary_body();
  const Totals totals = read_totals_4(cursor, "elements");
  contents.element_tags.reserve(totals.count);
  const TagIndex nodes(contents.node_tags);
  for (std::uint64_t b = 0; b < totals.blocks; ++b) {
    const Block block = read_block_4(cursor, "an element type", "elements",
                                     totals.count - contents.element_tags.size());
    const int corners = nodes_of_type(cursor, block.flag);
    for (std::uint64_t i = 0; i < block.count; ++i) {
      const std::uint64_t element = read_tag(cursor, "an element tag");
      for (int n = 0; n < corners; ++n) {
        const std::uint64_t node = cursor.size("a node of an element");
        if (!nodes.find(node))
          cursor.fail("element " + std::to_string(element) + " uses node " + std::to_string(node) +
                          ", which $Nodes does not have",
                      InputFault::bad_id);
      }
      contents.element_tags.push_back(element);
    }
    if (is_tetrahedron(block.flag)) contents.tetrahedra += block.count;
  }
  check_total(cursor, contents.element_tags.size(), totals.count, "elements");
  check_unique(cursor, contents.element_tags, "element");
}

}  // namespace sunder::app
