// SPDX-License-Identifier: Apache-2.0
// One finished frame of a body, copied out: all that a picture of it takes, at true scale. It can
// be drawn while the simulation goes on.
#pragma once

#include <array>
#include <cstdint>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "app/figure/pose.hpp"
#include "app/output/state.hpp"
#include "app/view/vulkan/shared_points.hpp"
#include "sunder/board_plane.hpp"
#include "sunder/surface.hpp"

namespace sunder::app {

/// What is said of a frame beside its state.
struct FrameWords {
  std::string title;
  std::vector<std::string> lines;
};

struct Shown {
  std::shared_ptr<const Problem> problem;  ///< whose body it is
  State state;
  std::vector<SurfaceTriangle> triangles;
  /// Of the triangles (Surface::version); those that have changed since version `since` have their
  /// places in `changed`, which may name some beyond the last: they are gone.
  std::uint64_t version = 0, since = 0;
  std::vector<std::uint32_t> changed;
  std::vector<Vec3> places;   ///< of all nodes [mm]
  std::vector<Vec3> normals;  ///< likewise, outward and unit; 0: no triangle ends there
  /// Both on the device that draws, in place of uploading these; `normals` is empty then. Null:
  /// what is drawn is where the host says.
  std::shared_ptr<const view::Points> points;
  /// Edges between what the mesh always showed and what a tear has laid open; as of `version`.
  std::vector<std::array<Index, 2>> lips;
  std::vector<TipState> tips;
  FrameWords words;
  std::optional<StepReport> report;  ///< of the last step; none before the first
};

/// Makes them of a simulation as it goes on; it must outlive this.
class Showing {
 public:
  /// `points`: what the simulation shares with the device that draws; null: nothing.
  explicit Showing(Simulation& simulation, std::shared_ptr<view::SharedPoints> points = nullptr);
  ~Showing();
  Showing(const Showing&) = delete;
  Showing& operator=(const Showing&) = delete;

  /// What is there now but for its words and report. No step is in work. `since`: the version of
  /// triangles that whoever draws has; 0: none.
  [[nodiscard]] std::shared_ptr<Shown> show(std::uint64_t since);

 private:
  Simulation& simulation_;
  const std::shared_ptr<view::SharedPoints> points_;
  BoardPlane plane_;
  Surface surface_;
  std::uint64_t lips_version_ = 0;
  std::vector<std::array<Index, 2>> lips_;
};

/// What a simulation shows now: its last frame, or the body before the first.
[[nodiscard]] State state_of(const Simulation& simulation);

/// The edges that opened triangles and others have in common.
[[nodiscard]] std::vector<std::array<Index, 2>> lips_of(std::span<const SurfaceTriangle> triangles);

/// Of nodes at these places, weighted by area.
[[nodiscard]] std::vector<Vec3> normals_of(std::span<const SurfaceTriangle> triangles,
                                           std::span<const Vec3> places);

}  // namespace sunder::app
