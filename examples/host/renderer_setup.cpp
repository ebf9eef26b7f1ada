// SPDX-License-Identifier: Apache-2.0
// What the renderer creates once: images, render pass, descriptors, pipelines.
#include "renderer.hpp"

namespace {

#include "body_vert.h"
#include "flat_frag.h"
#include "mark_vert.h"
#include "surface_vert.h"

VkShaderModule shader(const Device& device, std::span<const std::uint32_t> words) {
  VkShaderModuleCreateInfo info{VK_STRUCTURE_TYPE_SHADER_MODULE_CREATE_INFO};
  info.codeSize = words.size_bytes();
  info.pCode = words.data();
  VkShaderModule module = VK_NULL_HANDLE;
  check(vkCreateShaderModule(device.handle, &info, nullptr, &module), "vkCreateShaderModule");
  return module;
}

}  // namespace

void Renderer::create_image(VkFormat format, VkImageUsageFlags usage, VkImageAspectFlags aspect,
                            VkImage& image, VkDeviceMemory& memory, VkImageView& view) {
  VkImageCreateInfo info{VK_STRUCTURE_TYPE_IMAGE_CREATE_INFO};
  info.imageType = VK_IMAGE_TYPE_2D;
  info.format = format;
  info.extent = {width_, kHeight, 1};
  info.mipLevels = info.arrayLayers = 1;
  info.samples = VK_SAMPLE_COUNT_1_BIT;
  info.usage = usage;
  check(vkCreateImage(device_.handle, &info, nullptr, &image), "vkCreateImage");
  VkMemoryRequirements needed{};
  vkGetImageMemoryRequirements(device_.handle, image, &needed);
  VkMemoryAllocateInfo allocate{VK_STRUCTURE_TYPE_MEMORY_ALLOCATE_INFO};
  allocate.allocationSize = needed.size;
  allocate.memoryTypeIndex =
      device_.memory_type(needed.memoryTypeBits, VK_MEMORY_PROPERTY_DEVICE_LOCAL_BIT);
  check(vkAllocateMemory(device_.handle, &allocate, nullptr, &memory), "vkAllocateMemory");
  check(vkBindImageMemory(device_.handle, image, memory, 0), "vkBindImageMemory");
  VkImageViewCreateInfo of{VK_STRUCTURE_TYPE_IMAGE_VIEW_CREATE_INFO};
  of.image = image;
  of.viewType = VK_IMAGE_VIEW_TYPE_2D;
  of.format = format;
  of.subresourceRange = {aspect, 0, 1, 0, 1};
  check(vkCreateImageView(device_.handle, &of, nullptr, &view), "vkCreateImageView");
}

void Renderer::create_pass() {
  VkAttachmentDescription images[2]{};
  images[0].format = kColour;
  images[0].samples = images[1].samples = VK_SAMPLE_COUNT_1_BIT;
  images[0].loadOp = VK_ATTACHMENT_LOAD_OP_LOAD;  // the other panels stay
  images[0].storeOp = VK_ATTACHMENT_STORE_OP_STORE;
  images[0].initialLayout = images[0].finalLayout = VK_IMAGE_LAYOUT_COLOR_ATTACHMENT_OPTIMAL;
  images[1].format = kDepth;
  images[1].loadOp = VK_ATTACHMENT_LOAD_OP_CLEAR;
  images[1].storeOp = VK_ATTACHMENT_STORE_OP_DONT_CARE;
  images[1].finalLayout = VK_IMAGE_LAYOUT_DEPTH_STENCIL_ATTACHMENT_OPTIMAL;
  const VkAttachmentReference colour{0, VK_IMAGE_LAYOUT_COLOR_ATTACHMENT_OPTIMAL};
  const VkAttachmentReference depth{1, VK_IMAGE_LAYOUT_DEPTH_STENCIL_ATTACHMENT_OPTIMAL};
  VkSubpassDescription subpass{};
  subpass.colorAttachmentCount = 1;
  subpass.pColorAttachments = &colour;
  subpass.pDepthStencilAttachment = &depth;
  VkRenderPassCreateInfo info{VK_STRUCTURE_TYPE_RENDER_PASS_CREATE_INFO};
  info.attachmentCount = 2;
  info.pAttachments = images;
  info.subpassCount = 1;
  info.pSubpasses = &subpass;
  check(vkCreateRenderPass(device_.handle, &info, nullptr, &pass_), "vkCreateRenderPass");
  const VkImageView views[] = {colour_view_, depth_view_};
  VkFramebufferCreateInfo frame{VK_STRUCTURE_TYPE_FRAMEBUFFER_CREATE_INFO};
  frame.renderPass = pass_;
  frame.attachmentCount = 2;
  frame.pAttachments = views;
  frame.width = width_;
  frame.height = kHeight;
  frame.layers = 1;
  check(vkCreateFramebuffer(device_.handle, &frame, nullptr, &frame_), "vkCreateFramebuffer");
}

