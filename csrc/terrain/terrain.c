/* Heights of a body's ground: creation, levels, bounds. */
#include "terrain/terrain.h"

#include <math.h>
#include <stdatomic.h>
#include <stdlib.h>

#include "base/memory.h"
#include "terrain/rock_fillets.h"
#include "terrain/sub_cell.h"
#include "terrain/terrain_parts.h"

static pl_status check_layer(const pl_terrain_layer *layer, size_t n) {
  if (layer->raster == NULL || !(layer->interpolation < PL_INTERPOLATION_COUNT))
    return pl_fail(PL_E_ARGUMENT, "layer %zu of a terrain has no raster or no interpolation", n);
  if (!(isfinite(layer->border_posts) && layer->border_posts >= 0.0))
    return pl_fail(PL_E_RANGE, "layer %zu of a terrain: a border of %g posts", n,
                   layer->border_posts);
  if (!(isfinite(layer->datum_m) && layer->datum_m >= 0.0))
    return pl_fail(PL_E_RANGE, "layer %zu of a terrain: a datum with a radius of %g m", n,
                   layer->datum_m);
  return PL_OK;
}

static double mean_radius_m(pl_vec3 r) {
  return r.x * cbrt((r.y / r.x) * (r.z / r.x)); /* exact on a sphere */
}

static pl_status check_craters(const pl_terrain_frame *frame) {
  const double radius_m = mean_radius_m(frame->radii_m);
  const double given_m =
      frame->craters != NULL ? pl_crater_field_frame(frame->craters)->radius_m : radius_m;
  if (fabs(given_m - radius_m) > 0.01 * radius_m)
    return pl_fail(PL_E_RANGE, "craters of a body with a radius of %g m on one of %g m", given_m,
                   radius_m);
  return PL_OK;
}

/* The lattices of ground and rocks must be the same. */
static pl_status check_rocks(const pl_terrain_frame *frame) {
  const double radius_m = mean_radius_m(frame->radii_m);
  if (frame->rocks == NULL)
    return PL_OK;
  const double own = pl_rock_field_frame(frame->rocks)->radius_m;
  if (fabs(own - radius_m) <= 1e-9 * radius_m)
    return PL_OK;
  return pl_fail(PL_E_RANGE, "rocks of a body of radius %.9g m on terrain of %.9g m", own,
                 radius_m);
}

/* Values that the laws of reflectance can take. */
static pl_status check_surface(const pl_terrain_frame *frame) {
  const pl_raster_stack *albedo = frame->albedo, *roughness = frame->roughness;
  if (albedo != NULL && !(albedo->low >= 0.0 && albedo->high <= PL_TERRAIN_ALBEDO_MOST))
    return pl_fail(PL_E_RANGE, "rasters of albedo from %g to %g; must be from 0 to %g", albedo->low,
                   albedo->high, PL_TERRAIN_ALBEDO_MOST);
  if (roughness != NULL && !(roughness->low >= 0.0 && roughness->high <= PL_TERRAIN_ROUGHNESS_MOST))
    return pl_fail(PL_E_RANGE, "rasters of roughness from %g to %g rad; must be from 0 to %g",
                   roughness->low, roughness->high, PL_TERRAIN_ROUGHNESS_MOST);
  return PL_OK;
}

static pl_status check_patch(const pl_terrain_patch *patch) {
  if (!(isfinite(patch->side_m) && patch->side_m >= 0.0) ||
      (patch->side_m > 0.0 && !(fabs(pl_vec3_norm(patch->center) - 1.0) < 1e-9)))
    return pl_fail(PL_E_RANGE,
                   "the patch of a terrain needs a unit direction and a side of at "
                   "least 0, not %g m",
                   patch->side_m);
  return PL_OK;
}

static pl_status check(const pl_terrain_frame *frame) {
  const pl_vec3 r = frame->radii_m;
  if (!pl_vec3_finite(r) || !(r.x > 0.0 && r.y > 0.0 && r.z > 0.0))
    return pl_fail(PL_E_RANGE, "radii of a terrain must be above 0, not %g, %g and %g m", r.x, r.y,
                   r.z);
  if (frame->layer_count > PL_TERRAIN_LAYERS)
    return pl_fail(PL_E_RANGE, "a terrain of %zu rasters; at most %d are supported",
                   frame->layer_count, PL_TERRAIN_LAYERS);
  for (size_t n = 0; n < frame->layer_count; n++)
    PL_TRY(check_layer(&frame->layers[n], n));
  for (size_t n = 0; frame->aprons_m != NULL && n < frame->layer_count; n++)
    if (!(isfinite(frame->aprons_m[n]) && frame->aprons_m[n] >= 0.0))
      return pl_fail(PL_E_RANGE, "layer %zu of a terrain: an apron of %g m", n, frame->aprons_m[n]);
  if (!(frame->roughness_baseline_m >= 0.0 && isfinite(frame->roughness_baseline_m)))
    return pl_fail(PL_E_RANGE, "roughness_baseline_m of a terrain must be at least 0, not %g",
                   frame->roughness_baseline_m);
  PL_TRY(check_craters(frame));
  PL_TRY(check_rocks(frame));
  PL_TRY(check_surface(frame));
  PL_TRY(check_patch(&frame->patch));
  return frame->detail.on ? pl_terrain_detail_check(&frame->detail) : PL_OK;
}

