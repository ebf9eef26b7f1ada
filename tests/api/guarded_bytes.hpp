// SPDX-License-Identifier: Apache-2.0
// Bytes before a page that nobody may touch: a call that reads or writes beyond them ends the test.
#pragma once

#if defined(_WIN32)
#ifndef NOMINMAX
#define NOMINMAX
#endif
#include <windows.h>
#else
#include <sys/mman.h>
#include <unistd.h>
#endif

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
      : page_(page_size()),
        start_(two_pages(page_)),
        bytes_(static_cast<unsigned char*>(start_) + page_ - size),
        size_(size) {
    std::memset(bytes_, kUntouched, size_);
    state(stated);
  }
  ~GuardedBytes() {
#if defined(_WIN32)
    VirtualFree(start_, 0, MEM_RELEASE);
#else
    munmap(start_, 2 * page_);
#endif
  }
  GuardedBytes(const GuardedBytes&) = delete;
  GuardedBytes& operator=(const GuardedBytes&) = delete;

  void state(std::uint32_t size) { std::memcpy(bytes_, &size, std::min(size_, sizeof size)); }
  [[nodiscard]] unsigned char* data() { return bytes_; }
  [[nodiscard]] std::vector<unsigned char> copy() const { return {bytes_, bytes_ + size_}; }
  [[nodiscard]] bool untouched_from(std::size_t at) const {
    return std::all_of(bytes_ + at, bytes_ + size_, [](auto b) { return b == kUntouched; });
  }

 private:
#if defined(_WIN32)
  static std::size_t page_size() {
    SYSTEM_INFO info{};
    GetSystemInfo(&info);
    return info.dwPageSize;
  }
  /// Of which the second may not be touched.
  static void* two_pages(std::size_t page) {
    void* start = VirtualAlloc(nullptr, 2 * page, MEM_RESERVE | MEM_COMMIT, PAGE_READWRITE);
    DWORD before = 0;
    VirtualProtect(static_cast<unsigned char*>(start) + page, page, PAGE_NOACCESS, &before);
    return start;
  }
#else
  static std::size_t page_size() { return static_cast<std::size_t>(sysconf(_SC_PAGESIZE)); }
  /// Of which the second may not be touched.
  static void* two_pages(std::size_t page) {
    void* start =
        mmap(nullptr, 2 * page, PROT_READ | PROT_WRITE, MAP_PRIVATE | MAP_ANONYMOUS, -1, 0);
    mprotect(static_cast<unsigned char*>(start) + page, page, PROT_NONE);
    return start;
  }
#endif

  std::size_t page_;
  void* start_;
  unsigned char* bytes_;
  std::size_t size_;
};

}  // namespace sunder::test
