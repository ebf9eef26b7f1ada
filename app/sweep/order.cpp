// SPDX-License-Identifier: Apache-2.0
#include "app/sweep/order.hpp"

#include <algorithm>

namespace sunder::app::sweep {

std::vector<RunIndex> runs_to_do(const std::vector<Axis>& axes, const Part& part, const Rows& done,
                                 const std::vector<bool>& changes_body) {
  struct Run {
    RunIndex body = 0, run = 0;  // a number of the values that make the body
    auto operator<=>(const Run&) const = default;
  };
  std::vector<Run> runs;
  for (RunIndex run = part.i - 1; run < run_count(axes); run += part.n) {
    if (done.contains(run)) continue;
    const std::vector<std::size_t> places = places_of(axes, run);
    RunIndex body = 0;
    for (std::size_t a = 0; a < axes.size(); ++a) {
      if (!changes_body[a]) continue;
      body = body * static_cast<RunIndex>(axes[a].values.size()) + static_cast<RunIndex>(places[a]);
    }
    runs.push_back({body, run});
  }
  std::ranges::sort(runs);
  std::vector<RunIndex> order;
  for (const Run& run : runs) order.push_back(run.run);
  return order;
}

}  // namespace sunder::app::sweep
