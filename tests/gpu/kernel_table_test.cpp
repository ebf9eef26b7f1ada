// SPDX-License-Identifier: Apache-2.0
// The kernels' table against what the compiled kernels say of themselves: a binding that the table
// lacks, or has as another kind, would be read as something else, and no driver need notice.
#include <gtest/gtest.h>
#include <spirv_cross_c.h>

#include <algorithm>
#include <map>
#include <string>

#include "gpu/kernels.hpp"
#include "shaders/embedded.hpp"

namespace sunder::test {
namespace {

using vulkan::Access;

/// What a compiled kernel declares.
struct Declared {
  std::map<unsigned, Access> bindings;  ///< of set 0
  std::size_t push_bytes = 0;
  bool other_sets = false;
};

class Reflection {
 public:
  explicit Reflection(std::span<const std::uint32_t> words) {
    EXPECT_EQ(spvc_context_create(&context_), SPVC_SUCCESS);
    spvc_parsed_ir ir = nullptr;
    EXPECT_EQ(spvc_context_parse_spirv(context_, words.data(), words.size(), &ir), SPVC_SUCCESS);
    EXPECT_EQ(spvc_context_create_compiler(context_, SPVC_BACKEND_NONE, ir,
                                           SPVC_CAPTURE_MODE_TAKE_OWNERSHIP, &compiler_),
              SPVC_SUCCESS);
    EXPECT_EQ(spvc_compiler_create_shader_resources(compiler_, &resources_), SPVC_SUCCESS);
  }
  ~Reflection() { spvc_context_destroy(context_); }
  Reflection(const Reflection&) = delete;
  Reflection& operator=(const Reflection&) = delete;

  [[nodiscard]] Declared declared() const {
    Declared all;
    for (const auto& r : list(SPVC_RESOURCE_TYPE_STORAGE_BUFFER)) add(r, Access::storage, all);
    // samplerBuffer and usamplerBuffer: sampled images of dimension "buffer".
    for (const auto type : {SPVC_RESOURCE_TYPE_SAMPLED_IMAGE, SPVC_RESOURCE_TYPE_SEPARATE_IMAGE}) {
      for (const auto& r : list(type)) {
        const auto image = spvc_compiler_get_type_handle(compiler_, r.base_type_id);
        const auto texel =
            spvc_compiler_get_type_handle(compiler_, spvc_type_get_image_sampled_type(image));
        EXPECT_EQ(spvc_type_get_image_dimension(image), SpvDimBuffer);
        add(r,
            spvc_type_get_basetype(texel) == SPVC_BASETYPE_FP32 ? Access::texel_float4
                                                                : Access::texel_uint4,
            all);
      }
    }
    for (const auto& r : list(SPVC_RESOURCE_TYPE_PUSH_CONSTANT)) {
      const auto type = spvc_compiler_get_type_handle(compiler_, r.base_type_id);
      spvc_compiler_get_declared_struct_size(compiler_, type, &all.push_bytes);
    }
    return all;
  }

 private:
  [[nodiscard]] std::span<const spvc_reflected_resource> list(spvc_resource_type type) const {
    const spvc_reflected_resource* first = nullptr;
    std::size_t count = 0;
    spvc_resources_get_resource_list_for_type(resources_, type, &first, &count);
    return {first, count};
  }
  void add(const spvc_reflected_resource& resource, Access access, Declared& all) const {
    const auto of = [&](SpvDecoration d) {
      return spvc_compiler_get_decoration(compiler_, resource.id, d);
    };
    all.other_sets |= of(SpvDecorationDescriptorSet) != 0;
    const bool once = all.bindings.emplace(of(SpvDecorationBinding), access).second;
    EXPECT_TRUE(once) << resource.name << " has a binding of another";
  }

  spvc_context context_ = nullptr;
  spvc_compiler compiler_ = nullptr;
  spvc_resources resources_ = nullptr;
};

/// Of "stress_lvp_fp64": "fp64".
std::string_view precision_of(std::string_view name) { return name.substr(name.rfind('_') + 1); }

/// A kernel that computes in fp64 always is compiled as fp64 alone, a device without fp64 aside;
/// its exact columns are read by kernels in storage precision made as fp64.
Access expected(gpu::Reads reads, std::string_view kernel) {
  const bool lvp = kernel.find("_lvp_") != std::string_view::npos;
  return gpu::access(reads, lvp ? gpu::Variant::lvp : gpu::Variant::gpu,
                     precision_of(kernel) == "fp64", precision_of(kernel) == "single");
}

TEST(KernelTable, FitsEveryCompiledKernel) {
  ASSERT_FALSE(shaders::names().empty());
  for (std::string_view name : shaders::names()) {
    SCOPED_TRACE(name);
    const gpu::KernelRow& row = gpu::kernel_row(gpu::without_variant(name));
    const Declared declared = Reflection(shaders::find(name)).declared();
    EXPECT_FALSE(declared.other_sets);
    ASSERT_EQ(declared.bindings.size(), row.bindings.list().size());
    unsigned binding = 0;
    for (gpu::Reads reads : row.bindings.list()) {
      ASSERT_TRUE(declared.bindings.contains(binding)) << "no binding " << binding;
      EXPECT_EQ(declared.bindings.at(binding), expected(reads, name)) << "binding " << binding;
      ++binding;
    }
    // C++ rounds a struct up to its alignment.
    EXPECT_LE(declared.push_bytes, row.push_bytes);
    EXPECT_LT(row.push_bytes, declared.push_bytes + alignof(double));
  }
}

TEST(KernelTable, HasNoRowWithoutAKernelAndIsSorted) {
  std::string_view last;
  for (const gpu::KernelRow& row : gpu::kernel_table()) {
    EXPECT_LT(last, row.name);
    last = row.name;
    EXPECT_FALSE(row.does.empty());
    EXPECT_TRUE(std::ranges::any_of(shaders::names(), [&](std::string_view name) {
      return gpu::without_variant(name) == row.name;
    })) << row.name;
  }
}

}  // namespace
}  // namespace sunder::test
