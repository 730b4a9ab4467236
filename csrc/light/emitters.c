/* Light sampling of emitters. An emitter is chosen in proportion to power over squared distance. On
 * a mesh, a triangle is chosen in proportion to its power, then a point uniformly by area. On a
 * body, a direction is sampled in the cone of its bounding sphere. */
#include "light/emitters.h"

#include "geom/ellipsoid.h"
#include "light/graph_light.h"
#include "math/color.h"
#include "math/sampling.h"
#include "scene/graph_point.h"
#include "scene/shot_frame.h"
#include "shade/material_surface.h"

/* Smallest mean of an emission map that is assumed, as a fraction of its factor, so that a bright
 * spot on a black map has a positive sampling probability. */
static const float MEAN_MIN = 1e-3f;

/* --- the list --------------------------------------------------------------------------------- */

/* The graph that sets the emission of a triangle, or NULL. */
static const pl_object_graph *graph_of(const pl_object *object, uint32_t triangle) {
  const pl_object_graph *graph = pl_object_materials_at(object->materials, triangle);
  return graph != NULL && pl_graph_sets_emission(graph->graph) ? graph : NULL;
}

/* Luminance of the material's emission factor; the map can only reduce it. */
static float factor_of(const pl_object *object, uint32_t triangle) {
  const float *e = pl_material_of(object->model, triangle)->emissive;
  return pl_luminance(pl_vec3f_make(e[0], e[1], e[2]));
}

static bool may_emit(const pl_object *object, uint32_t triangle) {
  const pl_object_graph *graph = graph_of(object, triangle);
  return graph != NULL ? pl_graph_emits(graph->graph) : factor_of(object, triangle) > 0.0f;
}

/* Estimated mean luminance of a triangle that may emit light. */
static float luminance_of(const pl_shot_object *shot, uint32_t triangle, pl_detail detail) {
  const pl_object *object = shot->object;
  const pl_object_graph *graph = graph_of(object, triangle);
  if (graph != NULL)
    return pl_graph_light_luminance(shot, triangle, graph, detail);
  const pl_triangle_point any = {.triangle = triangle};
  const pl_detail none = {.maps = false};
  return pl_maxf(pl_luminance(pl_material_emission(object->model, &any, none)),
                 MEAN_MIN * factor_of(object, triangle));
}

typedef struct corners {
  pl_vec3 a; /* m, view axes */
  pl_vec3f edge1, edge2;
  pl_vec3f normal; /* outwards; its length is twice the area */
} corners;

static corners corners_of(const pl_shot_object *object, uint32_t triangle) {
  const pl_model *model = object->object->model;
  const uint32_t *index = model->indices + 3 * (size_t)triangle;
  const pl_shot_piece *piece = pl_shot_piece_of(object, triangle);
  const float *m = piece != NULL ? piece->to_view : object->to_view;
  const float *first = model->positions + 3 * (size_t)index[0];
  corners out;
  out.a = pl_shot_corner(object, piece, first);
  out.edge1 = pl_shot_edge(m, first, model->positions + 3 * (size_t)index[1]);
  out.edge2 = pl_shot_edge(m, first, model->positions + 3 * (size_t)index[2]);
  out.normal = pl_vec3f_cross(out.edge1, out.edge2);
  if (piece != NULL) /* a part that is not present emits nothing */
    out.normal = pl_vec3f_scale(out.normal, piece->present ? piece->side : 0.0f);
  return out;
}

/* Uniform emission of a body. If a graph varies the emission over the body, the camera sees it, but
 * it is not sampled as a light: only random paths hit it. */
static pl_vec3f body_emission(const pl_shot_body *body) {
  static const pl_graph_point nowhere = {.radius = INFINITY};
  const float *e = body->state->emission;
  const pl_graph *graph = body->body->graph;
  if (graph == NULL || !pl_graph_sets_emission(graph))
    return pl_vec3f_make(e[0], e[1], e[2]);
  if (!pl_graph_emits(graph) || !pl_graph_emits_evenly(graph))
    return pl_vec3f_make(0.0f, 0.0f, 0.0f);
  return pl_graph_emission(graph, &nowhere, body->state->parameters);
}

