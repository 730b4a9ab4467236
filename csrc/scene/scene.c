/* Adds to and frees a scene. */
#include "scene/scene.h"

#include <string.h>

#include "base/memory.h"
#include "shade/hapke.h"

pl_status pl_scene_init(int levels, pl_scene *out) {
  *out = (pl_scene){0};
  if (levels < 1 || levels > PL_LEVELS_MAX)
    return pl_fail(PL_E_RANGE, "%d semantic levels: must be 1..%d", levels, PL_LEVELS_MAX);
  out->levels = levels;
  return PL_OK;
}

static void object_clear(pl_object *object) {
  pl_free(object->name);
  pl_free(object->triangle_part);
  pl_free(object->part_ids);
  pl_free(object->class_ids);
  pl_object_materials_destroy(object->materials);
}

static void body_clear(pl_body *body) {
  pl_free(body->name);
  pl_free((void *)(uintptr_t)body->parts.part_ids);
  pl_free((void *)(uintptr_t)body->parts.class_ids);
}

void pl_scene_clear(pl_scene *scene) {
  for (size_t i = 0; i < scene->object_count; i++)
    object_clear(&scene->objects[i]);
  for (size_t i = 0; i < scene->body_count; i++)
    body_clear(&scene->bodies[i]);
  for (size_t i = 0; i < scene->cut_count; i++)
    pl_cut_destroy(scene->cuts[i]);
  pl_free(scene->cuts);
  for (size_t i = 0; i < scene->cover_count; i++) {
    pl_cover_clear(scene->covers[i]);
    pl_free(scene->covers[i]);
  }
  pl_free(scene->covers);
  pl_free(scene->objects);
  pl_free(scene->bodies);
  *scene = (pl_scene){0};
}

static void *copy(const void *from, size_t count, size_t size) {
  void *to = pl_alloc(count, size);
  if (to != NULL && count > 0)
    memcpy(to, from, count * size);
  return to;
}

static pl_status check_parts(const char *name, const pl_model *model, const pl_part_table *parts) {
  if (parts->triangle_part == NULL) {
    if (parts->count != model->part_count)
      return pl_fail(PL_E_RANGE, "object '%s': %zu parts, but its model has %zu", name,
                     parts->count, model->part_count);
    return PL_OK;
  }
  for (size_t t = 0; t < model->triangle_count; t++)
    if (parts->triangle_part[t] >= parts->count)
      return pl_fail(PL_E_RANGE, "object '%s': triangle %zu is of part %u, but there are %zu", name,
                     t, (unsigned)parts->triangle_part[t], parts->count);
  return PL_OK;
}

/* Returns the cover of a model, made on first use. */
static pl_status find_cover(pl_scene *scene, const pl_model *model, pl_cover **out) {
  void *memory;
  for (size_t i = 0; i < scene->cover_count; i++)
    if (scene->covers[i]->model == model) {
      *out = scene->covers[i];
      return PL_OK;
    }
  pl_cover **grown = pl_realloc(scene->covers, scene->cover_count + 1, sizeof(pl_cover *));
  if (grown == NULL)
    return pl_fail(PL_E_MEMORY, "out of memory for the cover of a model");
  scene->covers = grown;
  PL_TRY(pl_alloc_or_fail(1, sizeof(pl_cover), "the cover of a model", &memory));
  const pl_status status = pl_cover_init(model, memory);
  if (status != PL_OK) {
    pl_free(memory);
    return status;
  }
  *out = scene->covers[scene->cover_count++] = memory;
  return PL_OK;
}

/* Inserts an object, which the scene then owns, at `index` before the existing ones. */
static void insert_object(pl_scene *scene, size_t index, const pl_object *object) {
  pl_object *at = scene->objects + index;
  memmove(at + 1, at, (scene->object_count - index) * sizeof *at);
  *at = *object;
  scene->object_count++;
}

/* `body`: index of the body that it is the shape of, or -1. */
static pl_status add_object(pl_scene *scene, const char *name, const pl_model *model,
                            pl_vec3 offset, int32_t obj_id, int32_t instance_id, int body,
                            const pl_part_table *parts) {
  PL_TRY(check_parts(name, model, parts));
  pl_object *grown = pl_realloc(scene->objects, scene->object_count + 1, sizeof *grown);
  if (grown == NULL)
    return pl_fail(PL_E_MEMORY, "out of memory for object '%s'", name);
  scene->objects = grown;
  const size_t levels = (size_t)scene->levels;
  pl_object object = {
      .name = pl_strdup(name),
      .model = model,
      .offset = pl_model_mesh_point(model, offset),
      .obj_id = obj_id,
      .instance_id = instance_id,
      .part_count = parts->count,
      .part_ids = copy(parts->part_ids, parts->count, sizeof *parts->part_ids),
      .class_ids = copy(parts->class_ids, parts->count * levels, sizeof *parts->class_ids),
      .model_summary = pl_model_summarise(model),
      .body = body,
  };
  object.summary = object.model_summary;
  object.sent = pl_sent_light_of(model, &object.model_summary, NULL);
  if (parts->triangle_part != NULL)
    object.triangle_part =
        copy(parts->triangle_part, model->triangle_count, sizeof *parts->triangle_part);
  const bool cut = parts->triangle_part == NULL || object.triangle_part != NULL;
  if (!cut || object.name == NULL || object.part_ids == NULL || object.class_ids == NULL) {
    object_clear(&object);
    return pl_fail(PL_E_MEMORY, "out of memory for object '%s'", name);
  }
  pl_cover *cover = NULL;
  pl_status status = find_cover(scene, model, &cover);
  if (status == PL_OK && body < 0 && cover->facets.count == 0)
    status = pl_facets_init(model, &cover->facets);
  object.cover = cover;
  if (status != PL_OK) {
    object_clear(&object);
    return status;
  }
  insert_object(scene, body < 0 ? scene->craft_count++ : scene->object_count, &object);
  return PL_OK;
}

