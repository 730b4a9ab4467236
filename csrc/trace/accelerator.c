/* Builds Embree scenes of models and places instances of them. */
#include "trace/accelerator.h"

#include "base/memory.h"
#include "scene/graph_point.h"
#include "terrain/height_field.h"
#include "trace/coincident.h"

pl_status pl_accelerators_create(pl_accelerators **out) {
  void *memory;
  PL_TRY(pl_alloc_or_fail(1, sizeof(pl_accelerators), "accelerators", &memory));
  pl_accelerators *kept = memory;
  kept->device = rtcNewDevice("threads=1,set_affinity=0");
  if (kept->device == NULL) {
    const int error = (int)rtcGetDeviceError(NULL);
    pl_free(kept);
    return pl_fail(PL_E_DEVICE, "Embree cannot open a device (error %d)", error);
  }
  const pl_status status = pl_accelerator_check(kept, "opening a device");
  if (status != PL_OK)
    pl_accelerators_destroy(kept);
  else
    *out = kept;
  return status;
}

static void free_model(pl_model_accelerator *model) {
  rtcReleaseScene(model->scene);
  pl_free(model->coincident);
}

void pl_accelerators_destroy(pl_accelerators *kept) {
  if (kept == NULL)
    return;
  for (size_t i = 0; i < kept->model_count; i++)
    free_model(&kept->models[i]);
  pl_ground_tiles_destroy(kept);
  rtcReleaseDevice(kept->device);
  pl_free(kept->models);
  pl_free(kept);
}

pl_status pl_accelerator_check(const pl_accelerators *kept, const char *doing) {
  const enum RTCError error = rtcGetDeviceError(kept->device);
  if (error == RTC_ERROR_NONE)
    return PL_OK;
  if (error == RTC_ERROR_OUT_OF_MEMORY)
    return pl_fail(PL_E_MEMORY, "Embree is out of memory while %s", doing);
  return pl_fail(PL_E_DEVICE, "Embree error %d while %s", (int)error, doing);
}

/* Returns whether a surface exists at candidate hit `i`. With `to_light` the ray is a shadow ray
 * and is considered from its far end: a face that the light sees casts a shadow, and of two
 * back-to-back sheets the lit one is not shadowed by the other, in either order. Where the opacity
 * is below one half there is no surface. */
static bool is_there(const struct RTCFilterFunctionNArguments *arguments, unsigned i,
                     bool to_light) {
  const pl_model *model = arguments->geometryUserPtr;
  const unsigned n = arguments->N;
  const uint32_t triangle = pl_embree_hit_triangle(arguments->hit, n, i);
  const pl_material *material = pl_material_of(model, triangle);
  if ((pl_embree_from_behind(arguments->ray, arguments->hit, n, i) != 0) != to_light &&
      !pl_back_is_there(model, triangle))
    return false;
  if (material->alpha_mode == PL_ALPHA_OPAQUE)
    return true;
  const float u = pl_embree_hit_u(arguments->hit, n, i);
  const float v = pl_embree_hit_v(arguments->hit, n, i);
  const pl_triangle_point point = {.triangle = triangle, .w = {1.0f - u - v, u, v}};
  return pl_material_opacity(model, &point) >= 0.5f;
}

static void sight_filter(const struct RTCFilterFunctionNArguments *arguments) {
  for (unsigned i = 0; i < arguments->N; i++)
    if (arguments->valid[i] != 0 && !is_there(arguments, i, false))
      arguments->valid[i] = 0;
}

static void light_filter(const struct RTCFilterFunctionNArguments *arguments) {
  for (unsigned i = 0; i < arguments->N; i++)
    if (arguments->valid[i] != 0 && !is_there(arguments, i, true))
      arguments->valid[i] = 0;
}

static bool is_one_way(const pl_model *model) {
  bool one_way = model->backed != NULL;
  for (size_t i = 0; i < model->material_count; i++)
    one_way |= !model->materials[i].double_sided;
  return one_way;
}

/* Models that are opaque and have no missing back faces are traced without a filter. */
static void set_filter(RTCGeometry geometry, const pl_model *model) {
  bool always_there = !is_one_way(model);
  for (size_t i = 0; i < model->material_count; i++)
    always_there &= model->materials[i].alpha_mode == PL_ALPHA_OPAQUE;
  if (always_there)
    return;
  rtcSetGeometryUserData(geometry, (void *)(uintptr_t)model);
  rtcSetGeometryIntersectFilterFunction(geometry, sight_filter);
  rtcSetGeometryOccludedFilterFunction(geometry, light_filter);
}

static void share_buffers(RTCGeometry geometry, const pl_model *model) {
  rtcSetSharedGeometryBuffer(geometry, RTC_BUFFER_TYPE_VERTEX, 0, RTC_FORMAT_FLOAT3,
                             model->positions, 0, 3 * sizeof(float), model->vertex_count);
  rtcSetSharedGeometryBuffer(geometry, RTC_BUFFER_TYPE_INDEX, 0, RTC_FORMAT_UINT3, model->indices,
                             0, 3 * sizeof(uint32_t), model->triangle_count);
}

