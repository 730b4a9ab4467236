/* Corners are sorted by position and normal. Groups of faces at a vertex are found by union-find
 * over corners that share an edge. */
#include "geom/crease.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "base/memory.h"
#include "math/angle.h"

/* A corner of a triangle, with the values that identify its vertex. */
typedef struct corner {
  float key[6];   /* position, then normal */
  uint32_t index; /* 3 * triangle + k */
  uint32_t place; /* index of the position, equal for all corners at that position */
} corner;

/* A corner that gets a new vertex. */
typedef struct change {
  uint32_t vertex, group, index; /* group: index within its position; index: that of the corner */
  float normal[3];
} change;

/* Input and shared scratch memory of all steps. */
typedef struct creases {
  const pl_model *model;
  /* cosine of the largest angle between the normals of adjacent faces of a smooth edge */
  double least_cosine;
  double
      /* cosine of half that angle: where two faces meet at more, every normal deviates by more from
         one of them */
      lean_cosine;
  pl_vec3 *faces;   /* unit normals of triangles; zero for degenerate triangles */
  corner *corners;  /* sorted by key */
  uint32_t *places; /* position index of each corner, by corner index */
  change *changes;  /* at most one per corner */
  size_t change_count, split;
} creases;

static pl_vec3 position(const pl_model *model, uint32_t index) {
  const float *p = model->positions + 3 * (size_t)model->indices[index];
  return (pl_vec3){p[0], p[1], p[2]};
}

static uint32_t next_corner(uint32_t index, uint32_t by) {
  return index - index % 3 + (index + by) % 3;
}

static pl_vec3 face_normal(const pl_model *model, uint32_t triangle) {
  const pl_vec3 a = position(model, 3 * triangle);
  return pl_vec3_unit(pl_vec3_cross(pl_vec3_sub(position(model, 3 * triangle + 1), a),
                                    pl_vec3_sub(position(model, 3 * triangle + 2), a)));
}

static bool has_normal(pl_vec3 face) { return pl_vec3_dot(face, face) > 0.5; }

/* Returns true if the normal of a corner deviates from its face normal by more than half the crease
 * angle. Where faces meet at more than the crease angle this holds for at least one of them. The
 * sign is ignored, since winding and normals may disagree. */
static bool leans(const creases *c, uint32_t index) {
  const float *n = c->model->normals + 3 * (size_t)c->model->indices[index];
  const pl_vec3 face = c->faces[index / 3];
  return has_normal(face) && fabs(pl_vec3_dot(face, (pl_vec3){n[0], n[1], n[2]})) < c->lean_cosine;
}

static bool may_have_creases(const creases *c) {
  for (uint32_t i = 0; i < 3 * c->model->triangle_count; i++)
    if (leans(c, i))
      return true;
  return false;
}

static int compare_floats(const float *a, const float *b, int count) {
  for (int k = 0; k < count; k++)
    if (a[k] != b[k])
      return a[k] < b[k] ? -1 : 1;
  return 0;
}

static int by_key(const void *a, const void *b) {
  const corner *x = a, *y = b;
  const int order = compare_floats(x->key, y->key, 6);
  return order != 0 ? order : x->index < y->index ? -1 : 1;
}

static void sort_corners(creases *c) {
  const size_t count = 3 * c->model->triangle_count;
  for (uint32_t i = 0; i < count; i++) {
    corner *out = &c->corners[i];
    memcpy(out->key, c->model->positions + 3 * (size_t)c->model->indices[i], 3 * sizeof(float));
    memcpy(out->key + 3, c->model->normals + 3 * (size_t)c->model->indices[i], 3 * sizeof(float));
    out->index = i;
  }
  qsort(c->corners, count, sizeof *c->corners, by_key);
  uint32_t place = 0;
  for (size_t i = 0; i < count; i++) {
    place += i > 0 && compare_floats(c->corners[i].key, c->corners[i - 1].key, 3) != 0;
    c->corners[i].place = place;
    c->places[c->corners[i].index] = place;
  }
}

