#include "terrain/ground_texture.h"

#include <math.h>

#include "base/work.h"
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
  pl_vec3 dx, dy, dweight;
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

/* The image about a node: its middle's place in the image over width and height, and axes. */
typedef struct laid_image {
  int face; /* -1: none */
  int64_t node[2];
  pl_vec3 at, dx, dy;
  double x, y;
} laid_image;

static void lay_image(const pl_ground_texture *texture, double radius_m, const patch *about,
                      laid_image *out) {
  const double edge = edge_m(texture);
  const int64_t *node = about->node;
  const double unit = 1.0 / (0.25 * PL_PI * radius_m);
  const pl_vec3 at =
      pl_cube_direction(about->face, edge * ((double)node[0] + 0.5 * (double)node[1]) * unit,
                        edge * ROOT3_2 * (double)node[1] * unit);
  const uint64_t key[2] = {texture->seed, UINT64_C(0x74657874757265)};
  const uint64_t counter[4] = {(uint64_t)about->face, (uint64_t)node[0], (uint64_t)node[1], 0};
  uint64_t words[4];
  pl_philox(key, counter, words);
  const double turn = 2.0 * PL_PI * pl_philox_double(words[0]);
  const pl_vec3 other = fabs(at.z) < 0.7 ? (pl_vec3){0.0, 0.0, 1.0} : (pl_vec3){1.0, 0.0, 0.0};
  const pl_vec3 a = pl_vec3_unit(pl_vec3_cross(other, at)), b = pl_vec3_cross(at, a);
  const double cosine = cos(turn), sine = sin(turn);
  const double high_m = texture->size_m * tall(first_of(texture));
  const double free_x = 1.0 - 2.0 * edge / texture->size_m, free_y = 1.0 - 2.0 * edge / high_m;
  *out = (laid_image){
      .face = about->face,
      .node = {node[0], node[1]},
      .at = at,
      .dx = pl_vec3_madd(pl_vec3_scale(a, cosine / texture->size_m), -sine / texture->size_m, b),
      .dy = pl_vec3_madd(pl_vec3_scale(a, sine / high_m), cosine / high_m, b),
      .x = edge / texture->size_m + free_x * pl_philox_double(words[1]),
      .y = edge / high_m + free_y * pl_philox_double(words[2]),
  };
}

/* Images of nodes, kept while neighbouring points are looked at. */
enum { KEPT = 16 };
typedef struct kept_images {
  laid_image slots[KEPT];
} kept_images;

static void keep_none(kept_images *kept) {
  for (int k = 0; k < KEPT; k++)
    kept->slots[k].face = -1;
}

/* Places the image of a patch at a point: `to` is the direction of the point. */
static void place_image(const pl_ground_texture *texture, double radius_m, pl_vec3 to,
                        kept_images *kept, patch *out) {
  const uint64_t hash = (uint64_t)out->node[0] + 4 * (uint64_t)out->node[1];
  laid_image *of = &kept->slots[hash % KEPT];
  if (of->face != out->face || of->node[0] != out->node[0] || of->node[1] != out->node[1])
    lay_image(texture, radius_m, out, of);
  const pl_vec3 off = pl_vec3_scale(pl_vec3_sub(to, of->at), radius_m);
  out->x = of->x + pl_vec3_dot(off, of->dx);
  out->y = of->y + pl_vec3_dot(off, of->dy);
  out->dx = of->dx;
  out->dy = of->dy;
}

static double ramp(double t) {
  t = fmin(fmax(t, 0.0), 1.0);
  return t * t * (3.0 - 2.0 * t);
}

static double ramp_slope(double t) { return t > 0.0 && t < 1.0 ? 6.0 * t * (1.0 - t) : 0.0; }

/* A face about a point: its coordinates, its fraction of the ground there, and their gradients by
 * the unit direction. */
typedef struct beside {
  int face;
  double s, t, fraction;
  pl_vec3 ds, dt, dfraction;
} beside;

