// SPDX-License-Identifier: Apache-2.0
// One solved state of a simulation, copied out: what a picture or a VTU file shows.
#pragma once

#include <cstdint>
#include <span>
#include <string>
#include <vector>

#include "app/output/split_mesh.hpp"

namespace sunder::app {

struct InstrumentState {
  std::string name;
  std::vector<Index> nodes;  ///< on which it acts now
  Vec3 force;                ///< on the body, N
  bool pressure = false;
};

/// What drove the last growth of a tip, from the state before it.
struct LastGrowth {
  int crack = 0;
  SifTerms terms;
};

struct State {
  int step = 0;                            ///< the step in which it was taken
  double load_factor = 0;                  ///< its scene time
  std::vector<Vec3> displacement;          ///< per node of mesh_of(), mm
  std::vector<Voigt> stress;               ///< per element, MPa; empty: not computed in this scene
  std::vector<std::uint8_t> destroyed;     ///< per element
  int destroyed_count = 0;                 ///< elements
  int split_count = 0;                     ///< rows of events in which a crack has split
  std::shared_ptr<const SplitMesh> split;  ///< null: the body has the problem's mesh
  double lip_overlap = 0;                  ///< of split cracks, the largest so far [mm]
  std::vector<Crack> cracks;
  std::vector<LastGrowth> growths;  ///< of every tip that has grown, in order of its first growth
  std::vector<InstrumentState> instruments;
  Vec3 support_reaction = Vec3::Zero();  ///< N
};

/// The fields of the last solve, taken in `step`.
[[nodiscard]] State capture(const Simulation& simulation, int step);

/// The undeformed body before the first solve, without stress.
[[nodiscard]] State undeformed(const Problem& problem);

/// The body that a state's fields belong to, undeformed.
[[nodiscard]] const Mesh& mesh_of(const Problem& problem, const State& state);

/// Gradient in an element of a field of the nodes, linear between them.
[[nodiscard]] Mat3 nodal_gradient(const Mesh& mesh, Index element, std::span<const Vec3> field);

/// What `--snapshots` counts: destroyed elements and rows of cracks that have split.
[[nodiscard]] inline int broken(const State& state) {
  return state.destroyed_count + state.split_count;
}

/// Scene time of a step (method.md "Time").
[[nodiscard]] double scene_time(const Scene& scene, int step);

/// The chosen yield measure over the yield stress per element; 0 for unbreakable and destroyed.
[[nodiscard]] std::vector<double> yield_ratios(const Problem& problem, const State& state);

[[nodiscard]] std::vector<double> max_shears(const State& state);

}  // namespace sunder::app
