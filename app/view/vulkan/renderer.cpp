// SPDX-License-Identifier: Apache-2.0
#include "app/view/vulkan/renderer.hpp"

#include <algorithm>
#include <cstring>

#include "app/figure/shading.hpp"
#include "app/view/overlay.hpp"
#include "app/view/shaders/embedded.hpp"

namespace sunder::app::view {
namespace {

constexpr VkFormat kColourFormat = VK_FORMAT_R8G8B8A8_UNORM;
constexpr VkFormat kDepthFormat = VK_FORMAT_D16_UNORM;             // every device has it
constexpr VkSampleCountFlagBits kSamples = VK_SAMPLE_COUNT_4_BIT;  // likewise
constexpr double kLipWidth = 2.2;                                  // [px]
constexpr std::size_t kLeastBytes = 256;

/// As shaders/view.glsl has it.
struct Push {
  std::array<float, 16> to_clip{};
  std::array<float, 4> key{}, eye{}, plane{};
  std::array<float, 2> half_width{};
  std::uint32_t value_of = 0;
  float per_value = 0;
};
static_assert(sizeof(Push) == 128);  // what every device has room for

constexpr std::uint32_t kOpened = 1, kGrey = 2, kItemBits = 4;

std::array<float, 4> four(const Vec3& v, double w) {
  return {static_cast<float>(v.x()), static_cast<float>(v.y()), static_cast<float>(v.z()),
          static_cast<float>(w)};
}

}  // namespace

Renderer::Renderer(Device& device, const PictureSize& size)
    : device_(device),
      size_(size),
      extent_{static_cast<std::uint32_t>(size.width), static_cast<std::uint32_t>(size.height)},
      many_(device, extent_, kColourFormat, kSamples, VK_IMAGE_USAGE_COLOR_ATTACHMENT_BIT,
            VK_IMAGE_ASPECT_COLOR_BIT),
      depth_(device, extent_, kDepthFormat, kSamples, VK_IMAGE_USAGE_DEPTH_STENCIL_ATTACHMENT_BIT,
             VK_IMAGE_ASPECT_DEPTH_BIT),
      colour_(device, extent_, kColourFormat, VK_SAMPLE_COUNT_1_BIT,
              VK_IMAGE_USAGE_COLOR_ATTACHMENT_BIT | VK_IMAGE_USAGE_TRANSFER_SRC_BIT,
              VK_IMAGE_ASPECT_COLOR_BIT),
      commands_(device),
      pixels_(device, std::size_t{4} * extent_.width * extent_.height,
              VK_BUFFER_USAGE_TRANSFER_DST_BIT, true) {
  make_pass();
  make_framebuffer();
  make_layout();
  body_ = make_pipeline(shaders::body_vert(), shaders::body_frag());
  lips_ = make_pipeline(shaders::lips_vert(), shaders::lips_frag());
  for (std::size_t b = 0; b < kBindings; ++b) reserve(static_cast<Binding>(b), kLeastBytes);
  upload_shades();
}

/// The scale's shades, then grey, then what nothing is known of.
void Renderer::upload_shades() {
  std::vector<Color> shades(reds().begin(), reds().end());
  shades.insert(shades.end(), {kFrame, kPlain});
  reserve(kShades, shades.size() * sizeof(std::uint32_t));
  auto* row = buffers_[kShades].as<std::uint32_t>();
  for (const Color c : shades) {
    *row++ = 0xff000000U | static_cast<std::uint32_t>(c.b) << 16U |
             static_cast<std::uint32_t>(c.g) << 8U | c.r;
  }
}

void Renderer::make_pass() {
  std::array<VkAttachmentDescription, 3> attachments{};
  for (VkAttachmentDescription& a : attachments) {
    a.format = kColourFormat;
    a.samples = kSamples;
    a.loadOp = VK_ATTACHMENT_LOAD_OP_CLEAR;
    a.storeOp = VK_ATTACHMENT_STORE_OP_DONT_CARE;
    a.stencilLoadOp = VK_ATTACHMENT_LOAD_OP_DONT_CARE;
    a.stencilStoreOp = VK_ATTACHMENT_STORE_OP_DONT_CARE;
    a.finalLayout = VK_IMAGE_LAYOUT_COLOR_ATTACHMENT_OPTIMAL;
  }
  attachments[1].format = kDepthFormat;
  attachments[1].finalLayout = VK_IMAGE_LAYOUT_DEPTH_STENCIL_ATTACHMENT_OPTIMAL;
  attachments[2].samples = VK_SAMPLE_COUNT_1_BIT;
  attachments[2].loadOp = VK_ATTACHMENT_LOAD_OP_DONT_CARE;
  attachments[2].storeOp = VK_ATTACHMENT_STORE_OP_STORE;
  attachments[2].finalLayout = VK_IMAGE_LAYOUT_TRANSFER_SRC_OPTIMAL;
  const VkAttachmentReference colour{0, VK_IMAGE_LAYOUT_COLOR_ATTACHMENT_OPTIMAL};
  const VkAttachmentReference depth{1, VK_IMAGE_LAYOUT_DEPTH_STENCIL_ATTACHMENT_OPTIMAL};
  const VkAttachmentReference resolved{2, VK_IMAGE_LAYOUT_COLOR_ATTACHMENT_OPTIMAL};
  VkSubpassDescription subpass{};
  subpass.pipelineBindPoint = VK_PIPELINE_BIND_POINT_GRAPHICS;
  subpass.colorAttachmentCount = 1;
  subpass.pColorAttachments = &colour;
  subpass.pResolveAttachments = &resolved;
  subpass.pDepthStencilAttachment = &depth;
  // The picture before is done with; this one is copied afterwards.
  constexpr VkPipelineStageFlags kTests =
      VK_PIPELINE_STAGE_EARLY_FRAGMENT_TESTS_BIT | VK_PIPELINE_STAGE_LATE_FRAGMENT_TESTS_BIT;
  std::array<VkSubpassDependency, 2> dependencies{};
  dependencies[0].srcSubpass = VK_SUBPASS_EXTERNAL;
  dependencies[0].dstSubpass = 0;
  dependencies[0].srcStageMask =
      kTests | VK_PIPELINE_STAGE_COLOR_ATTACHMENT_OUTPUT_BIT | VK_PIPELINE_STAGE_TRANSFER_BIT;
  dependencies[0].dstStageMask = kTests | VK_PIPELINE_STAGE_COLOR_ATTACHMENT_OUTPUT_BIT;
  dependencies[0].srcAccessMask = VK_ACCESS_COLOR_ATTACHMENT_WRITE_BIT |
                                  VK_ACCESS_DEPTH_STENCIL_ATTACHMENT_WRITE_BIT |
                                  VK_ACCESS_TRANSFER_READ_BIT;
  dependencies[0].dstAccessMask = VK_ACCESS_COLOR_ATTACHMENT_WRITE_BIT |
                                  VK_ACCESS_DEPTH_STENCIL_ATTACHMENT_READ_BIT |
                                  VK_ACCESS_DEPTH_STENCIL_ATTACHMENT_WRITE_BIT;
  dependencies[1].srcSubpass = 0;
  dependencies[1].dstSubpass = VK_SUBPASS_EXTERNAL;
  dependencies[1].srcStageMask = VK_PIPELINE_STAGE_COLOR_ATTACHMENT_OUTPUT_BIT;
  dependencies[1].dstStageMask = VK_PIPELINE_STAGE_TRANSFER_BIT;
  dependencies[1].srcAccessMask = VK_ACCESS_COLOR_ATTACHMENT_WRITE_BIT;
  dependencies[1].dstAccessMask = VK_ACCESS_TRANSFER_READ_BIT;
  VkRenderPassCreateInfo info{};
  info.sType = VK_STRUCTURE_TYPE_RENDER_PASS_CREATE_INFO;
  info.attachmentCount = static_cast<std::uint32_t>(attachments.size());
  info.pAttachments = attachments.data();
  info.subpassCount = 1;
  info.pSubpasses = &subpass;
  info.dependencyCount = static_cast<std::uint32_t>(dependencies.size());
  info.pDependencies = dependencies.data();
  const DeviceFunctions& vk = device_.vk();
  pass_ = make<VkRenderPass>(device_, vk.CreateRenderPass, info, vk.DestroyRenderPass,
                             "vkCreateRenderPass");
}

void Renderer::make_framebuffer() {
  const std::array<VkImageView, 3> views{many_.view(), depth_.view(), colour_.view()};
  VkFramebufferCreateInfo info{};
  info.sType = VK_STRUCTURE_TYPE_FRAMEBUFFER_CREATE_INFO;
  info.renderPass = pass_.get();
  info.attachmentCount = static_cast<std::uint32_t>(views.size());
  info.pAttachments = views.data();
  info.width = extent_.width;
  info.height = extent_.height;
  info.layers = 1;
  const DeviceFunctions& vk = device_.vk();
  framebuffer_ = make<VkFramebuffer>(device_, vk.CreateFramebuffer, info, vk.DestroyFramebuffer,
                                     "vkCreateFramebuffer");
}

void Renderer::make_layout() {
  const DeviceFunctions& vk = device_.vk();
  std::array<VkDescriptorSetLayoutBinding, kBindings> bindings{};
  for (std::size_t b = 0; b < kBindings; ++b) {
    bindings[b].binding = static_cast<std::uint32_t>(b);
    bindings[b].descriptorType = VK_DESCRIPTOR_TYPE_STORAGE_BUFFER;
    bindings[b].descriptorCount = 1;
    bindings[b].stageFlags = VK_SHADER_STAGE_VERTEX_BIT;
  }
  VkDescriptorSetLayoutCreateInfo set_info{};
  set_info.sType = VK_STRUCTURE_TYPE_DESCRIPTOR_SET_LAYOUT_CREATE_INFO;
  set_info.bindingCount = static_cast<std::uint32_t>(bindings.size());
  set_info.pBindings = bindings.data();
  set_layout_ =
      make<VkDescriptorSetLayout>(device_, vk.CreateDescriptorSetLayout, set_info,
                                  vk.DestroyDescriptorSetLayout, "vkCreateDescriptorSetLayout");
  const VkDescriptorPoolSize pool_size{VK_DESCRIPTOR_TYPE_STORAGE_BUFFER, kBindings};
  VkDescriptorPoolCreateInfo pool_info{};
  pool_info.sType = VK_STRUCTURE_TYPE_DESCRIPTOR_POOL_CREATE_INFO;
  pool_info.maxSets = 1;
  pool_info.poolSizeCount = 1;
  pool_info.pPoolSizes = &pool_size;
  set_pool_ = make<VkDescriptorPool>(device_, vk.CreateDescriptorPool, pool_info,
                                     vk.DestroyDescriptorPool, "vkCreateDescriptorPool");
  VkDescriptorSetAllocateInfo allocate{};
  allocate.sType = VK_STRUCTURE_TYPE_DESCRIPTOR_SET_ALLOCATE_INFO;
  allocate.descriptorPool = set_pool_.get();
  allocate.descriptorSetCount = 1;
  allocate.pSetLayouts = set_layout_.address();
  check(vk.AllocateDescriptorSets(device_.handle(), &allocate, &set_), "vkAllocateDescriptorSets");
  const VkPushConstantRange range{VK_SHADER_STAGE_VERTEX_BIT | VK_SHADER_STAGE_FRAGMENT_BIT, 0,
                                  sizeof(Push)};
  VkPipelineLayoutCreateInfo info{};
  info.sType = VK_STRUCTURE_TYPE_PIPELINE_LAYOUT_CREATE_INFO;
  info.setLayoutCount = 1;
  info.pSetLayouts = set_layout_.address();
  info.pushConstantRangeCount = 1;
  info.pPushConstantRanges = &range;
  layout_ = make<VkPipelineLayout>(device_, vk.CreatePipelineLayout, info, vk.DestroyPipelineLayout,
                                   "vkCreatePipelineLayout");
}

Owned<VkPipeline> Renderer::make_pipeline(std::span<const std::uint32_t> vertex,
                                          std::span<const std::uint32_t> fragment) {
  const DeviceFunctions& vk = device_.vk();
  const auto module_of = [&](std::span<const std::uint32_t> words) {
    VkShaderModuleCreateInfo info{};
    info.sType = VK_STRUCTURE_TYPE_SHADER_MODULE_CREATE_INFO;
    info.codeSize = words.size_bytes();
    info.pCode = words.data();
    return make<VkShaderModule>(device_, vk.CreateShaderModule, info, vk.DestroyShaderModule,
                                "vkCreateShaderModule");
  };
  const auto vertex_module = module_of(vertex), fragment_module = module_of(fragment);
  std::array<VkPipelineShaderStageCreateInfo, 2> stages{};
  for (VkPipelineShaderStageCreateInfo& s : stages) {
    s.sType = VK_STRUCTURE_TYPE_PIPELINE_SHADER_STAGE_CREATE_INFO;
    s.pName = "main";
  }
  stages[0].stage = VK_SHADER_STAGE_VERTEX_BIT;
  stages[0].module = vertex_module.get();
  stages[1].stage = VK_SHADER_STAGE_FRAGMENT_BIT;
  stages[1].module = fragment_module.get();
  VkPipelineVertexInputStateCreateInfo no_input{};  // the shaders read their buffers themselves
  no_input.sType = VK_STRUCTURE_TYPE_PIPELINE_VERTEX_INPUT_STATE_CREATE_INFO;
  VkPipelineInputAssemblyStateCreateInfo assembly{};
  assembly.sType = VK_STRUCTURE_TYPE_PIPELINE_INPUT_ASSEMBLY_STATE_CREATE_INFO;
  assembly.topology = VK_PRIMITIVE_TOPOLOGY_TRIANGLE_LIST;
  VkPipelineViewportStateCreateInfo viewport{};
  viewport.sType = VK_STRUCTURE_TYPE_PIPELINE_VIEWPORT_STATE_CREATE_INFO;
  viewport.viewportCount = viewport.scissorCount = 1;
  VkPipelineRasterizationStateCreateInfo raster{};
  raster.sType = VK_STRUCTURE_TYPE_PIPELINE_RASTERIZATION_STATE_CREATE_INFO;
  raster.frontFace = VK_FRONT_FACE_COUNTER_CLOCKWISE;
  raster.lineWidth = 1;
  VkPipelineMultisampleStateCreateInfo samples{};
  samples.sType = VK_STRUCTURE_TYPE_PIPELINE_MULTISAMPLE_STATE_CREATE_INFO;
  samples.rasterizationSamples = kSamples;
  VkPipelineDepthStencilStateCreateInfo depth{};
  depth.sType = VK_STRUCTURE_TYPE_PIPELINE_DEPTH_STENCIL_STATE_CREATE_INFO;
  depth.depthTestEnable = depth.depthWriteEnable = VK_TRUE;
  depth.depthCompareOp = VK_COMPARE_OP_LESS_OR_EQUAL;
  VkPipelineColorBlendAttachmentState opaque{};
  opaque.colorWriteMask = VK_COLOR_COMPONENT_R_BIT | VK_COLOR_COMPONENT_G_BIT |
                          VK_COLOR_COMPONENT_B_BIT | VK_COLOR_COMPONENT_A_BIT;
  VkPipelineColorBlendStateCreateInfo blend{};
  blend.sType = VK_STRUCTURE_TYPE_PIPELINE_COLOR_BLEND_STATE_CREATE_INFO;
  blend.attachmentCount = 1;
  blend.pAttachments = &opaque;
  const std::array<VkDynamicState, 2> states{VK_DYNAMIC_STATE_VIEWPORT, VK_DYNAMIC_STATE_SCISSOR};
  VkPipelineDynamicStateCreateInfo dynamic{};
  dynamic.sType = VK_STRUCTURE_TYPE_PIPELINE_DYNAMIC_STATE_CREATE_INFO;
  dynamic.dynamicStateCount = static_cast<std::uint32_t>(states.size());
  dynamic.pDynamicStates = states.data();
  VkGraphicsPipelineCreateInfo info{};
  info.sType = VK_STRUCTURE_TYPE_GRAPHICS_PIPELINE_CREATE_INFO;
  info.stageCount = static_cast<std::uint32_t>(stages.size());
  info.pStages = stages.data();
  info.pVertexInputState = &no_input;
  info.pInputAssemblyState = &assembly;
  info.pViewportState = &viewport;
  info.pRasterizationState = &raster;
  info.pMultisampleState = &samples;
  info.pDepthStencilState = &depth;
  info.pColorBlendState = &blend;
  info.pDynamicState = &dynamic;
  info.layout = layout_.get();
  info.renderPass = pass_.get();
  VkPipeline pipeline = VK_NULL_HANDLE;
  check(vk.CreateGraphicsPipelines(device_.handle(), VK_NULL_HANDLE, 1, &info, nullptr, &pipeline),
        "vkCreateGraphicsPipelines");
  return {device_, pipeline, vk.DestroyPipeline};
}

/// Room for so much, what is there stays. It grows by half at least, so that a tear that goes on
/// asks for memory now and then only.
void Renderer::reserve(Binding binding, std::size_t bytes) {
  HostBuffer& buffer = buffers_[binding];
  if (bytes <= buffer.size()) return;
  HostBuffer larger(device_, std::max(bytes, buffer.size() * 3 / 2),
                    VK_BUFFER_USAGE_STORAGE_BUFFER_BIT, false);
  if (buffer.size() > 0) {
    std::memcpy(larger.as<std::uint8_t>(), buffer.as<std::uint8_t>(), buffer.size());
  }
  buffer = std::move(larger);
  const bool shared = binding == kPlaces || binding == kNormals || binding == kValues;
  if (!points_ || !shared) bind(binding, buffer);
}

void Renderer::bind(Binding binding, const HostBuffer& buffer) {
  const VkDescriptorBufferInfo whole{buffer.get(), 0, VK_WHOLE_SIZE};
  VkWriteDescriptorSet write{};
  write.sType = VK_STRUCTURE_TYPE_WRITE_DESCRIPTOR_SET;
  write.dstSet = set_;
  write.dstBinding = static_cast<std::uint32_t>(binding);
  write.descriptorCount = 1;
  write.descriptorType = VK_DESCRIPTOR_TYPE_STORAGE_BUFFER;
  write.pBufferInfo = &whole;
  device_.vk().UpdateDescriptorSets(device_.handle(), 1, &write, 0, nullptr);
}

void Renderer::set_triangles(std::span<const SurfaceTriangle> triangles,
                             std::span<const std::uint32_t> changed,
                             std::span<const std::uint8_t> grey) {
  using Row = std::array<std::uint32_t, 4>;
  reserve(kTriangles, triangles.size() * sizeof(Row));
  Row* const rows = buffers_[kTriangles].as<Row>();
  for (const std::uint32_t place : changed) {
    if (place >= triangles.size()) continue;
    const SurfaceTriangle& t = triangles[place];
    const bool is_grey = !grey.empty() && grey[static_cast<std::size_t>(t.element)] != 0;
    rows[place] = {static_cast<std::uint32_t>(t.nodes[0]), static_cast<std::uint32_t>(t.nodes[1]),
                   static_cast<std::uint32_t>(t.nodes[2]),
                   (t.opened ? kOpened : 0) | (is_grey ? kGrey : 0)};
    uploaded_ += sizeof(Row);
  }
  triangle_count_ = static_cast<std::uint32_t>(triangles.size());
}

void Renderer::set_points(std::span<const Vec3> places, std::span<const Vec3> normals) {
  using Row = std::array<float, 4>;
  if (points_) {
    points_.reset();
    bind(kPlaces, buffers_[kPlaces]);
    bind(kNormals, buffers_[kNormals]);
    bind(kValues, buffers_[kValues]);
  }
  const auto put = [&](Binding binding, std::span<const Vec3> points) {
    reserve(binding, points.size() * sizeof(Row));
    Row* const rows = buffers_[binding].as<Row>();
    for (std::size_t i = 0; i < points.size(); ++i) rows[i] = four(points[i], 0);
    uploaded_ += points.size() * sizeof(Row);
  };
  put(kPlaces, places);
  put(kNormals, normals);
}

void Renderer::set_points(std::shared_ptr<const Points> points) {
  bind(kPlaces, points->places);
  bind(kNormals, points->normals);
  bind(kValues, points->values);
  points_ = std::move(points);
}

void Renderer::set_values(std::span<const float> values) {
  reserve(kValues, values.size_bytes());
  auto* const rows = buffers_[kValues].as<float>();
  const std::size_t known = std::min(values_.size(), values.size());
  values_.resize(values.size());
  for (std::size_t i = 0; i < values.size(); ++i) {
    if (i < known && values_[i] == values[i]) continue;
    rows[i] = values_[i] = values[i];
    uploaded_ += sizeof(float);
  }
}

void Renderer::set_lips(std::span<const std::array<Index, 2>> lips) {
  using Row = std::array<std::uint32_t, 2>;
  reserve(kLips, lips.size() * sizeof(Row));
  Row* const rows = buffers_[kLips].as<Row>();
  for (std::size_t i = 0; i < lips.size(); ++i) {
    rows[i] = {static_cast<std::uint32_t>(lips[i][0]), static_cast<std::uint32_t>(lips[i][1])};
  }
  uploaded_ += lips.size() * sizeof(Row);
  lip_count_ = static_cast<std::uint32_t>(lips.size());
}

void Renderer::record(const Camera& camera, const Look& look, const Scale& scale) {
  const DeviceFunctions& vk = device_.vk();
  const VkCommandBuffer commands = commands_.begin();
  constexpr float kFull = 255;
  std::array<VkClearValue, 2> clear{};
  clear[0].color = {{kBackground.r / kFull, kBackground.g / kFull, kBackground.b / kFull, 1}};
  clear[1].depthStencil = {1, 0};
  VkRenderPassBeginInfo pass{};
  pass.sType = VK_STRUCTURE_TYPE_RENDER_PASS_BEGIN_INFO;
  pass.renderPass = pass_.get();
  pass.framebuffer = framebuffer_.get();
  pass.renderArea = {{0, 0}, extent_};
  pass.clearValueCount = static_cast<std::uint32_t>(clear.size());
  pass.pClearValues = clear.data();
  vk.CmdBeginRenderPass(commands, &pass, VK_SUBPASS_CONTENTS_INLINE);
  const VkViewport viewport{0, 0, static_cast<float>(size_.width), static_cast<float>(size_.height),
                            0, 1};
  const VkRect2D all{{0, 0}, extent_};
  vk.CmdSetViewport(commands, 0, 1, &viewport);
  vk.CmdSetScissor(commands, 0, 1, &all);
  Push push;
  push.to_clip = camera.matrix();
  const Vec3 key = (-0.5 * camera.right() + 0.7 * camera.up() + 0.5 * camera.eye()).normalized();
  push.key = four(key, look.wireframe ? 1 : 0);
  push.eye = four(camera.eye(), 0);
  push.plane =
      look.clip.normal ? four(*look.clip.normal, look.clip.offset) : std::array<float, 4>{};
  push.half_width = {static_cast<float>(kLipWidth / size_.width),
                     static_cast<float>(kLipWidth / size_.height)};
  push.value_of = points_ ? Points::kNumbers | scale.item << kItemBits : 1;
  push.per_value = scale.known ? static_cast<float>(1 / scale.maximum) : -1;
  vk.CmdBindDescriptorSets(commands, VK_PIPELINE_BIND_POINT_GRAPHICS, layout_.get(), 0, 1, &set_, 0,
                           nullptr);
  vk.CmdPushConstants(commands, layout_.get(),
                      VK_SHADER_STAGE_VERTEX_BIT | VK_SHADER_STAGE_FRAGMENT_BIT, 0, sizeof push,
                      &push);
  if (triangle_count_ > 0) {
    vk.CmdBindPipeline(commands, VK_PIPELINE_BIND_POINT_GRAPHICS, body_.get());
    vk.CmdDraw(commands, 3 * triangle_count_, 1, 0, 0);
  }
  if (lip_count_ > 0) {
    vk.CmdBindPipeline(commands, VK_PIPELINE_BIND_POINT_GRAPHICS, lips_.get());
    vk.CmdDraw(commands, 6 * lip_count_, 1, 0, 0);
  }
  vk.CmdEndRenderPass(commands);
  VkBufferImageCopy copy{};
  copy.imageSubresource = {VK_IMAGE_ASPECT_COLOR_BIT, 0, 0, 1};
  copy.imageExtent = {extent_.width, extent_.height, 1};
  vk.CmdCopyImageToBuffer(commands, colour_.get(), VK_IMAGE_LAYOUT_TRANSFER_SRC_OPTIMAL,
                          pixels_.get(), 1, &copy);
  VkMemoryBarrier to_host{};
  to_host.sType = VK_STRUCTURE_TYPE_MEMORY_BARRIER;
  to_host.srcAccessMask = VK_ACCESS_TRANSFER_WRITE_BIT;
  to_host.dstAccessMask = VK_ACCESS_HOST_READ_BIT;
  vk.CmdPipelineBarrier(commands, VK_PIPELINE_STAGE_TRANSFER_BIT, VK_PIPELINE_STAGE_HOST_BIT, 0, 1,
                        &to_host, 0, nullptr, 0, nullptr);
}

void Renderer::draw(const Camera& camera, const Look& look, const Scale& scale) {
  record(camera, look, scale);
  commands_.run();
}

Pixels Renderer::read() const {
  Pixels pixels{size_.width, size_.height, {}};
  const auto* bytes = pixels_.as<std::uint8_t>();
  pixels.rgba.assign(bytes, bytes + pixels_.size());
  return pixels;
}

}  // namespace sunder::app::view
