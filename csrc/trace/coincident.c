/* Coplanar faces are found by hashing their planes when a model is built; a hit on one of them is
 * resolved by a second, short ray. */
#include "trace/coincident.h"

#include <stdlib.h>

#include "base/hash.h"
#include "base/memory.h"
#include "shade/material_surface.h"

/* Quantisation steps of a plane's normal, and of its distance relative to the model's extent. SHIFT
 * offsets the quantisation so that faces which differ by rounding rarely fall into different cells.
 */
static const double NORMAL_STEP = 1e-3, DISTANCE_STEP = 1e-5, SHIFT = 0.3819660113;
/* Largest number of parts in a plane that are compared; with more, all of them count as
 * overlapping. */
enum { PARTS_MAX = 32 };
/* Surfaces that differ by less than this along a ray, relative to the ray length plus 1 in mesh
 * units, count as coincident. */
static const float WITHIN = 0x1p-18f;

typedef struct face {
  uint64_t plane;
  uint32_t triangle;
} face;

typedef struct range {
  uint32_t part;
  float low[3], high[3];
} range;

static double extent_of(const pl_model *model) {
  double extent = 0.0;
  for (int axis = 0; axis < 3; axis++)
    extent = fmax(extent, (double)model->bounds_max[axis] - model->bounds_min[axis]);
  return extent;
}

static const float *corner(const pl_model *model, uint32_t triangle, int k) {
  return model->positions + 3 * (size_t)model->indices[3 * (size_t)triangle + (size_t)k];
}

static pl_vec3 point_of(const float *p) { return (pl_vec3){p[0], p[1], p[2]}; }

/* Returns a key of the triangle's plane, independent of its orientation; 0 for a degenerate
 * triangle. */
static uint64_t plane_of(const pl_model *model, uint32_t triangle, double extent) {
  const pl_vec3 a = point_of(corner(model, triangle, 0));
  const pl_vec3 e1 = pl_vec3_sub(point_of(corner(model, triangle, 1)), a);
  const pl_vec3 e2 = pl_vec3_sub(point_of(corner(model, triangle, 2)), a);
  pl_vec3 n = pl_vec3_unit(pl_vec3_cross(e1, e2));
  const double sum = n.x + 1.7 * n.y + 2.9 * n.z;
  if (!(pl_vec3_dot(n, n) > 0.5))
    return 0;
  n = pl_vec3_scale(n, sum < 0.0 ? -1.0 : 1.0);
  const int64_t key[4] = {(int64_t)floor(n.x / NORMAL_STEP + SHIFT),
                          (int64_t)floor(n.y / NORMAL_STEP + SHIFT),
                          (int64_t)floor(n.z / NORMAL_STEP + SHIFT),
                          (int64_t)floor(pl_vec3_dot(n, a) / (extent * DISTANCE_STEP) + SHIFT)};
  return pl_hash(PL_HASH_SEED, key, sizeof key) | 1u;
}

static int by_plane(const void *a, const void *b) {
  const face *x = a, *y = b;
  if (x->plane != y->plane)
    return x->plane < y->plane ? -1 : 1;
  return x->triangle < y->triangle ? -1 : x->triangle > y->triangle;
}

/* Includes a margin for rounding, since a flat range has no extent along its normal. */
static range range_of(const pl_model *model, uint32_t triangle) {
  range out = {.part = model->triangle_part[triangle]};
  const float room = (float)(extent_of(model) * DISTANCE_STEP);
  for (int axis = 0; axis < 3; axis++) {
    const float a = corner(model, triangle, 0)[axis], b = corner(model, triangle, 1)[axis];
    const float c = corner(model, triangle, 2)[axis];
    out.low[axis] = pl_minf(a, pl_minf(b, c)) - room;
    out.high[axis] = pl_maxf(a, pl_maxf(b, c)) + room;
  }
  return out;
}

static void widen(range *all, const range *one) {
  for (int axis = 0; axis < 3; axis++) {
    all->low[axis] = pl_minf(all->low[axis], one->low[axis]);
    all->high[axis] = pl_maxf(all->high[axis], one->high[axis]);
  }
}

static bool touches(const range *a, const range *b) {
  for (int axis = 0; axis < 3; axis++)
    if (a->low[axis] > b->high[axis] || b->low[axis] > a->high[axis])
      return false;
  return true;
}

/* Collects the ranges of the parts in a plane. Returns their number, or PARTS_MAX + 1 if there are
 * too many. */
static size_t list_parts(const pl_model *model, const face *faces, size_t count,
                         range parts[PARTS_MAX]) {
  size_t found = 0;
  for (size_t i = 0; i < count; i++) {
    const range one = range_of(model, faces[i].triangle);
    size_t k = 0;
    while (k < found && parts[k].part != one.part)
      k++;
    if (k == PARTS_MAX)
      return PARTS_MAX + 1;
    if (k == found)
      parts[found++] = one;
    else
      widen(&parts[k], &one);
  }
  return found;
}

/* Marks the triangles of one plane that overlap another part. Returns whether there are any. */
static bool mark_plane(const pl_model *model, const face *faces, size_t count, uint8_t *marks) {
  range parts[PARTS_MAX];
  const size_t found = list_parts(model, faces, count, parts);
  bool any = false;
  for (size_t i = 0; found > 1 && i < count; i++) {
    const range one = range_of(model, faces[i].triangle);
    bool meets = found > PARTS_MAX;
    for (size_t k = 0; !meets && k < found; k++)
      meets = parts[k].part != one.part && touches(&parts[k], &one);
    marks[faces[i].triangle] = meets;
    any |= meets;
  }
  return any;
}

