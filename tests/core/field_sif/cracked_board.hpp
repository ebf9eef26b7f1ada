// SPDX-License-Identifier: Apache-2.0
// Boards with a straight crack, built in code and solved once by a sparse factor: what the
// published stress intensity factors are compared with. Unit: mm, N, MPa.
#pragma once

#include <functional>
#include <memory>
#include <vector>

#include "fracture/board.hpp"
#include "fracture/field_sif/field_intensity.hpp"
#include "sunder/problem.hpp"

namespace sunder::test {

/// A board over grid lines; cells are cut into six tetrahedra, mirrored from cell to cell so that
/// no diagonal direction is preferred.
struct GridLines {
  std::vector<double> x, y, z;
};

/// `count` cells of size h.
[[nodiscard]] std::vector<double> even_lines(int count, double h);
/// Cells of size h within +-fine of 0, growing by `growth` per cell beyond, up to +-half.
[[nodiscard]] std::vector<double> graded_lines(double h, double fine, double half, double growth);

/// Nodes of the grid; copies that split faces need have higher ids.
[[nodiscard]] Index grid_node_count(const Mesh& mesh);

enum class CrackMade { deleted, split };

struct CrackedBoardOptions {
  double young = 5, poisson = 0.3;
  CrackMade made = CrackMade::deleted;
  bool held_flat = false;    ///< no displacement along z: plane strain
  double jitter = 0;         ///< [mm] largest in-plane shift of inner nodes, by a fixed seed
  bool mirror_left = false;  ///< the left side is a plane of symmetry: half of a centre crack
};

class CrackedBoard {
 public:
  /// A crack along x from `from` to `to`. Deleted elements: the row of cells around y is taken out
  /// between these ends. Split nodes: y is a grid line; an end inside the board keeps its node.
  CrackedBoard(const GridLines& lines, double from, double to, double y,
               const CrackedBoardOptions& options);
  CrackedBoard(CrackedBoard&&) = default;

  /// Uniform stress on the outer faces: s_xx on the sides, s_yy on top and bottom, s_xy on all.
  void load_uniform(double s_xx, double s_yy, double s_xy);
  /// A pair of forces [N/mm of thickness] that opens the crack at x.
  void load_pair(double x, double per_thickness);
  void solve();

  /// Half the work of the loads: the strain energy [N mm].
  [[nodiscard]] double energy() const;
  /// The tip at `to` (0) or at `from` (1).
  [[nodiscard]] fracture::FieldIntensity intensity(double radius, int tip = 0);
  [[nodiscard]] std::vector<fracture::FieldIntensity> front(int stations);

  [[nodiscard]] const Problem& problem() const { return *problem_; }
  [[nodiscard]] const fracture::Board& board() const { return *board_; }
  [[nodiscard]] const Crack& crack() const { return crack_; }
  [[nodiscard]] fracture::FieldIntensityMeter& meter() { return *meter_; }
  [[nodiscard]] fracture::FieldView view() const;

 private:
  void take_row(const GridLines& lines, const Mesh& mesh);
  void add_force(Index node, const Vec3& force);

  std::unique_ptr<Problem> problem_;
  std::unique_ptr<fracture::Board> board_;
  std::unique_ptr<fracture::FieldIntensityMeter> meter_;
  Crack crack_;
  std::vector<std::uint8_t> destroyed_;
  std::vector<double> force_, displacement_;  // shape (3 * nodes)
  std::vector<NodalForce> crack_forces_;      // those on the crack's faces
  double from_, to_, y_;
};

}  // namespace sunder::test
