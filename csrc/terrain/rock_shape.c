#include "terrain/rock_shape.h"

#include "math/noise.h"
#include "math/philox.h"

/* Heights over widths are 0.54 on average, with a scatter (Demidov and Basilevsky 2014). */
const pl_rock_family pl_rock_families[PL_ROCK_FAMILIES] = {
    [PL_ROCK_BLOCK] = {"block", "Angular, with flat faces.", 0.82, 0.62, 14, 0.55, 0.85, 5, 0.06,
                       0.030},
    [PL_ROCK_CUBE] = {"cube", "Six faces at about right angles.", 0.88, 0.70, 6, 0.58, 0.72, 5,
                      0.05, 0.025},
    [PL_ROCK_WEDGE] = {"wedge", "Few large faces at sharp angles.", 0.80, 0.58, 6, 0.35, 0.70, 5,
                       0.06, 0.030},
    [PL_ROCK_SLAB] = {"slab", "Flat, with a broken outline.", 0.80, 0.30, 12, 0.60, 0.85, 5, 0.06,
                      0.030},
    [PL_ROCK_TABLET] = {"tablet", "Flat and rounded.", 0.85, 0.38, 10, 0.65, 0.95, 3, 0.10, 0.035},
    [PL_ROCK_SHARD] = {"shard", "Long and sharp.", 0.50, 0.40, 12, 0.45, 0.85, 6, 0.06, 0.030},
    [PL_ROCK_SPLIT] = {"split", "Rounded, with a few fresh faces.", 0.82, 0.60, 4, 0.32, 0.80, 5,
                       0.10, 0.040},
    [PL_ROCK_COBBLE] = {"cobble", "Rounded by long exposure.", 0.85, 0.60, 10, 0.68, 0.95, 2, 0.12,
                        0.035},
    [PL_ROCK_BOULDER] = {"boulder", "Blocky, with worn edges.", 0.82, 0.62, 12, 0.60, 0.90, 3, 0.10,
                         0.040},
    [PL_ROCK_EGG] = {"egg", "Nearly an ellipsoid.", 0.80, 0.64, 5, 0.80, 1.00, 2, 0.10, 0.030},
    [PL_ROCK_BRECCIA] = {"breccia", "Knobbly, of fragments of many sizes.", 0.82, 0.58, 10, 0.65,
                         0.95, 3, 0.16, 0.060},
    [PL_ROCK_PITTED] = {"pitted", "Worn and rough.", 0.84, 0.60, 10, 0.65, 0.90, 3, 0.08, 0.080},
};

/* A stream of numbers in [0, 1): 24 bits of each of the blocks of a key. */
typedef struct stream {
  uint64_t key[2], words[4];
  uint64_t used;
} stream;

static double next(stream *s) {
  if (s->used % 4 == 0) {
    const uint64_t counter[4] = {s->used / 4, 0, 0, 0};
    pl_philox(s->key, counter, s->words);
  }
  return pl_philox_double(s->words[s->used++ % 4]);
}

static pl_vec3 next_direction(stream *s) {
  const double z = 2.0 * next(s) - 1.0, a = 2.0 * PL_PI * next(s), r = sqrt(1.0 - z * z);
  return (pl_vec3){r * cos(a), r * sin(a), z};
}

/* About normal: the sum of three uniform numbers, with deviation 1 and at most 3. */
static double next_normal(stream *s) { return 2.0 * (next(s) + next(s) + next(s) - 1.5); }

/* The planes of a cube are its faces, somewhat turned; others are random, away from the last ones,
 * so that they do not cut alike. */
static pl_vec3 next_plane(const pl_rock_shape *shape, pl_rock_family_kind family, int k,
                          stream *s) {
  if (family == PL_ROCK_CUBE) {
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
      nearest = fmax(nearest, pl_vec3_dot(d, pl_vec3_unit(shape->normals[m])));
    if (nearest < most) {
      most = nearest;
      best = d;
    }
  }
  return best;
}

