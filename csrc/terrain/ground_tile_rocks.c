/* Meshes of the rocks of tiles. */
#include "terrain/ground_tile_rocks.h"

#include <string.h>

#include "base/memory.h"

/* A rock that is to be meshed. */
typedef struct shaped {
  pl_rock rock;
  pl_rock_shape shape;
  int lod;
} shaped;

typedef struct collection {
  const pl_rock_field *field;
  const pl_terrain *terrain;
  double cell_m;
  shaped *rocks;
  size_t count, capacity, vertices, triangles;
} collection;

/* Level with triangles about as wide as cells: 80 triangles from 2 cells on, four times as many for
 * each factor of 2. */
static int lod_of(double diameter_m, double cell_m) {
  const int octave = ilogb(diameter_m / cell_m);
  return octave < 1 ? 1 : octave > PL_ROCK_LODS - 1 ? PL_ROCK_LODS - 1 : octave;
}

static pl_status collect(void *context, const pl_scatter_site *site) {
  collection *all = context;
  if (all->count == all->capacity) {
    const size_t more = all->capacity > 0 ? 2 * all->capacity : 16;
    shaped *grown = pl_realloc(all->rocks, more, sizeof *grown);
    if (grown == NULL)
      return pl_fail(PL_E_MEMORY, "out of memory for the rocks of a tile of ground");
    all->rocks = grown;
    all->capacity = more;
  }
  shaped *at = &all->rocks[all->count];
  if (!pl_rock_set(all->field, all->terrain, site, &at->rock, &at->shape))
    return PL_OK;
  at->lod = lod_of(site->diameter_m, all->cell_m);
  const pl_rock_sphere *sphere = &pl_rock_field_spheres(all->field)[at->lod];
  all->count++;
  all->vertices += (size_t)sphere->vertex_count;
  all->triangles += (size_t)sphere->triangle_count;
  return PL_OK;
}

/* Adds the normals of triangles, which are as long as twice their areas, to those of their corners.
 */
static void set_normals(pl_ground_rocks *out, size_t vertex, size_t vertices, size_t triangle,
                        size_t triangles) {
  memset(out->normals[vertex], 0, vertices * sizeof out->normals[0]);
  for (size_t k = triangle; k < triangle + triangles; k++) {
    pl_vec3f p[3];
    for (int c = 0; c < 3; c++) {
      const float *at = out->positions[out->triangles[k][c]];
      p[c] = (pl_vec3f){at[0], at[1], at[2]};
    }
    const pl_vec3f n = pl_vec3f_cross(pl_vec3f_add(p[1], pl_vec3f_scale(p[0], -1.0f)),
                                      pl_vec3f_add(p[2], pl_vec3f_scale(p[0], -1.0f)));
    for (int c = 0; c < 3; c++) {
      float *at = out->normals[out->triangles[k][c]];
      at[0] += n.x;
      at[1] += n.y;
      at[2] += n.z;
    }
  }
  for (size_t k = vertex; k < vertex + vertices; k++) {
    float *at = out->normals[k];
    const pl_vec3f n = pl_vec3f_unit((pl_vec3f){at[0], at[1], at[2]});
    at[0] = n.x;
    at[1] = n.y;
    at[2] = n.z;
  }
}

/* Meshes one rock behind the others. */
static void add_mesh(const shaped *from, const pl_rock_sphere *sphere, pl_vec3 origin,
                     pl_ground_rocks *out) {
  const size_t vertex = out->vertex_count, triangle = out->triangle_count;
  const pl_vec3 center = pl_vec3_sub(from->rock.center, origin);
  const double scale = from->rock.diameter_m * sphere->scale;
  for (int k = 0; k < sphere->vertex_count; k++) {
    const pl_vec3 own = pl_rock_shape_point(&from->shape, sphere->vertices[k]);
    const pl_vec3 p = pl_vec3_madd(center, scale, pl_mat3_mul_vec(from->rock.rotation, own));
    float *at = out->positions[vertex + (size_t)k];
    at[0] = (float)p.x;
    at[1] = (float)p.y;
    at[2] = (float)p.z;
    out->radius_m = fmax(out->radius_m, pl_vec3_norm(p));
  }
  for (int k = 0; k < sphere->triangle_count; k++)
    for (int c = 0; c < 3; c++)
      out->triangles[triangle + (size_t)k][c] = (uint32_t)vertex + sphere->triangles[k][c];
  set_normals(out, vertex, (size_t)sphere->vertex_count, triangle, (size_t)sphere->triangle_count);
  out->vertex_count += (size_t)sphere->vertex_count;
  out->triangle_count += (size_t)sphere->triangle_count;
}

static pl_status mesh(const collection *all, pl_vec3 origin, pl_ground_rocks **out) {
  enum { BEHIND = 16 };
  const size_t sizes[5] = {all->count * sizeof(pl_rock), (all->count + 1) * sizeof(uint32_t),
                           all->triangles * sizeof(uint32_t[3]), all->vertices * sizeof(float[3]),
                           all->vertices * sizeof(float[3]) + BEHIND};
  size_t bytes = sizeof(pl_ground_rocks);
  for (int k = 0; k < 5; k++)
    bytes += sizes[k];
  void *block;
  PL_TRY(pl_alloc_or_fail(1, bytes, "the rocks of a tile of ground", &block));
  char *at = (char *)block + sizeof(pl_ground_rocks);
  void *parts[5];
  for (int k = 0; k < 5; k++) {
    parts[k] = at;
    at += sizes[k];
  }
  pl_ground_rocks *rocks = block;
  rocks->bytes = bytes;
  rocks->rocks = parts[0];
  rocks->first = parts[1];
  rocks->triangles = parts[2];
  rocks->normals = parts[3];
  rocks->positions = parts[4];
  for (size_t k = 0; k < all->count; k++) {
    rocks->rocks[k] = all->rocks[k].rock;
    rocks->first[k] = (uint32_t)rocks->triangle_count;
    add_mesh(&all->rocks[k], &pl_rock_field_spheres(all->field)[all->rocks[k].lod], origin, rocks);
  }
  rocks->count = all->count;
  rocks->first[all->count] = (uint32_t)rocks->triangle_count;
  rocks->radius_m *= 1.0 + 1e-6;
  *out = rocks;
  return PL_OK;
}

pl_status pl_ground_rocks_make(const pl_rock_field *field, const pl_terrain *terrain,
                               pl_ground_tile_id id, pl_vec3 origin, pl_ground_rocks **out) {
  const double cell_m = pl_cube_cell_m(pl_ground_tile_lattice(id), pl_terrain_radius_m(terrain));
  collection all = {.field = field, .terrain = terrain, .cell_m = cell_m};
  const pl_rock_square square = {id.face, id.level, id.i, id.j};
  *out = NULL;
  pl_status status = pl_rock_sites(field, terrain, &square, collect, &all);
  if (status == PL_OK && all.count > 0)
    status = mesh(&all, origin, out);
  pl_free(all.rocks);
  return status;
}

void pl_ground_rocks_destroy(pl_ground_rocks *rocks) { pl_free(rocks); }

size_t pl_ground_rocks_of(const pl_ground_rocks *rocks, uint32_t triangle) {
  size_t low = 0, high = rocks->count;
  while (high - low > 1) {
    const size_t middle = (low + high) / 2;
    if (rocks->first[middle] <= triangle)
      low = middle;
    else
      high = middle;
  }
  return low;
}
