// SPDX-License-Identifier: Apache-2.0
// What a host draws of a live body: the triangles where live elements end, kept up to date. What
// update() costs grows with what has changed, but for one comparison of a byte an element (and of
// its corners where cracks split).
#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <vector>

#include "sunder/simulation.hpp"

namespace sunder {

/// Nodes of Simulation::mesh(), anticlockwise seen from outside.
struct SurfaceTriangle {
  std::array<Index, 3> nodes{};
  Index element = kNone;  ///< live, behind it
  Index piece = kNone;    ///< as Simulation::piece_of
  bool opened = false;    ///< lies where the mesh had another element: a lip of a cut or a crack
};

class Surface {
 public:
  /// Of the body as it is now. The simulation must outlive it.
  explicit Surface(const Simulation& simulation);

  /// Follows what has happened, taken back or come back since. Returns the version, from 1 on: it
  /// grows where a triangle has changed.
  std::uint64_t update();
  [[nodiscard]] std::uint64_t version() const { return version_; }

  /// In places of their own: where one goes, the last one takes its place.
  [[nodiscard]] std::span<const SurfaceTriangle> triangles() const { return triangles_; }
  /// Places whose triangle has changed or come since a version, each once, ascending; those beyond
  /// the last triangle are gone. 0: all. A version of the last kVersions costs what has changed, an
  /// older one all.
  [[nodiscard]] std::vector<std::uint32_t> changed_since(std::uint64_t version) const;
  static constexpr std::size_t kVersions = 64;

  /// Nodes of the body, those that splitting has brought included.
  [[nodiscard]] std::size_t node_count() const;
  /// Places [mm] and outward unit normals, weighted by area, of all nodes as they are now, 3 each;
  /// the normal is 0 where no triangle ends. Empty: not asked for.
  void points(std::span<float> places, std::span<float> normals) const;

 private:
  [[nodiscard]] const std::array<Index, 4>& corners(Index element) const;
  [[nodiscard]] std::array<Index, 3> face(Index element, int opposite) const;
  [[nodiscard]] bool ends(Index element, int opposite) const;
  void look_at(Index element);
  void set(Index element, int opposite);
  void drop(std::uint32_t place);
  void touch(std::uint32_t place);
  void find_changes();
  void follow_pieces();

  const Simulation& simulation_;
  std::vector<std::array<Index, 4>> behind_;   // per element, opposite to each corner; kNone: none
  std::vector<std::uint8_t> gone_;             // as of the last update
  std::vector<std::array<Index, 4>> corners_;  // likewise; empty: as the mesh has them
  std::vector<SurfaceTriangle> triangles_;
  std::vector<std::uint32_t> slots_;  // of each triangle: 4 element + opposite
  std::vector<std::uint32_t> place_;  // of each slot; kNowhere: it shows no triangle
  std::vector<Index> changed_;        // elements, of the update in work
  std::vector<std::uint8_t> is_changed_;
  std::vector<std::vector<std::uint32_t>> log_;  // places, of the last versions, the newest last
  std::uint64_t version_ = 0, looks_ = 0;
};

}  // namespace sunder
