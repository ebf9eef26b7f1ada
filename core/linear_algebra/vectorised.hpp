// SPDX-License-Identifier: Apache-2.0
// Loops compiled once for each vector width; the fit one is chosen when the program starts. Used
// only for loops without reductions and contraction is off, so every width gives the same bits.
#pragma once

#if defined(__x86_64__) && defined(__GNUC__) && !defined(__clang__) && \
    !defined(__SANITIZE_THREAD__) && !defined(__SANITIZE_ADDRESS__)
#define SUNDER_VECTORISED \
  __attribute__((target_clones("avx512f", "avx2", "default"), optimize("O3")))
#else
#define SUNDER_VECTORISED
#endif
