// SPDX-License-Identifier: Apache-2.0
// Boards with a straight crack, built in code and solved once by a sparse factor: what the
// published stress intensity factors are compared with. Unit: mm, N, MPa.
#pragma once

#include <vector>

#include "core/field_sif/cracked_body.hpp"

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
  MaterialLaw law = MaterialLaw::linear;
  MaterialVolume volume = MaterialVolume::element;
  /// What is left of a destroyed element. The program's default 1e-6 still carries 0.1 % of the
  /// load across a crack of 100 elements; published solutions carry nothing.
  double alpha = 1e-9;
  CrackMade made = CrackMade::deleted;
  bool held_flat = false;      ///< no displacement along z: plane strain
  bool held_in_plane = false;  ///< no displacement along x and y: antiplane
  double jitter = 0;           ///< [mm] largest in-plane shift of inner nodes, by a fixed seed
  bool mirror_left = false;    ///< the left side is a plane of symmetry: half of a centre crack
};

class CrackedBoard : public CrackedBody {
 public:
  /// A crack along x from `from` to `to`. Deleted elements: the row of cells around y is taken out
  /// between these ends. Split nodes: y is a grid line; an end inside the board keeps its node.
  CrackedBoard(const GridLines& lines, double from, double to, double y,
               const CrackedBoardOptions& options);

  /// A pair of forces [N/mm of thickness] that opens the crack at x.
  void load_pair(double x, double per_thickness);
  /// Shear s_yz on top and bottom.
  void load_antiplane(double s_yz);

 private:
  double y_;
};

/// The grid's mesh, whole.
[[nodiscard]] Mesh grid_mesh(const GridLines& lines);

}  // namespace sunder::test
