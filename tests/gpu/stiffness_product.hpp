// SPDX-License-Identifier: Apache-2.0
// K p as route cg computes it, with vectors of its own.
#pragma once

#include <memory>
#include <span>
#include <vector>

#include "gpu/passes/block_matrix.hpp"
#include "gpu/passes/fields.hpp"
#include "gpu/vulkan/commands.hpp"

namespace sunder::test {

/// Four values a node.
class Multiply {
 public:
  Multiply(vulkan::Device& device, const gpu::KernelFactory& kernels, const gpu::Fields& fields,
           const gpu::BlockMatrix& matrix)
      : groups_(matrix.groups()), parts_(groups_ * kernels.parts()), commands_(device) {
    const std::size_t bytes = std::size_t{groups_} * shaders::kGroup * 4 * sizeof(double);
    p_ = vulkan::Buffer(device, bytes, vulkan::Placement::device);
    q_ = vulkan::Buffer(device, bytes, vulkan::Placement::device);
    sums_ = vulkan::Buffer(device, parts_ * sizeof(double), vulkan::Placement::device);
    std::vector<const vulkan::Buffer*> buffers{
        &matrix.blocks(), &matrix.slices(), &fields.dofs(), &p_, &q_, &sums_};
    const gpu::PatchVectors& patches = matrix.patches();
    if (!patches.empty()) {
      patches.append_to(buffers);
      patch_groups_ = patches.groups();
      patch_kernel_ = kernels.make("patch_sums");
      patch_sums_ = patches.bind_sums(kernels, *patch_kernel_, p_);
    }
    kernel_ = kernels.make(patches.empty() ? "cg_multiply" : "cg_multiply_pooled");
    binding_ = std::make_unique<vulkan::Binding>(device, *kernel_, buffers);
  }

  struct Result {
    std::vector<double> q;  // four values a node
    double pq = 0;
  };
  Result operator()(std::span<const double> p) {
    p_.write(p);
    commands_.begin();
    if (patch_sums_) commands_.dispatch(*patch_sums_, patch_groups_);
    commands_.dispatch(*binding_, groups_);
    commands_.end();
    return result(p.size());
  }
  /// What q holds after a dispatch of a size from a buffer; it held ones before.
  std::vector<double> of_size(const vulkan::Buffer& sizes, std::size_t offset) {
    const std::vector<double> ones(q_.bytes() / sizeof(double), 1.0);
    q_.write(std::span<const double>(ones));
    p_.fill_zero();
    commands_.begin();
    commands_.dispatch_indirect(*binding_, sizes, offset);
    commands_.end();
    return result(ones.size()).q;
  }

 private:
  Result result(std::size_t values) {
    commands_.submit();
    Result result{std::vector<double>(values), 0};
    q_.read(std::span<double>(result.q));
    std::vector<double> sums(parts_);
    sums_.read(std::span<double>(sums));
    for (double s : sums) result.pq += s;
    return result;
  }

  std::uint32_t groups_, parts_, patch_groups_ = 0;
  vulkan::Buffer p_, q_, sums_;
  std::unique_ptr<vulkan::Kernel> kernel_, patch_kernel_;
  std::unique_ptr<vulkan::Binding> binding_, patch_sums_;
  vulkan::Commands commands_;
};

}  // namespace sunder::test