static int by_z(const void *a, const void *b) {
  const pl_numbered_crater *x = a, *y = b;
  if (x->crater.direction.z != y->crater.direction.z)
    return x->crater.direction.z < y->crater.direction.z ? -1 : 1;
  return x->number < y->number ? -1 : x->number > y->number;
}

static pl_status copy_known(const pl_terrain_frame *frame, pl_terrain *t) {
  void *memory;
  t->known_count = frame->known_count;
  t->known_most_m = 0.0;
  PL_TRY(pl_alloc_or_fail(t->known_count, sizeof *t->known, "a catalogue of craters", &memory));
  t->known = memory;
  for (size_t k = 0; k < t->known_count; k++) {
    t->known[k] = (pl_numbered_crater){frame->known[k], (int64_t)k + 1};
    t->known_most_m = fmax(t->known_most_m, frame->known[k].diameter_m);
  }
  qsort(t->known, t->known_count, sizeof *t->known, by_z);
  return PL_OK;
}

static pl_status copy_layers(const pl_terrain_frame *frame, pl_terrain *t) {
  void *memory;
  PL_TRY(pl_alloc_or_fail(frame->layer_count, sizeof *t->layers, "rasters of a terrain", &memory));
  t->layers = memory;
  t->layer_count = frame->layer_count;
  for (size_t n = 0; n < t->layer_count; n++) {
    pl_layer *layer = &t->layers[n];
    layer->given = frame->layers[n];
    layer->spacing_m = pl_raster_spacing_m(layer->given.raster, t->radius_m);
    layer->coarsest = pl_cube_level(PL_TERRAIN_OVERLAP * layer->spacing_m, t->radius_m);
    if (layer->coarsest < t->detail.first)
      layer->coarsest = t->detail.first;
  }
  return PL_OK;
}

static pl_status refine_layers(const pl_terrain_detail *law, pl_terrain *t) {
  void *memory;
  const bool refined = law->method == PL_DETAIL_DIAMOND_SQUARE && t->detail.last >= 0;
  for (size_t n = 0; n < t->layer_count; n++)
    t->layers[n].refined = refined;
  if (!refined || t->layer_count == 0)
    return PL_OK;
  PL_TRY(pl_alloc_or_fail(1, sizeof *t->diamond, "weights of diamond-square", &memory));
  t->diamond = memory;
  pl_diamond_weights_init(law, t->diamond);
  for (size_t n = 0; n < t->layer_count; n++)
    pl_diamond_square_init(t->layers[n].given.raster, t->layers[n].given.interpolation, law,
                           t->diamond, t->radius_m, &t->layers[n].diamond);
  return PL_OK;
}

pl_status pl_terrain_create(const pl_terrain_frame *frame, pl_terrain **out) {
  void *memory;
  *out = NULL;
  PL_TRY(check(frame));
  PL_TRY(pl_alloc_or_fail(1, sizeof(pl_terrain), "a terrain", &memory));
  pl_terrain *t = memory;
  static atomic_ullong numbers;
  t->number = atomic_fetch_add(&numbers, 1) + 1;
  t->radii_m = frame->radii_m;
  t->radius_m = mean_radius_m(frame->radii_m);
  pl_fractal_detail_init(&frame->detail, t->radius_m, &t->detail);
  t->craters = frame->craters;
  t->rocks = frame->rocks;
  t->albedo = frame->albedo != NULL ? *frame->albedo : (pl_raster_stack){.mean = {0.0, 1.0}};
  t->roughness =
      frame->roughness != NULL ? *frame->roughness : (pl_raster_stack){.mean = {0.0, 1.0}};
  t->mask = frame->mask != NULL ? *frame->mask : (pl_raster_stack){.mean = {0.0, 1.0}};
  t->patch = frame->patch;
  pl_status status = copy_layers(frame, t);
  if (status == PL_OK)
    status = pl_terrain_take_textures(t, frame);
  pl_slope_table_init(t, frame->roughness_baseline_m);
  if (status == PL_OK)
    status = refine_layers(&frame->detail, t);
  if (status == PL_OK && frame->aprons_m != NULL)
    status = pl_terrain_add_aprons(t, frame->aprons_m);
  if (status == PL_OK)
    status = copy_known(frame, t);
  if (status == PL_OK && frame->track_count > 0)
    status = pl_wheel_tracks_create(frame->tracks, frame->track_count, &t->tracks);
  if (status == PL_OK)
    *out = t;
  else
    pl_terrain_destroy(t);
  return status;
}

