/* Slopes of the craters that a mesh leaves out, as the law of their sizes and ages has them. */
#include <math.h>

#include "terrain/crater_cells.h"

enum { STEPS = 2, AGES = 8 }; /* sizes an octave; ages of each size */

/* Integral of the squared slope along one axis over the ground of a crater, m^2. */
static double slope_area(const float profile[PL_CRATER_KNOTS], double radius_m) {
  const double step = 1.0 / PL_CRATER_KNOTS_PER_RADIUS;
  double sum = 0.0;
  for (int k = 1; k + 2 < PL_CRATER_KNOTS; k++) {
    const double rise = ((double)profile[k + 1] - (double)profile[k]) / (step * radius_m);
    sum += rise * rise * (k - 0.5) * step;
  }
  return PL_PI * sum * step * radius_m * radius_m;
}

/* The same as a mean over the ages of craters of a size, which are uniform in the number of
 * impacts. */
static double mean_slope_area(const pl_crater_field *field, double diameter_m) {
  const pl_crater_frame *frame = &field->frame;
  const pl_crater_dimensions fresh = pl_crater_fresh(diameter_m);
  const double most = pl_crater_chronology(pl_crater_oldest_drawn_ga(frame, diameter_m));
  float profile[PL_CRATER_KNOTS];
  double sum = 0.0;
  for (int k = 0; k < AGES; k++) {
    const double age_ga = pl_crater_chronology_age_ga((k + 0.5) / AGES * most);
    const double tau = pl_crater_tau(diameter_m, age_ga, frame->diffusivity_m2_per_myr,
                                     frame->diffusivity_exponent);
    pl_crater_profile(field->shapes, &fresh, tau, profile);
    sum += slope_area(profile, 0.5 * diameter_m);
  }
  return sum / AGES;
}

/* Fraction of a crater's variance of slopes that a mesh leaves out, by its diameter in cells.
 * Heights fade in; of the slopes of wide craters, normals between posts keep what they keep of
 * waves as long (terrain/sub_cell.c), within a tenth. */
static double left_out(double cells) {
  const double t = fmin(
      fmax((cells - PL_CRATER_FADE_FROM) / (PL_CRATER_FADE_TO - PL_CRATER_FADE_FROM), 0.0), 1.0);
  const double faded = t * t * (3.0 - 2.0 * t), octave = cells / 3.5;
  return 1.0 - faded * faded * (1.0 - 1.0 / (1.0 + 0.4 * octave * octave));
}

void pl_crater_slope_variances(const pl_crater_field *field, const double *cells_m, size_t count,
                               double *variances) {
  const pl_crater_frame *frame = &field->frame;
  const double factor = exp2(1.0 / STEPS);
  for (size_t k = 0; k < count; k++)
    variances[k] = 0.0;
  for (double low = frame->min_m; low < frame->max_m; low *= factor) {
    const double high = fmin(low * factor, frame->max_m), middle = sqrt(low * high);
    const double density =
        pl_crater_density(&frame->law, low) - pl_crater_density(&frame->law, high);
    if (!(density > 0.0))
      continue;
    const double variance = density * mean_slope_area(field, middle);
    for (size_t k = 0; k < count; k++)
      variances[k] += variance * left_out(middle / cells_m[k]);
  }
}