/* --- faces at one vertex ---------------------------------------------------------------------- */

enum { EDGE_FACES = 8 };

/* An edge of a face from the vertex to another position. */
typedef struct spoke {
  uint32_t to, face; /* face: index within the faces at the vertex */
  uint32_t before;   /* 1: the face traverses the edge towards the vertex */
} spoke;

static int by_end(const void *a, const void *b) {
  const spoke *x = a, *y = b;
  if (x->to != y->to)
    return x->to < y->to ? -1 : 1;
  return x->face < y->face ? -1 : x->face > y->face;
}

static uint32_t root_of(uint32_t *parents, uint32_t i) {
  while (parents[i] != i)
    i = parents[i] = parents[parents[i]];
  return i;
}

/* Returns the cosine of the angle between the normals of two faces that share an edge. Faces of
 * consistent winding traverse the edge in opposite directions; otherwise one of them is treated as
 * flipped (*turned). */
static double cosine_over(const creases *c, const corner *at, const spoke *a, const spoke *b,
                          bool *turned) {
  const double cosine =
      pl_vec3_dot(c->faces[at[a->face].index / 3], c->faces[at[b->face].index / 3]);
  *turned = a->before == b->before;
  return *turned ? -cosine : cosine;
}

/* Joins faces at the vertex that share an edge of at most the crease angle. *turned: some of them
 * have opposite windings. At edges with more than two faces, only faces that are consecutive in the
 * file are compared. */
static void join_faces(const creases *c, const corner *at, spoke *spokes, uint32_t count,
                       uint32_t *parents, bool *turned) {
  for (uint32_t i = 0; i < count; i++) {
    parents[i] = i;
    for (uint32_t k = 0; k < 2; k++)
      spokes[2 * i + k] = (spoke){c->places[next_corner(at[i].index, 1 + k)], i, k};
  }
  qsort(spokes, 2 * (size_t)count, sizeof *spokes, by_end);
  for (uint32_t i = 0; i < 2 * count; i++)
    for (uint32_t k = i + 1; k < 2 * count && k < i + EDGE_FACES && spokes[k].to == spokes[i].to;
         k++) {
      bool opposite;
      const uint32_t a = spokes[i].face, b = spokes[k].face;
      if (!has_normal(c->faces[at[a].index / 3]) || !has_normal(c->faces[at[b].index / 3]) ||
          cosine_over(c, at, &spokes[i], &spokes[k], &opposite) < c->least_cosine)
        continue;
      *turned |= opposite;
      parents[root_of(parents, a)] = root_of(parents, b);
    }
}

static double angle_at(const pl_model *model, uint32_t index) {
  const pl_vec3 p = position(model, index);
  return pl_vec3_angle(pl_vec3_sub(position(model, next_corner(index, 1)), p),
                       pl_vec3_sub(position(model, next_corner(index, 2)), p));
}

/* Mean normal of the faces joined to `first`, flipped to the side of the vertex normal. */
static pl_vec3 mean_of(const creases *c, const corner *at, uint32_t count, uint32_t *parents,
                       uint32_t first, bool turned) {
  const pl_vec3 own = {at[0].key[3], at[0].key[4], at[0].key[5]};
  const pl_vec3 to = c->faces[at[first].index / 3];
  pl_vec3 sum = {0.0, 0.0, 0.0};
  for (uint32_t i = first; i < count; i++) {
    const pl_vec3 face = c->faces[at[i].index / 3];
    const double side = turned && pl_vec3_dot(face, to) < 0.0 ? -1.0 : 1.0;
    if (root_of(parents, i) == first && has_normal(face))
      sum = pl_vec3_madd(sum, side * angle_at(c->model, at[i].index), face);
  }
  sum = pl_vec3_norm(sum) > 1e-9 ? pl_vec3_unit(sum) : to;
  return pl_vec3_dot(sum, own) < 0.0 ? pl_vec3_scale(sum, -1.0) : sum;
}

