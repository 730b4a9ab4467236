#include "terrain/rock_shape.h"

#include "base/memory.h"
#include "math/noise.h"
#include "math/philox.h"
#include "terrain/rock_shadow.h"

/* Heights over widths are 0.54 on average, with a scatter (Demidov and Basilevsky 2014). */
const pl_rock_family pl_rock_families[PL_ROCK_FAMILIES] = {
    [PL_ROCK_BLOCK] = {"block", "Angular, with flat faces.", 0.82, 0.62, 9, 0.52, 0.80, 6, 0.03,
                       0.04, 0.5, 15},
    [PL_ROCK_CUBE] = {"cube", "Six faces at about right angles.", 0.88, 0.70, 6, 0.58, 0.70, 6,
                      0.03, 0.035, 0.4, 12},
    [PL_ROCK_WEDGE] = {"wedge", "Few large faces at sharp angles.", 0.80, 0.58, 7, 0.35, 0.74, 6,
                       0.03, 0.04, 0.5, 12},
    [PL_ROCK_SLAB] = {"slab", "Flat, with a broken outline.", 0.80, 0.30, 10, 0.55, 0.85, 6, 0.03,
                      0.04, 0.4, 12},
    [PL_ROCK_TABLET] = {"tablet", "Flat and rounded.", 0.85, 0.38, 10, 0.65, 0.95, 3, 0.10, 0.05,
                        0.6, 0},
    [PL_ROCK_SHARD] = {"shard", "Long and sharp.", 0.50, 0.40, 10, 0.42, 0.85, 6, 0.03, 0.04, 0.5,
                       10},
    [PL_ROCK_SPLIT] = {"split", "Rounded, with a few fresh faces.", 0.82, 0.60, 4, 0.32, 0.80, 6,
                       0.08, 0.05, 0.6, 6},
    [PL_ROCK_COBBLE] = {"cobble", "Rounded by long exposure.", 0.85, 0.60, 10, 0.68, 0.95, 2, 0.12,
                        0.05, 0.7, 0},
    [PL_ROCK_BOULDER] = {"boulder", "Blocky, with worn edges.", 0.82, 0.62, 9, 0.52, 0.82, 4, 0.06,
                         0.06, 0.8, 12},
    [PL_ROCK_EGG] = {"egg", "Nearly an ellipsoid.", 0.80, 0.64, 5, 0.80, 1.00, 2, 0.10, 0.04, 0.5,
                     0},
    [PL_ROCK_BRECCIA] = {"breccia", "Knobbly, of fragments of many sizes.", 0.82, 0.58, 10, 0.65,
                         0.95, 3, 0.16, 0.07, 1.0, 0},
    [PL_ROCK_PITTED] = {"pitted", "Worn and rough.", 0.84, 0.60, 10, 0.65, 0.90, 3, 0.08, 0.09, 0.2,
                        0},
    [PL_ROCK_MODEL] = {"model", "One of the user's models.", 1.0, 1.0, 0, 1.0, 1.0, 2, 0.0, 0.0,
                       0.0, 0},
};

static pl_vec3 next_direction(pl_philox_stream *s) {
  const double z = 2.0 * pl_philox_next(s) - 1.0, a = 2.0 * PL_PI * pl_philox_next(s),
               r = sqrt(1.0 - z * z);
  return (pl_vec3){r * cos(a), r * sin(a), z};
}

/* About normal: the sum of three uniform numbers, with deviation 1. */
#define MOST_DEVIATIONS 3.0
/* Deviation of the widths of rocks of a family, over their mean. */
#define WIDTH_SCATTER 0.12
static double next_normal(pl_philox_stream *s) {
  return 2.0 * (pl_philox_next(s) + pl_philox_next(s) + pl_philox_next(s) - 1.5);
}

/* The planes of a cube are its faces, somewhat turned; others are random, away from the last ones,
 * so that they do not cut alike. */
static pl_vec3 next_plane(const pl_rock_variant *ball, int k, pl_philox_stream *s) {
  if (ball->family == &pl_rock_families[PL_ROCK_CUBE]) {
    const double side = k % 2 == 0 ? 1.0 : -1.0;
    const pl_vec3 face = {k / 2 == 0 ? side : 0.0, k / 2 == 1 ? side : 0.0,
                          k / 2 == 2 ? side : 0.0};
    return pl_vec3_unit(pl_vec3_madd(face, 0.25, next_direction(s)));
  }
  pl_vec3 best = {0.0, 0.0, 1.0};
  double most = INFINITY;
  for (int trial = 0; trial < 4; trial++) {
    const pl_vec3 d = next_direction(s);
    double nearest = -1.0;
    for (int m = 0; m < k; m++)
      nearest = fmax(nearest, pl_vec3_dot(d, pl_vec3_unit(ball->normals[m])));
    if (nearest < most) {
      most = nearest;
      best = d;
    }
  }
  return best;
}

/* Radius of the ball with its cuts: the norm of all bounds 1/r, of which a high power is nearly the
 * greatest. Powers of two are squared up and rooted down, the same on all machines. */
