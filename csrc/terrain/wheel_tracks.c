#include "terrain/wheel_tracks.h"

#include <math.h>
#include <string.h>

#include "base/memory.h"

/* Across a wheel, over half its width: the rut is flat to FLAT and ends at END, the heap of soil
 * lies about HEAP and is as wide to both sides as HEAP_WIDTH, BERM ruts high (by eye). */
#define FLAT 0.8
#define END 1.1
#define HEAP 1.25
#define HEAP_WIDTH 0.3
#define BERM 0.3
/* Nothing is farther from the middle of a wheel. */
#define REACH (HEAP + HEAP_WIDTH)
/* Pieces of a path that share a sphere. */
enum { CHUNK = 16 };

/* A point of a path. */
typedef struct knot {
  pl_vec3 place, along; /* unit tangent */
  double s_m;           /* along the path */
} knot;

typedef struct chunk {
  pl_vec3 center;
  double radius_m;          /* encloses the ruts */
  size_t track, first, end; /* its pieces */
} chunk;

typedef struct path {
  pl_wheel_shape shape;
  const knot *knots;
  double length_m, radius_m; /* distance from the body's centre */
} path;

struct pl_wheel_tracks {
  path *paths;
  chunk *chunks;
  knot *knots;
  size_t count, chunk_count;
};

static pl_status check(const pl_wheel_track *track, size_t n) {
  const pl_wheel_shape *s = &track->shape;
  if (track->count < 2)
    return pl_fail(PL_E_RANGE, "track %zu has %zu points; must have 2 or more", n, track->count);
  for (size_t k = 0; k < track->count; k++)
    if (!pl_vec3_finite(track->points[k]) || !(pl_vec3_norm(track->points[k]) > 0.0) ||
        (k > 0 && !(pl_vec3_norm(pl_vec3_sub(track->points[k], track->points[k - 1])) > 0.0)))
      return pl_fail(PL_E_RANGE, "point %zu of track %zu is 0, not finite, or that before it", k,
                     n);
  if (!(s->width_m > 0.0 && s->gauge_m > s->width_m && isfinite(s->gauge_m)))
    return pl_fail(PL_E_RANGE, "track %zu: a gauge of %g m; must be above the width, %g, above 0",
                   n, s->gauge_m, s->width_m);
  if (!(s->depth_m >= 0.0 && s->depth_m <= s->width_m && s->imprint_m >= 0.0 &&
        s->imprint_m <= s->width_m && s->spacing_m >= 0.0 && isfinite(s->spacing_m)))
    return pl_fail(PL_E_RANGE,
                   "track %zu: depths of %g and %g m and a spacing of %g m; must be 0 or more, "
                   "depths at most the width",
                   n, s->depth_m, s->imprint_m, s->spacing_m);
  if (!(fabs(s->chevron_rad) < 1.4 && s->albedo >= 0.0 && s->albedo <= 4.0))
    return pl_fail(PL_E_RANGE,
                   "track %zu: bars at %g rad and an albedo of %g; must be below 1.4, "
                   "and from 0 to 4",
                   n, s->chevron_rad, s->albedo);
  return PL_OK;
}

static void fill_knots(const pl_wheel_track *track, knot *knots) {
  for (size_t k = 0; k < track->count; k++) {
    const pl_vec3 before = track->points[k > 0 ? k - 1 : 0];
    const pl_vec3 after = track->points[k + 1 < track->count ? k + 1 : k];
    const pl_vec3 here = track->points[k];
    /* The normal plane halves the angle of a bend. */
    const pl_vec3 from = pl_vec3_sub(here, before), to = pl_vec3_sub(after, here);
    pl_vec3 along = k == 0                  ? to
                    : k + 1 == track->count ? from
                                            : pl_vec3_add(pl_vec3_unit(from), pl_vec3_unit(to));
    if (!(pl_vec3_norm(along) > 1e-9)) /* it turns back */
      along = to;
    knots[k] =
        (knot){here, pl_vec3_unit(along), k > 0 ? knots[k - 1].s_m + pl_vec3_norm(from) : 0.0};
  }
}