/* Luminance of all triangles of a body's shape model; 0 for objects that are not the shape of a
 * body. */
static float shape_luminance(const pl_snapshot *shot, const pl_shot_object *object) {
  const int body = object->object->body;
  return body < 0 ? 0.0f : pl_luminance(body_emission(&shot->bodies[body]));
}

static bool emits(const pl_snapshot *shot, const pl_shot_object *object) {
  return object->kept &&
         (object->object->summary.emission_max > 0.0 || shape_luminance(shot, object) > 0.0f);
}

static size_t count_triangles(const pl_snapshot *shot) {
  size_t count = 0;
  for (size_t i = 0; i < shot->object_count; i++) {
    const pl_object *object = shot->objects[i].object;
    if (!emits(shot, &shot->objects[i]))
      continue;
    for (uint32_t t = 0; t < object->model->triangle_count; t++)
      count += object->body >= 0 || may_emit(object, t);
  }
  return count;
}

/* Appends an object's emissive triangles after the first `used` ones. */
static void add_object(pl_emitters *list, size_t index, size_t *used) {
  const pl_shot_object *object = &list->shot->objects[index];
  const pl_model *model = object->object->model;
  pl_emitter item = {.surface_id = object->id,
                     .center = object->center,
                     .radius_m = object->radius_m,
                     .first = *used};
  const bool shape = object->object->body >= 0;
  const float even = shape_luminance(list->shot, object);
  for (uint32_t t = 0; t < model->triangle_count; t++) {
    if (!shape && !may_emit(object->object, t))
      continue;
    const float luminance = shape ? even : luminance_of(object, t, list->detail);
    if (!(luminance > 0.0f))
      continue;
    const corners c = corners_of(object, t);
    item.weight += 0.5 * (double)luminance * (double)pl_vec3f_norm(c.normal);
    list->triangles[*used] = t;
    list->luminances[*used] = luminance;
    list->sums[(*used)++] = (float)item.weight;
  }
  item.count = *used - item.first;
  if (!(item.weight > 0.0))
    return;
  for (size_t i = item.first; i < *used; i++)
    list->sums[i] = (float)((double)list->sums[i] / item.weight);
  item.power = 0.5 * item.weight;
  list->items[list->count++] = item;
}

static void add_body(pl_emitters *list, size_t index) {
  const pl_shot_body *body = &list->shot->bodies[index];
  const double luminance = (double)pl_luminance(body_emission(body));
  if (luminance > 0.0)
    list->items[list->count++] =
        (pl_emitter){.surface_id = pl_surface_of_body(index),
                     .center = body->center,
                     .radius_m = body->radius_m,
                     .power = luminance * PL_PI * body->radius_m * body->radius_m};
}

pl_status pl_emitters_build(const pl_snapshot *shot, pl_detail detail, pl_arena *arena,
                            pl_emitters *out) {
  const size_t triangles = count_triangles(shot);
  size_t used = 0;
  *out = (pl_emitters){
      .shot = shot,
      .detail = detail,
      .items = pl_arena_alloc(arena, shot->object_count + shot->body_count, sizeof(pl_emitter)),
      .triangles = pl_arena_alloc(arena, triangles, sizeof(uint32_t)),
      .luminances = pl_arena_alloc(arena, triangles, sizeof(float)),
      .sums = pl_arena_alloc(arena, triangles, sizeof(float)),
  };
  if (out->items == NULL || out->triangles == NULL || out->luminances == NULL || out->sums == NULL)
    return pl_fail(PL_E_MEMORY, "out of memory for emissive surfaces");
  for (size_t i = 0; i < shot->object_count; i++)
    if (emits(shot, &shot->objects[i]))
      add_object(out, i, &used);
  for (size_t i = 0; i < shot->body_count; i++)
    if (pl_shot_is_smooth(&shot->bodies[i])) /* light of terrain is found by chance */
      add_body(out, i);
  return PL_OK;
}

/* --- selection -------------------------------------------------------------------------------- */

/* Selection weight of an emitter at a point. Inside the bounding sphere it is the value at the
 * sphere. */