static pl_status build_model(pl_accelerators *kept, const pl_model *model, RTCScene *out) {
  RTCScene scene = rtcNewScene(kept->device);
  RTCGeometry geometry = rtcNewGeometry(kept->device, RTC_GEOMETRY_TYPE_TRIANGLE);
  rtcSetSceneFlags(scene, RTC_SCENE_FLAG_ROBUST | PL_EMBREE_QUERY_FILTERS);
  rtcSetSceneBuildQuality(scene, RTC_BUILD_QUALITY_HIGH);
  share_buffers(geometry, model);
  set_filter(geometry, model);
  rtcCommitGeometry(geometry);
  rtcAttachGeometry(scene, geometry);
  rtcReleaseGeometry(geometry);
  rtcCommitScene(scene);
  const pl_status status = pl_accelerator_check(kept, "building a model's accelerator");
  if (status != PL_OK)
    rtcReleaseScene(scene);
  else
    *out = scene;
  return status;
}

/* Returns the accelerator of a model, which is built on first use and cached; valid until the next
 * call. */
static pl_status accelerator_of_model(pl_accelerators *kept, const pl_model *model,
                                      const pl_model_accelerator **out) {
  for (size_t i = 0; i < kept->model_count; i++) {
    if (kept->models[i].model == model) {
      *out = &kept->models[i];
      return PL_OK;
    }
  }
  pl_model_accelerator *grown = pl_realloc(kept->models, kept->model_count + 1, sizeof *grown);
  if (grown == NULL)
    return pl_fail(PL_E_MEMORY, "out of memory for accelerators");
  kept->models = grown;
  pl_model_accelerator *made = &kept->models[kept->model_count];
  *made = (pl_model_accelerator){.model = model, .one_way = is_one_way(model)};
  PL_TRY(pl_coincident_find(model, &made->coincident));
  const pl_status status = build_model(kept, model, &made->scene);
  if (status != PL_OK) {
    pl_free(made->coincident);
    return status;
  }
  kept->model_count++;
  *out = made;
  return PL_OK;
}

size_t pl_accelerator_count(const pl_shot_object *object) {
  return object->pieces != NULL ? object->piece_count : 1;
}

static pl_status open_instance(pl_accelerators *kept, const pl_shot_object *object,
                               const pl_model *model, pl_instance *out) {
  const pl_model_accelerator *own = NULL;
  PL_TRY(accelerator_of_model(kept, model, &own));
  *out = (pl_instance){.model = model,
                       .scene = own->scene,
                       .coincident = own->coincident,
                       .surface_id = object->id,
                       .size_m = object->radius_m,
                       .cuts = pl_object_cuts(object->object),
                       .one_way = own->one_way};
  return PL_OK;
}

static void place_whole(const pl_shot_object *object, pl_instance *out) {
  pl_mat3 linear = object->rotation;
  for (int i = 0; i < 3; i++)
    linear.row[i] = pl_vec3_scale(linear.row[i], object->scale);
  const pl_vec3 shift = pl_mat3_mul_vec(linear, object->object->offset);
  pl_instance_place(out, &linear, pl_vec3_sub(object->position, shift), object->center,
                    object->radius_m);
}

/* The sphere encloses the corners of the piece's own bounding box. */
static void place_piece(const pl_shot_piece *piece, pl_instance *out) {
  const float *low = piece->model->bounds_min, *high = piece->model->bounds_max;
  const pl_vec3 half = {0.5 * ((double)high[0] - low[0]), 0.5 * ((double)high[1] - low[1]),
                        0.5 * ((double)high[2] - low[2])};
  const pl_vec3 middle = {low[0] + half.x, low[1] + half.y, low[2] + half.z};
  double radius_m = 0.0;
  for (int k = 0; k < 4; k++) { /* the other four are opposite to these */
    const pl_vec3 corner = {half.x, k & 1 ? half.y : -half.y, k & 2 ? half.z : -half.z};
    radius_m = fmax(radius_m, pl_vec3_norm(pl_mat3_mul_vec(piece->linear, corner)));
  }
  pl_instance_place(out, &piece->linear, piece->origin,
                    pl_vec3_add(piece->origin, pl_mat3_mul_vec(piece->linear, middle)),
                    radius_m * (1.0 + 1e-6));
}

pl_status pl_accelerator_place(pl_accelerators *kept, const pl_shot_object *object,
                               pl_instance *out, size_t *count) {
  *count = 0;
  if (object->pieces == NULL) {
    PL_TRY(open_instance(kept, object, object->object->model, out));
    place_whole(object, &out[(*count)++]);
    return PL_OK;
  }
  for (size_t k = 0; k < object->piece_count; k++) {
    const pl_shot_piece *piece = &object->pieces[k];
    if (!piece->present)
      continue;
    PL_TRY(open_instance(kept, object, piece->model, &out[*count]));
    out[*count].first = (uint32_t)object->object->cut->first[k];
    place_piece(piece, &out[(*count)++]);
  }
  return PL_OK;
}

