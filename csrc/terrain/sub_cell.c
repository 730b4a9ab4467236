/* Slopes that a mesh leaves out. */
#include "terrain/sub_cell.h"

#include <math.h>

#include "terrain/rock_relief.h"
#include "terrain/terrain_parts.h"

/* What interpolated normals keep of an octave that is by `n` levels wider than cells: of the
 * variance of its slopes, and of the covariance with the true ones (measured; a test repeats it).
 * With ADDED times its true slope the variance is right. Further octaves are kept. */
enum { KEPT = 4 };
static const double VARIANCE[KEPT] = {0.212, 0.610, 0.868, 0.967};
static const double COVARIANCE[KEPT] = {0.375, 0.766, 0.930, 0.983};
static const double ADDED[KEPT] = {0.58865, 0.2223, 0.0, 0.0};

/* Mean height of rocks over the ground, over their width, by the mean of their burial, as their
 * shadows say: on real ground they are sunk further (measured, within 3 %). */
static double stone_height(double burial) { return 0.507 - 0.69 * burial * burial; }
/* Share of the ground that they hide from above, over that of circles of their diameters (measured,
 * within 1 %). */
static double stone_plan(double burial) { return 0.925 - 0.36 * burial * burial; }

static void add_stones(pl_terrain *terrain, const double cells_m[PL_CUBE_LEVELS]) {
  pl_slope_table *out = &terrain->slopes;
  const pl_rock_frame *frame = terrain->rocks != NULL ? pl_rock_field_frame(terrain->rocks) : NULL;
  const double burial = frame != NULL ? 0.5 * (frame->least_burial + frame->most_burial) : 0.0;
  out->stone_height = frame != NULL ? stone_height(burial) : 0.0;
  const double shown = frame != NULL ? stone_plan(burial) : 0.0;
  for (int k = 0; k < PL_CUBE_LEVELS; k++) {
    const double most_m = frame != NULL ? fmin(PL_ROCK_CELLS * cells_m[k], frame->max_m) : 0.0;
    const bool some = frame != NULL && most_m > frame->min_m;
    out->stones[k] = some ? shown * pl_rock_cover(&frame->law, frame->min_m, most_m) : 0.0;
    out->stone_relief[k] = some ? pl_rock_relief_variance(sqrt(frame->min_m * most_m)) : 0.0;
  }
}

void pl_slope_table_init(pl_terrain *terrain, double roughness_baseline_m) {
  pl_slope_table *out = &terrain->slopes;
  double cells_m[PL_CUBE_LEVELS];
  out->beyond[PL_CUBE_LEVELS] = 0.0;
  for (int k = PL_CUBE_LEVELS - 1; k >= 0; k--) {
    cells_m[k] = pl_cube_cell_m(k, terrain->radius_m);
    out->octave[k] = pl_fractal_detail_slope_variance(&terrain->detail, k, terrain->radius_m);
    out->beyond[k] = out->beyond[k + 1] + out->octave[k];
    out->craters[k] = 0.0;
  }
  if (terrain->craters != NULL)
    pl_crater_slope_variances(terrain->craters, cells_m, PL_CUBE_LEVELS, out->craters);
  for (int k = 0; k < PL_CUBE_LEVELS; k++) {
    out->textures[k] = 0.0;
    for (size_t n = 0; n < terrain->texture_count; n++)
      out->textures[k] += pl_ground_texture_variance(&terrain->textures[n], 0.0) -
                          pl_ground_texture_variance(&terrain->textures[n], 2.0 * cells_m[k]);
  }
  add_stones(terrain, cells_m);
  out->shared =
      roughness_baseline_m > 0.0 ? pl_terrain_slope_variance(terrain, roughness_baseline_m) : 0.0;
}

/* The coarsest octave that is drawn in a direction: elsewhere, wider waves are the model's. */
static int coarsest_at(const pl_terrain *terrain, pl_vec3 direction) {
  for (size_t n = terrain->layer_count; n-- > 0;) {
    const pl_layer *layer = &terrain->layers[n];
    double u, v;
    if (!pl_raster_far(layer->given.raster, direction, 0.0) &&
        pl_raster_find(layer->given.raster, direction, &u, &v) &&
        pl_raster_weight(layer->given.raster, u, v, layer->given.border_posts) >= 0.5)
      return pl_cube_level(layer->spacing_m, terrain->radius_m);
  }
  return terrain->detail.first;
}

