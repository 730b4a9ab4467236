/* Makes and keeps the meshes that rocks share. */
#include "terrain/rock_mesh.h"

#include "base/memory.h"

enum { SLOTS = PL_ROCK_FAMILIES * PL_ROCK_VARIANTS * PL_ROCK_LODS };

static pl_status open_pool(pl_rock_meshes *meshes) {
  void *memory;
  if (meshes->spheres == NULL)
    PL_TRY(pl_rock_spheres_create(&meshes->spheres));
  if (meshes->slots == NULL) {
    PL_TRY(pl_alloc_or_fail(SLOTS, sizeof *meshes->slots, "meshes of rocks", &memory));
    meshes->slots = memory;
  }
  if (meshes->list == NULL) {
    PL_TRY(pl_alloc_or_fail(SLOTS, sizeof *meshes->list, "meshes of rocks", &memory));
    meshes->list = memory;
  }
  return PL_OK;
}

/* The list has room for SLOTS, and for SLOTS more whenever it is full. */
static pl_status make_room(pl_rock_meshes *meshes) {
  if (meshes->count == 0 || meshes->count % SLOTS != 0)
    return PL_OK;
  void *memory = pl_realloc(meshes->list, meshes->count + SLOTS, sizeof *meshes->list);
  if (memory == NULL)
    return pl_fail(PL_E_MEMORY, "out of memory for %zu meshes of rocks", meshes->count + SLOTS);
  meshes->list = memory;
  return PL_OK;
}

static pl_rock_mesh **slot_of(const pl_rock_meshes *meshes, uint32_t variant, int lod) {
  return &meshes->slots[variant * PL_ROCK_LODS + (uint32_t)lod];
}

pl_status pl_rock_meshes_add(pl_rock_meshes *meshes, const pl_rock_variant *variant, int lod,
                             pl_rock_mesh **out) {
  void *memory;
  PL_TRY(open_pool(meshes));
  const uint64_t serial = variant->scan != NULL ? variant->scan->serial : 0;
  pl_rock_mesh **slot = slot_of(meshes, variant->number, lod);
  while (*slot != NULL && (*slot)->serial != serial)
    slot = &(*slot)->next;
  if (*slot == NULL) {
    PL_TRY(make_room(meshes));
    PL_TRY(pl_alloc_or_fail(1, sizeof(pl_rock_mesh), "a mesh of rocks", &memory));
    *slot = memory;
    (*slot)->variant = variant->number;
    (*slot)->serial = serial;
    (*slot)->lod = lod;
    meshes->list[meshes->count++] = *slot;
  }
  *out = *slot;
  return PL_OK;
}

static pl_vec3f vertex(const float (*all)[3], uint32_t k) {
  return (pl_vec3f){all[k][0], all[k][1], all[k][2]};
}

static void add_normals(pl_rock_mesh *mesh) {
  for (int k = 0; k < mesh->triangle_count; k++) {
    const uint32_t *t = mesh->triangles[k];
    const float(*all)[3] = (const float(*)[3])mesh->positions;
    const pl_vec3f minus = pl_vec3f_scale(vertex(all, t[0]), -1.0f);
    const pl_vec3f n = pl_vec3f_cross(pl_vec3f_add(vertex(all, t[1]), minus),
                                      pl_vec3f_add(vertex(all, t[2]), minus));
    for (int c = 0; c < 3; c++) {
      mesh->normals[t[c]][0] += n.x;
      mesh->normals[t[c]][1] += n.y;
      mesh->normals[t[c]][2] += n.z;
    }
  }
}

pl_status pl_rock_mesh_fill(pl_rock_mesh *mesh, const pl_rock_meshes *meshes,
                            const pl_rock_variant *variant) {
  enum { BEHIND = 16 }; /* Embree reads whole vectors */
  const pl_rock_sphere *sphere = &meshes->spheres[mesh->lod];
  const size_t vertices = (size_t)sphere->vertex_count, each = sizeof mesh->positions[0];
  void *memory;
  PL_TRY(pl_alloc_or_fail(1, 2 * vertices * each + BEHIND, "a mesh of rocks", &memory));
  mesh->normals = memory;
  mesh->positions = mesh->normals + vertices;
  mesh->vertex_count = sphere->vertex_count;
  mesh->triangle_count = sphere->triangle_count;
  mesh->triangles = (const uint32_t(*)[3])sphere->triangles;
  for (int c = 0; c < 3; c++) {
    mesh->low[c] = INFINITY;
    mesh->high[c] = -INFINITY;
  }
  for (size_t k = 0; k < vertices; k++) {
    const pl_vec3 d = sphere->vertices[k];
    const pl_vec3f p = pl_vec3_to_float(pl_vec3_scale(d, pl_rock_variant_radius(variant, d)));
    const float at[3] = {p.x, p.y, p.z};
    for (int c = 0; c < 3; c++) {
      mesh->positions[k][c] = at[c];
      mesh->low[c] = fminf(mesh->low[c], at[c]);
      mesh->high[c] = fmaxf(mesh->high[c], at[c]);
    }
  }
  add_normals(mesh);
  return PL_OK;
}

void pl_rock_meshes_drop(pl_rock_meshes *meshes, size_t from) {
  while (meshes->count > from) {
    pl_rock_mesh *mesh = meshes->list[--meshes->count];
    pl_rock_mesh **slot = slot_of(meshes, mesh->variant, mesh->lod);
    while (*slot != mesh)
      slot = &(*slot)->next;
    *slot = mesh->next;
    pl_free(mesh->normals);
    pl_free(mesh);
  }
}

size_t pl_rock_meshes_sort_shown(pl_rock_meshes *meshes) {
  size_t shown = 0;
  for (size_t k = 0; k < meshes->count; k++) {
    pl_rock_mesh *mesh = meshes->list[k];
    if (!mesh->shown)
      continue;
    meshes->list[k] = meshes->list[shown];
    meshes->list[shown++] = mesh;
  }
  return shown;
}

void pl_rock_meshes_clear(pl_rock_meshes *meshes) {
  pl_rock_meshes_drop(meshes, 0);
  pl_free(meshes->list);
  pl_free(meshes->slots);
  pl_rock_spheres_destroy(meshes->spheres);
  *meshes = (pl_rock_meshes){0};
}
