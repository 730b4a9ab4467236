/* Loops made for the machine's vectors where it has them. */
#ifndef PL_BASE_WIDE_H
#define PL_BASE_WIDE_H

/* Before a function: it is compiled for AVX2 too, which is taken where the machine has it. Both
 * give the same bits, as nothing is fused or reordered. Sanitizers instrument the resolver of such
 * a function before they are ready. */
#if defined(__x86_64__) && defined(__GNUC__) && !defined(__clang__) &&                             \
    !defined(__SANITIZE_ADDRESS__) && !defined(__SANITIZE_THREAD__)
#define PL_WIDE __attribute__((target_clones("avx2", "default")))
#else
#define PL_WIDE
#endif

#endif