/* Finds the fraction of a face; false where it has none. */
static bool find_fraction(int face, pl_vec3 to, double seam, beside *out) {
  double s, t;
  if (!pl_cube_beside(face, to, &s, &t))
    return false;
  const double from[2] = {(1.0 - fabs(s) + seam) / (2.0 * seam),
                          (1.0 - fabs(t) + seam) / (2.0 * seam)};
  const double fraction[2] = {ramp(from[0]), ramp(from[1])};
  if (!(fraction[0] * fraction[1] > 0.0))
    return false;
  *out = (beside){.face = face, .s = s, .t = t, .fraction = fraction[0] * fraction[1]};
  pl_cube_gradients(face, to, &out->ds, &out->dt);
  const double by_s = -copysign(ramp_slope(from[0]) / (2.0 * seam), s) * fraction[1];
  const double by_t = -copysign(ramp_slope(from[1]) / (2.0 * seam), t) * fraction[0];
  out->dfraction = pl_vec3_madd(pl_vec3_scale(out->ds, by_s), by_t, out->dt);
  return true;
}

/* Adds the three patches about a point on a face; returns their number. */
static int add_face(const pl_ground_texture *texture, double radius_m, const beside *at,
                    patch *out) {
  const double edge = edge_m(texture), unit = 0.25 * PL_PI * radius_m / edge;
  const double q = at->t * unit / ROOT3_2, r = at->s * unit - 0.5 * q;
  const pl_vec3 dq = pl_vec3_scale(at->dt, unit / ROOT3_2);
  const pl_vec3 dr = pl_vec3_madd(pl_vec3_scale(at->ds, unit), -0.5, dq);
  const int64_t i = (int64_t)floor(r), j = (int64_t)floor(q);
  const double f = r - (double)i, g = q - (double)j;
  const bool upper = f + g > 1.0;
  const int64_t nodes[3][2] = {{i + upper, j + upper}, {i + 1, j}, {i, j + 1}};
  const double w[3] = {upper ? f + g - 1.0 : 1.0 - f - g, upper ? 1.0 - g : f, upper ? 1.0 - f : g};
  const pl_vec3 both = pl_vec3_add(dr, dq);
  const pl_vec3 dw[3] = {upper ? both : pl_vec3_scale(both, -1.0),
                         upper ? pl_vec3_scale(dq, -1.0) : dr,
                         upper ? pl_vec3_scale(dr, -1.0) : dq};
  int count = 0;
  for (int k = 0; k < 3; k++)
    if (w[k] > 0.0) /* Squares: they fall to 0 without a kink. */
      out[count++] = (patch){
          .face = at->face,
          .node = {nodes[k][0], nodes[k][1]},
          .weight = at->fraction * w[k] * w[k],
          .dweight = pl_vec3_madd(pl_vec3_scale(dw[k], 2.0 * at->fraction * w[k]), w[k] * w[k],
                                  at->dfraction),
      };
  return count;
}

/* Faces that reach over a point to where they have a fraction have at least this part of its
 * greatest coordinate outwards: seams are at most a twentieth of the face to either side. */
#define LEAST_OUTWARD 0.8

/* Finds the patches of a point, with weights whose squares sum to 1, but not their images. */
static int weigh_patches(const pl_ground_texture *texture, double radius_m, pl_vec3 to,
                         patch out[PATCHES]) {
  const double seam = SEAM * edge_m(texture) / (0.25 * PL_PI * radius_m);
  const double most = fmax(fabs(to.x), fmax(fabs(to.y), fabs(to.z)));
  double squares = 0.0;
  pl_vec3 change = {0.0, 0.0, 0.0};
  int count = 0;
  for (int face = 0; face < PL_CUBE_FACES; face++) {
    beside at;
    if (pl_cube_outward(face, to) >= LEAST_OUTWARD * most && count + 3 <= PATCHES &&
        find_fraction(face, to, seam, &at))
      count += add_face(texture, radius_m, &at, &out[count]);
  }
  for (int k = 0; k < count; k++) {
    squares += out[k].weight * out[k].weight;
    change = pl_vec3_madd(change, out[k].weight, out[k].dweight);
  }
  const double norm = sqrt(squares);
  for (int k = 0; k < count; k++) {
    out[k].dweight = pl_vec3_madd(pl_vec3_scale(out[k].dweight, 1.0 / (norm * radius_m)),
                                  -out[k].weight / (norm * squares * radius_m), change);
    out[k].weight /= norm;
  }
  return count;
}