static double cut_radius(const pl_rock_variant *ball, pl_vec3 d) {
  double sum = 1.0;
  for (int k = 0; k < ball->planes; k++) {
    const double along = pl_vec3_dot(ball->normals[k], d);
    double x = along > 0.0 ? along : 0.0;
    for (int n = 0; n < ball->family->sharpness; n++)
      x *= x;
    sum += x;
  }
  for (int n = 0; n < ball->family->sharpness; n++)
    sum = sqrt(sum);
  return 1.0 / sum;
}

/* Noise, more or less folded: knobs with grooves between them, where it is 0. Within -1 and 1. */
static double relief_at(const pl_rock_family *of, pl_vec3 point, uint32_t seed) {
  const double n = (double)pl_noise(point, seed);
  return (1.0 - of->knobs) * n + of->knobs * fmin(1.5 * fabs(n) - 0.25, 1.0);
}

double pl_rock_variant_radius(const pl_rock_variant *variant, pl_vec3 d) {
  const pl_rock_family *of = variant->family;
  if (variant->scan != NULL)
    return pl_rock_scan_radius(variant->scan, d);
  double factor = 1.0 + of->lumps * (double)pl_noise(pl_vec3_scale(d, 1.2), variant->seed);
  double amplitude = of->roughness, frequency = 3.0;
  for (int k = 1; k < PL_ROCK_OCTAVES + 1; k++) {
    factor += amplitude * relief_at(of, pl_vec3_scale(d, frequency), variant->seed + (uint32_t)k);
    amplitude *= 0.5;
    frequency *= 2.1;
  }
  return cut_radius(variant, d) * factor;
}

static pl_vec3 stretched(pl_vec3 p, pl_vec3 axes) {
  return (pl_vec3){axes.x * p.x, axes.y * p.y, axes.z * p.z};
}

/* How far the surface reaches along a vector: from the best probe on, which the surface around it
 * may exceed, uphill in ever smaller steps. */
static double reach(const pl_rock_variant *ball, pl_vec3 along) {
  static const double steps[] = {0.12, 0.08, 0.05, 0.03, 0.015};
  pl_vec3 best = ball->probes[0];
  for (int k = 1; k < PL_ROCK_PROBES; k++)
    if (pl_vec3_dot(ball->probes[k], along) > pl_vec3_dot(best, along))
      best = ball->probes[k];
  for (size_t n = 0; n < sizeof steps / sizeof *steps; n++) {
    const pl_vec3 from = pl_vec3_unit(best);
    const pl_vec3 other = fabs(from.z) < 0.7 ? (pl_vec3){0, 0, 1} : (pl_vec3){1, 0, 0};
    const pl_vec3 a = pl_vec3_unit(pl_vec3_cross(other, from)), b = pl_vec3_cross(from, a);
    for (int k = 0; k < 4; k++) {
      const pl_vec3 d =
          pl_vec3_unit(pl_vec3_madd(from, k & 1 ? -steps[n] : steps[n], k & 2 ? b : a));
      const pl_vec3 p = pl_vec3_scale(d, pl_rock_variant_radius(ball, d));
      if (pl_vec3_dot(p, along) > pl_vec3_dot(best, along))
        best = p;
    }
  }
  return pl_vec3_dot(best, along);
}

/* Fills in what follows from the surface. */
static void probe(const pl_rock_sphere *sphere, pl_rock_variant *out) {
  for (int n = 0; n < PL_ROCK_PROBES; n++)
    out->probes[n] =
        pl_vec3_scale(sphere->vertices[n], pl_rock_variant_radius(out, sphere->vertices[n]));
  double widths = 1.0;
  for (int axis = 0; axis < 2; axis++) {
    const pl_vec3 along = {axis == 0, axis == 1, 0.0};
    widths *= reach(out, along) + reach(out, pl_vec3_scale(along, -1.0));
  }
  out->plan = sqrt(widths);
}

/* Chips part corners and edges from what the planes so far have left: each is cut off at a part of
 * how far the surface reaches along it. */
static void draw_chips(const pl_rock_sphere *sphere, pl_philox_stream *s, pl_rock_variant *out) {
  static const double LEAST = 0.84, MOST = 0.96;
  double radii[PL_ROCK_PROBES];
  for (int n = 0; n < PL_ROCK_PROBES; n++)
    radii[n] = cut_radius(out, sphere->vertices[n]);
  for (int k = 0; k < out->family->chips; k++) {
    const pl_vec3 normal = next_direction(s);
    double far = 0.0;
    for (int n = 0; n < PL_ROCK_PROBES; n++)
      far = fmax(far, radii[n] * pl_vec3_dot(sphere->vertices[n], normal));
    const double distance = far * (LEAST + (MOST - LEAST) * pl_philox_next(s));
    out->normals[out->planes++] = pl_vec3_scale(normal, 1.0 / distance);
  }
}

