#include "terrain/ground_texture.h"

#include <math.h>

#include "math/philox.h"
#include "terrain/cube.h"

/* Lattices have edges of this part of the shorter side of the image: patches reach as far about
 * their node, and their middles are within the inner half of the image. */
#define EDGE 0.25
/* Faces of the cube blend over so many edges to both sides of where they meet. */
#define SEAM 2.0
/* Nodes about a point: three on each of up to three faces. */
enum { PATCHES = 9 };
/* Least number of edges along a face: patches are flat. */
#define LEAST_EDGES 40.0
/* The weights of patches sum to at most this, where their squares sum to 1. */
#define WEIGHTS_MOST 3.0
/* From this footprint on, in edges, deviations fade, to nothing at twice as much. */
#define FADE_FROM 1.0

static const double ROOT3_2 = 0.86602540378443865;

/* A patch at a point: place in the image over its width and height, by how much it changes along
 * directions on the ground (over a metre), and its weight. */
typedef struct patch {
  int face;
  int64_t node[2]; /* of the face's lattice */
  double x, y, weight;
  pl_vec3 dx, dy;
} patch;

static const pl_raster *first_of(const pl_ground_texture *texture) {
  return texture->heights != NULL     ? texture->heights
         : texture->roughness != NULL ? texture->roughness
                                      : texture->albedo;
}

static double tall(const pl_raster *raster) {
  const pl_raster_frame *frame = pl_raster_frame_of(raster);
  return (double)frame->height / (double)frame->width;
}

static double edge_m(const pl_ground_texture *texture) {
  return EDGE * texture->size_m * fmin(1.0, tall(first_of(texture)));
}

/* Places the image of a patch at a point: `to` is the direction of the point. */
static void place_image(const pl_ground_texture *texture, double radius_m, pl_vec3 to, patch *out) {
  const double edge = edge_m(texture);
  const int face = out->face;
  const int64_t *node = out->node;
  const double unit = 1.0 / (0.25 * PL_PI * radius_m);
  const pl_vec3 at =
      pl_cube_direction(face, edge * ((double)node[0] + 0.5 * (double)node[1]) * unit,
                        edge * ROOT3_2 * (double)node[1] * unit);
  const uint64_t key[2] = {texture->seed, UINT64_C(0x74657874757265)};
  const uint64_t counter[4] = {(uint64_t)face, (uint64_t)node[0], (uint64_t)node[1], 0};
  uint64_t words[4];
  pl_philox(key, counter, words);
  const double turn = 2.0 * PL_PI * pl_philox_double(words[0]);
  const pl_vec3 other = fabs(at.z) < 0.7 ? (pl_vec3){0.0, 0.0, 1.0} : (pl_vec3){1.0, 0.0, 0.0};
  const pl_vec3 a = pl_vec3_unit(pl_vec3_cross(other, at)), b = pl_vec3_cross(at, a);
  const pl_vec3 off = pl_vec3_scale(pl_vec3_sub(to, at), radius_m);
  const double u = pl_vec3_dot(off, a), v = pl_vec3_dot(off, b);
  const double cosine = cos(turn), sine = sin(turn);
  const double high_m = texture->size_m * tall(first_of(texture));
  const double free_x = 1.0 - 2.0 * edge / texture->size_m, free_y = 1.0 - 2.0 * edge / high_m;
  out->x = edge / texture->size_m + free_x * pl_philox_double(words[1]) +
           (u * cosine - v * sine) / texture->size_m;
  out->y = edge / high_m + free_y * pl_philox_double(words[2]) + (u * sine + v * cosine) / high_m;
  out->dx = pl_vec3_madd(pl_vec3_scale(a, cosine / texture->size_m), -sine / texture->size_m, b);
  out->dy = pl_vec3_madd(pl_vec3_scale(a, sine / high_m), cosine / high_m, b);
}

