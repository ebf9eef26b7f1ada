// SPDX-License-Identifier: Apache-2.0
// Interfaces (method.md "Interfaces"): surfaces between two volumes of a mesh that part by a law of
// traction and opening. Each is a layer of thin elements between the nodes of one side and those of
// the other, three to a face. Each has one edge across the layer, so that it is a spring between
// two nodes, and those of one pair of nodes part together.
#pragma once

#include <array>
#include <cstdint>
#include <memory>
#include <span>
#include <vector>

#include "sunder/problem.hpp"

namespace sunder {

/// One interface as it lies in the mesh.
struct InterfaceLayer {
  Index volume = 0;      ///< of Mesh::volumes
  double thickness = 0;  ///< nominal [mm]
  double opening = 0;    ///< at which it parts in tension [mm]
  double mu = 0;         ///< of its elements [MPa]
  double strength = 0, energy = 0, shear_ratio = 1;
  double area = 0;  ///< [mm^2]
};

/// Traction on a layer per undeformed area [MPa].
struct Traction {
  double normal = 0, shear = 0;  ///< normal: > 0 in tension
};

class Interfaces {
 public:
  /// All of a scene's, which are laid in its mesh.
  Interfaces(const Scene& scene, std::span<const TetShape> shapes);

  [[nodiscard]] std::span<const InterfaceLayer> layers() const { return layers_; }
  /// Whether an element is one of a layer.
  [[nodiscard]] bool has(Index element) const { return element >= first_ && place(element); }
  /// The layer of an element that has() knows.
  [[nodiscard]] const InterfaceLayer& layer(Index element) const {
    return layers_[at(element).layer];
  }
  /// Area of which the element is the spring [mm^2].
  [[nodiscard]] double area(Index element) const { return at(element).area; }
  /// Both nodes of its pair.
  [[nodiscard]] std::array<Index, 2> nodes(Index element) const { return at(element).nodes; }
  /// Its pair, and how many there are.
  [[nodiscard]] std::size_t pair(Index element) const { return at(element).pair; }
  [[nodiscard]] std::size_t pair_count() const { return pair_begin_.size() - 1; }
  /// Elements of a pair, ascending.
  [[nodiscard]] std::span<const Index> elements(std::size_t pair) const {
    return std::span(of_pair_).subspan(pair_begin_[pair],
                                       pair_begin_[pair + 1] - pair_begin_[pair]);
  }
  /// Pairs of the faces that a pair is at, itself not.
  [[nodiscard]] std::span<const std::size_t> neighbours(std::size_t pair) const {
    return std::span(neighbours_)
        .subspan(neighbour_begin_[pair], neighbour_begin_[pair + 1] - neighbour_begin_[pair]);
  }

  /// From the element's Biot stress.
  [[nodiscard]] Traction traction(Index element, const Voigt& biot) const;
  /// sqrt(<t_n>^2 + (t_s / shear_ratio)^2) / strength: at 1 it parts.
  [[nodiscard]] double ratio(Index element, const Voigt& biot) const;
  /// That an element holds in this state [N mm].
  [[nodiscard]] double energy(Index element, const Voigt& biot) const;

 private:
  struct Element {
    std::size_t layer = 0;
    double area = 0, thickness = 0;
    Vec3 normal = Vec3::Zero();  ///< undeformed
    std::array<Index, 2> nodes{};
    std::size_t pair = 0;
  };
  [[nodiscard]] bool place(Index element) const {
    const auto i = static_cast<std::size_t>(element - first_);
    return i < elements_.size() && elements_[i].area > 0;
  }
  void find_neighbours(const Mesh& mesh);
  [[nodiscard]] const Element& at(Index element) const {
    return elements_[static_cast<std::size_t>(element - first_)];
  }

  std::vector<InterfaceLayer> layers_;
  Index first_ = 0;                ///< element
  std::vector<Element> elements_;  ///< from the first on
  std::vector<std::size_t> pair_begin_;
  std::vector<Index> of_pair_;  ///< elements, by pair
  std::vector<std::size_t> neighbour_begin_, neighbours_;
};

/// Null where the scene has none.
[[nodiscard]] std::shared_ptr<const Interfaces> interfaces_of(const Scene& scene,
                                                              std::span<const TetShape> shapes);

}  // namespace sunder
