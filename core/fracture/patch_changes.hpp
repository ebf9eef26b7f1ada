// SPDX-License-Identifier: Apache-2.0
// What patches of pooled volume (method.md "Pooled volume") have changed their volume by, round a
// place of the body: of some elements' patches, elements elsewhere included.
#pragma once

#include <array>
#include <cstdint>
#include <functional>
#include <optional>
#include <span>
#include <vector>

#include "body/law_stress.hpp"
#include "sunder/problem.hpp"

namespace sunder::fracture {

class PatchChanges {
 public:
  /// The problem must outlive it.
  explicit PatchChanges(const Problem& problem) : problem_(problem) {}

  /// The body as it is now, as FieldView has it.
  struct Body {
    std::span<const std::uint8_t> destroyed;  ///< per element; empty: none is
    const std::function<void(std::span<const Index>, std::span<Vec3>)>& displacement;
    std::span<const std::array<Index, 4>> corners;  ///< empty: as the mesh has them
    const fem::Pools* pools = nullptr;              ///< null: the problem's
  };
  /// Reads the patches of some elements. `turned`: in the body turned back by this rotation.
  void read(std::span<const Index> elements, const Body& body,
            const Mat3& turned = Mat3::Identity());
  /// Of each of those elements, none where it does not pool. Empty: nothing pools.
  [[nodiscard]] std::span<const std::optional<fem::PatchChange>> of_elements() const {
    return of_elements_;
  }

 private:
  [[nodiscard]] fem::PatchChange of(std::span<const Index> patch, const Body& body,
                                    const Mat3& turned);

  const Problem& problem_;
  std::vector<std::optional<fem::PatchChange>> of_elements_;
  std::vector<Index> patches_, corners_;
  std::vector<Vec3> moved_;
};

/// Stress in the material's frame of element e, the i-th of those that were read.
[[nodiscard]] Voigt stress_with(const PatchChanges& patches, const Problem& problem, std::size_t i,
                                Index e, const Eigen::Matrix<double, 3, 4>& displacement);

}  // namespace sunder::fracture