static double importance(const pl_emitter *item, pl_vec3 point) {
  const pl_vec3 offset = pl_vec3_sub(item->center, point);
  return item->power / fmax(pl_vec3_dot(offset, offset), item->radius_m * item->radius_m);
}

static double total_importance(const pl_emitters *list, pl_vec3 point) {
  double sum = 0.0;
  for (size_t i = 0; i < list->count; i++)
    sum += importance(&list->items[i], point);
  return sum;
}

/* Chooses an emitter and rescales the position of *u within the emitter's interval to [0, 1), so
 * that the stratification of the sample carries over to the point on the emitter. */
static const pl_emitter *choose(const pl_emitters *list, pl_vec3 point, float *u,
                                double *probability) {
  const double total = total_importance(list, point);
  double left = (double)*u * total, drawn = importance(&list->items[0], point);
  size_t i = 0;
  while (i + 1 < list->count && left >= drawn) {
    left -= drawn;
    drawn = importance(&list->items[++i], point);
  }
  *probability = drawn / total;
  *u = pl_minf((float)(left / drawn), 1.0f - 0x1p-24f);
  return &list->items[i];
}

/* Index in the list of the triangle whose interval of the emitter's cumulative weight contains *u.
 * Rescales *u to [0, 1) within that interval. */
static size_t choose_triangle(const pl_emitters *list, const pl_emitter *item, float *u) {
  size_t low = item->first, high = item->first + item->count - 1;
  while (low < high) {
    const size_t middle = low + (high - low) / 2;
    if (*u < list->sums[middle])
      high = middle;
    else
      low = middle + 1;
  }
  const float from = low > item->first ? list->sums[low - 1] : 0.0f, to = list->sums[low];
  *u = to > from ? pl_minf(pl_maxf((*u - from) / (to - from), 0.0f), 1.0f - 0x1p-24f) : 0.5f;
  return low;
}

/* Mean luminance of a triangle of the object; 0 if the triangle is not in the list. */
static float listed_luminance(const pl_emitters *list, const pl_emitter *item, uint32_t triangle) {
  size_t low = item->first, high = item->first + item->count;
  while (low < high) {
    const size_t middle = low + (high - low) / 2;
    if (list->triangles[middle] < triangle)
      low = middle + 1;
    else
      high = middle;
  }
  const bool found = low < item->first + item->count && list->triangles[low] == triangle;
  return found ? list->luminances[low] : 0.0f;
}

/* --- sampling --------------------------------------------------------------------------------- */

/* Probability density per solid angle of a point sampled by power over a mesh. */
static double mesh_pdf(const pl_emitter *item, float luminance, double distance, double cosine) {
  return (double)luminance / item->weight * distance * distance / cosine;
}

static bool sample_mesh(const pl_emitters *list, const pl_emitter *item, pl_vec3 point,
                        const float u[2], pl_emitter_sample *out) {
  const pl_shot_object *object = pl_shot_object_of(list->shot, item->surface_id);
  const pl_model *model = object->object->model;
  float along = u[0];
  const size_t chosen = choose_triangle(list, item, &along);
  const uint32_t triangle = list->triangles[chosen];
  const corners c = corners_of(object, triangle);
  /* Uniform over the triangle (Shirley and Chiu 1997, with the square root of one number). */
  const float root = sqrtf(along), v = root * u[1], w = 1.0f - root;
  const pl_vec3f off = pl_vec3f_madd(pl_vec3f_scale(c.edge1, v), w, c.edge2);
  const pl_vec3 at = pl_vec3_add(c.a, pl_vec3f_to_double(off));
  const pl_vec3 way = pl_vec3_sub(at, point);
  const double distance = pl_vec3_norm(way);
  out->direction = pl_vec3_to_float(pl_vec3_unit(way));
  const float facing = -pl_vec3f_dot(out->direction, pl_vec3f_unit(c.normal));
  const bool both =
      pl_back_is_there(model, triangle) && !pl_material_of(model, triangle)->dark_behind;
  const float cosine = both ? fabsf(facing) : facing;
  /* Vertex positions have rounding errors of a few ulp of the mesh's size. */
  out->distance_m =
      distance - fmin(1e-4 * distance, 1e-4 * item->radius_m) - 0x1p-18 * item->radius_m;
  if (!(cosine > 1e-6f) || !(out->distance_m > 0.0))
    return false;
  out->pdf = (float)mesh_pdf(item, list->luminances[chosen], distance, (double)cosine);
  if (object->object->body >= 0) {
    out->radiance = body_emission(&list->shot->bodies[object->object->body]);
    return true;
  }
  const pl_triangle_point hit = {
      .triangle = triangle, .w = {1.0f - v - w, v, w}, .edge1 = c.edge1, .edge2 = c.edge2};
  if (pl_material_opacity(model, &hit) < 0.5f)
    return false;
  const pl_object_graph *graph = graph_of(object->object, triangle);
  if (!pl_shot_is_there(object, triangle, v, w, out->direction))
    return false;
  out->radiance = graph != NULL
                      ? pl_graph_light_radiance(object, triangle, hit.w, graph, list->detail,
                                                pl_vec3f_scale(out->direction, -1.0f))
                      : pl_material_emission(model, &hit, list->detail);
  return true;
}

