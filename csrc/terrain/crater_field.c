#include "terrain/crater_field.h"

#include <string.h>

#include "base/memory.h"
#include "terrain/crater_cells.h"

#define ELLIPTICITY_MOST 0.6
#define IRREGULARITY_MOST 3.0
#define GEOMETRIC_SATURATION 1.54
/* Diameters of an octave are from 1/16 to 1/8 of its lattice's cells. */
#define CELLS_OVER_LEAST 16.0

pl_crater_frame pl_crater_frame_default(double radius_m) {
  return (pl_crater_frame){
      .radius_m = radius_m,
      .law = {.kind = PL_CRATERS_NEUKUM_EQUILIBRIUM, .surface_age_ga = 3.5, .factor = 1.0},
      .min_m = fmax(0.1, PL_CRATER_MIN_OF_RADIUS * radius_m),
      .max_m = fmin(300e3, PL_CRATER_MAX_OF_RADIUS * radius_m),
      .diffusivity_m2_per_myr = 5.5,
      .diffusivity_exponent = 0.9,
      .irregularity = 1.0,
      .model_posts = 6.0};
}

static pl_status check_frame(const pl_crater_frame *frame) {
  const double r = frame->radius_m;
  if (!(r > 0.0 && isfinite(r)))
    return pl_fail(PL_E_RANGE, "craters on a body of radius %g m; must be above 0", r);
  if (!(frame->min_m >= PL_CRATER_MIN_OF_RADIUS * r && frame->max_m > frame->min_m &&
        frame->max_m <= PL_CRATER_MAX_OF_RADIUS * r))
    return pl_fail(
        PL_E_RANGE,
        "craters of %g to %g m; on a body of radius %g m they must be of %.3g to %.6g m, "
        "the least below the greatest",
        frame->min_m, frame->max_m, r, PL_CRATER_MIN_OF_RADIUS * r, PL_CRATER_MAX_OF_RADIUS * r);
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
  if (!(frame->model_posts > 0.0 && isfinite(frame->model_posts)))
    return pl_fail(PL_E_RANGE, "model_posts = %g of craters; must be above 0", frame->model_posts);
  return pl_crater_law_check(&frame->law, frame->min_m, frame->max_m);
}

static pl_status copy_law(pl_crater_field *field) {
  pl_crater_law *law = &field->frame.law;
  if (law->kind != PL_CRATERS_TABLE)
    return PL_OK;
  PL_TRY(pl_alloc_or_fail(2 * law->count, sizeof(double), "the table of craters",
                          (void **)&field->table));
  memcpy(field->table, law->diameters_m, law->count * sizeof(double));
  memcpy(field->table + law->count, law->densities, law->count * sizeof(double));
  law->diameters_m = field->table;
  law->densities = field->table + law->count;
  return PL_OK;
}

/* Cuts sizes into octaves by the widths of cells. Returns the mean number in a cell of the size of
 * those at the centres of faces. */
static double octave_of(pl_crater_field *field, int level) {
  const pl_crater_frame *frame = &field->frame;
  const double cell = pl_cube_cell_m(level, frame->radius_m);
  pl_crater_octave *octave = &field->octaves[level];
  octave->low_m = fmax(cell / CELLS_OVER_LEAST, frame->min_m);
  octave->high_m = fmin(2.0 * cell / CELLS_OVER_LEAST, frame->max_m);
  if (octave->low_m >= octave->high_m)
    return 0.0;
  return cell * cell *
         (pl_size_table_density(field->sizes, octave->low_m) -
          pl_size_table_density(field->sizes, octave->high_m));
}

static pl_status check_density(const pl_crater_field *field, double diameter_m) {
  const double n = pl_size_table_density(field->sizes, diameter_m),
               cover = n * diameter_m * diameter_m;
  if (cover <= PL_CRATER_DENSEST)
    return PL_OK;
  return pl_fail(
      PL_E_RANGE,
      "law '%s' has %.3g craters of %g m or more per km^2, %.3g times what a surface can "
      "hold (1.54 D^-2); use 'neukum_equilibrium', or a greater least diameter, or a "
      "lower density",
      pl_crater_laws[field->frame.law.kind].name, 1e6 * n, diameter_m,
      cover / GEOMETRIC_SATURATION);
}

/* Cumulative Poisson probabilities, up to rounding to 1. Terms are computed from their logarithms:
 * exp(-mean) alone may underflow. Returns their number. */
static size_t poisson_shares(double mean, double *shares) {
  double log_factorial = 0.0, sum = 0.0;
  size_t k = 0;
  for (; k < PL_CRATER_CELL_MOST; k++) {
    log_factorial += k > 0 ? log((double)k) : 0.0;
    const double term =
        mean > 0.0 ? exp((double)k * log(mean) - mean - log_factorial) : (k == 0 ? 1.0 : 0.0);
    shares[k] = sum += term;
    if ((double)k >= mean && term < 1e-18)
      break;
  }
  const size_t count = k < PL_CRATER_CELL_MOST ? k + 1 : k;
  shares[count - 1] = 1.0;
  return count;
}

static pl_status make_octaves(pl_crater_field *field) {
  field->first = PL_CRATER_LEVELS;
  field->last = -1;
  size_t used = 0;
  PL_TRY(pl_alloc_or_fail((size_t)PL_CRATER_LEVELS * PL_CRATER_CELL_MOST, sizeof(double),
                          "the numbers of craters", (void **)&field->shares));
  for (int level = 0; level < PL_CRATER_LEVELS; level++) {
    pl_crater_octave *octave = &field->octaves[level];
    const double mean = octave_of(field, level);
    if (octave->low_m >= octave->high_m)
      continue;
    PL_TRY(check_density(field, octave->low_m));
    octave->shares = field->shares + used;
    octave->count = poisson_shares(mean, field->shares + used);
    used += octave->count;
    field->first = field->first < level ? field->first : level;
    field->last = level;
  }
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
  PL_TRY(copy_law(field));
  PL_TRY(pl_size_table_create(pl_crater_density, &field->frame.law, frame->min_m, frame->max_m,
                              &field->sizes));
  PL_TRY(pl_crater_shapes_create(&field->shapes));
  make_faces(field);
  field->stretch = pl_crater_stretch(frame);
  return make_octaves(field);
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
  pl_size_table_destroy(field->sizes);
  pl_crater_shapes_destroy(field->shapes);
  pl_free(field->shares);
  pl_free(field);
}

const pl_crater_frame *pl_crater_field_frame(const pl_crater_field *field) { return &field->frame; }

void pl_crater_bounds(const pl_crater_field *field, double largest_m, double *low_m,
                      double *high_m) {
  *low_m = *high_m = 0.0;
  for (int level = field->first; level <= field->last; level++) {
    const double d = fmin(field->octaves[level].high_m, largest_m);
    if (field->octaves[level].low_m >= largest_m)
      continue;
    const pl_crater_dimensions fresh = pl_crater_fresh(d);
    /* Two craters of an octave, one on the other's rim, and its rim's harmonics. */
    *low_m -= 1.5 * (fresh.depth_m - fresh.rim_m);
    *high_m += 2.0 * fresh.rim_m;
  }
}
