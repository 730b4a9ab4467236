#include "math/cellular.h"

#include <stddef.h>

#include "math/lattice.h"

/* Range of the search for sites, in cells about the point's own. The distance to the site of the
 * own cell is at most sqrt(3), and the second nearest site is within sqrt(3) too (that of the own
 * cell, or of the cell across the nearest face), so that two cells are enough. */
#define REACH 2

PL_WIDE_PART float clamp01(float x) { return pl_minf(pl_maxf(x, 0.0f), 1.0f); }

enum { SIDE = 2 * REACH + 1, CELLS = SIDE * SIDE * SIDE };
static const int ORDER[SIDE] = {0, -1, 1, -2, 2}; /* near cells first */

/* The cells about the points of all lanes. */
typedef struct field {
  pl_lattice_lanes at;
  /* Size and margin of the part of a cell in which its site can be. */
  float randomness[PL_LANES], margin[PL_LANES];
  /* Square of the minimum distance along each axis to the possible sites of the cells at ORDER. */
  float gap2[3][SIDE][PL_LANES];
  uint32_t start[PL_LANES];
} field;

/* The site of one cell about each point. */
typedef struct site {
  float to[3][PL_LANES]; /* offset from the point */
  float distance2[PL_LANES];
  uint32_t id[PL_LANES];
} site;

/* State of a search. Cells entirely beyond sqrt(limit2) have no part in it, lane by lane: they are
 * skipped if that holds in all lanes, and masked otherwise. */
typedef struct search {
  float limit2[PL_LANES];
  site nearest;
  float second2[PL_LANES]; /* used by pl_cellular_find_lanes */
  /* Used by pl_cellular_edge_lanes; first: the distance; wall: from the nearest site to that
   * beyond. */
  float first[PL_LANES], edge[PL_LANES], wall[3][PL_LANES];
  /* Used by pl_cellular_smooth_lanes; inverse: 1/s; slope: the gradient times the sum. */
  float sum[PL_LANES], inverse[PL_LANES], slope[3][PL_LANES];
  size_t count;      /* lanes in use */
  bool known[CELLS]; /* sites that were made */
  site sites[CELLS];
} search;

/* gap2: squared distance to the possible sites of the cell. */
typedef void (*visit_fn)(search *found, const site *s, const float gap2[PL_LANES]);

PL_WIDE_PART void make_field(const pl_point_lanes *points, const float *randomness, uint32_t seed,
                             field *out) {
  const uint32_t start = pl_sampler_mix(seed);
  pl_lattice_split_lanes(points, &out->at);
  PL_EACH_LANE(i) {
    out->start[i] = start;
    out->randomness[i] = clamp01(randomness[i]);
    out->margin[i] = 0.5f - 0.5f * out->randomness[i];
  }
  for (int axis = 0; axis < 3; axis++)
    for (int k = 0; k < SIDE; k++)
      PL_EACH_LANE(i) {
        const float low = (float)ORDER[k] + out->margin[i] - out->at.fraction[axis][i];
        const float high = low + out->randomness[i];
        const float gap = pl_maxf(pl_maxf(low, -high), 0.0f);
        out->gap2[axis][k][i] = gap * gap;
      }
}

/* Adds squared distances of one more axis; false if the sum is beyond the limit in all lanes. */
PL_WIDE_PART bool add_gap(const float *restrict gap2, const float *restrict sum,
                          const float *restrict limit2, float *restrict out) {
  int near = 0;
  PL_EACH_LANE(i) {
    out[i] = gap2[i] + sum[i];
    near |= out[i] > limit2[i] ? 0 : 1;
  }
  return near != 0;
}

PL_WIDE_PART void hash_axis(const uint32_t *restrict hash, const uint32_t *restrict cell,
                            int offset, uint32_t *restrict out) {
  PL_EACH_LANE(i) out[i] = pl_lattice_hash(hash[i], cell[i] + (uint32_t)offset);
}

PL_WIDE_PART float jitter(const field *f, size_t lane, int offset, uint32_t bits, int axis) {
  const float uniform = (float)(int32_t)(bits >> 8) * 0x1p-24f;
  return (float)offset + f->margin[lane] + f->randomness[lane] * uniform -
         f->at.fraction[axis][lane];
}