/* 1 - cos of the half angle of the cone that encloses a body. 2 (all directions) from inside its
 * bounding sphere. */
static float cone_of(const pl_emitter *item, pl_vec3 point, pl_vec3 *axis) {
  const pl_vec3 way = pl_vec3_sub(item->center, point);
  const double sine = item->radius_m / pl_vec3_norm(way);
  *axis = pl_vec3_unit(way);
  if (!(sine < 1.0))
    return 2.0f;
  return (float)(sine * sine / (1.0 + sqrt(1.0 - sine * sine)));
}

static bool sample_body(const pl_emitters *list, const pl_emitter *item, pl_vec3 point,
                        const float u[2], pl_emitter_sample *out) {
  const pl_shot_body *body = pl_shot_body_of(list->shot, item->surface_id);
  pl_vec3 axis;
  const float cone = cone_of(item, point, &axis);
  const pl_basis basis = pl_basis_make(pl_vec3_to_float(axis));
  out->direction = pl_basis_to_world(&basis, pl_sample_cone(u[0], u[1], cone));
  const pl_vec3 local = pl_vec3_add(body->camera, pl_mat3_mul_vec_t(body->rotation, point));
  const pl_vec3 ray =
      pl_mat3_mul_vec_t(body->rotation, pl_vec3_unit(pl_vec3f_to_double(out->direction)));
  double t;
  if (!pl_ellipsoid_intersect(body->state->radii_m, local, ray, 0.0, &t))
    return false;
  out->radiance = body_emission(body);
  out->distance_m = t * 0.99999;
  out->pdf = pl_cone_pdf(cone);
  return true;
}

bool pl_emitters_sample(const pl_emitters *list, pl_vec3 point, const float u[2],
                        pl_emitter_sample *out) {
  if (list->count == 0)
    return false;
  double probability;
  float v[2] = {u[0], u[1]};
  const pl_emitter *item = choose(list, point, &v[1], &probability);
  const bool found = pl_surface_is_mesh(item->surface_id) ? sample_mesh(list, item, point, v, out)
                                                          : sample_body(list, item, point, v, out);
  if (!found)
    return false;
  out->surface_id = item->surface_id;
  out->pdf = (float)((double)out->pdf * probability);
  return out->pdf > 0.0f;
}

float pl_emitters_pdf(const pl_emitters *list, pl_vec3 point, const pl_emitter_hit *hit) {
  for (size_t i = 0; i < list->count; i++) {
    const pl_emitter *item = &list->items[i];
    if (!pl_surface_same(item->surface_id, hit->surface_id))
      continue;
    const double probability = importance(item, point) / total_importance(list, point);
    pl_vec3 axis;
    if (pl_surface_is_ellipsoid(hit->surface_id))
      return (float)(probability * (double)pl_cone_pdf(cone_of(item, point, &axis)));
    const float luminance = listed_luminance(list, item, hit->triangle);
    if (!(luminance > 0.0f) || !(hit->cosine > 1e-6f))
      return 0.0f;
    return (float)(probability * mesh_pdf(item, luminance, hit->t, (double)hit->cosine));
  }
  return 0.0f;
}
