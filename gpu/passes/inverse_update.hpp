// SPDX-License-Identifier: Apache-2.0
// A new base on the device from its own inverse: with X that, B and the small matrices of the
// damage (solver/deferred.hpp), X' = X + X B x, where x are the forces of the damage under each
// unit load, refined once. Computed bit by bit, some of it with each event: 12 k^2 n + k n^2
// flops for k columns of n unknowns.
#pragma once

#include <memory>
#include <optional>
#include <span>
#include <vector>

#include "gpu/kernels.hpp"
#include "gpu/passes/dense_inverse.hpp"
#include "gpu/passes/exact_columns.hpp"
#include "gpu/vulkan/commands.hpp"
#include "solver/deferred.hpp"

namespace sunder::gpu {

class InverseUpdate {
 public:
  /// `kernels`: in fp64, as the inverse is stored. Takes the memory of another inverse, and what so
  /// many columns of the damage need; more of them are made room for when they come.
  InverseUpdate(const KernelFactory& kernels, Index n, std::uint32_t rows, std::size_t panel_bytes,
                std::uint32_t columns);

  /// Bytes of that, before it exists.
  [[nodiscard]] static std::size_t planned_bytes(const KernelFactory& kernels, Index n,
                                                 std::uint32_t rows, std::size_t panel_bytes,
                                                 std::uint32_t columns);

  /// Begins with X = `of`, which nobody may write until hand_over() or drop(). X B are the columns
  /// at `places`, at least one; `damage` is what Deferred::copy_damage() gave of as many. `parts`:
  /// of the work, that advance() does one by one.
  void begin(const DenseInverse& of, const ExactColumns& columns, std::span<const Index> places,
             const solver::DamageMatrices& damage, std::size_t parts);
  /// Does a part, which is a submit at most; nothing is left after all of them.
  void advance();
  /// Does what is left; X' is there.
  void finish();
  [[nodiscard]] bool finished() const { return in_work_ && part_ == parts_; }
  /// That of finish().
  [[nodiscard]] const DenseInverse& inverse() const { return next_; }
  /// After finish(): `into`, the X of begin(), becomes X'.
  void hand_over(DenseInverse& into);
  /// Nobody wants it any more.
  void drop() { in_work_ = false; }
  [[nodiscard]] bool in_work() const { return in_work_; }

  [[nodiscard]] std::size_t bytes() const;

 private:
  /// X B, and what products of it the forces go through: a column for each of B.
  enum Panel { kColumns, kForces, kMoved, kLost, kLacks, kPanels };
  /// Compliance B^T X B, M and D.
  enum Small { kCompliance, kM, kD, kSmall };
  /// Some columns of one product.
  struct Piece {
    std::size_t step;  // pieces of one have columns of their own
    const vulkan::Binding* binding;
    shaders::ProductPush push;
    std::uint32_t tiles;
    double work;
  };

  void reserve(std::uint32_t columns);
  void copy_columns(const ExactColumns& columns, std::span<const Index> places);
  void write_small(Small which, const linear_algebra::RowMajor& a, Index count);
  void add_forces();
  void add_small_product(Panel after, Panel left, Small right, float keep, Panel before);
  void add_inverse(const DenseInverse& of);
  void add_pieces(std::unique_ptr<vulkan::Binding> binding, shaders::ProductPush push,
                  std::uint32_t columns);
  void compute(double until);

  const KernelFactory kernels_;
  std::uint32_t rows_;
  std::unique_ptr<vulkan::Kernel> product_;
  DenseInverse next_;
  std::uint32_t capacity_ = 0, depth_ = 0;  // columns of the damage: room for them, and how many
  vulkan::Buffer panels_[kPanels], small_[kSmall];
  std::vector<std::unique_ptr<vulkan::Binding>> bindings_;
  std::vector<Piece> pieces_;
  std::size_t step_ = 0, next_piece_ = 0, parts_ = 0, part_ = 0;
  double all_work_ = 0, done_work_ = 0;
  bool in_work_ = false;
  vulkan::Commands commands_;
};

}  // namespace sunder::gpu
