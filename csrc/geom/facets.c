/* Extracts large planar groups of facets first, then repeatedly splits the group of the largest
 * cost. */
#include "geom/facets.h"

#include <math.h>
#include <string.h>

#include "base/memory.h"
#include "math/sampling.h"

/* Orientations that are tried for a rectangle: the edges of the largest facet, and equally spaced
 * angles. */
enum { EDGES = 3, TURNS = 8 };
/* Planar groups are extracted first: at most FLATS per material (ROUGH_FLATS if it is rough), each
 * of facets whose normals agree within 1.8 degrees, with at least FLAT_PART of the material's area.
 * Their directions are binned into CELLS x CELLS cells on each face of a cube; the number is odd,
 * so that the coordinate axes lie at the centre of a cell. In later steps planar groups weigh
 * FLAT_WEIGHT times as much as curved ones. */
enum { FLATS = 8, ROUGH_FLATS = 2, CELLS = 17 };
static const float FLAT_PART = 0.02f, FLAT_COSINE = 0.9995f, FLAT_WEIGHT = 10.0f;
/* Number of bins of a range in which gaps are searched. */
enum { BINS = 64 };
/* Weight of a group of rough material relative to a glossy one; it is not 0, as a material graph
 * may replace the material. Materials below this roughness count as glossy. */
static const float ROUGH_COST = 0.02f, SHINY_ROUGHNESS = 0.45f;
/* Cost of the unfilled part of a rectangle, relative to the spread of normals. */
static const float UNFILLED_COST = 0.2f;
/* A group with a lower cost per area is not split. */
static const float COST_MIN = 1e-5f;
/* Groups of a larger ratio of thickness to size are split across their thickness. */
static const float THICK = 0.1f;
/* Groups of a smaller spread are split by position, and more orientations are tried for their
 * rectangles. */
static const float SPREAD_FLAT = 0.005f;

typedef struct facet {
  pl_vec3f corner[3];
  pl_vec3f normal; /* its length is twice the area */
} facet;

static facet facet_of(const pl_model *model, uint32_t triangle) {
  facet f;
  for (size_t k = 0; k < 3; k++) {
    const float *p = model->positions + 3 * (size_t)model->indices[3 * (size_t)triangle + k];
    f.corner[k] = pl_vec3f_make(p[0], p[1], p[2]);
  }
  f.normal = pl_vec3f_cross(pl_vec3f_sub(f.corner[1], f.corner[0]),
                            pl_vec3f_sub(f.corner[2], f.corner[0]));
  return f;
}

static pl_vec3f centroid(const facet *f) {
  return pl_vec3f_scale(pl_vec3f_add(pl_vec3f_add(f->corner[0], f->corner[1]), f->corner[2]),
                        1.0f / 3.0f);
}

/* Returns the normal of a corner, flipped to the facet's side. */
static pl_vec3f corner_normal(const pl_model *model, uint32_t triangle, size_t k, const facet *f) {
  const float *n = model->normals + 3 * (size_t)model->indices[3 * (size_t)triangle + k];
  const pl_vec3f v = pl_vec3f_make(n[0], n[1], n[2]);
  return pl_vec3f_dot(v, f->normal) < 0.0f ? pl_vec3f_scale(v, -1.0f) : v;
}

/* A group of facets during the splitting. */
typedef struct group {
  pl_facet_group out;
  size_t first, count; /* range of its triangles in `order` */
  float weight, cost;
  float thickness;   /* extent along its normal */
  float variance[3]; /* of the normals, per axis */
} group;