static double half_width_m(const pl_wheel_shape *shape) {
  return 0.5 * (shape->gauge_m + REACH * shape->width_m);
}

static chunk chunk_of(const path *of, size_t track, size_t first, size_t end) {
  chunk out = {.track = track, .first = first, .end = end};
  for (size_t k = first; k <= end; k++)
    out.center = pl_vec3_madd(out.center, 1.0 / (double)(end - first + 1), of->knots[k].place);
  for (size_t k = first; k <= end; k++)
    out.radius_m = fmax(out.radius_m, pl_vec3_norm(pl_vec3_sub(of->knots[k].place, out.center)));
  out.radius_m += 1.5 * half_width_m(&of->shape); /* normal planes may slant in bends */
  return out;
}

static void fill(const pl_wheel_track *tracks, pl_wheel_tracks *out) {
  size_t knots = 0;
  for (size_t n = 0; n < out->count; n++) {
    path *to = &out->paths[n];
    fill_knots(&tracks[n], out->knots + knots);
    *to = (path){.shape = tracks[n].shape, .knots = out->knots + knots};
    knots += tracks[n].count;
    to->length_m = out->knots[knots - 1].s_m;
    to->radius_m = pl_vec3_norm(to->knots[0].place);
    for (size_t k = 0; k + 1 < tracks[n].count; k += CHUNK) {
      const size_t end = k + CHUNK < tracks[n].count - 1 ? k + CHUNK : tracks[n].count - 1;
      out->chunks[out->chunk_count++] = chunk_of(to, n, k, end);
    }
  }
}

pl_status pl_wheel_tracks_create(const pl_wheel_track *tracks, size_t count,
                                 pl_wheel_tracks **out) {
  size_t knots = 0, chunks = 0;
  void *memory;
  *out = NULL;
  for (size_t n = 0; n < count; n++) {
    PL_TRY(check(&tracks[n], n));
    knots += tracks[n].count;
    chunks += (tracks[n].count - 2) / CHUNK + 1;
  }
  PL_TRY(pl_alloc_or_fail(1,
                          sizeof(pl_wheel_tracks) + count * sizeof(path) + chunks * sizeof(chunk) +
                              knots * sizeof(knot),
                          "tracks", &memory));
  pl_wheel_tracks *made = memory;
  made->count = count;
  made->paths = (path *)(void *)(made + 1);
  made->chunks = (chunk *)(void *)(made->paths + count);
  made->knots = (knot *)(void *)(made->chunks + chunks);
  fill(tracks, made);
  *out = made;
  return PL_OK;
}

void pl_wheel_tracks_destroy(pl_wheel_tracks *tracks) { pl_free(tracks); }

/* A place on a track: along the path, and how far from its middle to the side, m. */
typedef struct spot {
  double s_m, side_m;
} spot;

/* Finds the place on a piece; false if the point lies beyond its ends. */
static bool locate(const path *of, size_t piece, pl_vec3 point, pl_vec3 up, spot *out) {
  const knot *a = &of->knots[piece], *b = a + 1;
  const double from = pl_vec3_dot(pl_vec3_sub(point, a->place), a->along);
  const double to = pl_vec3_dot(pl_vec3_sub(point, b->place), b->along);
  if (!(from >= 0.0 && to < 0.0))
    return false;
  const double t = from / (from - to);
  const pl_vec3 along = pl_vec3_madd(pl_vec3_scale(a->along, 1.0 - t), t, b->along);
  const pl_vec3 middle = pl_vec3_madd(pl_vec3_scale(a->place, 1.0 - t), t, b->place);
  out->s_m = a->s_m + t * (b->s_m - a->s_m);
  out->side_m = pl_vec3_dot(pl_vec3_sub(point, middle), pl_vec3_unit(pl_vec3_cross(along, up)));
  return true;
}

