/* Evaluates glTF materials at a point: factors times maps times vertex colours. */
#include "shade/material_surface.h"

#include "shade/reflectance.h"

void pl_triangle_point_step(const pl_triangle_point *point, pl_vec3f step, float out[3]) {
  const float e11 = pl_vec3f_dot(point->edge1, point->edge1);
  const float e12 = pl_vec3f_dot(point->edge1, point->edge2);
  const float e22 = pl_vec3f_dot(point->edge2, point->edge2);
  const float s1 = pl_vec3f_dot(point->edge1, step), s2 = pl_vec3f_dot(point->edge2, step);
  const float determinant = e11 * e22 - e12 * e12;
  out[0] = out[1] = out[2] = 0.0f;
  if (!(determinant > 1e-12f * e11 * e22))
    return;
  out[1] = (e22 * s1 - e12 * s2) / determinant;
  out[2] = (e11 * s2 - e12 * s1) / determinant;
  out[0] = -out[1] - out[2];
}

static void mix2(const float *values, const uint32_t *corner, const float w[3], float out[2]) {
  for (uint32_t k = 0; k < 2; k++)
    out[k] = w[0] * values[2 * corner[0] + k] + w[1] * values[2 * corner[1] + k] +
             w[2] * values[2 * corner[2] + k];
}

void pl_material_uv(const pl_model *model, const pl_triangle_point *point, int set, float uv[2],
                    float a[2], float b[2]) {
  const float *values = set == 0 || set == 1 ? model->uvs[set] : NULL;
  uv[0] = uv[1] = a[0] = a[1] = b[0] = b[1] = 0.0f;
  if (values == NULL)
    return;
  const uint32_t *corner = model->indices + 3 * (size_t)point->triangle;
  float step_a[3], step_b[3];
  pl_triangle_point_step(point, point->footprint_a, step_a);
  pl_triangle_point_step(point, point->footprint_b, step_b);
  mix2(values, corner, point->w, uv);
  mix2(values, corner, step_a, a);
  mix2(values, corner, step_b, b);
}

static void transform(const pl_uv_transform *t, float v[2], float translate) {
  const float u = t->m[0][0] * v[0] + t->m[0][1] * v[1] + translate * t->m[0][2];
  v[1] = t->m[1][0] * v[0] + t->m[1][1] * v[1] + translate * t->m[1][2];
  v[0] = u;
}

/* Coordinates and footprint of a point in one uv set, before a slot's own transform. */
typedef struct image_place {
  int set; /* NO_SET: not yet computed */
  float uv[2], a[2], b[2];
} image_place;
enum { NO_SET = -2 };

/* `last`: cached coordinates of the previous slot at the same point. */
static void read_slot(const pl_model *model, const pl_triangle_point *point,
                      const pl_texture_slot *slot, pl_detail detail, image_place *last,
                      float out[4]) {
  out[0] = out[1] = out[2] = out[3] = 1.0f;
  if (slot->texture < 0)
    return;
  const pl_texture *texture = model->textures[slot->texture];
  if (!detail.maps) {
    pl_texture_mean(texture, out);
    return;
  }
  if (last->set != slot->uv_set)
    pl_material_uv(model, point, slot->uv_set, last->uv, last->a, last->b);
  last->set = slot->uv_set;
  image_place at = *last;
  transform(&slot->transform, at.uv, 1.0f);
  transform(&slot->transform, at.a, 0.0f);
  transform(&slot->transform, at.b, 0.0f);
  pl_texture_sample(texture, at.uv[0], at.uv[1], at.a, at.b, detail.filter, out);
}

void pl_material_slot(const pl_model *model, const pl_triangle_point *point,
                      const pl_texture_slot *slot, pl_detail detail, float out[4]) {
  image_place place = {.set = NO_SET};
  read_slot(model, point, slot, detail, &place, out);
}

