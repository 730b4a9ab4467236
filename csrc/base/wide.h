/* Attribute for loops that are compiled for wider vector instructions too. */
#ifndef PL_BASE_WIDE_H
#define PL_BASE_WIDE_H

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

#endif