/* Adds the three patches about a point on a face with a share; returns their number. */
static int add_face(const pl_ground_texture *texture, double radius_m, int face, double s, double t,
                    double share, patch *out) {
  const double edge = edge_m(texture), unit = 0.25 * PL_PI * radius_m / edge;
  const double q = t * unit / ROOT3_2, r = s * unit - 0.5 * q;
  const int64_t i = (int64_t)floor(r), j = (int64_t)floor(q);
  const double f = r - (double)i, g = q - (double)j;
  const bool upper = f + g > 1.0;
  const int64_t nodes[3][2] = {{i + upper, j + upper}, {i + 1, j}, {i, j + 1}};
  const double w[3] = {upper ? f + g - 1.0 : 1.0 - f - g, upper ? 1.0 - g : f, upper ? 1.0 - f : g};
  int count = 0;
  for (int k = 0; k < 3; k++)
    if (w[k] > 0.0) /* Squares: they fall to 0 without a kink. */
      out[count++] =
          (patch){.face = face, .node = {nodes[k][0], nodes[k][1]}, .weight = share * w[k] * w[k]};
  return count;
}

static double ramp(double t) {
  t = fmin(fmax(t, 0.0), 1.0);
  return t * t * (3.0 - 2.0 * t);
}

/* Share of a face beside its edges, by a coordinate. */
static double share_of(double s, double seam) {
  return ramp((1.0 - fabs(s) + seam) / (2.0 * seam));
}

/* Finds the patches of a point, with weights whose squares sum to 1, but not their images. */
static int weigh_patches(const pl_ground_texture *texture, double radius_m, pl_vec3 to,
                         patch out[PATCHES]) {
  const double seam = SEAM * edge_m(texture) / (0.25 * PL_PI * radius_m);
  double squares = 0.0;
  int count = 0;
  for (int face = 0; face < PL_CUBE_FACES; face++) {
    double s, t;
    if (!pl_cube_beside(face, to, &s, &t))
      continue;
    const double share = share_of(s, seam) * share_of(t, seam);
    if (share > 0.0 && count + 3 <= PATCHES)
      count += add_face(texture, radius_m, face, s, t, share, &out[count]);
  }
  for (int k = 0; k < count; k++)
    squares += out[k].weight * out[k].weight;
  for (int k = 0; k < count; k++)
    out[k].weight /= sqrt(squares);
  return count;
}

static int find_patches(const pl_ground_texture *texture, double radius_m, pl_vec3 to,
                        patch out[PATCHES]) {
  const int count = weigh_patches(texture, radius_m, to, out);
  for (int k = 0; k < count; k++)
    place_image(texture, radius_m, to, &out[k]);
  return count;
}

/* Value of an image, between the two levels whose cells are about as wide as the footprint. */
static double value_at(const pl_raster *raster, double size_m, double x, double y,
                       double footprint_m) {
  const pl_raster_frame *frame = pl_raster_frame_of(raster);
  const double columns = (double)frame->width, rows = (double)frame->height;
  const double texels = footprint_m * columns / size_m;
  const double at = texels > 1.0 ? fmin(log2(texels), pl_raster_levels(raster) - 1.0) : 0.0;
  const int level = (int)at;
  const double u = x * columns - 0.5, v = y * rows - 0.5;
  const double fine = pl_raster_value(raster, level, u, v, PL_INTERPOLATION_CUBIC);
  if (at - level <= 0.0)
    return fine;
  return fine +
         (at - level) * (pl_raster_value(raster, level + 1, u, v, PL_INTERPOLATION_CUBIC) - fine);
}

static const pl_raster *raster_of(const pl_ground_texture *texture, pl_ground_texture_kind kind) {
  return kind == PL_GROUND_HEIGHTS     ? texture->heights
         : kind == PL_GROUND_ROUGHNESS ? texture->roughness
                                       : texture->albedo;
}

/* Share of deviations over a footprint: wider ones than patches have the mean. */
static double left_of(const pl_ground_texture *texture, double footprint_m) {
  return 1.0 - ramp((footprint_m / edge_m(texture) - FADE_FROM) / FADE_FROM);
}

