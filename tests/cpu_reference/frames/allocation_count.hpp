// SPDX-License-Identifier: Apache-2.0
// Every call of the allocator is counted, from operator new, Eigen or anywhere else: glibc lets a
// program put its own functions in the place of malloc's.
#pragma once

namespace sunder::test {

/// Allocations of this thread during a scope. One at a time.
class Count {
 public:
  Count();
  ~Count();
  Count(const Count&) = delete;
  Count& operator=(const Count&) = delete;
  [[nodiscard]] long sum() const;
};

}  // namespace sunder::test