static int find_patches(const pl_ground_texture *texture, double radius_m, pl_vec3 to,
                        kept_images *kept, patch out[PATCHES]) {
  const int count = weigh_patches(texture, radius_m, to, out);
  pl_work_add(PL_WORK_texture_patches, (size_t)count);
  for (int k = 0; k < count; k++)
    place_image(texture, radius_m, to, kept, &out[k]);
  return count;
}

/* A place in an image: between the two levels whose cells are about as wide as the footprint. */
typedef struct image_place {
  int level;
  double beyond; /* part of the next level */
  double u, v;   /* column and row */
} image_place;

static image_place place_in(const pl_raster *raster, double size_m, double x, double y,
                            double footprint_m) {
  const pl_raster_frame *frame = pl_raster_frame_of(raster);
  const double texels = footprint_m * (double)frame->width / size_m;
  const double at = texels > 1.0 ? fmin(log2(texels), pl_raster_levels(raster) - 1.0) : 0.0;
  return (image_place){.level = (int)at,
                       .beyond = at - (int)at,
                       .u = x * (double)frame->width - 0.5,
                       .v = y * (double)frame->height - 0.5};
}

/* Value of an image. */
static double value_at(const pl_raster *raster, double size_m, double x, double y,
                       double footprint_m) {
  const image_place at = place_in(raster, size_m, x, y, footprint_m);
  const double fine = pl_raster_value(raster, at.level, at.u, at.v, PL_INTERPOLATION_CUBIC);
  if (!(at.beyond > 0.0))
    return fine;
  const double wide = pl_raster_value(raster, at.level + 1, at.u, at.v, PL_INTERPOLATION_CUBIC);
  return fine + at.beyond * (wide - fine);
}

/* The same, with its slopes over the width and the height of the image. */
static double slopes_at(const pl_raster *raster, double size_m, double x, double y,
                        double footprint_m, double slope[2]) {
  const image_place at = place_in(raster, size_m, x, y, footprint_m);
  double value = pl_raster_value_slope(raster, at.level, at.u, at.v, slope);
  if (at.beyond > 0.0) {
    double wide[2];
    const double other = pl_raster_value_slope(raster, at.level + 1, at.u, at.v, wide);
    value += at.beyond * (other - value);
    for (int k = 0; k < 2; k++)
      slope[k] += at.beyond * (wide[k] - slope[k]);
  }
  slope[0] *= (double)pl_raster_frame_of(raster)->width;
  slope[1] *= (double)pl_raster_frame_of(raster)->height;
  return value;
}

static const pl_raster *raster_of(const pl_ground_texture *texture, pl_ground_texture_kind kind) {
  return kind == PL_GROUND_HEIGHTS     ? texture->heights
         : kind == PL_GROUND_ROUGHNESS ? texture->roughness
                                       : texture->albedo;
}

/* Fraction of deviations over a footprint: wider ones than patches have the mean. */
static double left_of(const pl_ground_texture *texture, double footprint_m) {
  return 1.0 - ramp((footprint_m / edge_m(texture) - FADE_FROM) / FADE_FROM);
}

/* Sum over the patches of a point of deviations from the mean. */
static double deviation_at(const pl_ground_texture *texture, pl_ground_texture_kind kind,
                           double radius_m, pl_vec3 direction, double footprint_m,
                           kept_images *kept) {
  const pl_raster *raster = raster_of(texture, kind);
  const double mean = texture->means[kind];
  patch patches[PATCHES];
  double sum = 0.0;
  const int count = find_patches(texture, radius_m, direction, kept, patches);
  for (int k = 0; k < count; k++)
    sum += patches[k].weight *
           (value_at(raster, texture->size_m, patches[k].x, patches[k].y, footprint_m) - mean);
  return sum * left_of(texture, footprint_m);
}

double pl_ground_texture_at(const pl_ground_texture *texture, pl_ground_texture_kind kind,
                            double radius_m, pl_vec3 direction, double footprint_m) {
  kept_images kept;
  const double mean = texture->means[kind];
  if (raster_of(texture, kind) == NULL)
    return kind == PL_GROUND_HEIGHTS ? 0.0 : 1.0;
  if (!(left_of(texture, footprint_m) > 0.0))
    return kind == PL_GROUND_HEIGHTS ? 0.0 : mean;
  keep_none(&kept);
  const double sum = deviation_at(texture, kind, radius_m, direction, footprint_m, &kept);
  return kind == PL_GROUND_HEIGHTS ? sum : fmax(mean + sum, 0.0);
}