PL_WIDE_PART void make_site(const field *f, const uint32_t *restrict row, int x, int y, int z,
                            site *restrict s) {
  PL_EACH_LANE(i) {
    const uint32_t id = pl_lattice_hash(row[i], f->at.cell[0][i] + (uint32_t)x);
    const float dx = jitter(f, i, x, id, 0), dy = jitter(f, i, y, pl_lattice_hash(id, 1), 1),
                dz = jitter(f, i, z, pl_lattice_hash(id, 2), 2);
    s->id[i] = id;
    s->to[0][i] = dx;
    s->to[1][i] = dy;
    s->to[2][i] = dz;
    s->distance2[i] = dx * dx + dy * dy + dz * dz;
  }
}

/* Visits the sites of all cells within `outer` but not within `inner`. */
PL_WIDE_PART void scan(const field *f, int inner, int outer, visit_fn visit,
                       search *restrict found) {
  static const float NONE[PL_LANES] = {0.0f};
  float gap_z2[PL_LANES], gap_yz2[PL_LANES], gap2[PL_LANES];
  uint32_t layer[PL_LANES], row[PL_LANES];
  for (int k = 0; k < 2 * outer + 1; k++) {
    const int z = ORDER[k];
    if (!add_gap(f->gap2[2][k], NONE, found->limit2, gap_z2))
      continue;
    hash_axis(f->start, f->at.cell[2], z, layer);
    for (int j = 0; j < 2 * outer + 1; j++) {
      const int y = ORDER[j];
      if (!add_gap(f->gap2[1][j], gap_z2, found->limit2, gap_yz2))
        continue;
      hash_axis(layer, f->at.cell[1], y, row);
      const int first = (k + 1) / 2 <= inner && (j + 1) / 2 <= inner ? 2 * inner + 1 : 0;
      for (int n = first; n < 2 * outer + 1; n++) {
        if (!add_gap(f->gap2[0][n], gap_yz2, found->limit2, gap2))
          continue;
        const int cell = SIDE * (SIDE * k + j) + n;
        site *s = &found->sites[cell];
        if (!found->known[cell])
          make_site(f, row, ORDER[n], y, z, s);
        found->known[cell] = true;
        visit(found, s, gap2);
      }
    }
  }
}

PL_WIDE_PART void visit_nearest(search *restrict found, const site *restrict s,
                                const float *restrict gap2) {
  site *restrict nearest = &found->nearest;
  PL_EACH_LANE(i) {
    const float distance2 = gap2[i] > found->limit2[i] ? INFINITY : s->distance2[i];
    const bool nearer = distance2 < nearest->distance2[i];
    const float farther = nearer ? nearest->distance2[i] : distance2;
    found->second2[i] = nearer ? farther : pl_minf(farther, found->second2[i]);
    nearest->distance2[i] = nearer ? distance2 : nearest->distance2[i];
    nearest->id[i] = nearer ? s->id[i] : nearest->id[i];
    nearest->to[0][i] = nearer ? s->to[0][i] : nearest->to[0][i];
    nearest->to[1][i] = nearer ? s->to[1][i] : nearest->to[1][i];
    nearest->to[2][i] = nearer ? s->to[2][i] : nearest->to[2][i];
    found->limit2[i] = found->second2[i];
  }
}

PL_WIDE_PART void find(const field *f, size_t count, search *found) {
  found->count = count;
  for (int k = 0; k < CELLS; k++)
    found->known[k] = false;
  PL_EACH_LANE(i) {
    found->limit2[i] = found->second2[i] = found->nearest.distance2[i] = INFINITY;
    found->nearest.to[0][i] = found->nearest.to[1][i] = found->nearest.to[2][i] = 0.0f;
    found->nearest.id[i] = 0;
  }
  scan(f, -1, 1, visit_nearest, found);
  scan(f, 1, REACH, visit_nearest, found); /* skips cells beyond the second nearest site */
}

/* The wall of a site at distance b is at (b^2 - a^2) / (2 |b - a|) >= (b - a) / 2, where a is the
 * nearest distance: a site beyond a + 2 edge has no wall nearer than `edge`. */
