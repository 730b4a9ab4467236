/* glTF's material extensions at a point, as lobes of the model `principled`. */
#include "shade/material_surface.h"
#include "shade/reflectance.h"

/* KHR_materials_anisotropy: red and green of the map are a direction in tangent and bitangent,
 * rotated by the factor's angle; a zero vector stands for the tangent. */
static void set_anisotropy(const pl_material_layers *layers, const float map[4],
                           pl_surface *surface) {
  const bool mapped = layers->anisotropy_map.texture >= 0;
  float x = mapped ? 2.0f * map[0] - 1.0f : 1.0f, y = mapped ? 2.0f * map[1] - 1.0f : 0.0f;
  const float length = sqrtf(x * x + y * y);
  x = length > 1e-6f ? x / length : 1.0f;
  y = length > 1e-6f ? y / length : 0.0f;
  const float c = cosf(layers->anisotropy_rotation_rad), s = sinf(layers->anisotropy_rotation_rad);
  pl_surface_turn(surface, c * x - s * y, s * x + c * y);
  surface->lobes.anisotropy = pl_minf(layers->anisotropy * map[2], 1.0f);
}

void pl_material_layers_surface(const pl_model *model, const pl_triangle_point *point,
                                pl_detail detail, pl_vec3f coat_normal, pl_surface *surface) {
  const pl_material *material = pl_material_of(model, point->triangle);
  const pl_material_layers *layers = &material->layers;
  pl_lobes *lobes = &surface->lobes;
  float coat[4], rough[4], clear[4], turned[4], weight[4], tint[4];
  if (!material->layered)
    return;
  pl_material_slot(model, point, &layers->coat_map, detail, coat);
  pl_material_slot(model, point, &layers->coat_roughness_map, detail, rough);
  pl_material_slot(model, point, &layers->transmission_map, detail, clear);
  pl_material_slot(model, point, &layers->anisotropy_map, detail, turned);
  pl_material_slot(model, point, &layers->specular_map, detail, weight);
  pl_material_slot(model, point, &layers->specular_color_map, detail, tint);
  const float roughness = layers->coat_roughness * rough[1];
  *lobes = pl_lobes_plain();
  lobes->coat = pl_minf(layers->coat * coat[0], 1.0f);
  lobes->coat_alpha = roughness * roughness;
  lobes->coat_normal = coat_normal;
  lobes->transmission = pl_minf(layers->transmission * clear[0], 1.0f);
  pl_lobes_set_dielectric(lobes, layers->ior, pl_minf(layers->specular * weight[3], 1.0f),
                          pl_vec3f_make(layers->specular_color[0] * tint[0],
                                        layers->specular_color[1] * tint[1],
                                        layers->specular_color[2] * tint[2]));
  lobes->ior = layers->solid ? layers->ior : 0.0f;
  lobes->extinction =
      pl_vec3f_make(layers->extinction[0], layers->extinction[1], layers->extinction[2]);
  if (layers->anisotropy > 0.0f)
    set_anisotropy(layers, turned, surface);
  surface->reflectance = &pl_reflectance_principled;
}