double pl_ground_texture_at(const pl_ground_texture *texture, pl_ground_texture_kind kind,
                            double radius_m, pl_vec3 direction, double footprint_m) {
  const pl_raster *raster = raster_of(texture, kind);
  patch patches[PATCHES];
  if (raster == NULL)
    return kind == PL_GROUND_HEIGHTS ? 0.0 : 1.0;
  const double mean = texture->means[kind];
  const double left = left_of(texture, footprint_m);
  if (!(left > 0.0))
    return kind == PL_GROUND_HEIGHTS ? 0.0 : mean;
  double sum = 0.0;
  const int count = find_patches(texture, radius_m, direction, patches);
  for (int k = 0; k < count; k++)
    sum += patches[k].weight *
           (value_at(raster, texture->size_m, patches[k].x, patches[k].y, footprint_m) - mean);
  sum *= left;
  return kind == PL_GROUND_HEIGHTS ? sum : fmax(mean + sum, 0.0);
}

/* Weights change over differences of this part of an edge. */
#define WEIGHT_STEP 0.02

/* Writes by how much the weights of patches at a point change along a unit axis, over a metre. */
static void weight_slopes(const pl_ground_texture *texture, double radius_m, pl_vec3 to,
                          pl_vec3 axis, const patch *patches, int count, double out[PATCHES]) {
  const double step_m = WEIGHT_STEP * edge_m(texture);
  for (int k = 0; k < count; k++)
    out[k] = 0.0;
  for (int end = -1; end <= 1; end += 2) {
    patch beside[PATCHES];
    const int found = weigh_patches(
        texture, radius_m, pl_vec3_unit(pl_vec3_madd(to, end * step_m / radius_m, axis)), beside);
    for (int n = 0; n < found; n++)
      for (int k = 0; k < count; k++)
        if (beside[n].face == patches[k].face && beside[n].node[0] == patches[k].node[0] &&
            beside[n].node[1] == patches[k].node[1])
          out[k] += end * beside[n].weight / (2.0 * step_m);
  }
}

/* Slope along a unit axis over a footprint, with the changes of weights along it. */
static double slope_along(const pl_ground_texture *texture, const patch *patches, int count,
                          pl_vec3 axis, const double *changes, double footprint_m) {
  const double half_m = 0.5 * fmax(footprint_m, pl_ground_texture_texel_m(texture));
  const double mean = texture->means[PL_GROUND_HEIGHTS];
  double sum = 0.0;
  for (int k = 0; k < count; k++) {
    const patch *p = &patches[k];
    const double x = half_m * pl_vec3_dot(p->dx, axis), y = half_m * pl_vec3_dot(p->dy, axis);
    const double ahead =
        value_at(texture->heights, texture->size_m, p->x + x, p->y + y, footprint_m);
    const double back =
        value_at(texture->heights, texture->size_m, p->x - x, p->y - y, footprint_m);
    sum += p->weight * (ahead - back) / (2.0 * half_m) + changes[k] * (0.5 * (ahead + back) - mean);
  }
  return sum;
}

pl_vec3 pl_ground_texture_slope(const pl_ground_texture *texture, double radius_m,
                                pl_vec3 direction, double footprint_m, double without_m) {
  pl_vec3 out = {0.0, 0.0, 0.0};
  patch patches[PATCHES];
  const double own = left_of(texture, footprint_m), less = left_of(texture, without_m);
  if (texture->heights == NULL || !(own > 0.0))
    return out;
  const int count = find_patches(texture, radius_m, direction, patches);
  const pl_vec3 other =
      fabs(direction.z) < 0.7 ? (pl_vec3){0.0, 0.0, 1.0} : (pl_vec3){1.0, 0.0, 0.0};
  const pl_vec3 a = pl_vec3_unit(pl_vec3_cross(other, direction));
  const pl_vec3 axes[2] = {a, pl_vec3_cross(direction, a)};
  for (int k = 0; k < 2; k++) {
    double changes[PATCHES];
    weight_slopes(texture, radius_m, direction, axes[k], patches, count, changes);
    double slope = own * slope_along(texture, patches, count, axes[k], changes, footprint_m);
    if (less > 0.0)
      slope -= less * slope_along(texture, patches, count, axes[k], changes, without_m);
    out = pl_vec3_madd(out, slope, axes[k]);
  }
  return out;
}