PL_WIDE_PART void visit_edge(search *restrict found, const site *restrict s,
                             const float *restrict gap2) {
  const site *restrict nearest = &found->nearest;
  PL_EACH_LANE(i) {
    const float x = s->to[0][i] - nearest->to[0][i], y = s->to[1][i] - nearest->to[1][i],
                z = s->to[2][i] - nearest->to[2][i];
    const float length2 = x * x + y * y + z * z;
    /* Not the nearest site itself, nor one at the same position. */
    const bool counts = !(gap2[i] > found->limit2[i]) & (length2 > 1e-12f);
    const float mx = (s->to[0][i] + nearest->to[0][i]) * 0.5f,
                my = (s->to[1][i] + nearest->to[1][i]) * 0.5f,
                mz = (s->to[2][i] + nearest->to[2][i]) * 0.5f;
    const float wall = (mx * x + my * y + mz * z) / sqrtf(length2);
    const float edge = counts ? pl_minf(found->edge[i], wall) : found->edge[i];
    const bool nearer = edge < found->edge[i];
    found->wall[0][i] = nearer ? x : found->wall[0][i];
    found->wall[1][i] = nearer ? y : found->wall[1][i];
    found->wall[2][i] = nearer ? z : found->wall[2][i];
    const float limit = found->first[i] + 2.0f * edge;
    found->edge[i] = edge;
    found->limit2[i] = counts ? limit * limit : found->limit2[i];
  }
}

static void put_cell(const search *found, pl_cellular_lanes *out) {
  const site *nearest = &found->nearest;
  for (size_t i = 0; i < PL_LANES; i++) {
    out->first[i] = sqrtf(nearest->distance2[i]);
    out->second[i] = sqrtf(found->second2[i]);
    for (size_t axis = 0; axis < 3; axis++)
      out->to_site[axis][i] = nearest->to[axis][i];
    out->id[i] = nearest->id[i];
  }
}

PL_WIDE void pl_cellular_find_lanes(const pl_point_lanes *points, const float randomness[PL_LANES],
                                    uint32_t seed, pl_cellular_lanes *cell) {
  field f;
  search found;
  make_field(points, randomness, seed, &f);
  find(&f, PL_LANES, &found);
  put_cell(&found, cell);
}

/* Unit vectors against those of all lanes; zero for zero. */
PL_WIDE_PART void away_from(float (*restrict to)[PL_LANES], float (*restrict out)[PL_LANES]) {
  PL_EACH_LANE(i) {
    const float x = to[0][i], y = to[1][i], z = to[2][i];
    const float length = sqrtf(x * x + y * y + z * z), by = length > 0.0f ? -1.0f / length : 0.0f;
    out[0][i] = by * x;
    out[1][i] = by * y;
    out[2][i] = by * z;
  }
}

/* The site of the second distance is looked up among those that the search has made. */
PL_WIDE void pl_cellular_second_lanes(const pl_point_lanes *points,
                                      const float randomness[PL_LANES], uint32_t seed,
                                      pl_cellular_lanes *cell, float gradient[3][PL_LANES]) {
  field f;
  search found;
  float to[3][PL_LANES] = {{0.0f}};
  make_field(points, randomness, seed, &f);
  find(&f, PL_LANES, &found);
  put_cell(&found, cell);
  for (size_t k = 0; k < CELLS; k++) {
    if (!found.known[k])
      continue;
    const site *s = &found.sites[k];
    PL_EACH_LANE(i) {
      const bool is_it = (s->distance2[i] == found.second2[i]) & (s->id[i] != found.nearest.id[i]);
      to[0][i] = is_it ? s->to[0][i] : to[0][i];
      to[1][i] = is_it ? s->to[1][i] : to[1][i];
      to[2][i] = is_it ? s->to[2][i] : to[2][i];
    }
  }
  away_from(to, gradient);
}

PL_WIDE void pl_cellular_edge_lanes(const pl_point_lanes *points, const float randomness[PL_LANES],
                                    uint32_t seed, pl_cellular_lanes *cell, float out[PL_LANES],
                                    float gradient[3][PL_LANES]) {
  field f;
  search found;
  make_field(points, randomness, seed, &f);
  find(&f, PL_LANES, &found);
  put_cell(&found, cell);
  PL_EACH_LANE(i) {
    found.limit2[i] = found.edge[i] = INFINITY;
    found.first[i] = sqrtf(found.nearest.distance2[i]);
    found.wall[0][i] = found.wall[1][i] = found.wall[2][i] = 0.0f;
  }
  scan(&f, -1, 1, visit_edge, &found);
  scan(&f, 1, REACH, visit_edge, &found);
  PL_EACH_LANE(i) out[i] = pl_maxf(found.edge[i], 0.0f);
  if (gradient != NULL)
    away_from(found.wall, gradient);
}

