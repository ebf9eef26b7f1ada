// SPDX-License-Identifier: Apache-2.0
#include "c/names.hpp"
#include "c/structs.hpp"
#include "c/text.hpp"
#include "sunder/backends.hpp"

extern "C" {

sunder_status sunder_device_count(int32_t* count) {
  return sunder::c::guarded([&] {
    sunder::c::require(count, "count");
    *count = static_cast<int32_t>(sunder::devices().size());
  });
}

sunder_status sunder_device_at(int32_t index, sunder_device* device) {
  using namespace sunder::c;
  return guarded([&] {
    static_cast<void>(stated_size(device, "device"));
    const auto list = sunder::devices();
    require_index(index, static_cast<std::int64_t>(list.size()), "device");
    const sunder::DeviceInfo& info = list[static_cast<std::size_t>(index)];
    auto out = sized<sunder_device>();
    out.backend = backend_number(info.backend);
    out.index = info.index;
    out.chosen = info.chosen ? 1 : 0;
    write_text(info.name, out.name);
    write_text(info.driver, out.driver);
    write_text(info.precisions, out.precisions);
    write_text(info.why, out.why);
    write_struct(device, out, "device");
  });
}

}  // extern "C"
