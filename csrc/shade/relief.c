/* Slopes of the relief from height maps, by differences, and from normal maps. Both methods also
 * work at the poles. */
#include "math/sampling.h"
#include "shade/ground.h"

/* Normals are limited to 87 deg from the vertical: its cosine. */
static const double STEEPEST = 0.05;
/* Step of the differences is limited to this part of the distance from the body's centre. */
static const double REACH_MAX = 0.1;

static double height_at(const pl_ground *ground, const pl_body_place *place, pl_vec3 step,
                        pl_filter filter) {
  float value[4];
  pl_body_place there = *place;
  there.point = pl_vec3_add(place->point, step);
  pl_body_map_sample(ground->heights, &there, filter, value);
  return (double)value[0];
}

/* Half the distance over which heights are compared: a texel along a meridian, or half a footprint.
 */
static double reach_of(const pl_texture *heights, const pl_body_place *place) {
  int width, height, channels;
  pl_texture_size(heights, &width, &height, &channels);
  const double radius = pl_vec3_norm(place->point);
  const double area = pl_vec3_norm(pl_vec3_cross(place->across, place->along));
  const double reach = fmax(PL_PI * radius / fmax(height, 0.5 * width), 0.5 * sqrt(area));
  return fmin(reach, REACH_MAX * radius);
}

static pl_vec3 slope_of_heights(const pl_ground *ground, float height_m, const pl_body_place *place,
                                pl_vec3 up, pl_filter filter) {
  const pl_basis basis = pl_basis_make(pl_vec3_to_float(up));
  const pl_vec3 axes[2] = {pl_vec3f_to_double(basis.t), pl_vec3f_to_double(basis.b)};
  const double reach = reach_of(ground->heights, place);
  pl_vec3 slope = {0.0, 0.0, 0.0};
  for (int k = 0; k < 2; k++) {
    const pl_vec3 step = pl_vec3_scale(axes[k], reach);
    const double rise = height_at(ground, place, step, filter) -
                        height_at(ground, place, pl_vec3_scale(step, -1.0), filter);
    slope = pl_vec3_madd(slope, (double)height_m * rise / (2.0 * reach), axes[k]);
  }
  return slope;
}

/* Direction of east; at the poles that of longitude 0 (shade/body_map.h). */
static pl_vec3 east_at(pl_vec3 point) {
  const double r2 = pl_vec3_dot(point, point), rho2 = point.x * point.x + point.y * point.y;
  return rho2 < 1e-12 * r2 ? (pl_vec3){0.0, 1.0, 0.0}
                           : pl_vec3_unit((pl_vec3){-point.y, point.x, 0.0});
}

/* Parts of a footprint at a pole have different longitudes, hence each its own east. */
static pl_vec3 slope_of_normals(const pl_ground *ground, float steepness,
                                const pl_body_place *place, pl_vec3 up, pl_filter filter) {
  pl_body_place parts[PL_BODY_MAP_PARTS];
  const int count = pl_body_map_split(place, filter, parts);
  pl_vec3 sum = {0.0, 0.0, 0.0};
  for (int i = 0; i < count; i++) {
    float value[4];
    pl_body_map_read(ground->normals, &parts[i], count > 1, filter, value);
    const pl_vec3 east = east_at(parts[i].point);
    const pl_vec3 north = pl_vec3_unit(pl_vec3_cross(up, east));
    const double x = 2.0 * (double)value[0] - 1.0;
    const double y = (double)ground->north * (2.0 * (double)value[1] - 1.0);
    sum = pl_vec3_madd(pl_vec3_madd(sum, x, east), y, north);
    sum = pl_vec3_madd(sum, 2.0 * (double)value[2] - 1.0, up);
  }
  const double z = pl_vec3_dot(sum, up);
  const pl_vec3 flat = pl_vec3_madd(sum, -z, up);
  return pl_vec3_scale(flat, -(double)steepness / fmax(z, STEEPEST * pl_vec3_norm(sum) + 1e-12));
}

pl_vec3 pl_ground_slope(const pl_ground *ground, const pl_ground_state *state,
                        const pl_body_place *place, pl_vec3 up, pl_filter filter) {
  pl_vec3 slope = {0.0, 0.0, 0.0};
  if (ground->heights != NULL)
    slope = slope_of_heights(ground, state->height_m, place, up, filter);
  if (ground->normals != NULL)
    slope = pl_vec3_add(slope, slope_of_normals(ground, state->steepness, place, up, filter));
  return slope;
}
