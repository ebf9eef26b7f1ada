// SPDX-License-Identifier: Apache-2.0
// Whether bodies are held: rigid modes left by a set of held dofs.
#pragma once

#include <span>
#include <vector>

#include "sunder/mesh.hpp"

namespace sunder::fem {

struct HeldDof {
  Index node;
  int axis;
};

/// How many of the six rigid modes the held dofs leave free (0: held).
[[nodiscard]] int rigid_modes_left(const Mesh& mesh, std::span<const HeldDof> held);

/// As few dofs of `nodes` as take away the rigid modes that `held` leaves to a body of the nodes of
/// both; those that a mode moves most.
[[nodiscard]] std::vector<HeldDof> missing_supports(const Mesh& mesh, std::span<const HeldDof> held,
                                                    std::span<const Index> nodes);

/// Connected bodies: per element the index of its body (elements connect through shared nodes),
/// numbered by first element; kNone where `exclude` is set. Empty `exclude`: all elements.
struct Bodies {
  std::vector<Index> body_of_element;
  std::vector<Index> body_of_node;  ///< kNone: in excluded elements only
  Index count = 0;
};
[[nodiscard]] Bodies find_bodies(const Mesh& mesh, std::span<const std::uint8_t> exclude);

/// Lists that a search needs, kept between searches of one mesh.
struct BodyRoom {
  std::vector<Index> parent, number;  // per node
};
/// The same in place of what `bodies` held; allocates the first time only.
void find_bodies(const Mesh& mesh, std::span<const std::uint8_t> exclude, Bodies& bodies,
                 BodyRoom& room);

}  // namespace sunder::fem
