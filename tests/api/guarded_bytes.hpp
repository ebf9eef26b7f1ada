// SPDX-License-Identifier: Apache-2.0
// Bytes before a page that nobody may touch: a call that reads or writes beyond them ends the test.
#pragma once

#include <sys/mman.h>
#include <unistd.h>

#include <algorithm>
#include <cstdint>
#include <cstring>
#include <vector>

namespace sunder::test {

class GuardedBytes {
 public:
  static constexpr unsigned char kUntouched = 0xa5;

  /// `size` bytes (at most a page), the first four of them a struct's `stated` size.
  GuardedBytes(std::size_t size, std::uint32_t stated)
      : page_(static_cast<std::size_t>(sysconf(_SC_PAGESIZE))),
        start_(
            mmap(nullptr, 2 * page_, PROT_READ | PROT_WRITE, MAP_PRIVATE | MAP_ANONYMOUS, -1, 0)),
        bytes_(static_cast<unsigned char*>(start_) + page_ - size),
        size_(size) {
    mprotect(static_cast<unsigned char*>(start_) + page_, page_, PROT_NONE);
    std::memset(bytes_, kUntouched, size_);
    state(stated);
  }
  ~GuardedBytes() { munmap(start_, 2 * page_); }
  GuardedBytes(const GuardedBytes&) = delete;
  GuardedBytes& operator=(const GuardedBytes&) = delete;

  void state(std::uint32_t size) { std::memcpy(bytes_, &size, std::min(size_, sizeof size)); }
  [[nodiscard]] unsigned char* data() { return bytes_; }
  [[nodiscard]] std::vector<unsigned char> copy() const { return {bytes_, bytes_ + size_}; }
  [[nodiscard]] bool untouched_from(std::size_t at) const {
    return std::all_of(bytes_ + at, bytes_ + size_, [](auto b) { return b == kUntouched; });
  }

 private:
  std::size_t page_;
  void* start_;
  unsigned char* bytes_;
  std::size_t size_;
};

}  // namespace sunder::test