/* Normals of the mesh are differences across two cells: what they have of textures is taken away
 * from the slopes over the footprint. */
static void add_textures(const pl_terrain *terrain, pl_vec3 direction, int level,
                         double footprint_m, bool shown, pl_sub_cell *out) {
  const double mesh_m = 2.0 * pl_cube_cell_m(level, terrain->radius_m);
  for (size_t n = 0; n < terrain->texture_count; n++) {
    const pl_ground_texture *of = &terrain->textures[n];
    const double all = pl_ground_texture_variance(of, 0.0);
    const double fine = pl_ground_texture_variance(of, shown ? footprint_m : mesh_m);
    out->variance += all - fine;
    out->whole += all - fmin(fine, pl_ground_texture_variance(of, mesh_m));
    if (!shown || of->heights == NULL || footprint_m >= mesh_m)
      continue;
    out->slope = pl_vec3_add(
        out->slope, pl_ground_texture_slope(of, terrain->radius_m, direction, footprint_m, mesh_m));
  }
}

pl_sub_cell pl_terrain_sub_cell(const pl_terrain *terrain, pl_vec3 direction, int level,
                                double footprint_m, bool textures) {
  const pl_slope_table *table = &terrain->slopes;
  const int last = terrain->detail.last, coarsest = coarsest_at(terrain, direction);
  pl_sub_cell out = {.variance = table->craters[level],
                     .stones = table->stones[level],
                     .stone_height = table->stone_height,
                     .stone_relief = table->stone_relief[level]};
  int k = level - (KEPT - 1) > 0 ? level - (KEPT - 1) : 0;
  /* Of octaves with cells as wide as the footprint all is resolved, of half as wide ones none. */
  const double finest = 1.0 + log2(pl_cube_cell_m(0, terrain->radius_m) / footprint_m);
  for (; k <= last; k++) {
    const double fraction = k < coarsest ? 0.0 : fmin(fmax(finest - k, 0.0), 1.0);
    if (k > level && k >= coarsest && !(fraction > 0.0))
      break;
    const int wider = level - k;
    const double added = fraction * (wider >= 0 ? ADDED[wider] : 1.0);
    const double kept = wider >= 0 ? VARIANCE[wider] + 2.0 * added * COVARIANCE[wider] : 0.0;
    if (table->octave[k] > 0.0 && added > 0.0)
      out.slope = pl_vec3_madd(out.slope, added,
                               pl_fractal_detail_octave_gradient(&terrain->detail, direction, k));
    out.variance += table->octave[k] * (1.0 - kept - added * added);
    out.whole += table->octave[k] * added * added;
  }
  out.variance += k <= last ? table->beyond[k] : 0.0;
  out.whole += out.variance;
  out.slope = pl_vec3_madd(out.slope, -pl_vec3_dot(out.slope, direction), direction);
  out.slope = pl_vec3_scale(out.slope, 1.0 / terrain->radius_m);
  add_textures(terrain, direction, level, footprint_m, textures, &out);
  return out;
}

/* Linear between the levels on both sides. */
double pl_terrain_slope_variance(const pl_terrain *terrain, double cell_m) {
  const pl_slope_table *table = &terrain->slopes;
  const double widest_m = pl_cube_cell_m(0, terrain->radius_m);
  const double at = fmin(fmax(log2(widest_m / cell_m), 0.0), PL_CUBE_LEVELS - 1.0);
  const int level = (int)at < PL_CUBE_LEVELS - 2 ? (int)at : PL_CUBE_LEVELS - 2;
  const double part = at - level;
  return (1.0 - part) * (table->beyond[level] + table->craters[level] + table->textures[level]) +
         part * (table->beyond[level + 1] + table->craters[level + 1] + table->textures[level + 1]);
}

double pl_terrain_shared_variance(const pl_terrain *terrain) { return terrain->slopes.shared; }

/* Hapke's mean slope: tan(theta) is sqrt(2/pi) times the deviation of slopes along an axis. */
double pl_roughness_without(double roughness_rad, double variance) {
  const double tangent = tan(roughness_rad);
  return atan(sqrt(fmax(tangent * tangent - 2.0 / PL_PI * variance, 0.0)));
}