double pl_ground_texture_variance(const pl_ground_texture *texture, double footprint_m) {
  if (texture->heights == NULL)
    return 0.0;
  const double texels = footprint_m / pl_ground_texture_texel_m(texture);
  const double at = texels > 1.0 ? fmin(log2(texels), PL_GROUND_TEXTURE_LEVELS - 2.0) : 0.0;
  const int level = (int)at;
  return texture->slopes[level] +
         (at - level) * (texture->slopes[level + 1] - texture->slopes[level]);
}

double pl_ground_texture_bound_m(const pl_ground_texture *texture) {
  double low, high;
  if (texture->heights == NULL)
    return 0.0;
  pl_raster_bounds(texture->heights, PL_INTERPOLATION_CUBIC, &low, &high);
  const double mean = texture->means[PL_GROUND_HEIGHTS];
  return WEIGHTS_MOST * fmax(high - mean, mean - low);
}

double pl_ground_texture_brightest(const pl_ground_texture *texture) {
  double low, high;
  if (texture->albedo == NULL)
    return 1.0;
  pl_raster_bounds(texture->albedo, PL_INTERPOLATION_CUBIC, &low, &high);
  const double mean = texture->means[PL_GROUND_ALBEDO];
  return fmax(mean + WEIGHTS_MOST * fmax(high - mean, 0.0), 1.0);
}

double pl_ground_texture_texel_m(const pl_ground_texture *texture) {
  if (texture->heights == NULL)
    return INFINITY;
  return texture->size_m / (double)pl_raster_frame_of(texture->heights)->width;
}

/* Mean of the sum over patches of squares of the changes of their weights along an axis, over an
 * edge: the integral over a triangle of half the squares of the gradients of b_k^2 / sqrt(b_1^4 +
 * b_2^4 + b_3^4), b being barycentric coordinates. */
#define WEIGHT_CHANGES 5.35744

/* A place of an image as patches lay it, over its width and height; `weight`: square of the patch's
 * weight there; `turn`: of the patch. */
typedef struct laid_place {
  double x, y, turn, weight;
} laid_place;

/* Place k of a sequence that fills five dimensions evenly (Roberts' R5): the patch's middle, a
 * point of a triangle of the lattice, and the turn. */
static laid_place place_of(int k, double wide, double high) {
  static const double STEPS[5] = {0.8812714616335696, 0.7766393890897682, 0.6844301295853426,
                                  0.6031687406857282, 0.5315553977157792};
  double r[5], b[3], squares = 0.0;
  for (int d = 0; d < 5; d++)
    r[d] = fmod(0.5 + STEPS[d] * k, 1.0);
  const bool flip = r[0] + r[1] > 1.0;
  b[1] = flip ? 1.0 - r[0] : r[0];
  b[2] = flip ? 1.0 - r[1] : r[1];
  b[0] = 1.0 - b[1] - b[2];
  for (int n = 0; n < 3; n++)
    squares += b[n] * b[n] * b[n] * b[n];
  const double turn = 2.0 * PL_PI * r[2], u = b[1] + 0.5 * b[2], v = ROOT3_2 * b[2];
  return (laid_place){wide + (1.0 - 2.0 * wide) * r[3] + wide * (u * cos(turn) - v * sin(turn)),
                      high + (1.0 - 2.0 * high) * r[4] + high * (u * sin(turn) + v * cos(turn)),
                      turn, b[0] * b[0] * b[0] * b[0] / squares};
}

/* Variance of slopes of laid heights at cells of a level, by the differences of
 * pl_ground_texture_slope: slopes of the image, and of weights that change across heights. Patches
 * do not know each other, and squares of weights sum to 1: products of both cancel. */
