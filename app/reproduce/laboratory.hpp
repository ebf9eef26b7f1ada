// SPDX-License-Identifier: Apache-2.0
// Runs the paper's scenes, as they are or changed, and keeps what is measured.
#pragma once

#include <functional>
#include <map>
#include <memory>
#include <stdexcept>
#include <string>
#include <vector>

#include "app/output/state.hpp"
#include "app/reproduce/notch_mesh.hpp"
#include "sunder/board_plane.hpp"

namespace sunder::app::reproduce {

/// The user asked to stop; nothing has been written.
struct Interrupted : std::runtime_error {
  Interrupted() : std::runtime_error("interrupted") {}
};

struct RunPlan {
  std::string scene;                   ///< of scenes/, without ".toml"
  std::vector<std::string> overrides;  ///< as `sunder run --set`
  std::shared_ptr<const Mesh> mesh;    ///< instead of the scene's own
  double load = 1;                     ///< all forces times this
  std::vector<int> snapshots;          ///< at so many fractures, presets not counted; ascending
  /// Pulls become grips that move so far [mm] along their force, free across it.
  std::optional<double> grip = std::nullopt;
};

struct RunResult {
  std::shared_ptr<const Problem> problem;
  BoardPlane plane;
  std::vector<DestroyedElement> destroyed;
  std::vector<Crack> cracks;
  std::vector<StepReport> steps;
  std::vector<int> frames;       ///< solves, per step
  std::vector<State> snapshots;  ///< those that were reached
  State last;
  BackendInfo backend;
  std::vector<std::string> warnings;
  double prepare_ms = 0;  ///< assembly, factor and inverse: Table 2's work, done once

  /// Rows other than presets.
  [[nodiscard]] std::vector<DestroyedElement> fractures() const;
};

class Laboratory {
 public:
  /// `stop` is asked between events; `tell` hears what runs next.
  Laboratory(std::string backend, std::function<bool()> stop,
             std::function<void(const std::string&)> tell);

  /// Throws Interrupted, InputError, NumericalError.
  [[nodiscard]] RunResult run(const RunPlan& plan) const;
  [[nodiscard]] Scene scene(const RunPlan& plan) const;
  /// mesh_notch() and mesh_board(), each mesh made once.
  [[nodiscard]] std::shared_ptr<const Mesh> notch(const NotchMesh& wanted) const;
  [[nodiscard]] std::shared_ptr<const Mesh> board(const BoardMesh& wanted) const;
  void tell(const std::string& what) const { tell_(what); }
  void check_interrupt() const;

 private:
  [[nodiscard]] const Mesh& mesh_of(const std::string& file) const;

  std::string backend_;
  std::function<bool()> stop_;
  std::function<void(const std::string&)> tell_;
  mutable std::map<std::string, Mesh> meshes_;                       // by file
  mutable std::map<std::string, std::shared_ptr<const Mesh>> made_;  // by geometry
};

}  // namespace sunder::app::reproduce
