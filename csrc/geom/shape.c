/* Vertex normals weighted by angle; winding numbers from solid angles. */
#include "geom/shape.h"

#include <string.h>

#include "base/memory.h"

static pl_vec3 corner_of(const pl_model *model, size_t triangle, size_t k) {
  const float *p = model->positions + 3 * (size_t)model->indices[3 * triangle + k];
  return (pl_vec3){p[0], p[1], p[2]};
}

/* Adds the unit normal of a face to the sums of its vertices, weighted by the angle of the face at
 * each: the result does not depend on the triangulation of planar faces (Thuermer and Wuethrich
 * 1998). */
static void add_face(const pl_model *model, size_t triangle, double *sums) {
  pl_vec3 corner[3];
  for (size_t k = 0; k < 3; k++)
    corner[k] = corner_of(model, triangle, k);
  const pl_vec3 normal = pl_vec3_unit(
      pl_vec3_cross(pl_vec3_sub(corner[1], corner[0]), pl_vec3_sub(corner[2], corner[0])));
  for (size_t k = 0; k < 3; k++) {
    const pl_vec3 a = pl_vec3_sub(corner[(k + 1) % 3], corner[k]);
    const pl_vec3 b = pl_vec3_sub(corner[(k + 2) % 3], corner[k]);
    const double angle = atan2(pl_vec3_norm(pl_vec3_cross(a, b)), pl_vec3_dot(a, b));
    double *sum = sums + 3 * (size_t)model->indices[3 * triangle + k];
    sum[0] += angle * normal.x;
    sum[1] += angle * normal.y;
    sum[2] += angle * normal.z;
  }
}

/* A vertex without faces, or whose face normals cancel, gets +z: no surface point is shaded with
 * that normal alone. */
static pl_status set_normals(pl_model *model) {
  void *memory;
  PL_TRY(pl_alloc_or_fail(3 * model->vertex_count, sizeof(double), "normals", &memory));
  double *sums = memory;
  for (size_t t = 0; t < model->triangle_count; t++)
    add_face(model, t, sums);
  for (size_t v = 0; v < model->vertex_count; v++) {
    const pl_vec3 sum = {sums[3 * v], sums[3 * v + 1], sums[3 * v + 2]};
    const bool flat = pl_vec3_norm(sum) > 1e-6;
    const pl_vec3 n = flat ? pl_vec3_unit(sum) : (pl_vec3){0.0, 0.0, 1.0};
    model->normals[3 * v] = (float)n.x;
    model->normals[3 * v + 1] = (float)n.y;
    model->normals[3 * v + 2] = (float)n.z;
  }
  pl_free(memory);
  return PL_OK;
}

static pl_status check(const char *name, const float *positions, size_t vertices,
                       const uint32_t *indices, size_t triangles) {
  if (triangles == 0)
    return pl_fail(PL_E_RANGE, "shape '%s': has no triangles", name);
  for (size_t i = 0; i < 3 * vertices; i++)
    if (!isfinite(positions[i]))
      return pl_fail(PL_E_RANGE, "shape '%s': vertex %zu is not finite", name, i / 3);
  for (size_t i = 0; i < 3 * triangles; i++)
    if (indices[i] >= vertices)
      return pl_fail(PL_E_RANGE, "shape '%s': triangle %zu has vertex %u of %zu", name, i / 3,
                     (unsigned)indices[i], vertices);
  return PL_OK;
}

static pl_material plain(char *name) {
  return (pl_material){.name = name,
                       .base_color = {1.0f, 1.0f, 1.0f, 1.0f},
                       .roughness = 1.0f,
                       .normal_scale = 1.0f,
                       .double_sided = true,
                       .lambert = true,
                       .base_color_map = PL_NO_TEXTURE,
                       .metallic_roughness_map = PL_NO_TEXTURE,
                       .normal_map = PL_NO_TEXTURE,
                       .emissive_map = PL_NO_TEXTURE,
                       .layers = PL_MATERIAL_LAYERS_PLAIN};
}

/* Sets the mesh unit and origin, so that single precision resolves bodies of any size. */
static void place(const float *positions, pl_model *m) {
  pl_vec3 low = {INFINITY, INFINITY, INFINITY}, high = {-INFINITY, -INFINITY, -INFINITY};
  for (size_t v = 0; v < m->vertex_count; v++) {
    const pl_vec3 p = {positions[3 * v], positions[3 * v + 1], positions[3 * v + 2]};
    low = (pl_vec3){fmin(low.x, p.x), fmin(low.y, p.y), fmin(low.z, p.z)};
    high = (pl_vec3){fmax(high.x, p.x), fmax(high.y, p.y), fmax(high.z, p.z)};
  }
  pl_model_set_unit(m, low, high);
  for (size_t v = 0; v < m->vertex_count; v++) {
    const float *p = positions + 3 * v;
    const pl_vec3f q = pl_vec3_to_float(pl_model_mesh_point(m, (pl_vec3){p[0], p[1], p[2]}));
    m->positions[3 * v] = q.x;
    m->positions[3 * v + 1] = q.y;
    m->positions[3 * v + 2] = q.z;
  }
  pl_model_measure(m);
}

