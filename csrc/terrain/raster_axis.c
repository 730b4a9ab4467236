/* Places on a raster's lattice. */
#include "terrain/raster_axis.h"

#include <math.h>

/* Posts are counted up to this many: places of all levels of refinement then fit into 63 bits. */
#define MOST 1e9
/* Bits below the size of the body that places and the phase keep. A double has 53: a difference of
 * places is then exact, and the rounding of an origin does not reach the phase. */
enum { PLACE_BITS = 50, PHASE_BITS = 40 };

static double rounded(double x, double quantum) { return rint(x / quantum) * quantum; }

void pl_raster_axis_init(double origin, double step, double size, bool around,
                         pl_raster_axis *out) {
  const int bits = (int)ceil(log2(fmax(size / fabs(step), 1.0)));
  const double start = origin / step;
  *out = (pl_raster_axis){.step = step, .quantum = ldexp(1.0, bits - PLACE_BITS)};
  /* Posts are at whole or half steps from the origin: neither is near rounding up. */
  out->first = (int64_t)fmin(fmax(floor(start + 0.25), -MOST), MOST);
  out->phase = rounded(start - (double)out->first, ldexp(1.0, bits - PHASE_BITS));
  if (!around)
    return;
  out->turn = size / fabs(step);
  if (fabs(out->turn - rint(out->turn)) < 1e-9 * out->turn && out->turn < MOST) {
    out->turn = rint(out->turn);
    out->period = (int64_t)out->turn;
  }
}

double pl_raster_axis_column(const pl_raster_axis *axis, double place, double middle) {
  const double column =
      rounded(place / axis->step - axis->phase, axis->quantum) - (double)axis->first;
  return axis->turn > 0.0 ? column - axis->turn * rint((column - middle) / axis->turn) : column;
}

double pl_raster_axis_lattice(const pl_raster_axis *axis, double posts) {
  return (posts + axis->phase) * axis->step;
}

double pl_raster_axis_place(const pl_raster_axis *axis, double column) {
  const double posts = (double)axis->first + column, turn = (double)axis->period;
  return pl_raster_axis_lattice(axis, turn > 0.0 ? posts - turn * floor(posts / turn) : posts);
}