PL_WIDE_PART void visit_smooth(search *restrict found, const site *restrict s,
                               const float *restrict gap2) {
  for (size_t i = 0; i < found->count; i++) {
    const float distance = sqrtf(s->distance2[i]);
    if (gap2[i] > found->limit2[i])
      continue;
    const float weight = expf((sqrtf(found->nearest.distance2[i]) - distance) * found->inverse[i]);
    const float by = distance > 0.0f ? weight / distance : 0.0f;
    found->sum[i] += weight;
    for (int axis = 0; axis < 3; axis++)
      found->slope[axis][i] -= by * s->to[axis][i];
  }
}

/* Of -s ln sum exp(-d/s): the mean of the distances' gradients by their fractions of the sum. */
static void smooth_gradient(const search *found, const float smoothness[PL_LANES], size_t count,
                            float gradient[3][PL_LANES]) {
  for (size_t i = 0; i < PL_LANES; i++) {
    const float s = 0.125f * clamp01(smoothness[i]), first = sqrtf(found->nearest.distance2[i]);
    const float by = first > 0.0f ? -1.0f / first : 0.0f;
    for (int axis = 0; axis < 3; axis++)
      gradient[axis][i] = i >= count  ? gradient[axis][0]
                          : s > 1e-6f ? found->slope[axis][i] / found->sum[i]
                                      : by * found->nearest.to[axis][i];
  }
}

PL_WIDE void pl_cellular_smooth_lanes(size_t count, const pl_point_lanes *points,
                                      const float randomness[PL_LANES],
                                      const float smoothness[PL_LANES], uint32_t seed,
                                      pl_cellular_lanes *cell, float out[PL_LANES],
                                      float gradient[3][PL_LANES]) {
  field f;
  search found;
  make_field(points, randomness, seed, &f);
  find(&f, count, &found);
  put_cell(&found, cell);
  for (size_t i = 0; i < PL_LANES; i++) {
    const float s = 0.125f * clamp01(smoothness[i]);
    /* exp(-16) = 1e-7: below the precision of the float sum */
    const float limit = sqrtf(found.nearest.distance2[i]) + 16.0f * s;
    found.limit2[i] = s > 1e-6f ? limit * limit : -1.0f;
    found.inverse[i] = 1.0f / s;
    found.sum[i] = found.slope[0][i] = found.slope[1][i] = found.slope[2][i] = 0.0f;
  }
  scan(&f, -1, REACH, visit_smooth, &found);
  for (size_t i = 0; i < PL_LANES; i++) {
    const float s = 0.125f * clamp01(smoothness[i]), first = sqrtf(found.nearest.distance2[i]);
    /* Otherwise the effect of smoothing is below the rounding error of the distance. */
    out[i] = i >= count ? out[0] : s > 1e-6f ? first - s * logf(found.sum[i]) : first;
  }
  if (gradient != NULL)
    smooth_gradient(&found, smoothness, count, gradient);
}

static float polynomial(float x, const float c[5]) {
  return c[0] + x * (c[1] + x * (c[2] + x * (c[3] + x * c[4])));
}

/* Least-squares fits to the means of 3e6 points (edge: 1e6) at 7 values of the randomness. */
float pl_cellular_mean_first(float randomness) {
  static const float FIT[5] = {0.48030f, -0.00051f, 0.04552f, 0.01876f, -0.02368f};
  return polynomial(clamp01(randomness), FIT);
}

float pl_cellular_mean_second(float randomness) {
  static const float FIT[5] = {0.70271f, 0.00079f, 0.07735f, -0.11251f, 0.04864f};
  return polynomial(clamp01(randomness), FIT);
}

float pl_cellular_mean_edge(float randomness) {
  static const float FIT[5] = {0.12500f, 0.00257f, 0.03892f, -0.07190f, 0.03247f};
  return polynomial(clamp01(randomness), FIT);
}

float pl_cellular_mean_smooth(float randomness, float smoothness) {
  const float r = clamp01(randomness), s = clamp01(smoothness);
  return pl_cellular_mean_first(r) - s * s * (0.0518f + 0.0080f * r * r * r);
}