/* Accumulates the area-weighted mean and variance of the normals. */
static void measure_normals(const pl_model *model, const uint32_t *order, group *g) {
  double sum[3] = {0.0, 0.0, 0.0}, square[3] = {0.0, 0.0, 0.0}, area = 0.0;
  float largest = -1.0f;
  for (size_t i = 0; i < g->count; i++) {
    const facet f = facet_of(model, order[i]);
    const float size = 0.5f * pl_vec3f_norm(f.normal);
    if (size > largest) {
      largest = size;
      g->out.triangle = order[i];
    }
    area += (double)size;
    for (size_t k = 0; k < 3; k++) {
      const pl_vec3f n = corner_normal(model, order[i], k, &f);
      const float v[3] = {n.x, n.y, n.z};
      for (int axis = 0; axis < 3; axis++) {
        sum[axis] += (double)(size / 3.0f * v[axis]);
        square[axis] += (double)(size / 3.0f * v[axis] * v[axis]);
      }
    }
  }
  g->out.area = (float)area;
  const pl_vec3 mean = {sum[0], sum[1], sum[2]};
  const double length = pl_vec3_norm(mean);
  g->out.normal = length > 1e-6 * area ? pl_vec3_to_float(pl_vec3_scale(mean, 1.0 / length))
                                       : pl_vec3f_make(0.0f, 0.0f, 1.0f);
  for (int axis = 0; axis < 3 && area > 0.0; axis++)
    g->variance[axis] =
        (float)fmax(square[axis] / area - (sum[axis] / area) * (sum[axis] / area), 0.0);
}

typedef struct extent {
  float low, high;
} extent;

static extent extent_along(const pl_model *model, const uint32_t *order, const group *g,
                           pl_vec3f axis) {
  extent e = {INFINITY, -INFINITY};
  for (size_t i = 0; i < g->count; i++) {
    const facet f = facet_of(model, order[i]);
    for (size_t k = 0; k < 3; k++) {
      const float x = pl_vec3f_dot(f.corner[k], axis);
      e.low = pl_minf(e.low, x);
      e.high = pl_maxf(e.high, x);
    }
  }
  return e;
}

/* Stores the bounding rectangle with a side along `along` if it is the smallest so far. */
static void try_rectangle(const pl_model *model, const uint32_t *order, pl_vec3f along,
                          float *smallest, group *g) {
  const pl_vec3f n = g->out.normal;
  pl_vec3f x = pl_vec3f_madd(along, -pl_vec3f_dot(along, n), n);
  if (!(pl_vec3f_dot(x, x) > 1e-6f * pl_vec3f_dot(along, along)))
    return;
  x = pl_vec3f_unit(x);
  const pl_vec3f y = pl_vec3f_cross(n, x);
  const extent a = extent_along(model, order, g, x), b = extent_along(model, order, g, y);
  const float size = (a.high - a.low) * (b.high - b.low);
  if (!(size < 0.999f * *smallest))
    return;
  *smallest = size;
  const extent c = extent_along(model, order, g, n);
  g->thickness = c.high - c.low;
  g->out.half[0] = pl_vec3f_scale(x, 0.5f * (a.high - a.low));
  g->out.half[1] = pl_vec3f_scale(y, 0.5f * (b.high - b.low));
  g->out.center = pl_vec3f_madd(
      pl_vec3f_madd(pl_vec3f_scale(x, 0.5f * (a.low + a.high)), 0.5f * (b.low + b.high), y),
      0.5f * (c.low + c.high), n);
}

static void measure_rectangle(const pl_model *model, const uint32_t *order, group *g) {
  const pl_basis basis = pl_basis_make(g->out.normal);
  const facet f = facet_of(model, g->out.triangle);
  float smallest = INFINITY;
  g->out.spread = g->variance[0] + g->variance[1] + g->variance[2];
  const bool flat = g->out.spread < SPREAD_FLAT;
  for (size_t k = 0; k < (flat ? EDGES : 1); k++)
    try_rectangle(model, order, pl_vec3f_sub(f.corner[(k + 1) % 3], f.corner[k]), &smallest, g);
  for (int k = 0; k < (flat ? TURNS : 1); k++) {
    const float turn = 0.5f * PL_PI_F * (float)k / TURNS;
    const pl_vec3f along = pl_vec3f_madd(pl_vec3f_scale(basis.t, cosf(turn)), sinf(turn), basis.b);
    try_rectangle(model, order, along, &smallest, g);
  }
}

/* Ratio of thickness to the size of the rectangle. */
static float thickness_of(const group *g) {
  return g->thickness /
         pl_maxf(pl_vec3f_norm(g->out.half[0]) + pl_vec3f_norm(g->out.half[1]), 1e-30f);
}