static pl_status fill(const char *name, const float *positions, const uint32_t *indices,
                      pl_model *m) {
  const size_t numbers = 3 * m->vertex_count, corners = 3 * m->triangle_count;
  /* One extra float: Embree reads vertices as four floats. */
  PL_TRY(pl_alloc_or_fail(numbers + 1, sizeof(float), "a shape", (void **)&m->positions));
  PL_TRY(pl_alloc_or_fail(numbers, sizeof(float), "a shape", (void **)&m->normals));
  PL_TRY(pl_alloc_or_fail(corners, sizeof(uint32_t), "a shape", (void **)&m->indices));
  PL_TRY(
      pl_alloc_or_fail(m->triangle_count, sizeof(uint32_t), "a shape", (void **)&m->triangle_part));
  PL_TRY(pl_alloc_or_fail(1, sizeof(pl_part), "a shape", (void **)&m->parts));
  PL_TRY(pl_alloc_or_fail(1, sizeof(pl_material), "a shape", (void **)&m->materials));
  m->part_count = m->material_count = 1;
  m->parts[0].name = pl_strdup(name);
  m->materials[0] = plain(pl_strdup(name));
  m->warnings = pl_strdup("");
  if (m->parts[0].name == NULL || m->materials[0].name == NULL || m->warnings == NULL)
    return pl_fail(PL_E_MEMORY, "out of memory for a shape");
  memcpy(m->indices, indices, corners * sizeof(uint32_t));
  place(positions, m);
  return set_normals(m);
}

pl_status pl_shape_create(const char *name, const float *positions, size_t vertices,
                          const uint32_t *indices, size_t triangles, pl_model **out) {
  void *memory;
  PL_TRY(check(name, positions, vertices, indices, triangles));
  PL_TRY(pl_alloc_or_fail(1, sizeof(pl_model), "a shape", &memory));
  pl_model *model = memory;
  *model = (pl_model){.vertex_count = vertices, .triangle_count = triangles};
  const pl_status status = fill(name, positions, indices, model);
  if (status != PL_OK) {
    pl_model_destroy(model);
    return status;
  }
  *out = model;
  return PL_OK;
}

void pl_shape_make_one_sided(pl_model *model) {
  for (size_t i = 0; i < model->material_count; i++)
    model->materials[i].double_sided = false;
}

/* --- materials of the source model ------------------------------------------------------------ */

static pl_status check_source(const pl_model *shape, const pl_model *source,
                              const uint32_t *corners, const uint32_t *faces) {
  for (size_t t = 0; t < shape->triangle_count; t++) {
    bool there = faces[t] < source->triangle_count;
    for (size_t k = 0; k < 3; k++)
      there = there && corners[3 * t + k] < source->vertex_count;
    if (!there)
      return pl_fail(PL_E_RANGE, "shape: triangle %zu is made of none of its model", t);
  }
  return PL_OK;
}

/* Copies `width` numbers for each corner from the array of vertex from[corner]. */
static pl_status spread(const float *values, const uint32_t *from, size_t corners, size_t width,
                        float **out) {
  void *memory;
  *out = NULL;
  if (values == NULL)
    return PL_OK;
  /* One extra float: Embree reads vertices as four floats. */
  PL_TRY(pl_alloc_or_fail(corners * width + 1, sizeof(float), "a shape", &memory));
  for (size_t i = 0; i < corners; i++)
    memcpy((float *)memory + i * width, values + (size_t)from[i] * width, width * sizeof(float));
  *out = memory;
  return PL_OK;
}

/* Returns true if the winding of the shape's triangle is opposite to the source's; the sign of its
 * bitangents is then flipped. */
static bool is_turned(const pl_model *source, const uint32_t *corners, uint32_t face) {
  const uint32_t *index = source->indices + 3 * (size_t)face;
  for (size_t k = 0; k < 3; k++)
    if (index[k] == corners[0])
      return index[(k + 1) % 3] != corners[1];
  return false;
}