/* Makes the first face of each group its root. Returns the number of groups with a normal. */
static uint32_t order_groups(const creases *c, const corner *at, uint32_t count,
                             uint32_t *parents) {
  uint32_t groups = 0;
  for (uint32_t i = 0; i < count; i++) {
    const uint32_t root = root_of(parents, i);
    if (root > i) { /* i is the first face of its group */
      parents[root] = i;
      parents[i] = i;
    }
    groups += parents[i] == i && has_normal(c->faces[at[i].index / 3]);
  }
  return groups;
}

/* Splits a vertex: `count` corners with the same position and normal. `spokes` has room for two per
 * corner, `parents` for one per corner. */
static void split_vertex(creases *c, const corner *at, uint32_t count, spoke *spokes,
                         uint32_t *parents) {
  bool turned = false, any = false;
  for (uint32_t i = 0; i < count && !any; i++)
    any = leans(c, at[i].index);
  if (!any)
    return;
  join_faces(c, at, spokes, count, parents, &turned);
  if (order_groups(c, at, count, parents) < 2)
    return;
  c->split++;
  for (uint32_t i = 0; i < count; i++) {
    if (root_of(parents, i) != i || !has_normal(c->faces[at[i].index / 3]))
      continue;
    const pl_vec3 mean = mean_of(c, at, count, parents, i, turned);
    for (uint32_t k = i; k < count; k++)
      if (root_of(parents, k) == i)
        c->changes[c->change_count++] = (change){c->model->indices[at[k].index],
                                                 i,
                                                 at[k].index,
                                                 {(float)mean.x, (float)mean.y, (float)mean.z}};
  }
}

static pl_status split_vertices(creases *c) {
  const size_t count = 3 * c->model->triangle_count;
  size_t most = 0;
  for (size_t i = 0, end; i < count; i = end) {
    for (end = i + 1;
         end < count && compare_floats(c->corners[i].key, c->corners[end].key, 6) == 0;)
      end++;
    most = end - i > most ? end - i : most;
  }
  void *spokes = NULL, *parents = NULL;
  pl_status status = pl_alloc_or_fail(2 * most, sizeof(spoke), "edges of a model", &spokes);
  if (status == PL_OK)
    status = pl_alloc_or_fail(most, sizeof(uint32_t), "edges of a model", &parents);
  for (size_t i = 0, end; status == PL_OK && i < count; i = end) {
    for (end = i + 1;
         end < count && compare_floats(c->corners[i].key, c->corners[end].key, 6) == 0;)
      end++;
    split_vertex(c, c->corners + i, (uint32_t)(end - i), spokes, parents);
  }
  pl_free(spokes);
  pl_free(parents);
  return status;
}

/* --- model ------------------------------------------------------------------------------------ */

static int by_vertex(const void *a, const void *b) {
  const change *x = a, *y = b;
  if (x->vertex != y->vertex)
    return x->vertex < y->vertex ? -1 : 1;
  if (x->group != y->group)
    return x->group < y->group ? -1 : 1;
  return x->index < y->index ? -1 : x->index > y->index;
}

/* Returns true if a change starts a new vertex, i.e. the change before it has another vertex or
 * group. */
static bool begins(const change *changes, size_t i) {
  return i == 0 || changes[i].vertex != changes[i - 1].vertex ||
         changes[i].group != changes[i - 1].group;
}

/* Returns true if the new vertex must be appended, because another group keeps the original one. */
static bool is_further(const change *changes, size_t i) {
  return i > 0 && begins(changes, i) && changes[i].vertex == changes[i - 1].vertex;
}

/* Grows an array of `width` floats per vertex; NULL arrays stay NULL. */
static pl_status widen(float **values, size_t vertices, size_t width) {
  if (*values == NULL)
    return PL_OK;
  float *grown = pl_realloc(*values, vertices * width, sizeof **values);
  if (grown == NULL)
    return pl_fail(PL_E_MEMORY, "out of memory for vertices");
  *values = grown;
  return PL_OK;
}

