// SPDX-License-Identifier: Apache-2.0
// The body as interfaces make it and as split cracks leave it, with more nodes than the mesh.
#include <algorithm>

#include "c/simulation.hpp"
#include "c/structs.hpp"
#include "sunder/interfaces.hpp"

namespace {

using namespace sunder::c;
using sunder::CrackFace;
using sunder::Index;
using sunder::Mesh;
using sunder::Vec3;

/// Another one after each event that has split something, taken back ones included.
std::int32_t version_of(const sunder::Simulation& simulation) {
  return simulation.corners().empty() ? 0 : static_cast<std::int32_t>(simulation.looks());
}

sunder_body to_body(const sunder::Simulation& simulation) {
  auto body = sized<sunder_body>();
  body.version = version_of(simulation);
  body.node_count = simulation.backend().node_count();
  body.tet_count = simulation.problem().tet_count();
  body.crack_face_count = static_cast<std::int32_t>(simulation.crack_faces().size());
  return body;
}

/// Copies of a node are pairs of an interface; that of the mesh comes before all of them.
void find_parents(const sunder::Interfaces& all, std::int32_t* parents) {
  for (bool changed = true; changed;) {
    changed = false;
    for (std::size_t p = 0; p < all.pair_count(); ++p) {
      const auto& [a, b] = all.nodes(all.elements(p).front());
      changed |= parents[a] != parents[b];
      parents[a] = parents[b] = std::min(parents[a], parents[b]);
    }
  }
}

/// Checks a caller's array of `wanted` values.
template <class T>
void require_array(const T* values, std::size_t given, std::size_t wanted) {
  require_size(given, wanted, "values");
  if (wanted > 0) require(values, "values");
}

}  // namespace

extern "C" {

sunder_status sunder_simulation_body(sunder_simulation simulation, sunder_body* body) {
  return call<SimulationObject>(simulation, [&](SimulationObject& object) {
    write_struct(body, to_body(object.simulation()), "body");
  });
}

sunder_status sunder_simulation_body_nodes(sunder_simulation simulation, double* values,
                                           size_t size) {
  return call<SimulationObject>(simulation, [&](SimulationObject& object) {
    const Mesh body = object.simulation().mesh();
    require_array(values, size, 3 * body.nodes.size());
    for (const Vec3& x : body.nodes) values = std::copy_n(x.data(), 3, values);
  });
}

sunder_status sunder_simulation_body_corners(sunder_simulation simulation, int32_t* values,
                                             size_t size) {
  return call<SimulationObject>(simulation, [&](SimulationObject& object) {
    require_array(values, size, 4 * object.problem().mesh().tets.size());
    for (const auto& tet : object.simulation().mesh().tets) {
      values = std::copy(tet.begin(), tet.end(), values);
    }
  });
}

sunder_status sunder_simulation_body_parents(sunder_simulation simulation, int32_t* values,
                                             size_t size) {
  return call<SimulationObject>(simulation, [&](SimulationObject& object) {
    const Mesh& file = object.problem().mesh();
    const Index nodes = object.simulation().backend().node_count();
    require_array(values, size, static_cast<std::size_t>(nodes));
    for (Index n = 0; n < nodes; ++n) values[n] = n;
    if (const auto* all = object.problem().interfaces()) find_parents(*all, values);
    const Mesh body = object.simulation().mesh();
    for (std::size_t e = 0; e < file.tets.size(); ++e) {
      for (std::size_t a = 0; a < 4; ++a) values[body.tets[e][a]] = values[file.tets[e][a]];
    }
  });
}

sunder_status sunder_simulation_body_displacement(sunder_simulation simulation, double* values,
                                                  size_t size) {
  return call<SimulationObject>(simulation, [&](SimulationObject& object) {
    const auto nodes = static_cast<std::size_t>(object.simulation().backend().node_count());
    require_array(values, size, 3 * nodes);
    for (const Vec3& u : object.simulation().displacement()) {
      values = std::copy_n(u.data(), 3, values);
    }
  });
}

sunder_status sunder_simulation_crack_faces(sunder_simulation simulation, int32_t* values,
                                            size_t size) {
  return call<SimulationObject>(simulation, [&](SimulationObject& object) {
    const std::vector<CrackFace> faces = object.simulation().crack_faces();
    require_array(values, size, 7 * faces.size());
    for (const CrackFace& face : faces) {
      *values++ = face.crack;
      values = std::copy(face.left.begin(), face.left.end(), values);
      values = std::copy(face.right.begin(), face.right.end(), values);
    }
  });
}

}  // extern "C"