void pl_rock_shape_extent(const pl_rock_shape *shape, pl_vec3 axis, double *low, double *high) {
  static const double golden = 2.399963229728653; /* angle of a spiral of even points */
  enum { POINTS = 64 };
  *low = *high = 0.0;
  for (int k = 0; k < POINTS; k++) {
    const double z = (2.0 * k + 1.0) / POINTS - 1.0, r = sqrt(1.0 - z * z);
    const pl_vec3 d = {r * cos(golden * k), r * sin(golden * k), z};
    const double along = pl_vec3_dot(pl_rock_shape_point(shape, d), axis);
    *low = fmin(*low, along);
    *high = fmax(*high, along);
  }
}

/* Makes the plan diameter 1. */
static void measure(pl_rock_shape *shape) {
  double low[2], high[2];
  pl_rock_shape_extent(shape, (pl_vec3){1.0, 0.0, 0.0}, &low[0], &high[0]);
  pl_rock_shape_extent(shape, (pl_vec3){0.0, 1.0, 0.0}, &low[1], &high[1]);
  shape->axes = pl_vec3_scale(shape->axes, 1.0 / sqrt((high[0] - low[0]) * (high[1] - low[1])));
  /* No point is beyond the ball displaced by all noise. */
  const double most = fmax(shape->axes.x, fmax(shape->axes.y, shape->axes.z));
  shape->radius = most * (1.0 + shape->family->lumps + 2.0 * shape->family->roughness);
}

void pl_rock_shape_draw(pl_rock_family_kind family, const uint64_t words[4], pl_rock_shape *out) {
  stream s = {.key = {words[0], words[1]}};
  const pl_rock_family *of = &pl_rock_families[family];
  const double width = of->width * (1.0 + 0.12 * next_normal(&s));
  const double height = of->height * (1.0 + 0.18 * next_normal(&s));
  *out = (pl_rock_shape){.family = of, .planes = of->planes, .seed = (uint32_t)words[2]};
  out->axes = (pl_vec3){1.0, fmax(width, 0.3), fmax(height, 0.15)};
  for (int k = 0; k < of->planes; k++) {
    const pl_vec3 normal = next_plane(out, family, k, &s);
    const double distance = of->nearest + (of->furthest - of->nearest) * next(&s);
    out->normals[k] = pl_vec3_scale(normal, 1.0 / distance);
  }
  measure(out);
}

/* Radius of the ball with its cuts: the norm of all bounds 1/r, of which a high power is nearly the
 * greatest. Powers of two are squared up and rooted down, the same on all machines. */
static double cut_radius(const pl_rock_shape *shape, pl_vec3 d) {
  double sum = 1.0;
  for (int k = 0; k < shape->planes; k++) {
    double x = fmax(pl_vec3_dot(shape->normals[k], d), 0.0);
    for (int n = 0; n < shape->family->sharpness; n++)
      x *= x;
    sum += x;
  }
  for (int n = 0; n < shape->family->sharpness; n++)
    sum = sqrt(sum);
  return 1.0 / sum;
}

static double radius_at(const pl_rock_shape *shape, pl_vec3 d) {
  const pl_rock_family *of = shape->family;
  double factor = 1.0 + of->lumps * (double)pl_noise(pl_vec3_scale(d, 1.2), shape->seed);
  double amplitude = of->roughness, frequency = 3.0;
  for (int k = 1; k < PL_ROCK_OCTAVES + 1; k++) {
    factor += amplitude * (double)pl_noise(pl_vec3_scale(d, frequency), shape->seed + (uint32_t)k);
    amplitude *= 0.5;
    frequency *= 2.1;
  }
  return cut_radius(shape, d) * factor;
}

pl_vec3 pl_rock_shape_point(const pl_rock_shape *shape, pl_vec3 direction) {
  const double r = radius_at(shape, direction);
  return (pl_vec3){shape->axes.x * r * direction.x, shape->axes.y * r * direction.y,
                   shape->axes.z * r * direction.z};
}

double pl_rock_shape_depth(const pl_rock_shape *shape, pl_vec3 point) {
  const pl_vec3 ball = {point.x / shape->axes.x, point.y / shape->axes.y, point.z / shape->axes.z};
  const double r = pl_vec3_norm(ball);
  return r > 0.0 ? r / radius_at(shape, pl_vec3_scale(ball, 1.0 / r)) : 0.0;
}
