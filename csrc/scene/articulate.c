/* Makes nodes of an object movable. */
#include <string.h>

#include "base/memory.h"
#include "scene/scene.h"

static bool is_same(const pl_cut *cut, const pl_model *model, const int *nodes, size_t count) {
  return cut->model == model && cut->count == count + 1 &&
         memcmp(cut->nodes, nodes, count * sizeof *nodes) == 0;
}

static pl_status find_cut(pl_scene *scene, const pl_model *model, const int *nodes, size_t count,
                          const pl_cut **out) {
  for (size_t i = 0; i < scene->cut_count; i++)
    if (is_same(scene->cuts[i], model, nodes, count)) {
      *out = scene->cuts[i];
      return PL_OK;
    }
  pl_cut **grown = pl_realloc(scene->cuts, scene->cut_count + 1, sizeof(pl_cut *));
  if (grown == NULL)
    return pl_fail(PL_E_MEMORY, "out of memory for the pieces of a model");
  scene->cuts = grown;
  PL_TRY(pl_cut_create(model, nodes, count, &grown[scene->cut_count]));
  *out = grown[scene->cut_count++];
  return PL_OK;
}

/* Sorts the user's parts of triangles into the order of the pieces. */
static pl_status sort_parts(const pl_object *object, const pl_cut *cut, uint32_t **out) {
  void *memory;
  *out = NULL;
  if (object->triangle_part == NULL)
    return PL_OK;
  PL_TRY(
      pl_alloc_or_fail(cut->whole.triangle_count, sizeof(uint32_t), "parts of triangles", &memory));
  *out = memory;
  for (size_t t = 0; t < cut->whole.triangle_count; t++)
    (*out)[t] = object->triangle_part[cut->original[t]];
  return PL_OK;
}

/* Frees a cover that no object uses any more. */
static void drop_cover(pl_scene *scene, const pl_cover *cover) {
  for (size_t i = 0; i < scene->object_count; i++)
    if (scene->objects[i].cover == cover)
      return;
  for (size_t i = 0; i < scene->cover_count; i++)
    if (scene->covers[i] == cover) {
      pl_cover_clear(scene->covers[i]);
      pl_free(scene->covers[i]);
      scene->covers[i] = scene->covers[--scene->cover_count];
    }
}

pl_status pl_scene_articulate(pl_scene *scene, size_t index, const int *nodes, size_t count) {
  const pl_cut *cut = NULL;
  uint32_t *parts;
  if (index >= scene->craft_count || scene->objects[index].cut != NULL)
    return pl_fail(PL_E_ARGUMENT, "object %zu is not there or articulated already", index);
  pl_object *object = &scene->objects[index];
  PL_TRY(find_cut(scene, object->model, nodes, count, &cut));
  PL_TRY(sort_parts(object, cut, &parts));
  pl_status status = PL_OK;
  if (object->materials != NULL)
    status = pl_object_materials_sort(object->materials, cut);
  if (status != PL_OK) {
    pl_free(parts);
    return status;
  }
  pl_free(object->triangle_part);
  const pl_cover *cover = object->cover;
  object->triangle_part = parts;
  object->cover = NULL;
  object->model = &cut->whole;
  object->cut = cut;
  drop_cover(scene, cover);
  return PL_OK;
}
