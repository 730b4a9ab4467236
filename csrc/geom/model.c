/* Ownership and bounds of models. */
#include "geom/model.h"

#include <math.h>

#include "base/memory.h"

void pl_model_destroy(pl_model *model) {
  if (model == NULL)
    return;
  for (size_t i = 0; model->parts != NULL && i < model->part_count; i++)
    pl_free(model->parts[i].name);
  for (size_t i = 0; model->materials != NULL && i < model->material_count; i++)
    pl_free(model->materials[i].name);
  for (size_t i = 0; model->textures != NULL && i < model->texture_count; i++)
    pl_texture_destroy(model->textures[i]);
  for (size_t i = 0; model->animations != NULL && i < model->animation_count; i++)
    pl_animation_clear(&model->animations[i]);
  pl_nodes_clear(&model->nodes);
  void *const owned[] = {model->positions, model->normals,          model->tangents,
                         model->uvs[0],    model->uvs[1],           model->colors,
                         model->indices,   model->triangle_part,    model->parts,
                         model->materials, (void *)model->textures, model->animations,
                         model->warnings};
  for (size_t i = 0; i < sizeof owned / sizeof owned[0]; i++)
    pl_free(owned[i]);
  pl_free(model);
}

void pl_model_measure(pl_model *model) {
  for (int axis = 0; axis < 3; axis++) {
    model->bounds_min[axis] = INFINITY;
    model->bounds_max[axis] = -INFINITY;
    for (size_t v = 0; v < model->vertex_count; v++) {
      const float x = model->positions[3 * v + (size_t)axis];
      model->bounds_min[axis] = fminf(model->bounds_min[axis], x);
      model->bounds_max[axis] = fmaxf(model->bounds_max[axis], x);
    }
  }
}
