/* Planes are found by hashing when a model is built; hits are settled by a second, short ray. */
#include "trace/coincident.h"

#include <stdlib.h>

#include "base/hash.h"
#include "base/memory.h"

/* Steps of a plane's normal and, over the model's extent, of its distance: faces within rounding of
 * each other rarely part on one. */
static const double NORMAL_STEP = 1e-3, DISTANCE_STEP = 1e-5, SHIFT = 0.3819660113;
/* Parts of a plane that are told apart; of more, all count as overlapping. */
enum { PARTS_MAX = 32 };
/* Surfaces so near along a ray, over its length and the object's size, are one: faces that lie in
 * one plane of a model, where rounding of the plane counts too, and any of two objects, each of
 * which rounds by a few units in the last place. */
static const float WITHIN_MODEL = 0x1p-18f, WITHIN_OBJECTS = 0x1p-20f;

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

/* A key of the triangle's plane, whichever way it faces; 0 of a sliver. */
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

/* With room for rounding: a flat range has no depth of its own. */
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

/* The ranges of the parts in a plane; PARTS_MAX + 1 for too many. */
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

/* Marks the triangles of one plane; returns whether there are any. */
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
  const pl_tracer *tracer;
  pl_candidate_fn counts;
  const void *context;
  float from, to;  /* distances between which surfaces of two objects are one */
  uint32_t first;  /* object that was hit */
  uint32_t object; /* of the best */
  pl_hit *best;    /* names an instance */
} search;

/* Of the same object later triangles of coincident planes, of two objects the later one. Where two
 * triangles of a later object are met, as on their edge, the nearer. */
static bool is_better(const search *search, uint32_t instance, uint32_t object, uint32_t triangle,
                      float t) {
  const pl_hit *best = search->best;
  if (instance == best->thing) {
    const uint8_t *marks = search->tracer->instances[instance].coincident;
    if (marks != NULL && marks[triangle] != 0 && marks[best->triangle] != 0)
      return triangle > best->triangle;
  }
  if (object == search->first || t < search->from || t > search->to)
    return false;
  return object > search->object || (object == search->object && t < best->t);
}

/* Looks at every candidate and takes none, so that Embree shows them all. */
static void look(const struct RTCFilterFunctionNArguments *arguments) {
  const void *user = ((const pl_embree_query *)(const void *)arguments->context)->user;
  search *search = (void *)(uintptr_t)user;
  const unsigned n = arguments->N;
  for (unsigned i = 0; i < n; i++) {
    if (arguments->valid[i] == 0)
      continue;
    arguments->valid[i] = 0;
    const uint32_t instance = pl_embree_hit_instance(arguments->hit, n, i);
    const uint32_t triangle = pl_embree_hit_triangle(arguments->hit, n, i);
    const float t = pl_embree_ray_far(arguments->ray, n, i);
    uint32_t object = instance, whole = triangle;
    pl_tracer_name_owner(search->tracer, &object, &whole);
    if (!is_better(search, instance, object, triangle, t) ||
        !search->counts(search->context, arguments, i))
      continue;
    search->object = object;
    *search->best = (pl_hit){instance, triangle, t, pl_embree_hit_u(arguments->hit, n, i),
                             pl_embree_hit_v(arguments->hit, n, i)};
  }
}

/* Whether a later object may have a surface where the ray meets this one's. */
static bool meets_later(const pl_tracer *tracer, uint32_t object, const pl_ray *ray, float t,
                        float within) {
  const pl_snapshot *shot = tracer->snapshot;
  const pl_vec3f p = pl_vec3f_madd(ray->origin, t, ray->direction);
  for (size_t k = object + 1; k < shot->object_count; k++) {
    const pl_shot_object *later = &shot->objects[k];
    if (later->kept && pl_vec3_norm(pl_vec3_sub(pl_vec3f_to_double(p), later->center)) <=
                           later->radius_m + (double)within)
      return true;
  }
  return false;
}

void pl_coincident_settle(const pl_tracer *tracer, const pl_ray *ray, pl_candidate_fn counts,
                          const void *context, pl_hit *hit) {
  const pl_instance *instance = &tracer->instances[hit->thing];
  uint32_t object = hit->thing, triangle = hit->triangle;
  pl_tracer_name_owner(tracer, &object, &triangle);
  const float size = (float)instance->radius_m;
  const float between = WITHIN_OBJECTS * (hit->t + size);
  const bool marked = instance->coincident != NULL && instance->coincident[hit->triangle] != 0;
  if (!marked &&
      !(tracer->instances[object].overlapped && meets_later(tracer, object, ray, hit->t, between)))
    return;
  const float within = marked ? WITHIN_MODEL * (hit->t + size) : between;
  struct RTCRayHit query = {.ray = {.org_x = ray->origin.x,
                                    .org_y = ray->origin.y,
                                    .org_z = ray->origin.z,
                                    .dir_x = ray->direction.x,
                                    .dir_y = ray->direction.y,
                                    .dir_z = ray->direction.z,
                                    .tnear = pl_maxf(hit->t - within, 0.0f),
                                    .tfar = hit->t + within,
                                    .mask = UINT32_MAX}};
  query.hit.geomID = query.hit.instID[0] = RTC_INVALID_GEOMETRY_ID;
  search search = {.tracer = tracer,
                   .counts = counts,
                   .context = context,
                   .from = hit->t - between,
                   .to = hit->t + between,
                   .first = object,
                   .object = object,
                   .best = hit};
  pl_embree_query way = {.filter = look, .user = &search};
  pl_embree_intersect1(tracer->top, &way, &query);
}
