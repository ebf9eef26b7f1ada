// SPDX-License-Identifier: Apache-2.0
#include "c/status.hpp"

#include "c/handles.hpp"
#include "c/text.hpp"

extern "C" {

const char* sunder_status_text(sunder_status status) {
  switch (status) {
    case SUNDER_OK:
      return "done";
    case SUNDER_ERROR_INTERNAL:
      return "a defect of the library";
    case SUNDER_ERROR_ORDER:
      return "the call does not fit what was done before";
    case SUNDER_ERROR_INPUT:
      return "the scene is wrong";
    case SUNDER_ERROR_DEVICE:
      return "no such device, backend, route or feature";
    case SUNDER_ERROR_NUMERICAL:
      return "the promised accuracy cannot be kept";
    case SUNDER_ERROR_NULL:
      return "a pointer that is needed is null";
    case SUNDER_ERROR_HANDLE:
      return "no such handle";
    case SUNDER_ERROR_SIZE:
      return "an array has a wrong size";
    case SUNDER_ERROR_STRUCT_SIZE:
      return "a struct has a wrong struct_size";
    case SUNDER_ERROR_VALUE:
      return "an index or a value is outside what is allowed, or not finite";
    case SUNDER_ERROR_BUSY:
      return "the handle is in use";
    case SUNDER_ERROR_MEMORY:
      return "out of memory";
    case SUNDER_ERROR_CANCELLED:
      return "cancelled";
    default:
      return "unknown status";
  }
}

const char* sunder_last_error(void) { return sunder::c::last_text_of_thread(); }

sunder_status sunder_error_of(const void* handle, char* text, size_t capacity, size_t* length) {
  return sunder::c::guarded([&] {
    const auto object = sunder::c::find<sunder::c::Object>(handle, "sunder object");
    sunder::c::write_text(object->error(), text, capacity, length);
  });
}

void sunder_version(int32_t* major, int32_t* minor, int32_t* patch) {
  if (major) *major = SUNDER_VERSION_MAJOR;
  if (minor) *minor = SUNDER_VERSION_MINOR;
  if (patch) *patch = SUNDER_VERSION_PATCH;
}

}  // extern "C"