static void measure(const pl_model *model, const uint32_t *order, group *g) {
  measure_normals(model, order + g->first, g);
  measure_rectangle(model, order + g->first, g);
  const float size = 4.0f * pl_vec3f_norm(g->out.half[0]) * pl_vec3f_norm(g->out.half[1]);
  const float unfilled = size > 0.0f ? pl_maxf(1.0f - g->out.area / size, 0.0f) : 0.0f;
  const float thick = pl_minf(thickness_of(g), 1.0f);
  const float each = g->out.spread + UNFILLED_COST * (unfilled * unfilled + thick * thick);
  g->cost = each > COST_MIN && g->count > 1 ? g->weight * g->out.area * each : 0.0f;
}

/* Coordinate by which facets are split: the component of the normal, or of the centroid, along an
 * axis. */
typedef struct criterion {
  bool by_normal;
  pl_vec3f axis;
  float middle;
} criterion;

static float value_of(const facet *f, const criterion *c) {
  const float length = pl_vec3f_norm(f->normal);
  if (c->by_normal)
    return length > 0.0f ? pl_vec3f_dot(f->normal, c->axis) / length : 0.0f;
  return pl_vec3f_dot(centroid(f), c->axis);
}

static extent range_of(const pl_model *model, const uint32_t *order, const group *g,
                       const criterion *c) {
  extent e = {INFINITY, -INFINITY};
  for (size_t i = 0; i < g->count; i++) {
    const facet f = facet_of(model, order[i]);
    const float x = value_of(&f, c);
    e.low = pl_minf(e.low, x);
    e.high = pl_maxf(e.high, x);
  }
  return e;
}

/* Returns the middle of the widest gap between the values, found with bins, so that splits fall
 * between panels and not through them. Without a gap it is the middle of the range. */
static float gap_of(const pl_model *model, const uint32_t *order, const group *g,
                    const criterion *c, extent e) {
  bool used[BINS] = {false};
  const float scale = BINS / (e.high - e.low);
  int widest = 0, from = 0;
  float middle = 0.5f * (e.low + e.high);
  for (size_t i = 0; i < g->count; i++) {
    const facet f = facet_of(model, order[i]);
    const int bin = (int)((value_of(&f, c) - e.low) * scale);
    used[bin < BINS ? bin : BINS - 1] = true;
  }
  for (int i = 0; i < BINS; i++) {
    if (!used[i])
      continue;
    if (i - from > widest + 1) {
      widest = i - from;
      middle = e.low + 0.5f * (float)(from + 1 + i) / scale;
    }
    from = i;
  }
  return middle;
}

/* Finds the axis with the largest range of normals, or of positions along the sides and the normal
 * of the rectangle. */
static float longest(const pl_model *model, const uint32_t *order, const group *g, bool by_normal,
                     criterion *best) {
  const pl_basis own = pl_basis_make(g->out.normal);
  const bool sides = !by_normal && pl_vec3f_norm(g->out.half[0]) > 0.0f;
  const pl_vec3f x = sides ? pl_vec3f_unit(g->out.half[0]) : own.t;
  const pl_vec3f axes[3] = {x, pl_vec3f_cross(own.n, x), own.n};
  float length = -1.0f;
  const bool layers = !by_normal && thickness_of(g) > THICK;
  for (int axis = layers ? 2 : 0; axis < 3; axis++) {
    criterion c = {.by_normal = by_normal, .axis = axes[axis]};
    const extent e = range_of(model, order, g, &c);
    if (!(e.high - e.low > length))
      continue;
    length = e.high - e.low;
    *best = c;
    best->middle = length > 0.0f ? gap_of(model, order, g, &c, e) : e.low;
  }
  return length;
}

static criterion choose(const pl_model *model, const uint32_t *order, const group *g) {
  criterion best = {0};
  const bool by_normal = g->out.spread > SPREAD_FLAT;
  if (!(longest(model, order, g, by_normal, &best) > 1e-6f))
    longest(model, order, g, !by_normal, &best);
  return best;
}