static void copy_vertex(float *values, size_t from, size_t to, size_t width) {
  if (values != NULL)
    memcpy(values + to * width, values + from * width, width * sizeof *values);
}

static pl_status apply(pl_model *model, const change *changes, size_t count) {
  size_t total = model->vertex_count;
  for (size_t i = 0; i < count; i++)
    total += is_further(changes, i);
  if (total > UINT32_MAX)
    return pl_fail(PL_E_RANGE, "a model with more than %u vertices", UINT32_MAX);
  float **const arrays[] = {&model->positions, &model->normals, &model->tangents,
                            &model->uvs[0],    &model->uvs[1],  &model->colors};
  static const size_t widths[] = {3, 3, 4, 2, 2, 4};
  enum { ARRAYS = sizeof widths / sizeof *widths };
  for (size_t k = 0; k < ARRAYS; k++)
    PL_TRY(widen(arrays[k], total, widths[k]));
  uint32_t vertex = 0;
  for (size_t i = 0; i < count; i++) {
    if (is_further(changes, i)) {
      vertex = (uint32_t)model->vertex_count++;
      for (size_t k = 0; k < ARRAYS; k++)
        copy_vertex(*arrays[k], changes[i].vertex, vertex, widths[k]);
    } else if (begins(changes, i)) {
      vertex = changes[i].vertex;
    }
    memcpy(model->normals + 3 * (size_t)vertex, changes[i].normal, sizeof changes[i].normal);
    model->indices[changes[i].index] = vertex;
  }
  return PL_OK;
}

static pl_status tell(pl_model *model, size_t split, double angle_rad) {
  char line[160];
  snprintf(line, sizeof line,
           "%s%zu vertices have one normal for faces that meet at more than %.4g degrees: split "
           "(crease_angle_deg)",
           model->warnings[0] != '\0' ? "\n" : "", split, angle_rad * 180.0 / PL_PI);
  const size_t before = strlen(model->warnings), more = strlen(line) + 1;
  char *grown = pl_realloc(model->warnings, before + more, 1);
  if (grown == NULL)
    return pl_fail(PL_E_MEMORY, "out of memory for a model's warnings");
  memcpy(grown + before, line, more);
  model->warnings = grown;
  return PL_OK;
}

static pl_status allocate(creases *c) {
  const size_t triangles = c->model->triangle_count;
  PL_TRY(pl_alloc_or_fail(3 * triangles, sizeof(corner), "corners", (void **)&c->corners));
  PL_TRY(pl_alloc_or_fail(3 * triangles, sizeof(uint32_t), "corners", (void **)&c->places));
  return pl_alloc_or_fail(3 * triangles, sizeof(change), "corners", (void **)&c->changes);
}

static pl_status find_changes(creases *c) {
  PL_TRY(allocate(c));
  sort_corners(c);
  PL_TRY(split_vertices(c));
  if (c->change_count > 0)
    qsort(c->changes, c->change_count, sizeof *c->changes, by_vertex);
  return PL_OK;
}

pl_status pl_model_crease(pl_model *model, double angle_rad, size_t *split) {
  creases c = {.model = model, .least_cosine = cos(angle_rad), .lean_cosine = cos(0.5 * angle_rad)};
  *split = 0;
  if (!(angle_rad < PL_PI) || model->triangle_count == 0)
    return PL_OK;
  PL_TRY(pl_alloc_or_fail(model->triangle_count, sizeof(pl_vec3), "faces", (void **)&c.faces));
  for (uint32_t t = 0; t < model->triangle_count; t++)
    c.faces[t] = face_normal(model, t);
  pl_status status = PL_OK;
  if (may_have_creases(&c)) {
    status = find_changes(&c);
    if (status == PL_OK)
      status = apply(model, c.changes, c.change_count);
    if (status == PL_OK && c.split > 0)
      status = tell(model, c.split, angle_rad);
    *split = status == PL_OK ? c.split : 0;
  }
  pl_free(c.faces);
  pl_free(c.corners);
  pl_free(c.places);
  pl_free(c.changes);
  return status;
}
