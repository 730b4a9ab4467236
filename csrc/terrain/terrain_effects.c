/* The effect rows `terrain`, `far_casters`, `sub_cell_normals`, `texture_slopes` and `crater_rays`:
 * heights of bodies, shadows from beyond the frame, slopes finer than the mesh, and bright ejecta.
 */
#include <math.h>

#include "plan/changed_surfaces.h"
#include "plan/effects.h"

/* Whether the mesh of a body may be finer than a level. */
static bool has_terrain(const pl_view_entity *entity, int level) { return entity->terrain > level; }
static bool has_ground(const pl_view_entity *entity, int value) {
  return value == 0 && entity->terrain > 0;
}

static const char *terrain_absent(const pl_view *view) {
  return pl_view_has(view, has_terrain) ? NULL : "no body in the scene has terrain";
}

static int finest_level(const pl_view *view) {
  int most = 1;
  for (size_t i = 0; i < view->entity_count; i++)
    most = view->entities[i].terrain > most ? view->entities[i].terrain : most;
  return most;
}

/* Slopes and shadows can add or remove all light of ground that a finer mesh would show. */
static double terrain_bound_dn(const pl_view *view, int value) {
  return pl_view_changed_dn(view, has_terrain, value);
}

static double bound_dn(const pl_view *view, int value) {
  return pl_view_changed_dn(view, has_ground, value);
}

static double terrain_cost_ms(const pl_view *view, int value) {
  const int left_out = finest_level(view) - value;
  return (1e-4 + 2e-4 * exp2(-left_out)) * view->width * view->height * view->samples;
}

static double casters_cost_ms(const pl_view *view, int value) {
  (void)value;
  return 1e-4 * view->width * view->height;
}

const pl_effect pl_effect_terrain = {
    .name = "terrain",
    .doc =
        "Heights of bodies with terrain, refined up to so many levels of halved cells; off: their "
        "smooth ellipsoids, also in labels",
    .absent = terrain_absent,
    .ceiling = finest_level,
    .bound_dn = terrain_bound_dn,
    .cost_ms = terrain_cost_ms,
};

const pl_effect pl_effect_far_casters = {
    .name = "far_casters",
    .doc = "Fine terrain outside the frame that can throw shadows into it; off: coarse there",
    .absent = terrain_absent,
    .ceiling = pl_effect_ceiling_one,
    .bound_dn = bound_dn,
    .cost_ms = casters_cost_ms,
};

static double normals_cost_ms(const pl_view *view, int value) {
  (void)value;
  return 1e-3 * view->width * view->height * view->samples;
}

const pl_effect pl_effect_sub_cell_normals = {
    .name = "sub_cell_normals",
    .doc = "Slopes of terrain and its rocks that are finer than the cells of its mesh, in normals "
           "down to the "
           "footprint of a sample and beyond in the reflectance; off: left out",
    .absent = terrain_absent,
    .ceiling = pl_effect_ceiling_one,
    .bound_dn = bound_dn,
    .cost_ms = normals_cost_ms,
};

static bool has_texture_slopes(const pl_view_entity *entity, int value) {
  return value == 0 && entity->sampled;
}

static const char *texture_slopes_absent(const pl_view *view) {
  return pl_view_has(view, has_texture_slopes)
             ? NULL
             : "no terrain in the scene has textures of heights that samples resolve";
}

/* They can turn ground away from the Sun, or towards it. */
static double texture_slopes_bound_dn(const pl_view *view, int value) {
  return pl_view_changed_dn(view, has_texture_slopes, value);
}

static double texture_slopes_cost_ms(const pl_view *view, int value) {
  (void)value;
  return 2e-3 * view->width * view->height * view->samples;
}

const pl_effect pl_effect_texture_slopes = {
    .name = "texture_slopes",
    .doc = "Slopes of clods and other textures of heights that are finer than the mesh, in "
           "normals; off: in the reflectance by their variance",
    .absent = texture_slopes_absent,
    .ceiling = pl_effect_ceiling_one,
    .bound_dn = texture_slopes_bound_dn,
    .cost_ms = texture_slopes_cost_ms,
};

static bool has_rays(const pl_view_entity *entity, int value) { return value == 0 && entity->rays; }

static const char *rays_absent(const pl_view *view) {
  return pl_view_has(view, has_rays) ? NULL : "no terrain in the scene has rays of craters";
}

/* No more than all light of the ground with rays: by Hapke's law it grows faster than the albedo.
 */
static double rays_bound_dn(const pl_view *view, int value) {
  return pl_view_changed_dn(view, has_rays, value);
}

static double rays_cost_ms(const pl_view *view, int value) {
  (void)value;
  return 1e-4 * view->width * view->height;
}

const pl_effect pl_effect_crater_rays = {
    .name = "crater_rays",
    .doc = "Bright ejecta and rays of fresh craters; off: ground of its mean albedo",
    .absent = rays_absent,
    .ceiling = pl_effect_ceiling_one,
    .bound_dn = rays_bound_dn,
    .cost_ms = rays_cost_ms,
};
