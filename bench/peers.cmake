# SPDX-License-Identifier: Apache-2.0
# What the benchmarks need beyond the library: Google Benchmark, and the libraries they compare with.
# What is missing ends the configuration, not a run of minutes.
set(missing)
find_package(benchmark QUIET)
if(NOT benchmark_FOUND)
  list(APPEND missing "Google Benchmark (libbenchmark-dev)")
endif()
if(SUNDER_BENCH_PEERS)
  find_library(SUNDER_CHOLMOD cholmod)
  find_path(SUNDER_CHOLMOD_INCLUDE cholmod.h PATH_SUFFIXES suitesparse)
  find_library(SUNDER_OPENBLAS openblas)
  if(NOT SUNDER_CHOLMOD OR NOT SUNDER_CHOLMOD_INCLUDE)
    list(APPEND missing "CHOLMOD (libsuitesparse-dev)")
  endif()
  if(NOT SUNDER_OPENBLAS)
    list(APPEND missing "OpenBLAS (libopenblas-dev)")
  endif()
endif()
if(missing)
  list(JOIN missing ", " missing)
  message(FATAL_ERROR "The benchmarks need what is missing here: ${missing}. "
    "scripts/install-packages bench installs it; -DSUNDER_BENCH_PEERS=OFF leaves out the programs "
    "that compare with CHOLMOD and OpenBLAS.")
endif()