/* Moves the facets below the middle to the front; returns their number. */
static size_t partition(const pl_model *model, uint32_t *order, size_t count, const criterion *c) {
  size_t front = 0;
  for (size_t i = 0; i < count; i++) {
    const facet f = facet_of(model, order[i]);
    if (!(value_of(&f, c) < c->middle))
      continue;
    const uint32_t swap = order[front];
    order[front++] = order[i];
    order[i] = swap;
  }
  return front;
}

typedef struct groups {
  const pl_model *model;
  uint32_t *order;
  group items[PL_FACET_GROUPS];
  size_t count;
  float area[6 * CELLS * CELLS]; /* area of facets per direction cell */
} groups;

static void halve(groups *all, size_t at) {
  group *old = &all->items[at];
  uint32_t *order = all->order + old->first;
  const criterion c = choose(all->model, order, old);
  const size_t front = partition(all->model, order, old->count, &c);
  if (front == 0 || front == old->count) {
    old->cost = 0.0f;
    return;
  }
  group *added = &all->items[all->count++];
  *added = (group){.first = old->first + front, .count = old->count - front, .weight = old->weight};
  old->count = front;
  measure(all->model, all->order, old);
  measure(all->model, all->order, added);
}

static int material_of(const pl_model *model, uint32_t triangle) {
  return model->parts[model->triangle_part[triangle]].material;
}

static bool is_shiny(const pl_material *m) {
  return !m->lambert &&
         (m->roughness < SHINY_ROUGHNESS ||
          (m->layered && m->layers.coat > 0.0f && m->layers.coat_roughness < SHINY_ROUGHNESS));
}

/* Returns the cell of a direction: the face of a cube around the sphere, and the cell on that
 * face. */
static int cell_of(pl_vec3f n) {
  const float x = fabsf(n.x), y = fabsf(n.y), z = fabsf(n.z);
  const int axis = x >= y && x >= z ? 0 : y >= z ? 1 : 2;
  const float major = axis == 0 ? n.x : axis == 1 ? n.y : n.z;
  const float u = (axis == 0 ? n.y : n.x) / fabsf(major),
              v = (axis == 2 ? n.y : n.z) / fabsf(major);
  const int column = (int)(0.499f * (u + 1.0f) * CELLS), row = (int)(0.499f * (v + 1.0f) * CELLS);
  return ((2 * axis + (major < 0.0f)) * CELLS + row) * CELLS + column;
}

/* Finds the direction that most of a group's area faces; false if that area is too small. */
static bool main_direction(groups *all, const group *g, float total, pl_vec3f *out) {
  float *area = all->area;
  for (int i = 0; i < 6 * CELLS * CELLS; i++)
    area[i] = 0.0f;
  int most = 0;
  for (size_t i = 0; i < g->count; i++) {
    const facet f = facet_of(all->model, all->order[g->first + i]);
    const float size = pl_vec3f_norm(f.normal);
    if (!(size > 0.0f))
      continue;
    const int cell = cell_of(f.normal);
    area[cell] += 0.5f * size;
    most = area[cell] > area[most] ? cell : most;
  }
  pl_vec3f sum = {0.0f, 0.0f, 0.0f};
  for (size_t i = 0; i < g->count; i++) {
    const facet f = facet_of(all->model, all->order[g->first + i]);
    if (pl_vec3f_norm(f.normal) > 0.0f && cell_of(f.normal) == most)
      sum = pl_vec3f_add(sum, f.normal);
  }
  *out = pl_vec3f_unit(sum);
  return area[most] > FLAT_PART * total;
}

/* Extracts groups of facets with a common direction from a material as long as they are large; `g`
 * keeps the remaining facets. */
static void take_flats(groups *all, group *g) {
  const int most = g->weight < 1.0f ? ROUGH_FLATS : FLATS;
  measure_normals(all->model, all->order + g->first, g);
  const float total = g->out.area;
  pl_vec3f direction;
  for (int k = 0; k < most && g->count > 0 && all->count + 2 < PL_FACET_GROUPS; k++) {
    if (!main_direction(all, g, total, &direction))
      return;
    uint32_t *order = all->order + g->first;
    size_t front = 0;
    for (size_t i = 0; i < g->count; i++) {
      const facet f = facet_of(all->model, order[i]);
      if (!(pl_vec3f_dot(f.normal, direction) > FLAT_COSINE * pl_vec3f_norm(f.normal)))
        continue;
      const uint32_t swap = order[front];
      order[front++] = order[i];
      order[i] = swap;
    }
    if (front == 0)
      return;
    group *flat = &all->items[all->count++];
    *flat = (group){.first = g->first, .count = front, .weight = FLAT_WEIGHT * g->weight};
    measure(all->model, all->order, flat);
    g->first += front;
    g->count -= front;
  }
}

