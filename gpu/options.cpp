// SPDX-License-Identifier: Apache-2.0
// What the environment asks of the backend.
#include <charconv>
#include <cstdlib>
#include <string_view>

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

/// "word" or "word=number".
bool set(std::string_view asked, vulkan::DeviceProbe& probe) {
  const std::size_t sign = asked.find('=');
  const std::string_view word = asked.substr(0, sign);
  if (sign == std::string_view::npos) {
    if (word == "as_gpu") return probe.as_gpu = true;
    if (word == "no_compute") return probe.no_compute = true;
    return false;
  }
  const std::string_view number = asked.substr(sign + 1);
  if (word == "memory") return reads(number, probe.memory);
  if (word == "lost") return reads(number, probe.submits_until_lost);
  return false;
}

void set_all(std::string_view list, vulkan::DeviceProbe& probe) {
  while (!list.empty()) {
    const std::size_t comma = list.find(',');
    const std::string_view asked = list.substr(0, comma);
    if (!set(asked, probe)) {
      throw UsageError("SUNDER_VULKAN_PROBE has \"" + std::string(asked) +
                       "\"; it may have as_gpu, no_compute, memory=BYTES and lost=SUBMITS");
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
