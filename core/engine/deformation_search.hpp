// SPDX-License-Identifier: Apache-2.0
// The largest strain and rotation of many elements, of which bounds leave few to look at.
#pragma once

#include "fem/deformation.hpp"
#include "sunder/backend.hpp"

namespace sunder::engine {

class DeformationSearch {
 public:
  /// An element under both of these, squares of |sym grad u| and |curl u|, changes nothing.
  struct Limits {
    double strain_squared, curl_squared;
  };
  [[nodiscard]] Limits limits() const;
  /// Whether an element within these bounds can change what has been found.
  [[nodiscard]] bool matters(double strain_squared, double curl_squared) const;
  /// Takes an element; none twice.
  void take(const Mat3& gradient);
  /// Learns of an element, which is taken later, how far the search may leave out others.
  void preview(const Mat3& gradient);

  [[nodiscard]] const Deformation& found() const { return found_; }

 private:
  [[nodiscard]] bool turns_further(double half_curl_squared, double cosine) const;
  void raise(const Mat3& gradient, const fem::DeformationBounds& bounds);

  Deformation found_;
  double tangent_ = 0;  // of the largest rotation; not under 90 deg: infinite
};

}  // namespace sunder::engine
