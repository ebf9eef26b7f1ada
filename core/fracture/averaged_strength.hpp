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

  /// What Backend::stress() says, by the mean stress round each live breakable element: of those of
  /// its material, live, with centroids at most the radius away, weighted by volume.
  [[nodiscard]] StressSummary summarize(const Backend& backend);
  /// At or over yield in the last summary, by id.
  void over(std::span<const std::uint8_t> destroyed, std::vector<Worst>& found) const;
  /// Takes elements out of the candidates for good.
  void exclude(std::span<const Index> elements);

 private:
  void find_neighbours(double radius);
  [[nodiscard]] double ratio(Index element, std::span<const std::uint8_t> destroyed) const;
  [[nodiscard]] Voigt mean(Index element, std::span<const std::uint8_t> destroyed) const;

  const Problem& problem_;
  std::vector<std::size_t> begin_;  // shape (elements + 1): where each one's neighbours begin
  std::vector<Index> neighbours_;   // itself included; ascending
  std::vector<std::uint8_t> excluded_;
  std::vector<Voigt> stress_;  // of the summary in work
};

}  // namespace sunder::fracture
