// SPDX-License-Identifier: Apache-2.0
// The main function of a benchmark program whose rows are registered at run time.
#pragma once

#include <benchmark/benchmark.h>

namespace sunder::bench {

inline int run_rows(int argc, char** argv) {
  benchmark::Initialize(&argc, argv);
  if (benchmark::ReportUnrecognizedArguments(argc, argv)) return 1;
  benchmark::RunSpecifiedBenchmarks();
  return 0;
}

}  // namespace sunder::bench
