// SPDX-License-Identifier: Apache-2.0
// Pooled volume (method.md "Pooled volume"): patches of elements of one material that change their
// volume as one. Each element keeps its deviator, the patch has one pressure; so linear tetrahedra
// do not lock in nearly incompressible tissue. They are made once, intact; damage splits them
// (damaged_pools.hpp).
#pragma once

#include <array>
#include <functional>
#include <memory>
#include <span>
#include <vector>

#include "body/stiffness_difference.hpp"
#include "linear_algebra/sparse_matrix.hpp"
#include "sunder/problem.hpp"

namespace sunder::fem {

class Pools {
 public:
  /// Elements of a patch where there are enough; none is left with fewer than `kFewest` that has
  /// neighbours to join, and those that join make it larger.
  static constexpr std::size_t kSize = 8, kFewest = 4;

  /// Of the elements whose material pools its volume: joined by faces, of one volume of the mesh,
  /// the same for the same mesh on any machine but for the last digits of its coordinates.
  explicit Pools(const Problem& problem);
  /// Corners of an element, as cracks have split the body.
  using CornersOf = std::function<const std::array<Index, 4>&(Index element)>;
  /// The same patches where nodes have parted: of one whose elements no longer hang together by
  /// faces each part is a patch. The part with the first element keeps its number, the others
  /// follow after all patches that there were. `changed`: elements whose corners differ from those
  /// that they had in `whole`.
  Pools(const Pools& whole, const CornersOf& corners, std::span<const Index> changed);

  /// Elements of a patch of `whole` by the patches that they belong to here, by their first ones.
  [[nodiscard]] std::vector<std::vector<Index>> parts_of(const Pools& whole, Index patch) const;

  /// The same patches with each split by the body that its elements belong to (kNone: to none,
  /// which then stay with the first): the body of its first element keeps its number, others follow
  /// after all patches that there were. Null: none is split.
  [[nodiscard]] std::shared_ptr<const Pools> split(
      const std::function<Index(Index element)>& body_of) const;
  /// Whether the patches are the same.
  [[nodiscard]] bool operator==(const Pools& other) const { return of_ == other.of_; }

  [[nodiscard]] Index count() const { return static_cast<Index>(bulk_.size()); }
  /// Patch of an element; kNone: its material does not pool.
  [[nodiscard]] Index of(Index element) const { return of_[static_cast<std::size_t>(element)]; }
  /// Ascending.
  [[nodiscard]] std::span<const Index> elements(Index patch) const {
    const auto p = static_cast<std::size_t>(patch);
    return std::span(elements_).subspan(begin_[p], begin_[p + 1] - begin_[p]);
  }
  /// kappa of its material [MPa].
  [[nodiscard]] double bulk(Index patch) const { return bulk_[static_cast<std::size_t>(patch)]; }
  /// Those with fewer than kFewest elements: pieces that have no more.
  [[nodiscard]] Index small_count() const { return small_; }
  /// Nodes of a patch's elements, ascending.
  [[nodiscard]] std::vector<Index> nodes(const Problem& problem, Index patch) const;
  /// Patches of some elements, ascending, each once.
  void of(std::span<const Index> elements, std::vector<Index>& patches) const;

 private:
  Pools() = default;
  [[nodiscard]] std::vector<std::vector<Index>> hanging_together(Index patch,
                                                                 const CornersOf& corners) const;
  std::vector<Index> of_;
  std::vector<std::size_t> begin_;
  std::vector<Index> elements_;
  std::vector<double> bulk_;
  Index small_ = 0;
};

/// Pools of a problem; null where no material pools.
[[nodiscard]] std::shared_ptr<const Pools> pools_of(const Problem& problem);

/// Share of stiffness of an element.
using ShareOf = std::function<double(Index element)>;

/// Patches as cracks have split the body: those of its problem where none is split.
[[nodiscard]] std::shared_ptr<const Pools> parted_pools(
    const Problem& problem, const std::shared_ptr<const Pools>& whole,
    std::span<const std::array<Index, 4>> corners);

/// The stiffness kappa / V_p b_p b_p^T of a patch, V_p = sum a_e V_e, b_p = sum a_e V_e grad N, as
/// parts, one an element, whose first columns add up to one vector. `number`: StiffnessPart::patch.
void append_pressure(const Problem& problem, std::span<const Index> elements, Index number,
                     const ShareOf& share, std::vector<StiffnessPart>& parts);
/// The same of each part of a patch of the problem, as it is split in `now`.
void append_pressure(const Problem& problem, Index patch, const Pools& now, const ShareOf& share,
                     std::vector<StiffnessPart>& parts);

/// Sum of kappa / V_p b_p b_p^T over the unknowns: lower triangle. `scale`: a_e of each element;
/// empty: intact. `pools`: as damage has split them (damaged_pools.hpp); null: the problem's.
[[nodiscard]] linear_algebra::SparseMatrix assemble_pressure(const Problem& problem,
                                                             std::span<const double> scale,
                                                             const Pools* pools = nullptr);

/// Stress of elements in one displacement: what an element bears by itself, and the pressure
/// kappa b_p . u / V_p of its patch where it pools.
class StressField {
 public:
  /// `scale` and `pools` as above, `u`: at all nodes (3 * nodes). All of them must outlive it.
  StressField(const Problem& problem, std::span<const double> scale, std::span<const double> u,
              const Pools* pools = nullptr);
  /// As a live element has it: not scaled.
  [[nodiscard]] Voigt of(Index element) const;

 private:
  const Problem& problem_;
  std::span<const double> u_;
  const Pools* pools_;
  std::vector<double> pressure_;  // of each patch
};

}  // namespace sunder::fem
