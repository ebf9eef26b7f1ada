// SPDX-License-Identifier: Apache-2.0
// The bodies of $Nodes, $Elements and $Entities in the versions of .msh; version 1 calls them
// $NOD and $ELM.
#pragma once

#include "app/input/mesh_check.hpp"
#include "app/input/msh_cursor.hpp"

namespace sunder::app {

void read_nodes_1(MshCursor& cursor, MshContents& contents);
void read_elements_1(MshCursor& cursor, MshContents& contents);

void read_nodes_2(MshCursor& cursor, MshContents& contents);
void read_elements_2(MshCursor& cursor, MshContents& contents);

void skip_entities_4(MshCursor& cursor);
void read_nodes_4(MshCursor& cursor, MshContents& contents);
void read_elements_4(MshCursor& cursor, MshContents& contents);

/// Nodes of an element of gmsh's type number; fails when the type is not known.
[[nodiscard]] int nodes_of_type(const MshCursor& cursor, int type);
[[nodiscard]] bool is_tetrahedron(int type);

/// A node or element tag; fails outside 1 ... 2^31 - 1.
[[nodiscard]] std::uint64_t checked_tag(const MshCursor& cursor, std::int64_t tag,
                                        const char* what);
[[nodiscard]] std::uint64_t checked_tag(const MshCursor& cursor, std::uint64_t tag,
                                        const char* what);

/// Fails when a tag occurs twice.
void check_unique(const MshCursor& cursor, const std::vector<std::uint64_t>& tags,
                  const char* what);

}  // namespace sunder::app
