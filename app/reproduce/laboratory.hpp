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
  bool tips = false;  ///< keeps the state of all tips
  int until = 0;  ///< steps end once so many elements broke, presets not counted; 0: no such end
  /// Ends with the first step at rest, or with so many that were not: a failure; 0: neither.
  int patience = 0;
};

/// One run by a law of finite deformation, as it ended.
struct RunNote {
  std::string scene, k;  ///< k: "formula K", "field K" or ""
  double load = 1;       ///< times the scene's forces, in the last step
  int steps = 0, all = 0, fractures = 0;
  int unfinished = 0;   ///< steps that ended before the body was at rest
  bool by_j = false;    ///< strains at a tip left J in place of its K
  std::string failure;  ///< `sunder run` ends with exit code 5 there; empty: it did not fail
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
  std::vector<std::vector<TipState>> tips;  ///< per step, if the plan asks for them
  /// No equilibrium was found (laws of finite deformation): the results are those before; else
  /// empty.
  std::string failure;
  double prepare_ms = 0;  ///< assembly, factor and inverse: Table 2's work, done once

  /// Rows other than presets.
  [[nodiscard]] std::vector<DestroyedElement> fractures() const;
};

class Laboratory {
 public:
  /// `stop` is asked between events; `tell` hears what runs next.
  Laboratory(std::string backend, std::function<bool()> stop,
             std::function<void(const std::string&)> tell);

  /// The same scenes with all materials of that law; laws of finite deformation on backend cpu,
  /// with notes of their own.
  [[nodiscard]] Laboratory with_law(MaterialLaw law) const;
  [[nodiscard]] bool linear() const { return law_ == MaterialLaw::linear; }
  /// Of every run() since, where the law is not linear; in order.
  [[nodiscard]] const std::vector<RunNote>& notes() const { return notes_; }

  /// Throws Interrupted, InputError, and NumericalError where the law is linear.
  [[nodiscard]] RunResult run(const RunPlan& plan) const;
  [[nodiscard]] Scene scene(const RunPlan& plan) const;
  /// mesh_notch() and mesh_board(), each mesh made once.
  [[nodiscard]] std::shared_ptr<const Mesh> notch(const NotchMesh& wanted) const;
  [[nodiscard]] std::shared_ptr<const Mesh> board(const BoardMesh& wanted) const;
  void tell(const std::string& what) const { tell_(what); }
  void check_interrupt() const;

 private:
  [[nodiscard]] const Mesh& mesh_of(const std::string& file) const;
  void note(const RunPlan& plan, const RunResult& result) const;

  std::string backend_;
  MaterialLaw law_ = MaterialLaw::linear;
  std::function<bool()> stop_;
  std::function<void(const std::string&)> tell_;
  mutable std::map<std::string, Mesh> meshes_;                       // by file
  mutable std::map<std::string, std::shared_ptr<const Mesh>> made_;  // by geometry
  mutable std::vector<RunNote> notes_;
};

}  // namespace sunder::app::reproduce
