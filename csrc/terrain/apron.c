#include "terrain/apron.h"

#include <math.h>

#include "terrain/interpolation.h"
#include "terrain/raster_levels.h"

enum {
  PIECES = PL_APRON_PIECES,
  PLACES = PL_APRON_PLACES,
  FIRST_ROW = 0,
  LAST_ROW,
  FIRST_COLUMN,
  LAST_COLUMN
};
/* Times that differences are averaged with their neighbours: over about three pieces. */
enum { SMOOTHING = 8 };

void pl_apron_places(const pl_raster *raster, double u[PLACES], double v[PLACES]) {
  const double right = raster->columns - 1.0, down = raster->rows - 1.0;
  for (int k = 0; k < PIECES; k++) {
    const double t = k / (double)PIECES;
    u[k] = t * right; /* along the first row, down the last column, and back */
    v[k] = 0.0;
    u[PIECES + k] = right;
    v[PIECES + k] = t * down;
    u[2 * PIECES + k] = (1.0 - t) * right;
    v[2 * PIECES + k] = down;
    u[3 * PIECES + k] = 0.0;
    v[3 * PIECES + k] = (1.0 - t) * down;
  }
}

static void smooth(double around[PLACES]) {
  for (int pass = 0; pass < SMOOTHING; pass++) {
    const double first = around[0];
    double before = around[PLACES - 1];
    for (int k = 0; k < PLACES; k++) {
      const double here = around[k], after = k + 1 < PLACES ? around[k + 1] : first;
      around[k] = here + 0.25 * (before - 2.0 * here + after);
      before = here;
    }
  }
}

/* The edge's places, `step` apart around the raster, with straight ends. */
static void set_edge(const double around[PLACES], int start, int step, double edge[PIECES + 3]) {
  for (int k = 0; k <= PIECES; k++)
    edge[k + 1] = around[(start + step * k + PLACES) % PLACES];
  edge[0] = 2.0 * edge[1] - edge[2];
  edge[PIECES + 2] = 2.0 * edge[PIECES + 1] - edge[PIECES];
}

void pl_apron_init(const pl_raster *raster, const double differences_m[PLACES], double width_m,
                   double radius_m, pl_apron *out) {
  double around[PLACES], most_m = 0.0;
  for (int k = 0; k < PLACES; k++)
    around[k] = differences_m[k];
  smooth(around);
  *out = (pl_apron){.raster = raster, .radius_m = radius_m, .width_m = width_m};
  set_edge(around, 0, 1, out->edges_m[FIRST_ROW]);
  set_edge(around, PIECES, 1, out->edges_m[LAST_COLUMN]);
  set_edge(around, 3 * PIECES, -1, out->edges_m[LAST_ROW]);
  set_edge(around, PLACES, -1, out->edges_m[FIRST_COLUMN]);
  for (int k = 0; k < PLACES; k++)
    most_m = fmax(most_m, fabs(around[k]));
  out->most_m = 3.0 * most_m; /* edges along both axes, less the corners; it is cut there */
}

/* Catmull-Rom along an edge, straight beyond its ends. */
static double along(const double edge[PIECES + 3], double t) {
  const double place = t * PIECES;
  const int k = (int)fmin(fmax(floor(place), 0.0), PIECES - 1.0);
  const double s = place - k;
  if (place < 0.0)
    return edge[1] + (edge[2] - edge[1]) * place;
  if (place > PIECES)
    return edge[PIECES + 1] + (edge[PIECES + 1] - edge[PIECES]) * (place - PIECES);
  return pl_catmull_rom(edge + k, s);
}

/* Part of an edge's length; beyond its ends the place stays behind, and never gets farther than
 * `reach`, so that what is continued straight there remains bounded. */
static double part(double u, double length, double reach) {
  const double t = length > 0.0 ? u / length : 0.5;
  if (t < 0.0)
    return -reach * (1.0 - exp(t / reach));
  return t > 1.0 ? 1.0 + reach * (1.0 - exp((1.0 - t) / reach)) : t;
}

static double coons(const pl_apron *a, double s, double t) {
  const double *top = a->edges_m[FIRST_ROW], *bottom = a->edges_m[LAST_ROW];
  const double *left = a->edges_m[FIRST_COLUMN], *right = a->edges_m[LAST_COLUMN];
  const double rows = pl_linear(along(top, s), along(bottom, s), t);
  const double columns = pl_linear(along(left, t), along(right, t), s);
  const double corners = pl_linear(pl_linear(top[1], top[PIECES + 1], s),
                                   pl_linear(bottom[1], bottom[PIECES + 1], s), t);
  return rows + columns - corners;
}

/* 1 at 0, 0 from 1 on; first and second derivatives vanish at both. */
static double fade(double t) {
  return t < 1.0 ? 1.0 - t * t * t * (10.0 + t * (6.0 * t - 15.0)) : 0.0;
}

double pl_apron_lift_m(const pl_apron *a, pl_vec3 direction) {
  /* Places beyond an edge reach a tenth of it: slopes of edges go on for a few pieces only. */
  const double reach = 0.1;
  double u, v;
  if (pl_raster_far(a->raster, direction, a->width_m / a->radius_m))
    return 0.0;
  const double away_m = pl_raster_outside_m(a->raster, direction, a->radius_m);
  if (!(away_m < a->width_m))
    return 0.0;
  pl_raster_find(a->raster, direction, &u, &v);
  const double lift_m =
      coons(a, part(u, a->raster->columns - 1.0, reach), part(v, a->raster->rows - 1.0, reach));
  return fade(away_m / a->width_m) * fmin(fmax(lift_m, -a->most_m), a->most_m);
}
