// SPDX-License-Identifier: Apache-2.0
// A fine mesh of a host's own, carried by the tetrahedra of a body.
#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <vector>

#include "sunder/simulation.hpp"

namespace sunder {

class Skin {
 public:
  /// `vertices` [mm]: where they lie in the undeformed body, all finite. Each is carried by the
  /// element that holds it, the lowest of several, and where none does by the one whose inside is
  /// nearest by barycentric coordinates. The simulation must outlive it. Throws UsageError.
  Skin(const Simulation& simulation, std::span<const Vec3> vertices);

  [[nodiscard]] std::size_t size() const { return carriers_.size(); }
  [[nodiscard]] Index element(std::size_t vertex) const { return carriers_[vertex].element; }
  struct Carrier {
    Index element = kNone;
    std::array<double, 4> share{};  ///< of its corners; they sum up to 1
  };
  [[nodiscard]] std::span<const Carrier> carriers() const { return carriers_; }
  /// Places as the body is now [mm], 3 each; `lives` (one each, or empty): 0 where the element that
  /// carries a vertex is destroyed.
  void places(std::span<float> places, std::span<std::uint8_t> lives) const;

 private:
  const Simulation& simulation_;
  std::vector<Carrier> carriers_;
};

}  // namespace sunder
