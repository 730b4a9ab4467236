/* Table of ray sources, and what all of them share. */
#include "scene/ray_source.h"

#define PL_ROW(name) &pl_ray_source_##name,
const pl_ray_source_kind *const pl_ray_source_kinds[] = {PL_RAY_SOURCES(PL_ROW)};
#undef PL_ROW
const size_t pl_ray_source_kind_count = sizeof pl_ray_source_kinds / sizeof pl_ray_source_kinds[0];

static pl_status check_values(const pl_ray_source *source) {
  const pl_ray_source_kind *kind = source->kind;
  for (size_t i = 0; i < kind->value_count; i++) {
    const pl_ray_value *value = &kind->values[i];
    const double x = source->value[i];
    if (!(x >= value->low && x <= value->high))
      return pl_fail(PL_E_RANGE, "%s: %s must be in %g..%g, not %g", kind->name, value->name,
                     value->low, value->high, x);
    if (value->whole && x != floor(x))
      return pl_fail(PL_E_RANGE, "%s: %s must be a whole number, not %g", kind->name, value->name,
                     x);
  }
  for (size_t i = 0; i < source->list_count * kind->list_row; i++)
    if (!isfinite(source->list[i]))
      return pl_fail(PL_E_RANGE, "%s: %s must be finite", kind->name, kind->list);
  return PL_OK;
}

pl_status pl_ray_source_check(const pl_ray_source *source) {
  const char *name = source->kind->name;
  PL_TRY(check_values(source));
  if (source->sub_rays < 1 || source->sub_rays > PL_SUB_RAYS_MAX)
    return pl_fail(PL_E_RANGE, "%s: sub_rays must be in 1..%d, not %d", name, PL_SUB_RAYS_MAX,
                   source->sub_rays);
  if (!(source->divergence_rad >= 0.0 && source->divergence_rad < PL_PI))
    return pl_fail(PL_E_RANGE, "%s: the divergence must be in 0..pi rad, not %g", name,
                   source->divergence_rad);
  if (!(source->aperture_m >= 0.0 && isfinite(source->aperture_m)))
    return pl_fail(PL_E_RANGE, "%s: the aperture must be at least 0 m, not %g", name,
                   source->aperture_m);
  const size_t count = source->kind->count(source);
  if (count > PL_BEAMS_MAX)
    return pl_fail(PL_E_RANGE, "%s: %zu beams are more than %zu", name, count, PL_BEAMS_MAX);
  return PL_OK;
}

/* Two unit vectors across a unit direction: the first is as level as can be. */
static void across(pl_vec3 d, pl_vec3 *right, pl_vec3 *down) {
  const pl_vec3 y = {0.0, 1.0, 0.0}, x = {1.0, 0.0, 0.0};
  *right = pl_vec3_unit(pl_vec3_cross(fabs(d.y) < 0.999 ? y : x, d));
  *down = pl_vec3_cross(d, *right);
}

void pl_ray_source_ray(const pl_ray_source *source, size_t index, int sub, pl_sensor_ray *out) {
  const double golden_rad = 2.39996322972865332; /* pi (3 - sqrt 5) */
  source->kind->ray(source, index, sub, out);
  if (source->kind->fills_area || source->sub_rays == 1)
    return;
  pl_vec3 right, down;
  across(out->direction, &right, &down);
  const double radius = sqrt((sub + 0.5) / source->sub_rays), turn = golden_rad * sub;
  const pl_vec3 out_of_axis =
      pl_vec3_madd(pl_vec3_scale(right, radius * cos(turn)), radius * sin(turn), down);
  const double tilt = tan(0.5 * source->divergence_rad);
  out->origin = pl_vec3_madd(out->origin, 0.5 * source->aperture_m, out_of_axis);
  out->direction = pl_vec3_unit(pl_vec3_madd(out->direction, tilt, out_of_axis));
}

void pl_ray_source_cone(const pl_ray_source *source, pl_vec3 *axis, double *half_angle_rad) {
  const size_t count = source->kind->count(source);
  pl_sensor_ray ray;
  *axis = (pl_vec3){0.0, 0.0, 0.0};
  for (size_t i = 0; i < count; i++) {
    source->kind->ray(source, i, 0, &ray);
    *axis = pl_vec3_add(*axis, ray.direction);
  }
  /* Beams all around have no mean direction. */
  const bool some = pl_vec3_norm(*axis) > 1e-6 * (double)count;
  *axis = some ? pl_vec3_unit(*axis) : (pl_vec3){0.0, 0.0, 1.0};
  *half_angle_rad = 0.0;
  for (size_t i = 0; i < count; i++) {
    source->kind->ray(source, i, 0, &ray);
    const double sine = pl_vec3_norm(pl_vec3_cross(ray.direction, *axis));
    *half_angle_rad = fmax(*half_angle_rad, atan2(sine, pl_vec3_dot(ray.direction, *axis)));
  }
  *half_angle_rad = fmin(*half_angle_rad + 0.5 * source->divergence_rad, PL_PI);
}