void Renderer::create_descriptors(const sunder_vulkan_display& display) {
  constexpr std::uint32_t kCount = 8;
  VkDescriptorSetLayoutBinding bindings[kCount]{};
  for (std::uint32_t b = 0; b < kCount; ++b) {
    bindings[b] = {b, VK_DESCRIPTOR_TYPE_STORAGE_BUFFER, 1, VK_SHADER_STAGE_VERTEX_BIT, nullptr};
  }
  VkDescriptorSetLayoutCreateInfo layout{VK_STRUCTURE_TYPE_DESCRIPTOR_SET_LAYOUT_CREATE_INFO};
  layout.bindingCount = kCount;
  layout.pBindings = bindings;
  check(vkCreateDescriptorSetLayout(device_.handle, &layout, nullptr, &set_layout_), "set layout");
  const VkDescriptorPoolSize size{VK_DESCRIPTOR_TYPE_STORAGE_BUFFER, kCount};
  VkDescriptorPoolCreateInfo pool{VK_STRUCTURE_TYPE_DESCRIPTOR_POOL_CREATE_INFO};
  pool.maxSets = pool.poolSizeCount = 1;
  pool.pPoolSizes = &size;
  check(vkCreateDescriptorPool(device_.handle, &pool, nullptr, &pool_), "descriptor pool");
  VkDescriptorSetAllocateInfo allocate{VK_STRUCTURE_TYPE_DESCRIPTOR_SET_ALLOCATE_INFO};
  allocate.descriptorPool = pool_;
  allocate.descriptorSetCount = 1;
  allocate.pSetLayouts = &set_layout_;
  check(vkAllocateDescriptorSets(device_.handle, &allocate, &set_), "descriptor set");

  const auto of = [](const sunder_vulkan_buffer& b) {
    return VkDescriptorBufferInfo{reinterpret_cast<VkBuffer>(b.buffer), b.offset, b.size};
  };
  const VkDescriptorBufferInfo buffers[kCount] = {{rest_.handle, 0, VK_WHOLE_SIZE},
                                                  {tets_.handle, 0, VK_WHOLE_SIZE},
                                                  of(display.displacement),
                                                  of(display.stress),
                                                  of(display.live),
                                                  {vertices_of_surface_.handle, 0, VK_WHOLE_SIZE},
                                                  {triangles_.handle, 0, VK_WHOLE_SIZE},
                                                  {facts_.handle, 0, VK_WHOLE_SIZE}};
  VkWriteDescriptorSet write{VK_STRUCTURE_TYPE_WRITE_DESCRIPTOR_SET};
  write.dstSet = set_;
  write.descriptorCount = kCount;
  write.descriptorType = VK_DESCRIPTOR_TYPE_STORAGE_BUFFER;
  write.pBufferInfo = buffers;
  vkUpdateDescriptorSets(device_.handle, 1, &write, 0, nullptr);

  const VkPushConstantRange push{VK_SHADER_STAGE_VERTEX_BIT, 0, sizeof(Push)};
  VkPipelineLayoutCreateInfo pipeline{VK_STRUCTURE_TYPE_PIPELINE_LAYOUT_CREATE_INFO};
  pipeline.setLayoutCount = pipeline.pushConstantRangeCount = 1;
  pipeline.pSetLayouts = &set_layout_;
  pipeline.pPushConstantRanges = &push;
  check(vkCreatePipelineLayout(device_.handle, &pipeline, nullptr, &layout_), "pipeline layout");
}