/* Makes one vertex per corner, as texture coordinates may differ between the faces at a vertex. */
static pl_status take_vertices(pl_model *shape, const pl_model *source, const uint32_t *corners,
                               const uint32_t *faces) {
  const size_t count = 3 * shape->triangle_count;
  float *positions, *normals;
  PL_TRY(spread(shape->positions, shape->indices, count, 3, &positions));
  pl_free(shape->positions);
  shape->positions = positions;
  PL_TRY(spread(shape->normals, shape->indices, count, 3, &normals));
  pl_free(shape->normals);
  shape->normals = normals;
  shape->vertex_count = count;
  for (uint32_t i = 0; i < count; i++)
    shape->indices[i] = i;
  PL_TRY(spread(source->uvs[0], corners, count, 2, &shape->uvs[0]));
  PL_TRY(spread(source->uvs[1], corners, count, 2, &shape->uvs[1]));
  PL_TRY(spread(source->colors, corners, count, 4, &shape->colors));
  PL_TRY(spread(source->tangents, corners, count, 4, &shape->tangents));
  for (size_t t = 0; shape->tangents != NULL && t < shape->triangle_count; t++)
    for (size_t k = 0; k < 3 && is_turned(source, corners + 3 * t, faces[t]); k++)
      shape->tangents[4 * (3 * t + k) + 3] *= -1.0f;
  return PL_OK;
}

static void make_opaque(pl_material *material) {
  material->double_sided = true;
  material->alpha_mode = PL_ALPHA_OPAQUE;
  material->emissive_map = PL_NO_TEXTURE;
  memset(material->emissive, 0, sizeof material->emissive);
  material->layers.transmission = 0.0f;
  material->layers.transmission_map = PL_NO_TEXTURE;
  material->layers.solid = false;
}

/* Makes one part per material, so that each triangle refers to its material. */
static pl_status take_parts(pl_model *shape, const pl_model *source, const uint32_t *faces) {
  void *memory;
  PL_TRY(pl_alloc_or_fail(source->material_count, sizeof(pl_part), "a shape", &memory));
  pl_part *parts = memory;
  bool named = true;
  for (size_t i = 0; i < source->material_count; i++) {
    parts[i] = (pl_part){.name = pl_strdup(shape->parts[0].name), .material = (int)i};
    named = named && parts[i].name != NULL;
  }
  pl_free(shape->parts[0].name);
  pl_free(shape->parts);
  shape->parts = parts;
  shape->part_count = source->material_count;
  for (size_t t = 0; t < shape->triangle_count; t++)
    shape->triangle_part[t] = (uint32_t)source->parts[source->triangle_part[faces[t]]].material;
  return named ? PL_OK : pl_fail(PL_E_MEMORY, "out of memory for a shape");
}

static pl_status take_materials(pl_model *shape, const pl_model *source) {
  void *materials, *textures;
  PL_TRY(pl_alloc_or_fail(source->texture_count, sizeof(pl_texture *), "a shape", &textures));
  shape->textures = textures;
  shape->texture_count = source->texture_count;
  shape->borrows_textures = true;
  for (size_t i = 0; i < source->texture_count; i++)
    shape->textures[i] = source->textures[i];
  PL_TRY(pl_alloc_or_fail(source->material_count, sizeof(pl_material), "a shape", &materials));
  pl_free(shape->materials[0].name);
  pl_free(shape->materials);
  shape->materials = materials;
  shape->material_count = source->material_count;
  bool named = true;
  for (size_t i = 0; i < source->material_count; i++) {
    shape->materials[i] = source->materials[i];
    shape->materials[i].name = pl_strdup(source->materials[i].name);
    named = named && shape->materials[i].name != NULL;
    make_opaque(&shape->materials[i]);
  }
  return named ? PL_OK : pl_fail(PL_E_MEMORY, "out of memory for a shape");
}

pl_status pl_shape_dress(pl_model *shape, const pl_model *source, const uint32_t *corners,
                         const uint32_t *faces) {
  PL_TRY(check_source(shape, source, corners, faces));
  PL_TRY(take_vertices(shape, source, corners, faces));
  PL_TRY(take_parts(shape, source, faces));
  return take_materials(shape, source);
}

double pl_shape_winding(const pl_model *model, pl_vec3 point) {
  double sum = 0.0;
  point = pl_model_mesh_point(model, point);
  for (size_t t = 0; t < model->triangle_count; t++) {
    const pl_vec3 a = pl_vec3_sub(corner_of(model, t, 0), point);
    const pl_vec3 b = pl_vec3_sub(corner_of(model, t, 1), point);
    const pl_vec3 c = pl_vec3_sub(corner_of(model, t, 2), point);
    const double na = pl_vec3_norm(a), nb = pl_vec3_norm(b), nc = pl_vec3_norm(c);
    const double volume = pl_vec3_dot(a, pl_vec3_cross(b, c));
    const double cosines =
        na * nb * nc + pl_vec3_dot(a, b) * nc + pl_vec3_dot(b, c) * na + pl_vec3_dot(c, a) * nb;
    if (volume != 0.0)
      sum += 2.0 * atan2(volume, cosines);
  }
  return sum / (4.0 * PL_PI);
}