static void vertex_color(const pl_model *model, const pl_triangle_point *point, float out[4]) {
  out[0] = out[1] = out[2] = out[3] = 1.0f;
  if (model->colors == NULL)
    return;
  const uint32_t *corner = model->indices + 3 * (size_t)point->triangle;
  for (uint32_t k = 0; k < 4; k++)
    out[k] = point->w[0] * model->colors[4 * corner[0] + k] +
             point->w[1] * model->colors[4 * corner[1] + k] +
             point->w[2] * model->colors[4 * corner[2] + k];
}

const pl_material *pl_material_of(const pl_model *model, uint32_t triangle) {
  return &model->materials[model->parts[model->triangle_part[triangle]].material];
}

bool pl_back_is_there(const pl_model *model, uint32_t triangle) {
  return pl_material_of(model, triangle)->double_sided &&
         (model->backed == NULL || model->backed[triangle] == 0);
}

static pl_vec3f emission_of(const pl_model *model, const pl_triangle_point *point,
                            const pl_material *material, pl_detail detail, image_place *last) {
  float map[4];
  read_slot(model, point, &material->emissive_map, detail, last, map);
  return pl_vec3f_make(map[0] * material->emissive[0], map[1] * material->emissive[1],
                       map[2] * material->emissive[2]);
}

pl_vec3f pl_material_emission(const pl_model *model, const pl_triangle_point *point,
                              pl_detail detail) {
  image_place place = {.set = NO_SET};
  return emission_of(model, point, pl_material_of(model, point->triangle), detail, &place);
}

/* Normal from a normal map at the point, unit, in the axes of the surface's frame. */
static pl_vec3f bent_normal(const pl_model *model, const pl_triangle_point *point,
                            const pl_texture_slot *slot, float scale, pl_detail detail,
                            const pl_surface *surface) {
  float value[4];
  pl_material_slot(model, point, slot, detail, value);
  const float x = (2.0f * value[0] - 1.0f) * scale;
  const float y = (2.0f * value[1] - 1.0f) * scale;
  const float z = pl_maxf(2.0f * value[2] - 1.0f, 0.05f); /* normals stay on the surface's side */
  return pl_vec3f_unit(pl_surface_to_world(surface, pl_vec3f_make(x, y, z)));
}

static void bend_normal(const pl_model *model, const pl_triangle_point *point,
                        const pl_material *material, pl_detail detail, pl_surface *surface) {
  const pl_vec3f n =
      bent_normal(model, point, &material->normal_map, material->normal_scale, detail, surface);
  surface->n = n;
  surface->t = pl_vec3f_unit(pl_vec3f_madd(surface->t, -pl_vec3f_dot(surface->t, n), n));
  surface->b = pl_vec3f_cross(n, surface->t);
}

/* KHR_materials_clearcoat: without its own normal map the coat is flat over a bumped base.
 * `surface` has the frame before bump mapping. */
static pl_vec3f coat_normal_of(const pl_model *model, const pl_triangle_point *point,
                               const pl_material *material, pl_detail detail,
                               const pl_surface *surface) {
  const pl_material_layers *layers = &material->layers;
  if (layers->coat_normal_map.texture < 0)
    return surface->n;
  return bent_normal(model, point, &layers->coat_normal_map, layers->coat_normal_scale, detail,
                     surface);
}

void pl_material_surface(const pl_model *model, const pl_triangle_point *point, pl_detail detail,
                         pl_surface *surface) {
  const pl_material *material = pl_material_of(model, point->triangle);
  float base[4], vertex[4], mr[4];
  image_place place = {.set = NO_SET};
  read_slot(model, point, &material->base_color_map, detail, &place, base);
  vertex_color(model, point, vertex);
  surface->color = pl_vec3f_make(base[0] * vertex[0] * material->base_color[0],
                                 base[1] * vertex[1] * material->base_color[1],
                                 base[2] * vertex[2] * material->base_color[2]);
  if (detail.color_only)
    return;
  read_slot(model, point, &material->metallic_roughness_map, detail, &place, mr);
  surface->emission = emission_of(model, point, material, detail, &place);
  const float roughness = mr[1] * material->roughness;
  surface->alpha = roughness * roughness;
  surface->metallic = mr[2] * material->metallic;
  surface->reflectance =
      material->lambert ? &pl_reflectance_lambert : &pl_reflectance_metallic_roughness;
  const bool bends = detail.maps && detail.bumps && model->tangents != NULL;
  pl_vec3f coat_normal = {0.0f, 0.0f, 0.0f};
  if (material->layered && bends && material->layers.coat > 0.0f)
    coat_normal = coat_normal_of(model, point, material, detail, surface);
  if (bends && material->normal_map.texture >= 0)
    bend_normal(model, point, material, detail, surface);
  if (material->layered && !material->lambert)
    pl_material_layers_surface(model, point, detail, coat_normal, surface);
}

