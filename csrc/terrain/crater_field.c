#include "terrain/crater_field.h"

#include "base/memory.h"
#include "terrain/crater_cells.h"
#include "terrain/crater_rays.h"

#define ELLIPTICITY_MOST 0.6
#define IRREGULARITY_MOST 3.0
#define TERRACES_MOST 1.0
#define RAYS_BRIGHTEST 4.0
#define RAYS_OLDEST_GA 4.5
#define RAYS_SHORTEST 3.0
#define RAYS_LONGEST 20.0
#define GEOMETRIC_SATURATION 1.54
#define KEY_CRATERS UINT64_C(0x6372617465727321)

pl_crater_frame pl_crater_frame_default(double radius_m) {
  return (pl_crater_frame){
      .radius_m = radius_m,
      .law = {.kind = PL_CRATERS_NEUKUM_EQUILIBRIUM, .surface_age_ga = 3.5, .factor = 1.0},
      .min_m = fmax(0.1, PL_SCATTER_MIN_OF_RADIUS * radius_m),
      .max_m = fmin(300e3, PL_SCATTER_MAX_OF_RADIUS * radius_m),
      .diffusivity_m2_per_myr = 5.5,
      .diffusivity_exponent = 0.9,
      .irregularity = 1.0,
      .terraces = 1.0,
      .model_posts = 6.0,
      .rays = {.brightness = 0.0, .fade_ga = 1.0, .reach = 8.0}};
}

static pl_status check_frame(const pl_crater_frame *frame) {
  PL_TRY(pl_scatter_check("craters", frame->radius_m, frame->min_m, frame->max_m));
  if (!(frame->diffusivity_m2_per_myr >= 0.0 && isfinite(frame->diffusivity_m2_per_myr) &&
        fabs(frame->diffusivity_exponent) <= 3.0))
    return pl_fail(PL_E_RANGE,
                   "diffusivity of %g m^2/Myr (D/1 km)^%g; must be 0 or more, its exponent from -3 "
                   "to 3",
                   frame->diffusivity_m2_per_myr, frame->diffusivity_exponent);
  if (!(frame->ellipticity >= 0.0 && frame->ellipticity <= ELLIPTICITY_MOST))
    return pl_fail(PL_E_RANGE, "ellipticity %g of craters; must be from 0 to %g",
                   frame->ellipticity, ELLIPTICITY_MOST);
  if (!(frame->irregularity >= 0.0 && frame->irregularity <= IRREGULARITY_MOST))
    return pl_fail(PL_E_RANGE, "irregularity %g of craters; must be from 0 to %g",
                   frame->irregularity, IRREGULARITY_MOST);
  if (!(frame->terraces >= 0.0 && frame->terraces <= TERRACES_MOST))
    return pl_fail(PL_E_RANGE, "terraces %g of craters; must be from 0 to %g", frame->terraces,
                   TERRACES_MOST);
  if (!(frame->model_posts > 0.0 && isfinite(frame->model_posts)))
    return pl_fail(PL_E_RANGE, "model_posts = %g of craters; must be above 0", frame->model_posts);
  const pl_crater_rays *rays = &frame->rays;
  if (rays->brightness != 0.0 && !(rays->brightness >= 0.0 && rays->brightness <= RAYS_BRIGHTEST &&
                                   rays->fade_ga > 0.0 && rays->fade_ga <= RAYS_OLDEST_GA &&
                                   rays->reach >= RAYS_SHORTEST && rays->reach <= RAYS_LONGEST))
    return pl_fail(PL_E_RANGE,
                   "rays of craters with brightness %g, fade_ga %g and reach %g; must be from 0 to "
                   "%g, above 0 and at most %g, and from %g to %g",
                   rays->brightness, rays->fade_ga, rays->reach, RAYS_BRIGHTEST, RAYS_OLDEST_GA,
                   RAYS_SHORTEST, RAYS_LONGEST);
  return pl_crater_law_check(&frame->law, frame->min_m, frame->max_m);
}

