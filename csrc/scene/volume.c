/* Checks volumes. */
#include "scene/volume.h"

#include <math.h>

/* Limits on sizes; their squares stay far from the limits of single precision. */
static const double SIZE_MAX_M = 1e15, SIZE_MIN_M = 1e-9, PLACE_MAX_M = 1e15;
static const float VALUE_MAX = 1e30f, G_MAX = 0.98f;

static bool good_size(const pl_volume *volume) {
  bool any = false;
  for (int k = 0; k < 3; k++) {
    const double x = volume->size[k];
    const bool flat = (volume->bound->flat >> k & 1u) != 0;
    if (!(x <= SIZE_MAX_M) || !(x >= SIZE_MIN_M || (flat && x == 0.0)))
      return false;
    any |= flat && x > 0.0;
  }
  return any || volume->bound->flat == 0;
}

static bool good_pose(const pl_pose *pose) {
  const pl_quat q = pose->q;
  return pl_vec3_finite(pose->t) && pl_vec3_norm(pose->t) <= PLACE_MAX_M &&
         fabs(q.w * q.w + q.x * q.x + q.y * q.y + q.z * q.z - 1.0) < 1e-6;
}

static pl_status check(const pl_volume *volume, size_t entities) {
  if (volume->parent >= entities)
    return pl_fail(PL_E_RANGE, "volume '%s': entity %zu is not there", volume->name,
                   volume->parent);
  if (!good_size(volume))
    return pl_fail(PL_E_RANGE,
                   "volume '%s': a size must be %g..%g m; a cone's radii may be 0, but not both",
                   volume->name, SIZE_MIN_M, SIZE_MAX_M);
  if (!good_pose(&volume->local))
    return pl_fail(PL_E_RANGE, "volume '%s': pose must be within %g m with a unit quaternion",
                   volume->name, PLACE_MAX_M);
  for (int k = 0; k < 3; k++)
    if (!(volume->extinction[k] >= 0.0f && volume->extinction[k] <= VALUE_MAX) ||
        !(volume->albedo[k] >= 0.0f && volume->albedo[k] <= 1.0f) ||
        !(volume->emission[k] >= 0.0f && volume->emission[k] <= VALUE_MAX))
      return pl_fail(PL_E_RANGE,
                     "volume '%s': extinction and emission must be 0..%g, the albedo 0..1",
                     volume->name, (double)VALUE_MAX);
  if (!(volume->core_m >= 0.0 && volume->core_m <= SIZE_MAX_M))
    return pl_fail(PL_E_RANGE, "volume '%s': core_m must be 0..%g", volume->name, SIZE_MAX_M);
  if (!(fabsf(volume->g) <= G_MAX))
    return pl_fail(PL_E_RANGE, "volume '%s': g must be within %g of 0", volume->name,
                   (double)G_MAX);
  const size_t count = volume->graph != NULL ? pl_graph_parameter_count(volume->graph) : 0;
  if (count > 0 && volume->parameters == NULL)
    return pl_fail(PL_E_ARGUMENT, "volume '%s': its material has no parameters", volume->name);
  for (size_t i = 0; i < 4 * count; i++)
    if (!isfinite(volume->parameters[i / 4][i % 4]))
      return pl_fail(PL_E_RANGE, "volume '%s': parameter %zu of its material is not finite",
                     volume->name, i / 4);
  return PL_OK;
}

pl_status pl_volumes_check(const pl_volume *volumes, size_t count, size_t entities) {
  if (count > PL_VOLUMES_MAX)
    return pl_fail(PL_E_RANGE, "%zu volumes: there may be %d", count, PL_VOLUMES_MAX);
  for (size_t i = 0; i < count; i++)
    PL_TRY(check(&volumes[i], entities));
  return PL_OK;
}

double pl_volume_phase_max(const pl_volume *volume) {
  const double g = fabs((double)volume->g), less = 1.0 - g;
  return (1.0 + g) / (4.0 * 3.14159265358979323846 * less * less);
}