pl_status pl_scene_add_object(pl_scene *scene, const char *name, const pl_model *model,
                              pl_vec3 offset, int32_t obj_id, int32_t instance_id,
                              const pl_part_table *parts) {
  return add_object(scene, name, model, offset, obj_id, instance_id, -1, parts);
}

pl_status pl_scene_set_materials(pl_scene *scene, size_t index, const pl_graph *const *graphs,
                                 size_t count, const int32_t *triangle_graph) {
  if (index >= scene->craft_count)
    return pl_fail(PL_E_ARGUMENT, "object %zu is not there", index);
  pl_object *object = &scene->objects[index];
  pl_object_materials *made = NULL;
  PL_TRY(pl_object_materials_create(object->name, graphs, count, triangle_graph,
                                    object->model->triangle_count, &made));
  const pl_status status =
      object->cut != NULL ? pl_object_materials_sort(made, object->cut) : PL_OK;
  if (status != PL_OK) {
    pl_object_materials_destroy(made);
    return status;
  }
  pl_object_materials_destroy(object->materials);
  object->materials = made;
  object->summary = object->model_summary;
  for (size_t i = 0; i < count; i++)
    pl_graph_summarise(graphs[i], &object->summary);
  object->sent = pl_sent_light_of(object->model, &object->model_summary, made);
  return PL_OK;
}

/* Returns the reflectance along the normal at zero phase angle of a smooth surface; roughness does
 * not change it. */
static double opposition(const pl_regolith_texel *texel) {
  const pl_vec3 up = {0.0, 0.0, 1.0};
  const pl_regolith_band *band = &texel->band;
  const pl_hapke hapke = {.w = (double)texel->w,
                          .b = (double)band->b,
                          .c = (double)band->c,
                          .b_s0 = (double)band->b_s0,
                          .h_s = 1.0,
                          .b_c0 = (double)band->b_c0,
                          .h_c = 1.0,
                          .filling = (double)band->filling};
  return pl_hapke_reflectance(&hapke, up, up);
}

static void find_brightest(pl_body *body) {
  double peak[3] = {-1.0, -1.0, -1.0};
  memset(body->brightest, 0, sizeof body->brightest);
  if (body->regolith_map == NULL)
    return;
  const pl_grid_frame *frame = pl_grid_frame_of(body->regolith_map);
  for (int i = 0; i < frame->width * frame->height; i++) {
    pl_regolith_texel texel[3];
    memcpy(texel, pl_grid_cell(body->regolith_map, i % frame->width, i / frame->width),
           sizeof texel);
    for (int k = 0; k < 3; k++) {
      const double light = opposition(&texel[k]);
      if (light > peak[k])
        body->brightest[k] = texel[k];
      peak[k] = fmax(peak[k], light);
    }
  }
}

static pl_status check_regolith_map(const pl_body *body) {
  const size_t values = sizeof(pl_regolith_texel) / sizeof(float);
  if (body->regolith_map == NULL)
    return PL_OK;
  const pl_grid_frame *frame = pl_grid_frame_of(body->regolith_map);
  if ((size_t)frame->channels != 3 * values)
    return pl_fail(PL_E_RANGE, "body '%s': a regolith map has 3 bands of %zu values", body->name,
                   values);
  for (int y = 0; y < frame->height; y++)
    for (int x = 0; x < frame->width; x++) {
      pl_regolith_texel texel[3];
      memcpy(texel, pl_grid_cell(body->regolith_map, x, y), sizeof texel);
      for (int k = 0; k < 3; k++)
        if (!(texel[k].w >= 0.0f && texel[k].w <= 1.0f) ||
            !pl_regolith_band_valid(&texel[k].band, false))
          return pl_fail(PL_E_RANGE, "body '%s': regolith map: out of range at column %d, row %d",
                         body->name, x, y);
    }
  return PL_OK;
}

