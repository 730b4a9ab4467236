/* Checks the arguments of meshoptimizer, which only asserts them. */
#include "io/simplify.h"

#include <cmath>
#include <new>

#include <meshoptimizer.h>

extern "C" pl_status pl_simplify(const float *positions, size_t vertices, const uint32_t *indices,
                                 size_t triangles, size_t target, float error, uint32_t *out,
                                 size_t *out_triangles) {
  *out_triangles = 0;
  for (size_t i = 0; i < 3 * triangles; i++)
    if (indices[i] >= vertices)
      return pl_fail(PL_E_RANGE, "simplify: index %u; there are %zu vertices", indices[i],
                     vertices);
  for (size_t i = 0; i < 3 * vertices; i++)
    if (!std::isfinite(positions[i]))
      return pl_fail(PL_E_RANGE, "simplify: a position is not finite");
  if (!(error >= 0.0f && error <= 1.0f))
    return pl_fail(PL_E_RANGE, "simplify: error = %g; must be in 0..1", static_cast<double>(error));
  if (triangles == 0)
    return PL_OK;
  try {
    const size_t wanted = 3 * (target < triangles ? target : triangles);
    *out_triangles = meshopt_simplify(out, indices, 3 * triangles, positions, vertices,
                                      3 * sizeof(float), wanted, error, 0, nullptr) /
                     3;
  } catch (const std::bad_alloc &) {
    return pl_fail(PL_E_MEMORY, "out of memory for simplifying a mesh");
  }
  return PL_OK;
}
