// SPDX-License-Identifier: Apache-2.0
// What tests ask of the devices that draw, by the environment.
#include <charconv>
#include <cstdlib>
#include <string_view>

#include "app/view/vulkan/device.hpp"
#include "sunder/error.hpp"

namespace sunder::app::view {
namespace {

bool read(std::string_view text, int& number) {
  const char* end = text.data() + text.size();
  const auto [at, error] = std::from_chars(text.data(), end, number);
  return error == std::errc() && at == end && number >= 0;
}

/// "word=value".
bool ask(std::string_view asked, DeviceProbe& probe) {
  const std::size_t sign = asked.find('=');
  if (sign == std::string_view::npos) return false;
  const std::string_view word = asked.substr(0, sign), value = asked.substr(sign + 1);
  if (value.empty()) return false;
  if (word == "submits") return read(value, probe.submits);
  if (word == "devices") return read(value, probe.devices);
  if (word == "submit_file")
    probe.submit_file = value;
  else if (word == "present_file")
    probe.present_file = value;
  else
    return false;
  return true;
}

}  // namespace

DeviceProbe probe_from_environment() {
  DeviceProbe probe;
  const char* const variable = std::getenv("SUNDER_VIEW_PROBE");
  std::string_view list = variable ? variable : "";
  while (!list.empty()) {
    const std::size_t comma = list.find(',');
    const std::string_view asked = list.substr(0, comma);
    if (!ask(asked, probe)) {
      throw UsageError("SUNDER_VIEW_PROBE has \"" + std::string(asked) +
                       "\"; it may have submits=NUMBER, devices=NUMBER, submit_file=FILE and "
                       "present_file=FILE");
    }
    list = comma == std::string_view::npos ? "" : list.substr(comma + 1);
  }
  return probe;
}

}  // namespace sunder::app::view
