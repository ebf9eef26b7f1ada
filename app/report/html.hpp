// SPDX-License-Identifier: Apache-2.0
// index.html: the run on one self-contained page.
#pragma once

#include <string>
#include <vector>

#include "app/output/run_record.hpp"

namespace sunder::app {

struct SnapshotPicture {
  int wanted = 0;  ///< destroyed elements, or splits, asked for
  int broken = 0;  ///< those at the event that reached it
  int step = 0;
  std::string picture;  ///< PNG or SVG
};

struct ReportPictures {
  const std::string& svg;
  const std::string& picture;  ///< the same as PNG, or as SVG
  const std::vector<SnapshotPicture>& snapshots;
  const std::string& film;  ///< PNG or SVG: in motion, or of cracks that split; else empty
  const std::vector<std::string>& files;  ///< of the result folder
};

[[nodiscard]] std::string report_html(const RunRecord& run, const ReportPictures& pictures);

}  // namespace sunder::app
