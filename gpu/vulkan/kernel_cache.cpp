// SPDX-License-Identifier: Apache-2.0
#include "gpu/vulkan/kernel_cache.hpp"

#include <algorithm>
#include <array>
#include <cstring>

#include "gpu/vulkan/check.hpp"

namespace sunder::vulkan {
namespace {

constexpr std::array<char, 8> kWord = {'S', 'U', 'N', 'D', 'E', 'R', 'P', '1'};

struct Wrapping {
  std::array<char, 8> word = kWord;
  std::uint64_t bytes = 0, checksum = 0;
};

/// FNV-1a.
std::uint64_t checksum_of(std::span<const std::byte> bytes) {
  std::uint64_t sum = 0xcbf29ce484222325;
  for (const std::byte b : bytes) sum = (sum ^ static_cast<std::uint64_t>(b)) * 0x100000001b3;
  return sum;
}

/// Of bytes that are whole.
std::string why_not_of_driver(std::span<const std::byte> bytes, const PhysicalDevice& physical) {
  VkPipelineCacheHeaderVersionOne header{};
  if (bytes.size() < sizeof(header)) return "it lacks Vulkan's header";
  std::memcpy(&header, bytes.data(), sizeof(header));
  if (header.headerSize < sizeof(header) ||
      header.headerVersion != VK_PIPELINE_CACHE_HEADER_VERSION_ONE) {
    return "its header is of a version that is not known here";
  }
  if (header.vendorID != physical.vendor || header.deviceID != physical.device) {
    return "it is another device's";
  }
  const bool same = std::equal(physical.cache_uuid.begin(), physical.cache_uuid.end(),
                               std::begin(header.pipelineCacheUUID));
  return same ? "" : "it is another driver's, or of another version of this one";
}

}  // namespace

std::vector<std::byte> wrap(std::span<const std::byte> of_driver) {
  Wrapping wrapping;
  wrapping.bytes = of_driver.size();
  wrapping.checksum = checksum_of(of_driver);
  std::vector<std::byte> all(sizeof(wrapping) + of_driver.size());
  std::memcpy(all.data(), &wrapping, sizeof(wrapping));
  std::ranges::copy(of_driver, all.begin() + sizeof(wrapping));
  return all;
}

std::string why_not(std::span<const std::byte> wrapped, const PhysicalDevice& physical) {
  Wrapping wrapping;
  if (wrapped.size() < sizeof(wrapping)) return "it is cut";
  std::memcpy(&wrapping, wrapped.data(), sizeof(wrapping));
  if (wrapping.word != kWord) return "it is none that this library has given out";
  const auto of_driver = wrapped.subspan(sizeof(wrapping));
  if (of_driver.size() < wrapping.bytes) return "it is cut";
  if (of_driver.size() > wrapping.bytes) return "it goes on after its end";
  if (checksum_of(of_driver) != wrapping.checksum) return "its bytes have changed";
  return why_not_of_driver(of_driver, physical);
}

KernelCache::KernelCache(const DeviceFunctions& vk, VkDevice device, const PhysicalDevice& physical,
                         std::span<const std::byte> given)
    : vk_(vk), device_(device) {
  VkPipelineCacheCreateInfo info{};
  info.sType = VK_STRUCTURE_TYPE_PIPELINE_CACHE_CREATE_INFO;
  if (!given.empty()) ignored_ = why_not(given, physical);
  if (!given.empty() && ignored_.empty()) {
    const auto of_driver = given.subspan(sizeof(Wrapping));
    info.initialDataSize = of_driver.size();
    info.pInitialData = of_driver.data();
  }
  check(vk_.CreatePipelineCache(device_, &info, nullptr, &handle_), "vkCreatePipelineCache");
}

KernelCache::~KernelCache() { vk_.DestroyPipelineCache(device_, handle_, nullptr); }

std::vector<std::byte> KernelCache::bytes() const {
  std::size_t size = 0;
  if (vk_.GetPipelineCacheData(device_, handle_, &size, nullptr) != VK_SUCCESS) return {};
  std::vector<std::byte> of_driver(size);
  if (vk_.GetPipelineCacheData(device_, handle_, &size, of_driver.data()) != VK_SUCCESS) return {};
  of_driver.resize(size);
  return wrap(of_driver);
}

}  // namespace sunder::vulkan
