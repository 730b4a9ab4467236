/* Memory management and bounds of models. */
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
  for (size_t i = 0;
       model->textures != NULL && !model->borrows_textures && i < model->texture_count; i++)
    pl_texture_destroy(model->textures[i]);
  for (size_t i = 0; model->animations != NULL && i < model->animation_count; i++)
    pl_animation_clear(&model->animations[i]);
  pl_nodes_clear(&model->nodes);
  void *const owned[] = {model->positions,  model->normals,       model->tangents,
                         model->uvs[0],     model->uvs[1],        model->colors,
                         model->indices,    model->triangle_part, model->parts,
                         model->backed,     model->materials,     (void *)model->textures,
                         model->animations, model->warnings};
  for (size_t i = 0; i < sizeof owned / sizeof owned[0]; i++)
    pl_free(owned[i]);
  pl_free(model);
}

size_t pl_model_bytes(const pl_model *model) {
  const float *const rows[] = {model->positions, model->normals, model->tangents,
                               model->uvs[0],    model->uvs[1],  model->colors};
  static const size_t sizes[] = {3, 3, 4, 2, 2, 4};
  size_t bytes = model->triangle_count * (4 * sizeof(uint32_t) + (model->backed != NULL));
  for (size_t i = 0; i < sizeof rows / sizeof rows[0]; i++)
    bytes += rows[i] != NULL ? model->vertex_count * sizes[i] * sizeof(float) : 0;
  for (size_t i = 0; !model->borrows_textures && i < model->texture_count; i++)
    bytes += pl_texture_bytes(model->textures[i]);
  return sizeof *model + bytes;
}

/* Returns the mesh origin along an axis: zero, unless that is far from the geometry around
 * `middle`. */
static double origin_of(double middle, double unit) {
  return fabs(middle) < 2.0 * unit ? 0.0 : rint(middle / unit) * unit;
}

/* Returns the smallest power of two that is at least `size`. */
static double power_above(double size) {
  int exponent;
  return frexp(size, &exponent) > 0.5 ? ldexp(1.0, exponent) : size;
}

void pl_model_set_unit(pl_model *model, pl_vec3 low, pl_vec3 high) {
  const pl_vec3 half = {0.5 * high.x - 0.5 * low.x, 0.5 * high.y - 0.5 * low.y,
                        0.5 * high.z - 0.5 * low.z};
  const double most = fmax(half.x, fmax(half.y, half.z));
  model->unit = most > 0.0 && isfinite(most) ? power_above(most) : 1.0;
  model->origin = (pl_vec3){origin_of(0.5 * low.x + 0.5 * high.x, model->unit),
                            origin_of(0.5 * low.y + 0.5 * high.y, model->unit),
                            origin_of(0.5 * low.z + 0.5 * high.z, model->unit)};
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
