/* The effect row `texture_filter`: filtering of textures over footprints. */
#include <math.h>

#include "geom/texture.h"
#include "plan/effects.h"
#include "plan/view_tree.h"

/* Safety margin for rounding of footprints in single precision; also covers footprints at the poles
 * and of pixels with analytic shading, which are sampled in quarters. */
static const double MARGIN = 0.249;

static bool is_pictured(const pl_view_entity *entity) {
  return entity->pictured || (entity->map.ranges != NULL && entity->map.ranges[0] > 0.0f);
}

static const char *absent(const pl_view *view) {
  for (size_t i = 0; i < view->entity_count; i++)
    if (is_pictured(&view->entities[i]))
      return NULL;
  return "all textures in the scene are uniform";
}

static int ceiling(const pl_view *view) { return view->texture_filter; }

/* Minimum number of texels across a footprint's shorter axis. Along a path the footprint is at
 * least as wide as the path length times the spread of the first ray, and a path is no shorter than
 * the straight line from the camera. */
static double texels(const pl_view *view, const pl_view_entity *entity) {
  const double spread = view->pixel_rad / sqrt(fmax(1.0, view->samples));
  const double nearest = fmax(0.0, entity->distance_m - entity->radius_m);
  return MARGIN * spread * nearest * entity->map.texels_per_m;
}

/* Upper bound of the change of an object's colour by the filter `value`, 0..1: filters average
 * texels of the mip level of the footprint's shorter axis, or of coarser ones. */
static double change(const pl_view *view, const pl_view_entity *entity, int value) {
  if (!is_pictured(entity))
    return 0.0;
  if (entity->pictured || entity->map.ranges == NULL)
    return 1.0;
  const double across = texels(view, entity);
  int level = value > PL_FILTER_NONE && across > 1.0 ? (int)log2(across) : 0;
  level = level < entity->map.levels ? level : entity->map.levels - 1;
  return (double)entity->map.ranges[level];
}

typedef struct filtered {
  const pl_view *view;
  int value;
} filtered;

static double changed_light(const pl_view_entity *source, const void *context) {
  const filtered *query = context;
  return change(query->view, source, query->value) * pl_view_light(source);
}

/* Upper bound of the indirect light from other objects onto entities[i]. */
static double indirect(const pl_view *view, size_t i, const filtered *query) {
  return pl_view_sum(view, &view->entities[i], changed_light, query) *
         pl_view_series(view, view->max_bounces);
}

/* Textures on meshes and in graphs may be of roughness, normals or emission, see the row
 * surface_maps; and the reflectance of surfaces that are not Lambertian is not proportional to
 * their colour. */
static double bound_dn(const pl_view *view, int value) {
  double radiance = 0.0;
  if (value >= PL_FILTER_FINEST)
    return 0.0;
  const filtered query = {view, value};
  pl_view_weigh(view, changed_light, &query);
  for (size_t i = 0; i < view->entity_count && radiance < view->white_radiance; i++) {
    const pl_view_entity *entity = &view->entities[i];
    const double own = change(view, entity, value);
    if (!entity->in_frame)
      continue;
    if (own > 0.0 && !(entity->is_body && entity->diffuse && !entity->graphed))
      return pl_view_dn(view, view->white_radiance);
    const double lit = entity->albedo_max * entity->irradiance / 3.14159265358979 +
                       entity->lights_max +
                       pl_view_received(view, i) * pl_view_series(view, view->max_bounces);
    radiance = fmax(radiance, own * lit + indirect(view, i, &query));
  }
  return pl_view_dn(view, radiance);
}

static double cost_ms(const pl_view *view, int value) {
  static const double ns[PL_FILTER_COUNT] = {10.0, 20.0, 25.0, 30.0, 35.0, 40.0, 50.0, 70.0};
  return 1e-6 * ns[value] * view->width * view->height * view->samples;
}

const pl_effect pl_effect_texture_filter = {
    .name = "texture_filter",
    .doc = "Texture filter: 1 nearest texel of a mip level, 2 bilinear, 3 trilinear, 4 to 7 "
           "anisotropic with 2 to 16 samples; off: nearest texel of the full image",
    .absent = absent,
    .ceiling = ceiling,
    .bound_dn = bound_dn,
    .cost_ms = cost_ms,
};
