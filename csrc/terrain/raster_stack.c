#include "terrain/raster_stack.h"

#include <string.h>

/* Directions from which the mean over a body is found, and the footprint of each: a fraction of the
 * whole sphere. */
enum { LOOKS = 4096 };

/* The k-th direction of a spiral over the sphere, of equal areas. */
static pl_vec3 look(int k) {
  const double z = 1.0 - (2.0 * k + 1.0) / LOOKS, across = sqrt(1.0 - z * z);
  const double lon = PL_PI * (3.0 - sqrt(5.0)) * k;
  return (pl_vec3){across * cos(lon), across * sin(lon), z};
}

static void find_mean(pl_raster_stack *stack) {
  const double width_rad = sqrt(4.0 * PL_PI / LOOKS);
  pl_raster_mix sum = {0.0, 0.0};
  for (int k = 0; k < LOOKS; k++) {
    const pl_raster_mix at = pl_raster_stack_at(stack, look(k), width_rad);
    sum.value += at.value;
    sum.below += at.below;
  }
  stack->mean = (pl_raster_mix){sum.value / LOOKS, sum.below / LOOKS};
}

pl_status pl_raster_stack_init(const pl_raster_sheet *sheets, size_t count, pl_raster_stack *out) {
  memset(out, 0, sizeof *out);
  if (count > PL_RASTER_STACK)
    return pl_fail(PL_E_RANGE, "%zu rasters; at most %d are supported", count, PL_RASTER_STACK);
  out->mean.below = 1.0;
  for (size_t n = 0; n < count; n++) {
    const double border = sheets[n].border_posts;
    double low, high;
    if (!(isfinite(border) && border >= 0.0))
      return pl_fail(PL_E_RANGE, "raster %zu: a border of %g posts", n, border);
    pl_raster_bounds(sheets[n].raster, PL_INTERPOLATION_BILINEAR, &low, &high);
    out->low = n == 0 ? low : fmin(out->low, low);
    out->high = n == 0 ? high : fmax(out->high, high);
    out->sheets[n] = sheets[n];
  }
  out->count = count;
  if (count > 0)
    find_mean(out);
  return PL_OK;
}

/* Interpolated between the two levels whose cells are about as wide as the footprint. */
static double filtered(const pl_raster *raster, double u, double v, double width_rad) {
  const double level = log2(width_rad / pl_raster_spacing_m(raster, 1.0));
  if (!(level > 0.0))
    return pl_raster_value(raster, 0, u, v, PL_INTERPOLATION_BILINEAR);
  const double whole = fmin(floor(level), pl_raster_levels(raster) - 1.0);
  const double fine = pl_raster_value(raster, (int)whole, u, v, PL_INTERPOLATION_BILINEAR);
  const double coarse = pl_raster_value(raster, (int)whole + 1, u, v, PL_INTERPOLATION_BILINEAR);
  return fine + fmin(level - whole, 1.0) * (coarse - fine);
}

pl_raster_mix pl_raster_stack_at(const pl_raster_stack *stack, pl_vec3 direction,
                                 double width_rad) {
  pl_raster_mix mix = {0.0, 1.0};
  for (size_t n = stack->count; n-- > 0 && mix.below > 0.0;) {
    const pl_raster_sheet *sheet = &stack->sheets[n];
    double u, v;
    const double weight =
        pl_raster_cover(sheet->raster, direction, width_rad, sheet->border_posts, &u, &v);
    if (!(weight > 0.0))
      continue;
    mix.value += mix.below * weight * filtered(sheet->raster, u, v, width_rad);
    mix.below *= 1.0 - weight;
  }
  return mix;
}

double pl_raster_stack_nearest(const pl_raster_stack *stack, pl_vec3 direction) {
  double value = 0.0;
  for (size_t n = stack->count; n-- > 0;)
    if (!pl_raster_far(stack->sheets[n].raster, direction, 0.0) &&
        pl_raster_nearest(stack->sheets[n].raster, direction, &value))
      return value;
  return 0.0;
}
