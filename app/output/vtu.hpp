// SPDX-License-Identifier: Apache-2.0
// VTK XML files: unstructured grids (.vtu) and their series over the steps (.pvd).
#pragma once

#include <string>
#include <vector>

#include "app/output/result_file.hpp"
#include "app/output/state.hpp"

namespace sunder::app {

/// One state: binary inline arrays (base64, little endian, 64-bit headers), fp64.
void write_vtu(ResultFile& file, const Problem& problem, const State& state);

/// The lips of split cracks as triangles of surfaces of their own: on the ideal paths, then moved
/// as their nodes are. Without an open face it has none.
void write_cracks_vtu(ResultFile& file, const State& state);

struct SeriesEntry {
  double load_factor = 0;
  std::string file;  ///< relative to the .pvd
};
[[nodiscard]] std::string pvd(const std::vector<SeriesEntry>& entries);

}  // namespace sunder::app
