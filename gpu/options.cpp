// SPDX-License-Identifier: Apache-2.0
// What the environment asks of the backend.
#include <charconv>
#include <cstdlib>
#include <string_view>
#include <utility>

#include "gpu/vulkan_backend.hpp"
#include "sunder/error.hpp"

namespace sunder::gpu {
namespace {

std::string_view variable(const char* name) {
  const char* value = std::getenv(name);
  return value ? value : "";
}

template <class Number>
bool reads(std::string_view text, Number& number) {
  const char* end = text.data() + text.size();
  const auto [at, error] = std::from_chars(text.data(), end, number);
  return error == std::errc() && at == end;
}

/// Of a limit by its name in vulkan::LimitsProbe; else null.
std::uint64_t* limit(std::string_view word, vulkan::LimitsProbe& probe) {
  const std::pair<std::string_view, std::uint64_t*> all[] = {
      {"groups", &probe.groups},
      {"rows_of_groups", &probe.rows_of_groups},
      {"group", &probe.group},
      {"shared_bytes", &probe.shared_bytes},
      {"push_bytes", &probe.push_bytes},
      {"storage_buffers", &probe.storage_buffers},
      {"texel_buffers", &probe.texel_buffers},
      {"buffers", &probe.buffers},
      {"buffer_bytes", &probe.buffer_bytes},
      {"texels", &probe.texels},
      {"allocation_bytes", &probe.allocation_bytes},
      {"allocations", &probe.allocations},
      {"alignment", &probe.alignment}};
  for (const auto& named : all) {
    if (named.first == word) return named.second;
  }
  return nullptr;
}

/// "word" or "word=number".
bool set(std::string_view asked, vulkan::DeviceProbe& probe) {
  const std::size_t sign = asked.find('=');
  const std::string_view word = asked.substr(0, sign);
  if (sign == std::string_view::npos) {
    if (word == "as_gpu") return probe.as_gpu = true;
    if (word == "maps") return probe.maps = true;
    if (word == "no_compute") return probe.no_compute = true;
    return false;
  }
  const std::string_view number = asked.substr(sign + 1);
  if (word == "memory") return reads(number, probe.memory);
  if (word == "lost") return reads(number, probe.submits_until_lost);
  std::uint64_t* of = limit(word, probe.limits);
  return of && reads(number, *of);
}

void set_all(std::string_view list, vulkan::DeviceProbe& probe) {
  while (!list.empty()) {
    const std::size_t comma = list.find(',');
    const std::string_view asked = list.substr(0, comma);
    if (!set(asked, probe)) {
      throw UsageError(
          "SUNDER_VULKAN_PROBE has \"" + std::string(asked) +
          "\"; it may have as_gpu, maps, no_compute, memory=BYTES, lost=SUBMITS and limits "
          "(LimitsProbe in gpu/vulkan/limits.hpp), groups=3 say");
    }
    list = comma == std::string_view::npos ? "" : list.substr(comma + 1);
  }
}

}  // namespace

VulkanOptions options_from_environment() {
  VulkanOptions options;
  options.instance.validation = variable("SUNDER_VULKAN_VALIDATION") == "1";
  options.probe.no_float64 = variable("SUNDER_VULKAN_NO_FLOAT64") == "1";
  set_all(variable("SUNDER_VULKAN_PROBE"), options.probe);
  return options;
}

}  // namespace sunder::gpu
