// SPDX-License-Identifier: Apache-2.0
// The bodies of $Nodes, $Elements and $Entities in the versions of .msh; version 1 calls them
// $NOD and $ELM.
#pragma once

#include "app/input/msh_contents.hpp"
#include "app/input/msh_cursor.hpp"

namespace sunder::app {

void read_nodes_1(MshCursor& cursor, MshContents& contents);
void read_elements_1(MshCursor& cursor, MshContents& contents);

void read_nodes_2(MshCursor& cursor, MshContents& contents);
void read_elements_2(MshCursor& cursor, MshContents& contents);

/// The physical groups of the entities, which the elements of version 4.1 have theirs from.
void read_entities_4(MshCursor& cursor, MshContents& contents);
/// The same of a partitioned mesh, whose elements belong to the parts of entities.
void read_partitioned_entities_4(MshCursor& cursor, MshContents& contents);
void read_nodes_4(MshCursor& cursor, MshContents& contents);
void read_elements_4(MshCursor& cursor, MshContents& contents);

}  // namespace sunder::app
