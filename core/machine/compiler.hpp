// SPDX-License-Identifier: Apache-2.0
// What not every compiler has: loops compiled for several vector widths, vectors of numbers, forced
// inlining, prefetching. Whatever lacks one takes what standard C++ says in its place, with the
// same bits. SUNDER_PLAIN_COMPILER takes that everywhere: `.ci/run windows` compiles and tests it
// so.
#pragma once

#if defined(__GNUC__) && !defined(SUNDER_PLAIN_COMPILER)
#define SUNDER_GNU_COMPILER
#endif

// Loops compiled once for each vector width; the fit one is chosen when the program starts. Used
// only for loops without reductions and contraction is off, so every width gives the same bits.
// Windows has no such choice at load time, and its stacks are not aligned for wide registers.
#if defined(SUNDER_GNU_COMPILER) && defined(__x86_64__) && defined(__ELF__) && \
    !defined(__clang__) && !defined(__SANITIZE_THREAD__) && !defined(__SANITIZE_ADDRESS__)
#define SUNDER_VECTORISED \
  __attribute__((target_clones("avx512f", "avx2", "default"), optimize("O3")))
#else
#define SUNDER_VECTORISED
#endif

// In place of `inline`; the second one between a lambda's parameters and its body.
#if defined(SUNDER_GNU_COMPILER)
#define SUNDER_FORCE_INLINE inline __attribute__((always_inline))
#define SUNDER_FORCE_INLINE_LAMBDA __attribute__((always_inline))
#elif defined(_MSC_VER) && !defined(SUNDER_PLAIN_COMPILER)
#define SUNDER_FORCE_INLINE __forceinline
#define SUNDER_FORCE_INLINE_LAMBDA
#else
#define SUNDER_FORCE_INLINE inline
#define SUNDER_FORCE_INLINE_LAMBDA
#endif

namespace sunder::machine {

/// N numbers on which arithmetic is done at once. Copied from and to memory by std::memcpy.
#if defined(SUNDER_GNU_COMPILER)
typedef double Lanes4 __attribute__((vector_size(4 * sizeof(double))));
typedef double Lanes8 __attribute__((vector_size(8 * sizeof(double))));
#else
template <int N>
struct PlainLanes {
  double at[N];
  double operator[](int i) const { return at[i]; }
  PlainLanes& operator+=(const PlainLanes& other) {
    for (int i = 0; i < N; ++i) at[i] += other.at[i];
    return *this;
  }
  friend PlainLanes operator+(PlainLanes a, const PlainLanes& b) { return a += b; }
  friend PlainLanes operator*(const PlainLanes& a, const PlainLanes& b) {
    PlainLanes c;
    for (int i = 0; i < N; ++i) c.at[i] = a.at[i] * b.at[i];
    return c;
  }
  friend PlainLanes operator*(const PlainLanes& a, double b) {
    PlainLanes c;
    for (int i = 0; i < N; ++i) c.at[i] = a.at[i] * b;
    return c;
  }
  friend PlainLanes operator*(double a, const PlainLanes& b) { return b * a; }
};
using Lanes4 = PlainLanes<4>;
using Lanes8 = PlainLanes<8>;
#endif

/// Says that this will be read soon.
SUNDER_FORCE_INLINE void prefetch([[maybe_unused]] const void* at) {
#if defined(SUNDER_GNU_COMPILER)
  __builtin_prefetch(at);
#endif
}

/// Whether the processor has registers of eight numbers and this code uses them.
SUNDER_FORCE_INLINE bool wide_registers() {
#if defined(SUNDER_GNU_COMPILER) && defined(__x86_64__) && defined(__ELF__)
  return __builtin_cpu_supports("avx512f") != 0;
#elif defined(__AVX512F__)
  return true;
#else
  return false;
#endif
}

}  // namespace sunder::machine