static double measure(const pl_ground_texture *texture, int level) {
  enum { POINTS = 4096 };
  const double size_m = texture->size_m, edge = edge_m(texture), aspect = tall(texture->heights);
  const double footprint_m = ldexp(pl_ground_texture_texel_m(texture), level);
  const double wide = 0.5 * footprint_m / size_m;
  double slopes = 0.0, heights = 0.0, weights = 0.0;
  if (wide >= 0.25 || wide / aspect >= 0.25)
    return 0.0;
  for (int k = 0; k < POINTS; k++) {
    const laid_place at = place_of(k, edge / size_m, edge / size_m / aspect);
    double value[2][2];
    for (int axis = 0; axis < 2; axis++)
      for (int end = 0; end < 2; end++) {
        const double way = end == 0 ? -wide : wide, angle = at.turn + 0.5 * PL_PI * axis;
        value[axis][end] = value_at(texture->heights, size_m, at.x + way * cos(angle),
                                    at.y + way * sin(angle) / aspect, footprint_m) -
                           texture->means[PL_GROUND_HEIGHTS];
      }
    for (int axis = 0; axis < 2; axis++) {
      const double slope = (value[axis][1] - value[axis][0]) / footprint_m;
      const double height = 0.5 * (value[axis][0] + value[axis][1]);
      slopes += 0.5 * at.weight * slope * slope;
      heights += 0.5 * at.weight * height * height;
    }
    weights += at.weight;
  }
  return (slopes + WEIGHT_CHANGES * heights / (edge * edge)) / weights;
}

/* Mean of an image over all patches, with weights that fall from their middle outwards. */
static double laid_mean(const pl_raster *raster, double size_m, double edge) {
  enum { MIDDLES = 24, OFFSETS = 9 };
  const double wide = edge / size_m, high = wide / tall(raster);
  double sum = 0.0, weights = 0.0;
  for (int k = 0; k < MIDDLES * MIDDLES; k++)
    for (int n = 0; n < OFFSETS * OFFSETS; n++) {
      const double dx = (n % OFFSETS) / 4.0 - 1.0, dy = (n / OFFSETS) / 4.0 - 1.0;
      const double inside = fmax(1.0 - hypot(dx, dy), 0.0), w = inside * inside;
      const double x = wide + (1.0 - 2.0 * wide) * (k % MIDDLES + 0.5) / MIDDLES + dx * wide;
      const double y = high + (1.0 - 2.0 * high) * (k / MIDDLES + 0.5) / MIDDLES + dy * high;
      if (w > 0.0)
        sum += w * value_at(raster, size_m, x, y, 0.125 * edge);
      weights += w;
    }
  return sum / weights;
}

pl_status pl_ground_texture_init(pl_ground_texture *texture, double radius_m) {
  const pl_raster *first = first_of(texture);
  if (first == NULL)
    return pl_fail(PL_E_ARGUMENT, "a texture of the ground without an image");
  if (!(texture->size_m > 0.0 && edge_m(texture) * LEAST_EDGES <= 0.5 * PL_PI * radius_m))
    return pl_fail(PL_E_RANGE,
                   "a texture of the ground %g m wide; must be above 0 and at most %.3g on a body "
                   "of a radius of %g m",
                   texture->size_m,
                   0.5 * PL_PI * radius_m / LEAST_EDGES / EDGE / fmin(1.0, tall(first)), radius_m);
  for (int kind = 0; kind < 3; kind++) {
    const pl_raster *raster = raster_of(texture, (pl_ground_texture_kind)kind);
    if (raster != NULL && fabs(tall(raster) / tall(first) - 1.0) > 0.01)
      return pl_fail(PL_E_RANGE, "images of a texture of the ground have different shapes");
  }
  for (int kind = 0; kind < 3; kind++) {
    const pl_raster *raster = raster_of(texture, (pl_ground_texture_kind)kind);
    texture->means[kind] = raster != NULL ? laid_mean(raster, texture->size_m, edge_m(texture))
                           : kind == PL_GROUND_HEIGHTS ? 0.0
                                                       : 1.0;
  }
  double most = 0.0;
  for (int k = PL_GROUND_TEXTURE_LEVELS - 1; k >= 0; k--) {
    /* Filtering takes slopes away, never adds any. */
    most = fmax(most, texture->heights != NULL ? measure(texture, k) : 0.0);
    texture->slopes[k] = most;
  }
  return PL_OK;
}
