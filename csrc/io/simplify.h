/* Mesh simplification with meshoptimizer. */
#ifndef PL_IO_SIMPLIFY_H
#define PL_IO_SIMPLIFY_H

#include <stddef.h>
#include <stdint.h>

#include "base/status.h"

#ifdef __cplusplus
extern "C" {
#endif

/* Collapses edges of a mesh until it has at most `target` triangles, or the next collapse would
 * change its surface by more than `error` times its extent. Vertices keep their positions; some
 * become unused. `out`: room for 3 * triangles indices; *out_triangles: number of triangles that
 * are left. Returns PL_E_RANGE for indices out of range and positions that are not finite. */
pl_status pl_simplify(const float *positions, size_t vertices, const uint32_t *indices,
                      size_t triangles, size_t target, float error, uint32_t *out,
                      size_t *out_triangles);

#ifdef __cplusplus
}
#endif
#endif