void pl_ground_texture_add_heights(const pl_ground_texture *texture, double radius_m,
                                   const pl_vec3 *directions, size_t count, double footprint_m,
                                   double *heights_m) {
  kept_images kept;
  if (texture->heights == NULL || !(left_of(texture, footprint_m) > 0.0))
    return;
  keep_none(&kept);
  for (size_t k = 0; k < count; k++)
    heights_m[k] +=
        deviation_at(texture, PL_GROUND_HEIGHTS, radius_m, directions[k], footprint_m, &kept);
}

/* Slope of all patches over a footprint, with the changes of their weights. */
static pl_vec3 slope_of(const pl_ground_texture *texture, const patch *patches, int count,
                        double footprint_m) {
  const double mean = texture->means[PL_GROUND_HEIGHTS];
  pl_vec3 sum = {0.0, 0.0, 0.0};
  for (int k = 0; k < count; k++) {
    const patch *p = &patches[k];
    double slope[2];
    const double height =
        slopes_at(texture->heights, texture->size_m, p->x, p->y, footprint_m, slope);
    sum = pl_vec3_madd(sum, p->weight * slope[0], p->dx);
    sum = pl_vec3_madd(sum, p->weight * slope[1], p->dy);
    sum = pl_vec3_madd(sum, height - mean, p->dweight);
  }
  return sum;
}

pl_vec3 pl_ground_texture_slope(const pl_ground_texture *texture, double radius_m,
                                pl_vec3 direction, double footprint_m, double without_m) {
  pl_vec3 out = {0.0, 0.0, 0.0};
  patch patches[PATCHES];
  kept_images kept;
  const double own = left_of(texture, footprint_m), less = left_of(texture, without_m);
  if (texture->heights == NULL || !(own > 0.0))
    return out;
  keep_none(&kept);
  const int count = find_patches(texture, radius_m, direction, &kept, patches);
  out = pl_vec3_scale(slope_of(texture, patches, count, footprint_m), own);
  if (less > 0.0)
    out = pl_vec3_madd(out, -less, slope_of(texture, patches, count, without_m));
  return pl_vec3_madd(out, -pl_vec3_dot(out, direction), direction);
}

bool pl_ground_texture_shows(const pl_ground_texture *texture, double footprint_m) {
  return texture->heights != NULL && left_of(texture, footprint_m) > 0.0;
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

/* Mean squared derivative of the patches' weights along an axis, summed over patches, for edges of
 * length 1. It is the integral, over a triangle, of half the squared gradients of the weights
 * b_k^2 / sqrt(b_1^4 + b_2^4 + b_3^4), where b are barycentric coordinates. */
#define WEIGHT_CHANGES 5.35744

/* A place of an image as patches lay it, over its width and height; `weight`: square of the patch's
 * weight there. */
typedef struct laid_place {
  double x, y, weight;
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
                      b[0] * b[0] * b[0] * b[0] / squares};
}

/* Variance of slopes of laid heights at cells of a level. It has two terms: the slopes of the
 * image, and the change of weights across heights. Their products cancel, since patches are
 * independent and squares of weights sum to 1. */
static double measure(const pl_ground_texture *texture, int level) {
  enum { POINTS = 4096 };
  const double size_m = texture->size_m, edge = edge_m(texture), aspect = tall(texture->heights);
  const double footprint_m = ldexp(pl_ground_texture_texel_m(texture), level);
  double slopes = 0.0, heights = 0.0, weights = 0.0;
  if (footprint_m >= 0.5 * size_m * fmin(1.0, aspect))
    return 0.0;
  for (int k = 0; k < POINTS; k++) {
    const laid_place at = place_of(k, edge / size_m, edge / size_m / aspect);
    double slope[2];
    const double height = slopes_at(texture->heights, size_m, at.x, at.y, footprint_m, slope) -
                          texture->means[PL_GROUND_HEIGHTS];
    slopes += 0.5 * at.weight * (slope[0] * slope[0] + slope[1] * slope[1] / (aspect * aspect));
    heights += at.weight * height * height;
    weights += at.weight;
  }
  return (slopes / (size_m * size_m) + WEIGHT_CHANGES * heights / (edge * edge)) / weights;
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