float pl_material_opacity(const pl_model *model, const pl_triangle_point *point) {
  const pl_material *material = pl_material_of(model, point->triangle);
  if (material->alpha_mode == PL_ALPHA_OPAQUE)
    return 1.0f;
  float base[4], vertex[4];
  pl_material_slot(model, point, &material->base_color_map, PL_DETAIL_FULL, base);
  vertex_color(model, point, vertex);
  const float alpha = base[3] * vertex[3] * material->base_color[3];
  if (material->alpha_mode == PL_ALPHA_MASK)
    return alpha >= material->alpha_cutoff ? 1.0f : 0.0f;
  return pl_minf(pl_maxf(alpha, 0.0f), 1.0f);
}

/* A coat adds its lobe to the base's: the sum of both bounds, each 1/(2 alpha^3), is the bound of
 * one lobe with half of alpha^3. */
static void summarise_layers(const pl_material_layers *l, pl_model_summary *out) {
  out->transmission_max = fmax(out->transmission_max, l->transmission);
  out->textured |= l->coat_map.texture >= 0 || l->coat_roughness_map.texture >= 0 ||
                   l->transmission_map.texture >= 0 || l->anisotropy_map.texture >= 0 ||
                   l->specular_map.texture >= 0 || l->specular_color_map.texture >= 0 ||
                   l->coat_normal_map.texture >= 0;
  out->bumped |= l->coat_normal_map.texture >= 0;
  if (!(l->coat > 0.0f))
    return;
  const double roughness = l->coat_roughness_map.texture >= 0 ? 0.0 : l->coat_roughness;
  out->coat_max = fmax(out->coat_max, l->coat);
  out->ggx_alpha_min = fmin(out->ggx_alpha_min, roughness * roughness) * cbrt(0.5);
}

static void add_material(const pl_model *model, const pl_material *m, pl_model_summary *out) {
  for (int k = 0; k < 3; k++) {
    /* The specular lobe over a diffuse base reflects at most all light. */
    out->albedo_max = fmax(out->albedo_max, m->lambert ? m->base_color[k] : 1.0);
    out->emission_max = fmax(out->emission_max, m->emissive[k]);
  }
  const double roughness = m->metallic_roughness_map.texture >= 0 ? 0.0 : m->roughness;
  out->diffuse &= m->lambert;
  out->bumped |= m->normal_map.texture >= 0 && model->tangents != NULL;
  if (!m->lambert)
    out->ggx_alpha_min = fmin(out->ggx_alpha_min, roughness * roughness);
  if (m->layered && !m->lambert)
    summarise_layers(&m->layers, out);
  out->textured |= m->base_color_map.texture >= 0 || m->normal_map.texture >= 0 ||
                   m->metallic_roughness_map.texture >= 0 || m->emissive_map.texture >= 0;
}

pl_model_summary pl_material_summarise(const pl_model *model, const pl_material *material) {
  pl_model_summary out = {.ggx_alpha_min = 1.0, .diffuse = true};
  add_material(model, material, &out);
  return out;
}

pl_model_summary pl_model_summarise(const pl_model *model) {
  pl_model_summary out = {.ggx_alpha_min = 1.0, .diffuse = true};
  for (size_t i = 0; i < model->texture_count; i++) {
    int levels;
    out.pictured |= pl_texture_ranges(model->textures[i], &levels)[0] > 0.0f;
  }
  for (size_t i = 0; i < model->material_count; i++)
    add_material(model, &model->materials[i], &out);
  return out;
}