void pl_terrain_destroy(pl_terrain *terrain) {
  if (terrain == NULL)
    return;
  for (size_t n = 0; n < terrain->layer_count; n++)
    pl_free(terrain->layers[n].apron);
  pl_free(terrain->layers);
  pl_free(terrain->known);
  pl_free(terrain->diamond);
  pl_wheel_tracks_destroy(terrain->tracks);
  pl_free(terrain);
}

uint64_t pl_terrain_number(const pl_terrain *terrain) { return terrain->number; }

const pl_rock_field *pl_terrain_rocks(const pl_terrain *terrain) { return terrain->rocks; }

const pl_wheel_tracks *pl_terrain_tracks(const pl_terrain *terrain) { return terrain->tracks; }

const pl_raster_stack *pl_terrain_albedo(const pl_terrain *terrain) { return &terrain->albedo; }

const pl_raster_stack *pl_terrain_roughness(const pl_terrain *terrain) {
  return &terrain->roughness;
}

const pl_raster_stack *pl_terrain_mask(const pl_terrain *terrain) { return &terrain->mask; }

bool pl_terrain_has_patch(const pl_terrain *terrain) { return terrain->patch.side_m > 0.0; }

bool pl_terrain_beside_patch(const pl_terrain *terrain, pl_vec3 center, double radius_m) {
  const pl_terrain_patch *patch = &terrain->patch;
  const pl_vec3 up = patch->center;
  const pl_vec3 pole = fabs(up.z) < 1.0 ? (pl_vec3){0.0, 0.0, 1.0} : (pl_vec3){1.0, 0.0, 0.0};
  if (!pl_terrain_has_patch(terrain))
    return false;
  const pl_vec3 east = pl_vec3_unit(pl_vec3_cross(pole, up)), north = pl_vec3_cross(up, east);
  const double reach_m = 0.5 * patch->side_m + radius_m;
  return pl_vec3_dot(center, up) < -radius_m || fabs(pl_vec3_dot(center, east)) > reach_m ||
         fabs(pl_vec3_dot(center, north)) > reach_m;
}

double pl_terrain_radius_m(const pl_terrain *terrain) { return terrain->radius_m; }

double pl_terrain_datum_m(const pl_terrain *terrain, pl_vec3 direction) {
  const pl_vec3 r = terrain->radii_m;
  const double x = direction.x / r.x, y = direction.y / r.y, z = direction.z / r.z;
  return 1.0 / sqrt(x * x + y * y + z * z);
}

int pl_terrain_level_of(const pl_terrain *terrain, double cell_m) {
  return pl_cube_level(cell_m, terrain->radius_m);
}

/* Rasters end where nodes are half a post apart: without detail, cells between posts are not flat,
 * but nearly so. */
int pl_terrain_finest_level(const pl_terrain *terrain) {
  int finest = terrain->detail.last > 0 ? terrain->detail.last : 0;
  for (size_t n = 0; n < terrain->layer_count; n++) {
    const int level = pl_cube_level(0.5 * terrain->layers[n].spacing_m, terrain->radius_m);
    finest = level > finest ? level : finest;
  }
  for (size_t n = 0; n < terrain->texture_count; n++) {
    const double texel_m = pl_ground_texture_texel_m(&terrain->textures[n]);
    const int level = isfinite(texel_m) ? pl_cube_level(texel_m, terrain->radius_m) : 0;
    finest = level > finest ? level : finest;
  }
  return finest;
}

static void widen(double from_m, double to_m, double *low_m, double *high_m) {
  *low_m = fmin(*low_m, from_m);
  *high_m = fmax(*high_m, to_m);
}

