// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <malloc.h>

#include <cstddef>

#if defined(__SANITIZE_ADDRESS__)
#define SUNDER_ADDRESS_SANITIZER
#elif defined(__has_feature)
#if __has_feature(address_sanitizer)
#define SUNDER_ADDRESS_SANITIZER
#endif
#endif
#if defined(SUNDER_ADDRESS_SANITIZER)
#include <sanitizer/allocator_interface.h>
#endif

namespace sunder::test {

/// Bytes that the program has allocated and not given back.
inline std::size_t heap_in_use() {
#if defined(SUNDER_ADDRESS_SANITIZER)
  return __sanitizer_get_current_allocated_bytes();
#elif defined(_WIN32)
  std::size_t bytes = 0;
  _HEAPINFO block{};
  while (_heapwalk(&block) == _HEAPOK) {
    if (block._useflag == _USEDENTRY) bytes += block._size;
  }
  return bytes;
#else
  const auto info = mallinfo2();
  return info.uordblks + info.hblkhd;
#endif
}

}  // namespace sunder::test
