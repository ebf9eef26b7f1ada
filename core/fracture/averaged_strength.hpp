// SPDX-License-Identifier: Apache-2.0
// Strength by the mean stress of a neighbourhood (method.md "Averaged strength"): the load at which
// something breaks then depends on a length of the material and not on the size of its elements.
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "sunder/backend.hpp"

namespace sunder::fracture {

class AveragedStrength {
 public:
  /// For fracture.averaging above 0. Throws InputError when a neighbourhood holds so many elements
  /// that the lists of all would pass 4 GiB.
  explicit AveragedStrength(const Problem& problem);

  /// What Backend::stress() says, by the largest of the mean stresses round the corners of each
  /// live breakable element: of those of its material, live, with centroids at most the radius
  /// away, weighted by volume; its own where no corner has such elements. Of equal ones the element
  /// with the larger stress of its own counts.
  [[nodiscard]] StressSummary summarize(const Backend& backend);
  /// At or over yield in the last summary, by id.
  void over(std::span<const std::uint8_t> destroyed, std::vector<Worst>& found) const;
  /// Takes elements out of the candidates for good.
  void exclude(std::span<const Index> elements);
  /// Per element, to go back to.
  [[nodiscard]] const std::vector<std::uint8_t>& excluded() const { return excluded_; }
  void exclude_only(const std::vector<std::uint8_t>& elements) { excluded_ = elements; }

 private:
  /// A node, as a corner of elements of one material: those round it are averaged.
  struct Place {
    Index node;
    int volume;
  };
  [[nodiscard]] std::vector<Place> number_places();
  void find_neighbours(const std::vector<Place>& places, double radius);
  void measure_places(std::span<const std::uint8_t> destroyed);
  [[nodiscard]] double ratio(Index element) const;
  [[nodiscard]] double own_ratio(Index element) const;

  const Problem& problem_;
  std::vector<Index> place_of_;     // shape (elements, 4): of each corner; kNone: unbreakable
  std::vector<std::size_t> begin_;  // shape (places + 1): where each one's neighbours begin
  std::vector<Index> neighbours_;   // ascending
  std::vector<std::uint8_t> excluded_;
  std::vector<Voigt> stress_;    // of the summary in work
  std::vector<double> measure_;  // likewise, of each place [MPa]; -infinity: nothing live there
};

}  // namespace sunder::fracture