static void draw_variant(pl_rock_family_kind family, int k, const pl_rock_sphere *sphere,
                         pl_rock_variant *out) {
  const pl_rock_family *of = &pl_rock_families[family];
  const uint32_t number = (uint32_t)family * PL_ROCK_VARIANTS + (uint32_t)k;
  pl_philox_stream s = {.key = {UINT64_C(0x76617269616e74), number}};
  *out = (pl_rock_variant){.family = of,
                           .number = number,
                           .siblings = PL_ROCK_VARIANTS,
                           .planes = of->planes,
                           .seed = 16 * number};
  for (int n = 0; n < of->planes; n++) {
    const pl_vec3 normal = next_plane(out, n, &s);
    const double distance = of->nearest + (of->furthest - of->nearest) * pl_philox_next(&s);
    out->normals[n] = pl_vec3_scale(normal, 1.0 / distance);
  }
  draw_chips(sphere, &s, out);
  probe(sphere, out);
}

static pl_status take_scan(const pl_rock_scan *const *scans, size_t k, size_t count,
                           const pl_rock_sphere *sphere, pl_rock_variant *out) {
  *out = (pl_rock_variant){.family = &pl_rock_families[PL_ROCK_MODEL],
                           .scan = scans[k],
                           .number = PL_ROCK_MODEL * PL_ROCK_VARIANTS + (uint32_t)k,
                           .siblings = (uint32_t)count};
  probe(sphere, out);
  const double longest = 1.0 / (out->plan * sqrt(1.0 - MOST_DEVIATIONS * WIDTH_SCATTER));
  return longest <= PL_ROCK_SHAPE_REACH
             ? PL_OK
             : pl_fail(PL_E_RANGE,
                       "rocks.models[%zu] is too long for its width: seen from above, the "
                       "geometric mean of "
                       "both is %.2g of its greatest radius; at least %.2g",
                       k, out->plan, out->plan * longest / PL_ROCK_SHAPE_REACH);
}

pl_status pl_rock_variants_create(const pl_rock_sphere *spheres, const pl_rock_scan *const *scans,
                                  size_t scan_count, pl_rock_variant **out) {
  enum { PROBED = 2 }; /* the level of PL_ROCK_PROBES vertices */
  void *memory;
  *out = NULL;
  PL_TRY(pl_alloc_or_fail(PL_ROCK_FAMILIES * PL_ROCK_VARIANTS, sizeof(pl_rock_variant),
                          "shapes of rocks", &memory));
  *out = memory;
  for (int family = 0; family < PL_ROCK_MODEL; family++)
    for (int k = 0; k < PL_ROCK_VARIANTS; k++)
      draw_variant((pl_rock_family_kind)family, k, &spheres[PROBED],
                   &(*out)[family * PL_ROCK_VARIANTS + k]);
  pl_status status = PL_OK;
  for (size_t k = 0; status == PL_OK && k < scan_count; k++)
    status = take_scan(scans, k, scan_count, &spheres[PROBED],
                       &(*out)[PL_ROCK_MODEL * PL_ROCK_VARIANTS + k]);
  for (size_t k = 0; status == PL_OK && k < PL_ROCK_MODEL * PL_ROCK_VARIANTS + scan_count; k++)
    status = pl_rock_variant_set_scales(spheres, &(*out)[k]);
  if (status != PL_OK) {
    pl_free(*out);
    *out = NULL;
  }
  return status;
}

void pl_rock_shape_draw(const pl_rock_variant *variants, pl_rock_family_kind family,
                        const uint64_t words[3], pl_rock_shape *out) {
  pl_philox_stream s = {.key = {words[0], words[1]}};
  const pl_rock_family *of = &pl_rock_families[family];
  const double width = fmax(of->width * (1.0 + WIDTH_SCATTER * next_normal(&s)), 0.3);
  const double height = fmax(of->height * (1.0 + 0.18 * next_normal(&s)), 0.15);
  const pl_rock_variant *all = &variants[(size_t)family * PL_ROCK_VARIANTS];
  const pl_rock_variant *ball = &all[words[2] % all[0].siblings];
  *out = (pl_rock_shape){.variant = ball, .axes = {1.0, width, height}};
  out->axes = pl_vec3_scale(out->axes, 1.0 / (ball->plan * sqrt(width)));
  /* No point is beyond the ball displaced by all noise. */
  const double most = fmax(out->axes.x, fmax(out->axes.y, out->axes.z));
  out->radius = most * (1.0 + of->lumps + 2.0 * of->roughness);
}

void pl_rock_shape_extent(const pl_rock_shape *shape, pl_vec3 axis, double *low, double *high) {
  const pl_vec3 along = stretched(axis, shape->axes);
  *high = reach(shape->variant, along);
  *low = -reach(shape->variant, pl_vec3_scale(along, -1.0));
}

double pl_rock_shape_depth(const pl_rock_shape *shape, pl_vec3 point) {
  const pl_vec3 ball = {point.x / shape->axes.x, point.y / shape->axes.y, point.z / shape->axes.z};
  const double r = pl_vec3_norm(ball);
  return r > 0.0 ? r / pl_rock_variant_radius(shape->variant, pl_vec3_scale(ball, 1.0 / r)) : 0.0;
}
