/* Points of rocks over the ground. */
#include "terrain/rock_surface.h"

#include "base/memory.h"

/* Vertices of a mesh, and their heights over the ground. */
typedef struct vertices {
  const pl_rock_sphere *sphere;
  size_t count;
  pl_vec3 *points, *directions;
  double *over_m;
} vertices;

static void place(vertices *v, const pl_rock *rock, const pl_rock_shape *shape, int lod) {
  const double m = rock->diameter_m * shape->variant->scale[lod];
  const pl_vec3 s = pl_vec3_scale(shape->axes, m);
  for (size_t k = 0; k < v->count; k++) {
    const pl_vec3 d = v->sphere->vertices[k];
    const pl_vec3 p = pl_vec3_scale(d, pl_rock_variant_radius(shape->variant, d));
    const pl_vec3 own = {s.x * p.x, s.y * p.y, s.z * p.z};
    v->points[k] = pl_vec3_add(rock->center, pl_mat3_mul_vec(rock->rotation, own));
    v->directions[k] = pl_vec3_unit(v->points[k]);
  }
}

static pl_status measure(vertices *v, const pl_terrain *terrain, double cell_m) {
  const int level = pl_terrain_level_of(terrain, cell_m);
  PL_TRY(pl_terrain_heights(terrain, v->directions, v->count, level, v->over_m));
  for (size_t k = 0; k < v->count; k++)
    v->over_m[k] =
        pl_vec3_norm(v->points[k]) - pl_terrain_datum_m(terrain, v->directions[k]) - v->over_m[k];
  return PL_OK;
}

/* Where the edge between a vertex over the ground and one below goes through it. */
static pl_vec3 crossing(const vertices *v, uint32_t a, uint32_t b) {
  const double t = v->over_m[a] / (v->over_m[a] - v->over_m[b]);
  return pl_vec3_madd(v->points[a], t, pl_vec3_sub(v->points[b], v->points[a]));
}

/* Writes the points over the ground; there is room for all. */
static size_t collect(const vertices *v, pl_vec3 *out) {
  size_t count = 0;
  for (size_t k = 0; k < v->count; k++)
    if (v->over_m[k] >= 0.0)
      out[count++] = v->points[k];
  for (int k = 0; k < v->sphere->triangle_count; k++)
    for (int c = 0; c < 3; c++) {
      /* Of the two triangles at an edge, one meets it from above to below. */
      const uint32_t a = v->sphere->triangles[k][c], b = v->sphere->triangles[k][(c + 1) % 3];
      if (v->over_m[a] >= 0.0 && v->over_m[b] < 0.0)
        out[count++] = crossing(v, a, b);
    }
  return count;
}

/* Room for the vertices of a sphere, in one block. */
static pl_status make_room(const pl_rock_sphere *sphere, vertices *out) {
  const size_t count = (size_t)sphere->vertex_count;
  void *block;
  PL_TRY(pl_alloc_or_fail(count, 2 * sizeof(pl_vec3) + sizeof(double), "points of rocks", &block));
  *out = (vertices){.sphere = sphere, .count = count, .points = block};
  out->directions = out->points + count;
  out->over_m = (double *)(void *)(out->directions + count);
  return PL_OK;
}

/* Adds the points of a rock to those of the rocks before. */
static pl_status add(pl_rock_surfaces *all, size_t at, const pl_rock_field *field,
                     const pl_terrain *terrain, const pl_rock_shape *shape, double cell_m) {
  const pl_rock *rock = &all->rocks[at];
  const int lod = pl_rock_lod(rock->diameter_m, cell_m);
  const pl_rock_sphere *sphere = &pl_rock_field_spheres(field)[lod];
  const size_t before = all->first[at];
  const size_t edges = (size_t)sphere->triangle_count * 3 / 2;
  const size_t most = before + (size_t)sphere->vertex_count + edges;
  pl_vec3 *grown = pl_realloc(all->points, most, sizeof *grown);
  if (grown == NULL)
    return pl_fail(PL_E_MEMORY, "out of memory for points of rocks");
  all->points = grown;
  vertices v;
  PL_TRY(make_room(sphere, &v));
  place(&v, rock, shape, lod);
  const pl_status status = measure(&v, terrain, cell_m);
  if (status == PL_OK)
    all->first[at + 1] = before + collect(&v, all->points + before);
  pl_free(v.points);
  return status;
}

/* Width of a pixel at the near side of a rock, as far as meshes show the rock. */
static double cell_of(const pl_rock *rock, pl_vec3 eye, double pixel_rad) {
  const double away = pl_vec3_norm(pl_vec3_sub(rock->center, eye)) - 0.5 * rock->diameter_m;
  const double cell_m = pixel_rad * fmax(away, 0.1 * rock->diameter_m);
  return fmin(cell_m, rock->diameter_m / PL_ROCK_CELLS);
}

static pl_status find_all(const pl_rock_field *field, const pl_terrain *terrain,
                          const uint64_t *ids, pl_vec3 eye, double pixel_rad,
                          pl_rock_surfaces *out) {
  for (size_t k = 0; k < out->count; k++) {
    pl_rock_shape shape;
    pl_rock *rock = &out->rocks[k];
    if (!pl_rock_find(field, terrain, ids[k], rock, &shape))
      return pl_fail(PL_E_RANGE, "no rock with the id %llu", (unsigned long long)ids[k]);
    PL_TRY(add(out, k, field, terrain, &shape, cell_of(rock, eye, pixel_rad)));
  }
  return PL_OK;
}

pl_status pl_rock_surfaces_find(const pl_rock_field *field, const pl_terrain *terrain,
                                const uint64_t *ids, size_t count, pl_vec3 eye, double pixel_rad,
                                pl_rock_surfaces *out) {
  void *rocks, *first = NULL;
  *out = (pl_rock_surfaces){.count = count};
  pl_status status = pl_alloc_or_fail(count, sizeof(pl_rock), "rocks", &rocks);
  out->rocks = rocks;
  if (status == PL_OK)
    status = pl_alloc_or_fail(count + 1, sizeof(size_t), "rocks", &first);
  out->first = first;
  if (status == PL_OK) {
    out->first[0] = 0;
    status = find_all(field, terrain, ids, eye, pixel_rad, out);
  }
  if (status != PL_OK)
    pl_rock_surfaces_clear(out);
  return status;
}

void pl_rock_surfaces_clear(pl_rock_surfaces *surfaces) {
  pl_free(surfaces->rocks);
  pl_free(surfaces->first);
  pl_free(surfaces->points);
  *surfaces = (pl_rock_surfaces){0};
}