/* Sorts the facets by material; `start` has the first index of each material and the total
 * count. */
static void sort(const pl_model *model, size_t *start, uint32_t *order) {
  const size_t count = model->material_count;
  for (size_t m = 0; m <= count; m++)
    start[m] = 0;
  for (uint32_t t = 0; t < model->triangle_count; t++)
    start[material_of(model, t) + 1]++;
  for (size_t m = 0; m < count; m++)
    start[m + 1] += start[m];
  for (uint32_t t = 0; t < model->triangle_count; t++)
    order[start[material_of(model, t)]++] = t;
  for (size_t m = count; m > 0; m--) /* each entry has become the start of the next material */
    start[m] = start[m - 1];
  start[0] = 0;
}

/* Adds the groups of each material, glossy materials first, while there is room. */
static void add_materials(groups *all, const size_t *start) {
  const pl_model *model = all->model;
  for (int shiny = 1; shiny >= 0; shiny--)
    for (size_t m = 0; m < model->material_count; m++) {
      group g = {
          .first = start[m], .count = start[m + 1] - start[m], .weight = shiny ? 1.0f : ROUGH_COST};
      if (g.count == 0 || is_shiny(&model->materials[m]) != (shiny == 1) ||
          all->count == PL_FACET_GROUPS)
        continue;
      take_flats(all, &g);
      if (g.count == 0)
        continue;
      measure(model, all->order, &g);
      all->items[all->count++] = g;
    }
}

static void split(groups *all) {
  while (all->count < PL_FACET_GROUPS) {
    size_t worst = 0;
    for (size_t i = 1; i < all->count; i++)
      if (all->items[i].cost > all->items[worst].cost)
        worst = i;
    if (!(all->items[worst].cost > 0.0f))
      return;
    halve(all, worst);
  }
}

/* Insertion sort by area, largest first. */
static void keep(const groups *all, pl_facets *out) {
  for (size_t i = 0; i < all->count; i++) {
    size_t at = out->count++;
    for (; at > 0 && out->groups[at - 1].area < all->items[i].out.area; at--)
      out->groups[at] = out->groups[at - 1];
    out->groups[at] = all->items[i].out;
  }
}

/* Temporary memory of pl_facets_init. */
typedef struct scratch {
  groups *all;
  size_t *start;
  uint32_t *order;
  pl_facet_group *kept; /* becomes the result */
} scratch;

static pl_status allocate(const pl_model *model, scratch *s) {
  s->all = pl_alloc(1, sizeof *s->all);
  s->start = pl_alloc(model->material_count + 1, sizeof *s->start);
  s->order = pl_alloc(model->triangle_count, sizeof *s->order);
  s->kept = pl_alloc(PL_FACET_GROUPS, sizeof *s->kept);
  if (s->all != NULL && s->start != NULL && s->order != NULL && s->kept != NULL)
    return PL_OK;
  pl_free(s->kept);
  return pl_fail(PL_E_MEMORY, "out of memory for the flat places of a mesh");
}

pl_status pl_facets_init(const pl_model *model, pl_facets *out) {
  scratch s;
  *out = (pl_facets){0};
  if (model->triangle_count == 0)
    return PL_OK;
  const pl_status status = allocate(model, &s);
  if (status == PL_OK) {
    *s.all = (groups){.model = model, .order = s.order};
    sort(model, s.start, s.order);
    add_materials(s.all, s.start);
    split(s.all);
    out->groups = s.kept;
    keep(s.all, out);
  }
  pl_free(s.all);
  pl_free(s.start);
  pl_free(s.order);
  return status;
}

void pl_facets_clear(pl_facets *facets) {
  pl_free(facets->groups);
  *facets = (pl_facets){0};
}