static bool mark_planes(const pl_model *model, face *faces, size_t count, uint8_t *marks) {
  bool any = false;
  qsort(faces, count, sizeof *faces, by_plane);
  for (size_t first = 0, next; first < count; first = next) {
    for (next = first + 1; next < count && faces[next].plane == faces[first].plane;)
      next++;
    any |= mark_plane(model, faces + first, next - first, marks);
  }
  return any;
}

pl_status pl_coincident_find(const pl_model *model, uint8_t **out) {
  void *faces, *marks;
  *out = NULL;
  if (model->part_count < 2 || model->triangle_count == 0)
    return PL_OK;
  PL_TRY(pl_alloc_or_fail(model->triangle_count, sizeof(face), "planes of a model", &faces));
  const pl_status status =
      pl_alloc_or_fail(model->triangle_count, 1, "coincident faces of a model", &marks);
  if (status != PL_OK) {
    pl_free(faces);
    return status;
  }
  const double extent = extent_of(model);
  size_t count = 0;
  for (uint32_t i = 0; extent > 0.0 && i < model->triangle_count; i++) {
    const uint64_t plane = plane_of(model, i, extent);
    ((uint8_t *)marks)[i] = 0;
    if (plane != 0)
      ((face *)faces)[count++] = (face){plane, i};
  }
  if (count > 0 && mark_planes(model, faces, count, marks))
    *out = marks;
  else
    pl_free(marks);
  pl_free(faces);
  return PL_OK;
}

/* --- hits ------------------------------------------------------------------------------------- */

typedef struct search {
  const pl_model *model;
  const uint8_t *marks;
  pl_candidate_fn counts;
  const void *context;
  pl_mesh_hit *best;
  bool *facing; /* whether the best hit faces the ray */
} search;

/* Returns whether the triangle counts as facing a ray that meets it from behind: true for
 * double-sided materials. */
static bool has_two_faces(const pl_model *model, uint32_t triangle) {
  const pl_material *material = pl_material_of(model, triangle);
  return material->double_sided && !material->dark_behind;
}

/* Returns whether a hit is preferred to the best one so far: because only it faces the ray, or
 * because its index is higher. */
static bool is_better(const search *search, uint32_t triangle, bool facing) {
  return facing != *search->facing ? facing : triangle > search->best->triangle;
}

/* Examines every candidate and rejects it, so that Embree goes on to report all of them. */
static void look(const struct RTCFilterFunctionNArguments *arguments) {
  const search *search = ((const pl_embree_query *)(const void *)arguments->context)->user;
  const unsigned n = arguments->N;
  for (unsigned i = 0; i < n; i++) {
    const uint32_t triangle = pl_embree_hit_triangle(arguments->hit, n, i);
    if (arguments->valid[i] == 0)
      continue;
    arguments->valid[i] = 0;
    const bool facing = !pl_embree_from_behind(arguments->ray, arguments->hit, n, i) ||
                        has_two_faces(search->model, triangle);
    if (!is_better(search, triangle, facing) || search->marks[triangle] == 0 ||
        !search->counts(search->context, arguments, i))
      continue;
    *search->facing = facing;
    search->best->triangle = triangle;
    search->best->u = pl_embree_hit_u(arguments->hit, n, i);
    search->best->v = pl_embree_hit_v(arguments->hit, n, i);
    search->best->t = pl_embree_ray_far(arguments->ray, n, i);
  }
}

static bool faces_ray(const pl_model *model, uint32_t triangle, pl_vec3f direction) {
  const pl_vec3 a = point_of(corner(model, triangle, 0));
  const pl_vec3 e1 = pl_vec3_sub(point_of(corner(model, triangle, 1)), a);
  const pl_vec3 e2 = pl_vec3_sub(point_of(corner(model, triangle, 2)), a);
  return has_two_faces(model, triangle) ||
         pl_vec3_dot(pl_vec3_cross(e1, e2), pl_vec3f_to_double(direction)) <= 0.0;
}

void pl_coincident_choose(const pl_instance *instance, const pl_lone_approach *at,
                          pl_candidate_fn counts, const void *context, pl_mesh_hit *hit) {
  if (instance->coincident[hit->triangle] == 0)
    return;
  const float within = WITHIN * (hit->t + 1.0f);
  struct RTCRayHit query = {.ray = {.org_x = at->origin.x,
                                    .org_y = at->origin.y,
                                    .org_z = at->origin.z,
                                    .dir_x = at->direction.x,
                                    .dir_y = at->direction.y,
                                    .dir_z = at->direction.z,
                                    .tnear = pl_maxf(hit->t - within, 0.0f),
                                    .tfar = hit->t + within,
                                    .mask = UINT32_MAX}};
  query.hit.geomID = query.hit.instID[0] = RTC_INVALID_GEOMETRY_ID;
  bool facing = faces_ray(instance->model, hit->triangle, at->direction);
  const search search = {instance->model, instance->coincident, counts, context, hit, &facing};
  pl_embree_query way = {.filter = look, .user = &search};
  pl_embree_intersect1(instance->scene, &way, &query);
}