VkPipeline Renderer::create_pipeline(std::span<const std::uint32_t> vertex) {
  const VkShaderModule modules[] = {shader(device_, vertex), shader(device_, flat_frag)};
  VkPipelineShaderStageCreateInfo stages[2]{};
  for (int s = 0; s < 2; ++s) {
    stages[s].sType = VK_STRUCTURE_TYPE_PIPELINE_SHADER_STAGE_CREATE_INFO;
    stages[s].stage = s == 0 ? VK_SHADER_STAGE_VERTEX_BIT : VK_SHADER_STAGE_FRAGMENT_BIT;
    stages[s].module = modules[s];
    stages[s].pName = "main";
  }
  const VkPipelineVertexInputStateCreateInfo input{
      VK_STRUCTURE_TYPE_PIPELINE_VERTEX_INPUT_STATE_CREATE_INFO};
  VkPipelineInputAssemblyStateCreateInfo assembly{
      VK_STRUCTURE_TYPE_PIPELINE_INPUT_ASSEMBLY_STATE_CREATE_INFO};
  assembly.topology = VK_PRIMITIVE_TOPOLOGY_TRIANGLE_LIST;
  VkPipelineViewportStateCreateInfo viewport{VK_STRUCTURE_TYPE_PIPELINE_VIEWPORT_STATE_CREATE_INFO};
  viewport.viewportCount = viewport.scissorCount = 1;
  VkPipelineRasterizationStateCreateInfo raster{
      VK_STRUCTURE_TYPE_PIPELINE_RASTERIZATION_STATE_CREATE_INFO};
  raster.lineWidth = 1;
  VkPipelineMultisampleStateCreateInfo samples{
      VK_STRUCTURE_TYPE_PIPELINE_MULTISAMPLE_STATE_CREATE_INFO};
  samples.rasterizationSamples = VK_SAMPLE_COUNT_1_BIT;
  VkPipelineDepthStencilStateCreateInfo depth{
      VK_STRUCTURE_TYPE_PIPELINE_DEPTH_STENCIL_STATE_CREATE_INFO};
  depth.depthTestEnable = depth.depthWriteEnable = VK_TRUE;
  depth.depthCompareOp = VK_COMPARE_OP_LESS_OR_EQUAL;
  VkPipelineColorBlendAttachmentState opaque{};
  opaque.colorWriteMask = 0xf;
  VkPipelineColorBlendStateCreateInfo blend{
      VK_STRUCTURE_TYPE_PIPELINE_COLOR_BLEND_STATE_CREATE_INFO};
  blend.attachmentCount = 1;
  blend.pAttachments = &opaque;
  const VkDynamicState states[] = {VK_DYNAMIC_STATE_VIEWPORT, VK_DYNAMIC_STATE_SCISSOR};
  VkPipelineDynamicStateCreateInfo dynamic{VK_STRUCTURE_TYPE_PIPELINE_DYNAMIC_STATE_CREATE_INFO};
  dynamic.dynamicStateCount = 2;
  dynamic.pDynamicStates = states;
  VkGraphicsPipelineCreateInfo info{VK_STRUCTURE_TYPE_GRAPHICS_PIPELINE_CREATE_INFO};
  info.stageCount = 2;
  info.pStages = stages;
  info.pVertexInputState = &input;
  info.pInputAssemblyState = &assembly;
  info.pViewportState = &viewport;
  info.pRasterizationState = &raster;
  info.pMultisampleState = &samples;
  info.pDepthStencilState = &depth;
  info.pColorBlendState = &blend;
  info.pDynamicState = &dynamic;
  info.layout = layout_;
  info.renderPass = pass_;
  VkPipeline pipeline = VK_NULL_HANDLE;
  check(vkCreateGraphicsPipelines(device_.handle, VK_NULL_HANDLE, 1, &info, nullptr, &pipeline),
        "vkCreateGraphicsPipelines");
  for (VkShaderModule module : modules) vkDestroyShaderModule(device_.handle, module, nullptr);
  return pipeline;
}

void Renderer::create_pipelines() {
  body_ = surface_ ? create_pipeline(surface_vert) : create_pipeline(body_vert);
  mark_ = create_pipeline(mark_vert);
}
