// SPDX-License-Identifier: Apache-2.0
#include "api/vulkan_host.hpp"

#include <cstdlib>
#include <string_view>

namespace sunder::test {

Calls VulkanHost::calls;

namespace {

PFN_vkQueueSubmit real_submit;
PFN_vkCmdCopyBuffer real_copy;
PFN_vkCmdDispatch real_dispatch;
PFN_vkDeviceWaitIdle real_wait;

VKAPI_ATTR VkResult VKAPI_CALL count_submit(VkQueue queue, std::uint32_t count,
                                            const VkSubmitInfo* infos, VkFence fence) {
  ++VulkanHost::calls.submits;
  if (VulkanHost::calls.depth != 1) VulkanHost::calls.submitted_unlocked = true;
  return real_submit(queue, count, infos, fence);
}
VKAPI_ATTR void VKAPI_CALL count_copy(VkCommandBuffer commands, VkBuffer from, VkBuffer to,
                                      std::uint32_t count, const VkBufferCopy* regions) {
  ++VulkanHost::calls.copies;
  real_copy(commands, from, to, count, regions);
}
VKAPI_ATTR void VKAPI_CALL count_dispatch(VkCommandBuffer commands, std::uint32_t x,
                                          std::uint32_t y, std::uint32_t z) {
  ++VulkanHost::calls.dispatches;
  real_dispatch(commands, x, y, z);
}
VKAPI_ATTR VkResult VKAPI_CALL count_wait(VkDevice device) {
  ++VulkanHost::calls.device_waits;
  return real_wait(device);
}

template <class Function>
PFN_vkVoidFunction replace(Function& real, PFN_vkVoidFunction found, Function by) {
  real = reinterpret_cast<Function>(found);
  return reinterpret_cast<PFN_vkVoidFunction>(by);
}

VKAPI_ATTR PFN_vkVoidFunction VKAPI_CALL device_function(VkDevice device, const char* name) {
  const PFN_vkVoidFunction found = vkGetDeviceProcAddr(device, name);
  const std::string_view wanted = name;
  if (wanted == "vkQueueSubmit") return replace(real_submit, found, &count_submit);
  if (wanted == "vkCmdCopyBuffer") return replace(real_copy, found, &count_copy);
  if (wanted == "vkCmdDispatch") return replace(real_dispatch, found, &count_dispatch);
  if (wanted == "vkDeviceWaitIdle") return replace(real_wait, found, &count_wait);
  return found;
}

sunder_vulkan_function instance_function(void* instance, const char* name) {
  if (std::string_view(name) == "vkGetDeviceProcAddr") {
    return reinterpret_cast<sunder_vulkan_function>(&device_function);
  }
  return vkGetInstanceProcAddr(static_cast<VkInstance>(instance), name);
}

void lock(void*) {
  ++VulkanHost::calls.locks;
  if (++VulkanHost::calls.depth > 1) VulkanHost::calls.nested = true;
}
void unlock(void*) { --VulkanHost::calls.depth; }

VKAPI_ATTR VkBool32 VKAPI_CALL take_message(VkDebugUtilsMessageSeverityFlagBitsEXT,
                                            VkDebugUtilsMessageTypeFlagsEXT,
                                            const VkDebugUtilsMessengerCallbackDataEXT* data,
                                            void* user) {
  static_cast<std::vector<std::string>*>(user)->emplace_back(data->pMessage);
  return VK_FALSE;
}

template <class Struct>
Struct of(VkStructureType type) {
  Struct s{};
  s.sType = type;
  return s;
}

void expect(VkResult result) { EXPECT_EQ(result, VK_SUCCESS); }

}  // namespace

VulkanHost::VulkanHost(const Options& options) : options_(options) {
  calls = {};
  create_instance();
  choose_family();
  create_device();
}

VulkanHost::~VulkanHost() {
  for (VkSemaphore s : semaphores_) vkDestroySemaphore(device, s, nullptr);
  for (const Side& side : {lent_, drawing_}) vkDestroyCommandPool(device, side.pool, nullptr);
  vkDestroyDevice(device, nullptr);
  reinterpret_cast<PFN_vkDestroyDebugUtilsMessengerEXT>(vkGetInstanceProcAddr(
      instance, "vkDestroyDebugUtilsMessengerEXT"))(instance, messenger_, nullptr);
  vkDestroyInstance(instance, nullptr);
  for (const std::string& message : messages) ADD_FAILURE() << message;
  EXPECT_EQ(calls.depth, 0) << "the queue is left locked";
}

void VulkanHost::create_instance() {
  auto application = of<VkApplicationInfo>(VK_STRUCTURE_TYPE_APPLICATION_INFO);
  application.apiVersion = VK_API_VERSION_1_2;
  const VkValidationFeatureEnableEXT enable =
      VK_VALIDATION_FEATURE_ENABLE_SYNCHRONIZATION_VALIDATION_EXT;
  auto features = of<VkValidationFeaturesEXT>(VK_STRUCTURE_TYPE_VALIDATION_FEATURES_EXT);
  features.enabledValidationFeatureCount = 1;
  features.pEnabledValidationFeatures = &enable;
  auto debug = of<VkDebugUtilsMessengerCreateInfoEXT>(
      VK_STRUCTURE_TYPE_DEBUG_UTILS_MESSENGER_CREATE_INFO_EXT);
  debug.messageSeverity = VK_DEBUG_UTILS_MESSAGE_SEVERITY_WARNING_BIT_EXT |
                          VK_DEBUG_UTILS_MESSAGE_SEVERITY_ERROR_BIT_EXT;
  debug.messageType = VK_DEBUG_UTILS_MESSAGE_TYPE_VALIDATION_BIT_EXT;
  debug.pfnUserCallback = take_message;
  debug.pUserData = &messages;
  features.pNext = &debug;
  const char* layer = "VK_LAYER_KHRONOS_validation";
  // For leak checkers: Debian 12's layer itself leaves seven allocations per instance behind.
  const bool watched = std::getenv("SUNDER_WITHOUT_VALIDATION") == nullptr;
  const char* extension = VK_EXT_DEBUG_UTILS_EXTENSION_NAME;
  auto info = of<VkInstanceCreateInfo>(VK_STRUCTURE_TYPE_INSTANCE_CREATE_INFO);
  if (watched) info.pNext = &features;
  info.pApplicationInfo = &application;
  info.enabledLayerCount = watched ? 1 : 0;
  info.enabledExtensionCount = 1;
  info.ppEnabledLayerNames = &layer;
  info.ppEnabledExtensionNames = &extension;
  expect(vkCreateInstance(&info, nullptr, &instance));
  expect(reinterpret_cast<PFN_vkCreateDebugUtilsMessengerEXT>(vkGetInstanceProcAddr(
      instance, "vkCreateDebugUtilsMessengerEXT"))(instance, &debug, nullptr, &messenger_));
}

void VulkanHost::choose_family() {
  std::uint32_t count = 1;
  ASSERT_GE(vkEnumeratePhysicalDevices(instance, &count, &physical), 0);
  ASSERT_EQ(count, 1u) << "no Vulkan device";
  count = 0;
  vkGetPhysicalDeviceQueueFamilyProperties(physical, &count, nullptr);
  std::vector<VkQueueFamilyProperties> families(count);
  vkGetPhysicalDeviceQueueFamilyProperties(physical, &count, families.data());
  while (!(families.at(family).queueFlags & VK_QUEUE_COMPUTE_BIT)) ++family;
  drawing_family = family;
  if (!options_.draws_elsewhere) return;
  drawing_family = 0;
  while (!(families.at(drawing_family).queueFlags & VK_QUEUE_GRAPHICS_BIT)) ++drawing_family;
  ASSERT_NE(drawing_family, family);
}

void VulkanHost::create_device() {
  const float priority = 1;
  auto queues = of<VkDeviceQueueCreateInfo>(VK_STRUCTURE_TYPE_DEVICE_QUEUE_CREATE_INFO);
  queues.queueFamilyIndex = family;
  queues.queueCount = 1;
  queues.pQueuePriorities = &priority;
  std::vector<VkDeviceQueueCreateInfo> wanted{queues};
  if (options_.draws_elsewhere) {
    queues.queueFamilyIndex = drawing_family;
    wanted.push_back(queues);
  }
  auto features12 =
      of<VkPhysicalDeviceVulkan12Features>(VK_STRUCTURE_TYPE_PHYSICAL_DEVICE_VULKAN_1_2_FEATURES);
  features12.timelineSemaphore = options_.timeline;
  VkPhysicalDeviceFeatures features{};
  features.shaderFloat64 = options_.float64;
  features.shaderInt64 = options_.int64;
  auto info = of<VkDeviceCreateInfo>(VK_STRUCTURE_TYPE_DEVICE_CREATE_INFO);
  info.pNext = &features12;
  info.queueCreateInfoCount = static_cast<std::uint32_t>(wanted.size());
  info.pQueueCreateInfos = wanted.data();
  info.pEnabledFeatures = &features;
  ASSERT_EQ(vkCreateDevice(physical, &info, nullptr, &device), VK_SUCCESS);
  lent_ = side(family);
  queue = lent_.queue;
  if (options_.draws_elsewhere) drawing_ = side(drawing_family);
}

VulkanHost::Side VulkanHost::side(std::uint32_t of_family) const {
  Side side;
  vkGetDeviceQueue(device, of_family, 0, &side.queue);
  auto pool = of<VkCommandPoolCreateInfo>(VK_STRUCTURE_TYPE_COMMAND_POOL_CREATE_INFO);
  pool.queueFamilyIndex = of_family;
  expect(vkCreateCommandPool(device, &pool, nullptr, &side.pool));
  return side;
}

sunder_vulkan_host VulkanHost::lend() const {
  sunder_vulkan_host host{};
  host.struct_size = sizeof host;
  host.api_version = VK_API_VERSION_1_2;
  host.get_instance_proc_addr = instance_function;
  host.instance = instance;
  host.physical_device = physical;
  host.device = device;
  host.queue = queue;
  host.queue_family = family;
  if (options_.float64) host.features |= SUNDER_VULKAN_SHADER_FLOAT64;
  if (options_.int64) host.features |= SUNDER_VULKAN_SHADER_INT64;
  if (options_.timeline) host.features |= SUNDER_VULKAN_TIMELINE_SEMAPHORE;
  host.lock = lock;
  host.unlock = unlock;
  return host;
}

VulkanHost::Memory VulkanHost::allocate(VkDeviceSize size, VkBufferUsageFlags usage,
                                        bool shared) const {
  Memory result;
  result.size = size;
  auto info = of<VkBufferCreateInfo>(VK_STRUCTURE_TYPE_BUFFER_CREATE_INFO);
  info.size = size;
  info.usage = usage;
  const std::uint32_t both[] = {family, drawing_family};
  if (shared) {
    info.sharingMode = VK_SHARING_MODE_CONCURRENT;
    info.queueFamilyIndexCount = 2;
    info.pQueueFamilyIndices = both;
  }
  expect(vkCreateBuffer(device, &info, nullptr, &result.buffer));
  VkMemoryRequirements needed{};
  vkGetBufferMemoryRequirements(device, result.buffer, &needed);
  VkPhysicalDeviceMemoryProperties types{};
  vkGetPhysicalDeviceMemoryProperties(physical, &types);
  auto memory = of<VkMemoryAllocateInfo>(VK_STRUCTURE_TYPE_MEMORY_ALLOCATE_INFO);
  memory.allocationSize = needed.size;
  constexpr VkMemoryPropertyFlags visible =
      VK_MEMORY_PROPERTY_HOST_VISIBLE_BIT | VK_MEMORY_PROPERTY_HOST_COHERENT_BIT;
  while (!(needed.memoryTypeBits >> memory.memoryTypeIndex & 1) ||
         (types.memoryTypes[memory.memoryTypeIndex].propertyFlags & visible) != visible) {
    ++memory.memoryTypeIndex;
  }
  expect(vkAllocateMemory(device, &memory, nullptr, &result.memory));
  expect(vkBindBufferMemory(device, result.buffer, result.memory, 0));
  expect(vkMapMemory(device, result.memory, 0, VK_WHOLE_SIZE, 0, &result.mapped));
  std::memset(result.mapped, 0xa5, size);
  return result;
}

void VulkanHost::free(const Memory& memory) const {
  vkDestroyBuffer(device, memory.buffer, nullptr);
  vkFreeMemory(device, memory.memory, nullptr);
}

VkCommandBuffer VulkanHost::begin(const Side& side) const {
  auto info = of<VkCommandBufferAllocateInfo>(VK_STRUCTURE_TYPE_COMMAND_BUFFER_ALLOCATE_INFO);
  info.commandPool = side.pool;
  info.commandBufferCount = 1;
  VkCommandBuffer commands{};
  expect(vkAllocateCommandBuffers(device, &info, &commands));
  const auto start = of<VkCommandBufferBeginInfo>(VK_STRUCTURE_TYPE_COMMAND_BUFFER_BEGIN_INFO);
  expect(vkBeginCommandBuffer(commands, &start));
  return commands;
}

void VulkanHost::finish(const Side& side, VkCommandBuffer commands) const {
  expect(vkEndCommandBuffer(commands));
  auto info = of<VkSubmitInfo>(VK_STRUCTURE_TYPE_SUBMIT_INFO);
  info.commandBufferCount = 1;
  info.pCommandBuffers = &commands;
  expect(vkQueueSubmit(side.queue, 1, &info, VK_NULL_HANDLE));
  expect(vkQueueWaitIdle(side.queue));
  vkFreeCommandBuffers(device, side.pool, 1, &commands);
}

std::vector<std::byte> VulkanHost::read(const sunder_vulkan_buffer& part) const {
  const Memory target = allocate(part.size, VK_BUFFER_USAGE_TRANSFER_DST_BIT);
  draw([&](VkCommandBuffer commands) {
    const VkBufferCopy region{part.offset, 0, part.size};
    vkCmdCopyBuffer(commands, reinterpret_cast<VkBuffer>(part.buffer), target.buffer, 1, &region);
  });
  std::vector<std::byte> bytes(part.size);
  std::memcpy(bytes.data(), target.mapped, part.size);
  free(target);
  return bytes;
}

VkSemaphore VulkanHost::timeline() const {
  auto type = of<VkSemaphoreTypeCreateInfo>(VK_STRUCTURE_TYPE_SEMAPHORE_TYPE_CREATE_INFO);
  type.semaphoreType = VK_SEMAPHORE_TYPE_TIMELINE;
  auto info = of<VkSemaphoreCreateInfo>(VK_STRUCTURE_TYPE_SEMAPHORE_CREATE_INFO);
  info.pNext = &type;
  expect(vkCreateSemaphore(device, &info, nullptr, &semaphores_.emplace_back()));
  return semaphores_.back();
}

}  // namespace sunder::test