static double smooth(double t) {
  t = fmin(fmax(t, 0.0), 1.0);
  return t * t * (3.0 - 2.0 * t);
}

/* Depth of ruts and height of heaps at a place. */
typedef struct relief {
  double rut_m, heap_m, in; /* in: 1 on the floor of a rut, where there is no heap */
} relief;

static void add_relief(const path *of, const spot *at, double cell_m, relief *out) {
  const pl_wheel_shape *s = &of->shape;
  const double half = 0.5 * s->width_m;
  const double shown = cell_m > 0.0 ? smooth(s->width_m / cell_m - 1.0) : 1.0;
  const double ends = smooth(fmin(at->s_m, of->length_m - at->s_m) / half);
  const double off_m = fabs(at->side_m) - 0.5 * s->gauge_m, x = fabs(off_m) / half;
  if (x >= REACH || !(shown * ends > 0.0))
    return;
  const double in = 1.0 - smooth((x - FLAT) / (END - FLAT));
  double imprint = 0.5;
  if (s->spacing_m > 0.0 && s->imprint_m > 0.0) {
    const double fine = cell_m > 0.0 ? smooth(0.5 * s->spacing_m / cell_m - 1.0) : 1.0;
    const double turn = (at->s_m + fabs(off_m) * tan(s->chevron_rad)) / s->spacing_m;
    imprint += 0.5 * fine * cos(2.0 * PL_PI * turn);
  }
  const double deep = s->depth_m + (s->spacing_m > 0.0 ? imprint * s->imprint_m : 0.0);
  const double t = (x - HEAP) / HEAP_WIDTH, u = fmax(1.0 - t * t, 0.0);
  out->rut_m = fmax(out->rut_m, shown * ends * in * deep);
  out->heap_m = fmax(out->heap_m, shown * ends * BERM * s->depth_m * u * u);
  out->in = fmax(out->in, ends * in);
}

static double height_at(const pl_wheel_tracks *tracks, const chunk *const *near, size_t count,
                        pl_vec3 direction, double cell_m) {
  relief sum = {0.0, 0.0, 0.0};
  for (size_t c = 0; c < count; c++) {
    const path *of = &tracks->paths[near[c]->track];
    const pl_vec3 point = pl_vec3_scale(direction, of->radius_m);
    if (pl_vec3_norm(pl_vec3_sub(point, near[c]->center)) > near[c]->radius_m)
      continue;
    spot at;
    for (size_t k = near[c]->first; k < near[c]->end; k++)
      if (locate(of, k, point, direction, &at))
        add_relief(of, &at, cell_m, &sum);
  }
  return (1.0 - sum.in) * sum.heap_m - sum.rut_m;
}

/* Chunks about points at most: more are looked at one by one. */
enum { NEAR = 256 };

/* Finds the chunks about some points; returns NEAR + 1 if there are too many. */
static size_t find_near(const pl_wheel_tracks *tracks, const pl_vec3 *directions, size_t count,
                        const chunk *near[NEAR]) {
  pl_vec3 middle = {0.0, 0.0, 0.0};
  double spread = 0.0;
  size_t found = 0;
  for (size_t k = 0; k < count; k++)
    middle = pl_vec3_madd(middle, 1.0 / (double)count, directions[k]);
  for (size_t k = 0; k < count; k++)
    spread = fmax(spread, pl_vec3_norm(pl_vec3_sub(directions[k], middle)));
  for (size_t c = 0; c < tracks->chunk_count; c++) {
    const chunk *at = &tracks->chunks[c];
    const double radius_m = tracks->paths[at->track].radius_m;
    const double away = pl_vec3_norm(pl_vec3_sub(pl_vec3_scale(middle, radius_m), at->center));
    if (away > at->radius_m + (spread + 1e-12) * radius_m)
      continue;
    if (found == NEAR)
      return NEAR + 1;
    near[found++] = at;
  }
  return found;
}

