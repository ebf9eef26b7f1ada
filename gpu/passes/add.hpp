// SPDX-License-Identifier: Apache-2.0
// displacement += correction, over all nodes.
#pragma once

#include "gpu/passes/fields.hpp"

namespace sunder::gpu {

class AddCorrection {
 public:
  AddCorrection(const KernelFactory& kernels, const Fields& fields)
      : packs_(static_cast<std::uint32_t>(fields.nodal(Field::correction).bytes() / 32)),
        kernel_(kernels.make_fp64("add")) {
    const vulkan::Buffer* buffers[] = {&fields.nodal(Field::correction),
                                       &fields.nodal(Field::displacement)};
    binding_ = std::make_unique<vulkan::Binding>(kernels.device(), *kernel_, buffers);
  }
  void record(vulkan::Commands& commands) const {
    commands.dispatch(*binding_, packs_, packs_ / shaders::kGroup);
  }

 private:
  std::uint32_t packs_;  // a multiple of 64: nodes and rows are padded
  std::unique_ptr<vulkan::Kernel> kernel_;
  std::unique_ptr<vulkan::Binding> binding_;
};

}  // namespace sunder::gpu