/* Rays in the axes of the body, relative to the origin of the field. */
void pl_accelerator_place_field(const pl_shot_body *body, size_t index, pl_instance *out) {
  const pl_vec3 origin =
      pl_vec3_add(body->center, pl_mat3_mul_vec(body->rotation, body->field->origin));
  *out = (pl_instance){.scene = body->field->scene,
                       .surface_id = pl_surface_make(PL_SURFACE_HEIGHT_FIELD, index),
                       .size_m = body->outer_m,
                       .tiled = true,
                       .first_rocks = body->field->first_rocks};
  pl_instance_place(out, &body->rotation, origin, body->center, body->outer_m * (1.0 + 1e-6));
}

/* Instances of the objects of a kind, in their order. */
static size_t count_objects(const pl_snapshot *shot, pl_surface_kind kind) {
  size_t sum = 0;
  for (size_t i = 0; i < shot->object_count; i++) {
    const pl_shot_object *object = &shot->objects[i];
    sum +=
        object->kept && pl_surface_kind_of(object->id) == kind ? pl_accelerator_count(object) : 0;
  }
  return sum;
}

static pl_status place_objects(pl_accelerators *kept, const pl_snapshot *shot, pl_surface_kind kind,
                               pl_instance *out, size_t *count) {
  *count = 0;
  for (size_t i = 0; i < shot->object_count; i++) {
    const pl_shot_object *object = &shot->objects[i];
    size_t placed;
    if (!object->kept || pl_surface_kind_of(object->id) != kind)
      continue;
    PL_TRY(pl_accelerator_place(kept, object, out + *count, &placed));
    *count += placed;
  }
  return PL_OK;
}

static size_t count_fields(const pl_snapshot *shot, pl_surface_kind kind) {
  size_t sum = 0;
  (void)kind;
  for (size_t i = 0; i < shot->body_count; i++)
    sum += shot->bodies[i].field != NULL ? 1 : 0;
  return sum;
}

static pl_status place_fields(pl_accelerators *kept, const pl_snapshot *shot, pl_surface_kind kind,
                              pl_instance *out, size_t *count) {
  *count = 0;
  (void)kept, (void)kind;
  for (size_t i = 0; i < shot->body_count; i++)
    if (shot->bodies[i].field != NULL)
      pl_accelerator_place_field(&shot->bodies[i], i, &out[(*count)++]);
  return PL_OK;
}

const pl_intersect pl_intersect_objects = {.count = count_objects, .place = place_objects};
const pl_intersect pl_intersect_height_fields = {.count = count_fields, .place = place_fields};

static pl_status place_kinds(pl_accelerators *kept, const pl_intersects *kinds, pl_tracer *tracer) {
  for (int k = 0; k < PL_SURFACE_KINDS; k++) {
    const pl_intersect *kind = kinds->of[k];
    size_t count = 0;
    if (kind == NULL)
      continue;
    if (kind->place != NULL)
      PL_TRY(kind->place(kept, tracer->snapshot, (pl_surface_kind)k,
                         tracer->instances + tracer->instance_count, &count));
    tracer->instance_count += count;
    if (kind->closest != NULL)
      tracer->closed[tracer->closed_count++] = kind;
  }
  return PL_OK;
}

pl_status pl_tracer_build(pl_accelerators *kept, const pl_snapshot *shot,
                          const pl_intersects *kinds, pl_arena *arena, const pl_tracer **out) {
  size_t most = 0;
  for (int k = 0; k < PL_SURFACE_KINDS; k++)
    if (kinds->of[k] != NULL && kinds->of[k]->count != NULL)
      most += kinds->of[k]->count(shot, (pl_surface_kind)k);
  pl_tracer *tracer = pl_arena_alloc(arena, 1, sizeof *tracer);
  pl_instance *instances = pl_arena_alloc(arena, most, sizeof *instances);
  pl_sphere *leaves = pl_arena_alloc(arena, most, sizeof *leaves);
  if (tracer == NULL || instances == NULL || leaves == NULL)
    return pl_fail(PL_E_MEMORY, "out of memory for instances");
  *tracer = (pl_tracer){.instances = instances, .snapshot = shot, .log = kept->log};
  PL_TRY(place_kinds(kept, kinds, tracer));
  for (size_t i = 0; i < tracer->instance_count; i++)
    leaves[i] = (pl_sphere){.center = instances[i].center, .radius_m = instances[i].radius_m};
  PL_TRY(pl_sphere_tree_build(arena, leaves, tracer->instance_count, &tracer->tree));
  *out = tracer;
  return PL_OK;
}
