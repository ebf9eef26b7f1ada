// SPDX-License-Identifier: Apache-2.0
// What of a damaged body statics can speak of: the live elements that something holds. A node that
// no live element reaches and a piece that nothing holds have no equilibrium; they are frozen where
// they are, and their elements carry no force. In motion nothing is frozen. A patch of pooled
// volume through which a piece has come off is one patch in each of both.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "body/hyperelastic.hpp"
#include "body/pieces.hpp"

namespace sunder::solver {

struct FrozenParts {
  std::size_t nodes = 0;     ///< that no live element reaches
  std::size_t pieces = 0;    ///< that nothing holds
  std::size_t elements = 0;  ///< of those pieces, live
};

class RestingBody {
 public:
  enum class Loose { frozen, moving };
  /// Reads what is destroyed now. The body must outlive it.
  explicit RestingBody(const fem::HyperelasticBody& body, Loose loose = Loose::frozen);
  RestingBody(const RestingBody&) = delete;  // body() reads its lists
  RestingBody& operator=(const RestingBody&) = delete;

  /// Reads what is destroyed anew.
  void look();
  /// The body without what is frozen.
  [[nodiscard]] const fem::HyperelasticBody& body() const { return resting_; }
  /// Per element 1: destroyed, or of a frozen piece.
  [[nodiscard]] std::span<const std::uint8_t> out() const { return out_; }
  /// Per unknown 1: no element of body() reaches it.
  [[nodiscard]] std::span<const std::uint8_t> frozen() const { return frozen_; }
  /// In motion, per unknown 1: no live element that something holds reaches it.
  [[nodiscard]] std::span<const std::uint8_t> flying() const { return flying_; }
  [[nodiscard]] const FrozenParts& parts() const { return parts_; }

 private:
  void split_pools();

  const fem::HyperelasticBody& body_;
  Loose loose_;
  LooseSearch search_;
  std::vector<std::uint8_t> out_, frozen_, flying_;
  fem::HyperelasticBody resting_;
  FrozenParts parts_;
};

}  // namespace sunder::solver
