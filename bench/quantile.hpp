// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <algorithm>
#include <cstddef>
#include <utility>
#include <vector>

namespace sunder::bench {

/// The least value that at least this share of them does not exceed; of none 0.
inline double quantile(std::vector<double> of, double share) {
  if (of.empty()) return 0;
  std::sort(of.begin(), of.end());
  return of[static_cast<std::size_t>(share * static_cast<double>(of.size() - 1) + .999)];
}
inline double median_of(std::vector<double> of) { return quantile(std::move(of), .5); }

}  // namespace sunder::bench