void pl_body_set_graph(pl_body *body, const pl_graph *graph) {
  body->graph = graph;
  body->summary = (pl_model_summary){.ggx_alpha_min = 1.0, .diffuse = true};
  if (graph != NULL)
    pl_graph_summarise(graph, &body->summary);
}

static double reach_of(const pl_model *shape) {
  double square = 0.0;
  for (size_t v = 0; v < shape->vertex_count; v++) {
    const float *p = shape->positions + 3 * v;
    const pl_vec3 corner = pl_model_point(shape, (pl_vec3){p[0], p[1], p[2]});
    square = fmax(square, pl_vec3_dot(corner, corner));
  }
  return sqrt(square);
}

static pl_status add_shape(pl_scene *scene, const pl_body *body, size_t index) {
  /* all triangles belong to part 0 */
  uint32_t *whole = pl_alloc(body->shape->triangle_count, sizeof *whole);
  const pl_part_table parts = {
      .count = 1, .triangle_part = whole, .part_ids = &body->part_id, .class_ids = body->class_ids};
  if (whole == NULL)
    return pl_fail(PL_E_MEMORY, "out of memory for the shape of '%s'", body->name);
  pl_status status = add_object(scene, body->name, body->shape, (pl_vec3){0.0, 0.0, 0.0}, 0,
                                body->instance_id, (int)index, &parts);
  if (status == PL_OK)
    scene->objects[scene->object_count - 1].reach = reach_of(body->shape);
  pl_free(whole);
  return status;
}

static pl_status check_terrain(const pl_body *body) {
  if (body->terrain == NULL)
    return PL_OK;
  if (body->shape != NULL)
    return pl_fail(PL_E_ARGUMENT,
                   "body '%s' has a shape and terrain; only one of them can replace "
                   "its ellipsoid",
                   body->name);
  if (!(body->cells_per_pixel > 0.0 && body->cells_per_pixel <= 16.0))
    return pl_fail(PL_E_RANGE, "body '%s': cells_per_pixel must be above 0 and at most 16, not %g",
                   body->name, body->cells_per_pixel);
  if (!(body->finest_cell_m >= 1e-3 && isfinite(body->finest_cell_m)))
    return pl_fail(PL_E_RANGE, "body '%s': finest_cell_m must be at least 0.001, not %g",
                   body->name, body->finest_cell_m);
  return PL_OK;
}

/* Sets the body's own parts: its surface, then its areas. */
static pl_status copy_parts(const pl_body *body, size_t levels, pl_body *out) {
  const size_t areas = body->areas.count;
  int32_t *part_ids = pl_alloc(1 + areas, sizeof *part_ids);
  uint16_t *class_ids = pl_alloc((1 + areas) * levels, sizeof *class_ids);
  out->parts = (pl_part_table){.count = 1 + areas, .part_ids = part_ids, .class_ids = class_ids};
  out->areas = (pl_part_table){0};
  if (part_ids == NULL || class_ids == NULL)
    return pl_fail(PL_E_MEMORY, "out of memory for body '%s'", body->name);
  part_ids[0] = body->part_id;
  memcpy(class_ids, body->class_ids, levels * sizeof *class_ids);
  if (areas == 0)
    return PL_OK;
  memcpy(part_ids + 1, body->areas.part_ids, areas * sizeof *part_ids);
  memcpy(class_ids + levels, body->areas.class_ids, areas * levels * sizeof *class_ids);
  return PL_OK;
}

static pl_status check_areas(const pl_body *body) {
  return body->area_map.count > 0 ? pl_area_map_check(&body->area_map, body->areas.count) : PL_OK;
}

size_t pl_scene_label_count(const pl_scene *scene) {
  size_t count = scene->craft_count;
  for (size_t i = 0; i < scene->body_count; i++)
    count += scene->bodies[i].obj_id != 0 ? 1 : 0;
  return count;
}

pl_status pl_scene_add_body(pl_scene *scene, const pl_body *body) {
  pl_body *grown = pl_realloc(scene->bodies, scene->body_count + 1, sizeof *grown);
  if (grown == NULL)
    return pl_fail(PL_E_MEMORY, "out of memory for body '%s'", body->name);
  scene->bodies = grown;
  PL_TRY(check_regolith_map(body));
  PL_TRY(check_terrain(body));
  PL_TRY(check_areas(body));
  pl_body added = *body;
  if (!(added.craters.least_px > 0.0))
    added.craters = PL_CRATER_CRITERIA;
  find_brightest(&added);
  added.name = pl_strdup(body->name);
  added.random = pl_material_random(body->name);
  pl_body_set_graph(&added, body->graph);
  pl_status status = copy_parts(body, (size_t)scene->levels, &added);
  if (status == PL_OK && added.name == NULL)
    status = pl_fail(PL_E_MEMORY, "out of memory for body '%s'", body->name);
  if (status == PL_OK && body->shape != NULL)
    status = add_shape(scene, body, scene->body_count);
  if (status != PL_OK) {
    body_clear(&added);
    return status;
  }
  scene->bodies[scene->body_count++] = added;
  return PL_OK;
}
