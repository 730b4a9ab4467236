/* Attribute for loops that are compiled for wider vector instructions too. */
#ifndef PL_BASE_WIDE_H
#define PL_BASE_WIDE_H

#include <stddef.h>

/* Put before a function: compiles it for AVX2 too, and the loader picks that version where the
 * machine supports it. Both versions give the same bits, as nothing is fused or reordered. Off
 * under sanitizers: they instrument the resolver of such a function, which runs before they are
 * initialised. */
#if defined(__x86_64__) && defined(__GNUC__) && !defined(__clang__) &&                             \
    !defined(__SANITIZE_ADDRESS__) && !defined(__SANITIZE_THREAD__)
#define PL_WIDE __attribute__((target_clones("avx2", "default")))
#else
#define PL_WIDE
#endif

/* For what such functions call: it is compiled with them, and so as wide. */
#define PL_WIDE_PART static inline __attribute__((always_inline))

/* Points that are evaluated together: one vector of floats of AVX2. Loops over lanes always run
 * over all of them; lanes that are not used hold copies of a used one. */
enum { PL_LANES = 8 };

/* Loop over the lanes. Iterations are independent; without the second pragma short loops are
 * unrolled before they can become vectors. */
#define PL_EACH_LANE(i)                                                                            \
  _Pragma("GCC ivdep") _Pragma("GCC unroll 1") for (size_t i = 0; i < PL_LANES; i++)

#endif