static pl_status check_density(const pl_crater_law *law, double diameter_m) {
  const double n = pl_crater_density(law, diameter_m), cover = n * diameter_m * diameter_m;
  if (cover <= PL_CRATER_DENSEST)
    return PL_OK;
  return pl_fail(
      PL_E_RANGE,
      "law '%s' has %.3g craters of %g m or more per km^2, %.3g times what a surface can "
      "hold (1.54 D^-2); use 'neukum_equilibrium', or a greater least diameter, or a "
      "lower density",
      pl_crater_laws[law->kind].name, 1e6 * n, diameter_m, cover / GEOMETRIC_SATURATION);
}

/* Checks the density at the least diameter of each octave. */
static pl_status check_densities(const pl_crater_frame *frame) {
  double low_m, high_m;
  for (int level = 0; level < PL_SCATTER_LEVELS; level++)
    if (pl_scatter_sizes(level, frame->radius_m, frame->min_m, frame->max_m, &low_m, &high_m))
      PL_TRY(check_density(&frame->law, low_m));
  return PL_OK;
}

static void make_faces(pl_crater_field *field) {
  for (int face = 0; face < PL_CUBE_FACES; face++) {
    pl_vec3 *axes = field->faces[face];
    axes[0] = pl_cube_tangent_direction(face, 0.0, 0.0);
    axes[1] = pl_vec3_madd(pl_vec3_scale(pl_cube_tangent_direction(face, 1.0, 0.0), sqrt(2.0)),
                           -1.0, axes[0]);
    axes[2] = pl_vec3_madd(pl_vec3_scale(pl_cube_tangent_direction(face, 0.0, 1.0), sqrt(2.0)),
                           -1.0, axes[0]);
  }
}

static pl_status fill(pl_crater_field *field, const pl_crater_frame *frame) {
  field->frame = *frame;
  if (frame->law.kind == PL_CRATERS_TABLE)
    PL_TRY(pl_size_points_copy(&field->frame.law.table, &field->table));
  PL_TRY(pl_crater_shapes_create(&field->shapes));
  make_faces(field);
  field->stretch = pl_crater_stretch(frame);
  PL_TRY(check_densities(frame));
  PL_TRY(pl_scatter_init(frame->radius_m, frame->seed, KEY_CRATERS, pl_crater_density,
                         &field->frame.law, frame->min_m, frame->max_m, &field->scatter));
  return pl_crater_brightness_create(field, &field->brightness);
}

pl_status pl_crater_field_create(const pl_crater_frame *frame, pl_crater_field **out) {
  *out = NULL;
  PL_TRY(check_frame(frame));
  pl_crater_field *field;
  PL_TRY(pl_alloc_or_fail(1, sizeof *field, "a field of craters", (void **)&field));
  const pl_status status = fill(field, frame);
  if (status != PL_OK) {
    pl_crater_field_destroy(field);
    return status;
  }
  *out = field;
  return PL_OK;
}

void pl_crater_field_destroy(pl_crater_field *field) {
  if (field == NULL)
    return;
  pl_free(field->table);
  pl_crater_brightness_destroy(field->brightness);
  pl_scatter_clear(&field->scatter);
  pl_crater_shapes_destroy(field->shapes);
  pl_free(field);
}

const pl_crater_frame *pl_crater_field_frame(const pl_crater_field *field) { return &field->frame; }

void pl_crater_bounds(const pl_crater_field *field, double largest_m, double *low_m,
                      double *high_m) {
  *low_m = *high_m = 0.0;
  for (int level = field->scatter.first; level <= field->scatter.last; level++) {
    const pl_scatter_octave *octave = &field->scatter.octaves[level];
    const double d = fmin(octave->high_m, largest_m);
    if (octave->low_m >= largest_m)
      continue;
    const pl_crater_dimensions fresh = pl_crater_fresh(d);
    /* Two craters of an octave, one on the other's rim, and its rim's harmonics. */
    *low_m -= 1.5 * (fresh.depth_m - fresh.rim_m);
    *high_m += 2.0 * fresh.rim_m;
  }
}
