// SPDX-License-Identifier: Apache-2.0
#include "gpu/passes/inverse_refinement.hpp"

#include <algorithm>
#include <numeric>

#include "gpu/vulkan/commands.hpp"
#include "linear_algebra/row_product.hpp"

namespace sunder::gpu {
namespace {

using vulkan::Buffer;
using vulkan::Placement;

// Columns that are refined together, as shaders/dense_product.comp takes them.
constexpr std::uint32_t kColumns = shaders::kColumnPad;
static_assert(kColumns % shaders::kTile == 0 && kColumns % shaders::kDepth == 0);

/// X times so many columns.
class Product {
 public:
  Product(const KernelFactory& kernels, std::uint32_t rows, const DenseInverse& inverse)
      : kernels_(kernels),
        rows_(rows),
        kernel_(kernels.make("dense_product", kernels.low_rank_group())),
        right_(kernels.device(), bytes(), Placement::device),
        product_(kernels.device(), bytes(), Placement::device),
        commands_(kernels.device()) {
    for (const DenseInverse::Part& part : inverse.parts()) {
      const Buffer* buffers[] = {&product_, part.matrix, &right_, &product_};
      parts_.push_back(
          {part, std::make_unique<vulkan::Binding>(kernels.device(), *kernel_, buffers)});
    }
  }
  /// Shape of both (rows x kColumns).
  void multiply(const linear_algebra::RowMajor& by, Eigen::MatrixXd& product) {
    right_.write(std::span<const double>(by.data(), static_cast<std::size_t>(by.size())));
    const std::uint32_t groups =
        kColumns * (shaders::kTile / 4) / (kernels_.low_rank_group() * shaders::kUpdateColumns);
    commands_.begin();
    for (const auto& [part, binding] : parts_) {
      const float keep = part.first > 0 ? 1 : 0;
      commands_.dispatch(*binding,
                         shaders::ProductPush{rows_ / 4, part.columns, kColumns / 4,
                                              part.first * kColumns, 0, 0, keep, 0},
                         rows_ / shaders::kTile, groups);
    }
    commands_.end();
    commands_.submit();
    product.resize(rows_, kColumns);
    product_.read(std::span<double>(product.data(), static_cast<std::size_t>(product.size())));
  }
  [[nodiscard]] std::size_t bytes() const { return std::size_t{rows_} * kColumns * sizeof(double); }

 private:
  struct OfPart {
    DenseInverse::Part part;
    std::unique_ptr<vulkan::Binding> binding;
  };
  const KernelFactory& kernels_;
  std::uint32_t rows_;
  std::unique_ptr<vulkan::Kernel> kernel_;
  Buffer right_, product_;
  vulkan::Commands commands_;
  std::vector<OfPart> parts_;
};

}  // namespace

void unit_residuals(const fem::DamagedBody& body, std::span<const Index> dofs,
                    const Eigen::Ref<const Eigen::MatrixXd>& columns, Eigen::MatrixXd& residuals) {
  body.apply(columns, residuals);
  const double stiffness = body.problem().anchor_stiffness();  // K has it beside its elements
  for (Index d : body.problem().anchored_dofs()) {
    residuals.row(d) += stiffness * columns.row(d);
  }
  residuals = -residuals;
  for (std::size_t i = 0; i < dofs.size(); ++i) residuals(dofs[i], static_cast<Index>(i)) += 1;
}

void refine_inverse(const KernelFactory& kernels, const fem::DamagedBody& body, std::uint32_t rows,
                    DenseInverse& inverse) {
  const Index n = body.problem().dof_count();
  Product product(kernels, rows, inverse);
  linear_algebra::RowMajor right(rows, kColumns);
  Eigen::MatrixXd columns, residuals, change;
  std::vector<Index> dofs;
  for (Index first = 0; first < n; first += kColumns) {
    dofs.resize(static_cast<std::size_t>(std::min<Index>(kColumns, n - first)));
    std::iota(dofs.begin(), dofs.end(), first);
    const auto count = static_cast<Index>(dofs.size());
    columns.resize(n, count);
    inverse.read_columns(dofs, columns);
    unit_residuals(body, dofs, columns, residuals);
    right.setZero();
    right.topLeftCorner(n, count) = residuals;
    product.multiply(right, change);
    columns += change.topLeftCorner(n, count);
    inverse.write_columns(first, columns);
  }
}

std::size_t planned_refinement_bytes(std::uint32_t rows) {
  return 2 * Buffer::padded(std::size_t{rows} * kColumns * sizeof(double));
}

}  // namespace sunder::gpu
