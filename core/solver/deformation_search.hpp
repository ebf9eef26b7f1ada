// SPDX-License-Identifier: Apache-2.0
// The largest strain and rotation of many elements, of which bounds leave few to look at.
#pragma once

#include "body/deformation.hpp"
#include "sunder/backend.hpp"

namespace sunder::solver {

class DeformationSearch {
 public:
  /// What changes nothing: elements whose largest principal strain and shortening are at most
  /// these, and whose rotation's tangent is at most that, or whose grad u is that of the largest
  /// rotation.
  struct Limits {
    double strain = 0, compression = 0, tangent = 0;
    Mat3 turned = Mat3::Zero();
    double alike_squared = 0;  ///< of the difference to it, Frobenius
  };
  /// `rounding`: of a strain that is held against them, as a share of the largest.
  [[nodiscard]] Limits limits(double rounding) const;
  /// Takes an element; none twice.
  void take(const Mat3& gradient);
  /// Learns of an element, which is taken later, how far the search may leave out others.
  void preview_strain(const Mat3& gradient);
  void preview_rotation(const Mat3& gradient);

  [[nodiscard]] const Deformation& found() const { return found_; }

 private:
  [[nodiscard]] double tangent() const;

  Deformation found_;
  double tangent_ = 0;       // of the largest rotation; not under 90 deg: infinite
  double half_tangent_ = 0;  // of half of it
  Mat3 strained_ = Mat3::Zero(), turned_ = Mat3::Zero();  // grad u of both
};

}  // namespace sunder::solver
