// SPDX-License-Identifier: Apache-2.0
// A body with a crack, solved once by a sparse factor: what published stress intensity factors are
// compared with. Unit: mm, N, MPa.
#pragma once

#include <memory>
#include <vector>

#include "fracture/board.hpp"
#include "fracture/field_sif/field_intensity.hpp"
#include "sunder/problem.hpp"

namespace sunder::test {

inline constexpr double kClose = 1e-9;  ///< mm: between coordinates that are one

class CrackedBody {
 public:
  /// Cracks lie in the plane of x and y.
  explicit CrackedBody(Scene scene);

  /// Edge crack with its tip at `to`, or internal crack with tips at `from` (0) and `to` (1), along
  /// x and y. Its elements are taken out.
  void set_crack(CrackKind kind, const Vec2& from, const Vec2& to,
                 const std::vector<Index>& elements);
  /// Moves a tip along `direction` (in x and y) by as much as rule 10 of method.md makes of
  /// `length`: the elements that the ray separates are taken out. h is that of the finest elements:
  /// a body that grows coarser far away would have a larger mean.
  void grow(std::size_t tip, const Vec2& direction, double length);

  /// Uniform stress on the outer faces: s_xx on the sides, s_yy on top and bottom, s_xy on all.
  void load_uniform(double s_xx, double s_yy, double s_xy);
  void add_force(Index node, const Vec3& force);
  void solve();

  /// Half the work of the loads: the strain energy [N mm].
  [[nodiscard]] double energy() const;
  /// The crack's last tip (0) or the one before (1).
  [[nodiscard]] fracture::FieldIntensity intensity(double radius, int tip = 0);
  /// With the radius that the meter chooses; `tip` as in the crack.
  [[nodiscard]] fracture::FieldIntensity chosen_intensity(std::size_t tip);
  [[nodiscard]] std::vector<fracture::FieldIntensity> front(int stations);

  [[nodiscard]] const Problem& problem() const { return *problem_; }
  [[nodiscard]] const fracture::Board& board() const { return *board_; }
  /// Of the finest elements, what grow() takes for h; after the first grow().
  [[nodiscard]] double fine_h() const { return fine_->h(); }
  [[nodiscard]] const Crack& crack() const { return crack_; }
  [[nodiscard]] fracture::FieldIntensityMeter& meter() { return *meter_; }
  [[nodiscard]] fracture::FieldView view() const;
  /// Of another solver; shape (3 * nodes).
  void set_displacement(std::vector<double> displacement) {
    displacement_ = std::move(displacement);
  }
  [[nodiscard]] const std::vector<double>& displacement() const { return displacement_; }
  [[nodiscard]] const std::vector<double>& force() const { return force_; }
  /// a_e per element.
  [[nodiscard]] std::vector<double> scale() const;

 protected:
  std::vector<NodalForce> crack_forces_;  // those on the crack's faces

 private:
  [[nodiscard]] Vec2 in_plane(const Vec2& p) const {
    return board_->plane().project(Vec3(p.x(), p.y(), 0));
  }

  void find_fine_part();

  std::unique_ptr<Problem> problem_;
  std::unique_ptr<fracture::Board> board_;
  std::unique_ptr<fracture::FieldIntensityMeter> meter_;
  std::unique_ptr<Mesh> fine_mesh_;  // of the finest elements, all nodes
  std::unique_ptr<fracture::Board> fine_;
  std::vector<Index> fine_elements_;
  Crack crack_;
  std::vector<std::uint8_t> destroyed_;
  std::vector<double> force_, displacement_;  // shape (3 * nodes)
};

}  // namespace sunder::test