void pl_wheel_tracks_add_heights(const pl_wheel_tracks *tracks, const pl_vec3 *directions,
                                 size_t count, double cell_m, double *heights_m) {
  const chunk *near[NEAR];
  if (count == 0)
    return;
  const size_t found = find_near(tracks, directions, count, near);
  if (found > NEAR && count > 1) {
    const size_t half = count / 2;
    pl_wheel_tracks_add_heights(tracks, directions, half, cell_m, heights_m);
    pl_wheel_tracks_add_heights(tracks, directions + half, count - half, cell_m, heights_m + half);
    return;
  }
  const size_t used = found < NEAR ? found : NEAR;
  for (size_t k = 0; k < count && used > 0; k++)
    heights_m[k] += height_at(tracks, near, used, directions[k], cell_m);
}

/* Length that [-half, half] and [at - reach, at + reach] share. */
static double shared(double half, double at, double reach) {
  return fmax(fmin(half, at + reach) - fmax(-half, at - reach), 0.0);
}

typedef double (*spot_fn)(const path *of, const spot *at, double width_m);

/* The least or greatest of `start` and the results of `value` at all places of a direction, up to
 * `more_m` beside the ruts. */
static double extreme(const pl_wheel_tracks *tracks, pl_vec3 direction, double more_m, bool least,
                      double start, spot_fn value) {
  double out = start;
  for (size_t c = 0; c < tracks->chunk_count; c++) {
    const chunk *near = &tracks->chunks[c];
    const path *of = &tracks->paths[near->track];
    const pl_vec3 point = pl_vec3_scale(direction, of->radius_m);
    if (pl_vec3_norm(pl_vec3_sub(point, near->center)) > near->radius_m + more_m)
      continue;
    spot at;
    for (size_t k = near->first; k < near->end; k++)
      if (locate(of, k, point, direction, &at)) {
        const double found = value(of, &at, more_m);
        out = least ? fmin(out, found) : fmax(out, found);
      }
  }
  return out;
}

/* Fraction of a footprint of half a width that lies in ruts. */
static double cover_at(const path *of, const spot *at, double reach_m) {
  const double half = 0.5 * of->shape.width_m, reach = fmax(reach_m, 0.1 * half);
  const double gauge = 0.5 * of->shape.gauge_m;
  const double cover =
      shared(half, at->side_m - gauge, reach) + shared(half, at->side_m + gauge, reach);
  const double ends = smooth(fmin(at->s_m, of->length_m - at->s_m) / half);
  return ends * fmin(0.5 * cover / reach, 1.0);
}

static double factor_at(const path *of, const spot *at, double reach_m) {
  return 1.0 + (of->shape.albedo - 1.0) * cover_at(of, at, reach_m);
}

double pl_wheel_tracks_albedo(const pl_wheel_tracks *tracks, pl_vec3 direction,
                              double footprint_m) {
  const double reach_m = 0.5 * footprint_m;
  const double darkest = extreme(tracks, direction, reach_m, true, 1.0, factor_at);
  return darkest < 1.0 ? darkest : extreme(tracks, direction, reach_m, false, 1.0, factor_at);
}

double pl_wheel_tracks_brightest(const pl_wheel_tracks *tracks) {
  double most = 1.0;
  for (size_t n = 0; n < tracks->count; n++)
    most = fmax(most, tracks->paths[n].shape.albedo);
  return most;
}

bool pl_wheel_tracks_touch(const pl_wheel_tracks *tracks, pl_vec3 direction, double radius_m) {
  return extreme(tracks, direction, radius_m, false, 0.0, cover_at) > 0.0;
}

void pl_wheel_tracks_bounds(const pl_wheel_tracks *tracks, double *low_m, double *high_m) {
  *low_m = *high_m = 0.0;
  for (size_t n = 0; n < tracks->count; n++) {
    const pl_wheel_shape *s = &tracks->paths[n].shape;
    *low_m = fmin(*low_m, -s->depth_m - s->imprint_m);
    *high_m = fmax(*high_m, BERM * s->depth_m);
  }
}