/* Bounds of one layer: U(Z) and detail, over the ellipsoid. */
static void layer_bounds(const pl_terrain *t, const pl_layer *layer, double *low_m,
                         double *high_m) {
  const pl_terrain_layer *given = &layer->given;
  double from_m, to_m;
  pl_raster_bounds(given->raster, given->interpolation, &from_m, &to_m);
  /* The absolute weights of posts sum to at most 1, of cubic interpolation to (5/4)^2. */
  const double weights = given->interpolation == PL_INTERPOLATION_CUBIC ? 25.0 / 16.0 : 1.0;
  const double q_m = PL_DETAIL_BOUND *
                     pl_fractal_detail_deviation_m(&t->detail, layer->coarsest, PL_CUBE_LEVELS - 1);
  const double detail_m = layer->refined ? layer->diamond.add_m : (1.0 + weights) * q_m;
  double lift_low_m = 0.0, lift_high_m = 0.0;
  if (given->datum_m > 0.0) {
    const pl_vec3 r = t->radii_m;
    lift_low_m = given->datum_m - fmax(r.x, fmax(r.y, r.z));
    lift_high_m = given->datum_m - fmin(r.x, fmin(r.y, r.z));
  }
  const double spare_m = 1e-9 * (fabs(from_m) + fabs(to_m) + given->datum_m); /* rounding */
  widen(from_m + lift_low_m - detail_m - spare_m, to_m + lift_high_m + detail_m + spare_m, low_m,
        high_m);
}

/* Whether some ground is below all rasters. */
static bool bare(const pl_terrain *t) {
  for (size_t n = 0; n < t->layer_count; n++)
    if (pl_raster_whole(t->layers[n].given.raster))
      return false;
  return true;
}

/* Diameter of the largest craters that are drawn: the widest posts anywhere leave smaller ones. */
static double largest_crater_m(const pl_terrain *t) {
  const pl_crater_frame *frame = pl_crater_field_frame(t->craters);
  double spacing_m = 0.0;
  for (size_t n = 0; n < t->layer_count; n++)
    spacing_m = fmax(spacing_m, t->layers[n].spacing_m);
  return bare(t) ? frame->max_m : fmin(frame->max_m, frame->model_posts * spacing_m);
}

void pl_terrain_bounds(const pl_terrain *terrain, double *low_m, double *high_m) {
  *low_m = INFINITY;
  *high_m = -INFINITY;
  for (size_t n = 0; n < terrain->layer_count; n++)
    layer_bounds(terrain, &terrain->layers[n], low_m, high_m);
  if (bare(terrain)) {
    const double q_m =
        PL_DETAIL_BOUND * pl_fractal_detail_deviation_m(&terrain->detail, 0, PL_CUBE_LEVELS - 1);
    widen(-q_m, q_m, low_m, high_m);
  }
  for (size_t n = 0; n < terrain->layer_count; n++)
    if (terrain->layers[n].apron != NULL) {
      *low_m -= terrain->layers[n].apron->most_m;
      *high_m += terrain->layers[n].apron->most_m;
    }
  if (terrain->craters != NULL) {
    double below_m, above_m;
    pl_crater_bounds(terrain->craters, largest_crater_m(terrain), &below_m, &above_m);
    *low_m += fmin(below_m, 0.0);
    *high_m += fmax(above_m, 0.0);
  }
  if (terrain->tracks != NULL) {
    double below_m, above_m;
    pl_wheel_tracks_bounds(terrain->tracks, &below_m, &above_m);
    *low_m += below_m;
    *high_m += above_m;
  }
  if (terrain->rocks != NULL)
    *high_m += pl_rock_fillets_bound_m(terrain->rocks);
  for (size_t n = 0; n < terrain->texture_count; n++) {
    *low_m -= pl_ground_texture_bound_m(&terrain->textures[n]);
    *high_m += pl_ground_texture_bound_m(&terrain->textures[n]);
  }
}

double pl_terrain_relief_m(const pl_terrain *terrain, int level) {
  return pl_fractal_detail_deviation_m(&terrain->detail, level + 1, PL_CUBE_LEVELS - 1);
}

pl_status pl_terrain_slope(const pl_terrain *terrain, pl_vec3 direction, double baseline_m,
                           pl_vec3 *out) {
  const double half = 0.5 * baseline_m / pl_terrain_datum_m(terrain, direction);
  const pl_vec3 axis =
      fabs(direction.z) < 0.7 ? (pl_vec3){0.0, 0.0, 1.0} : (pl_vec3){1.0, 0.0, 0.0};
  const pl_vec3 east = pl_vec3_unit(pl_vec3_cross(axis, direction));
  const pl_vec3 north = pl_vec3_cross(direction, east);
  const pl_vec3 places[4] = {pl_vec3_unit(pl_vec3_madd(direction, -half, east)),
                             pl_vec3_unit(pl_vec3_madd(direction, half, east)),
                             pl_vec3_unit(pl_vec3_madd(direction, -half, north)),
                             pl_vec3_unit(pl_vec3_madd(direction, half, north))};
  double h[4];
  PL_TRY(pl_terrain_heights(terrain, places, 4, pl_terrain_level_of(terrain, baseline_m), h));
  *out = pl_vec3_madd(pl_vec3_scale(east, (h[1] - h[0]) / baseline_m), (h[3] - h[2]) / baseline_m,
                      north);
  return PL_OK;
}
