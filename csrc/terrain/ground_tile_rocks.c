/* Rocks of tiles. */
#include "terrain/ground_tile_rocks.h"

#include <string.h>

#include "base/memory.h"

typedef struct collection {
  const pl_rock_field *field;
  const pl_terrain *terrain;
  double cell_m;
  pl_ground_rock *rocks;
  size_t count, capacity;
} collection;

static pl_status collect(void *context, const pl_scatter_site *site) {
  collection *all = context;
  if (all->count == all->capacity) {
    const size_t more = all->capacity > 0 ? 2 * all->capacity : 16;
    pl_ground_rock *grown = pl_realloc(all->rocks, more, sizeof *grown);
    if (grown == NULL)
      return pl_fail(PL_E_MEMORY, "out of memory for the rocks of a tile of ground");
    all->rocks = grown;
    all->capacity = more;
  }
  pl_rock_shape shape;
  pl_ground_rock *at = &all->rocks[all->count];
  if (!pl_rock_set(all->field, all->terrain, site, &at->rock, &shape))
    return PL_OK;
  at->lod = pl_rock_lod(site->diameter_m, all->cell_m);
  at->variant = shape.variant;
  at->mesh = NULL;
  at->stretch = pl_vec3_scale(shape.axes, site->diameter_m * shape.variant->scale[at->lod]);
  all->count++;
  return PL_OK;
}

static pl_status keep(const collection *all, pl_vec3 origin, pl_ground_rocks **out) {
  const size_t list = all->count * sizeof(pl_ground_rock);
  const size_t bytes = sizeof(pl_ground_rocks) + list + (all->count + 1) * sizeof(uint32_t);
  void *block;
  PL_TRY(pl_alloc_or_fail(1, bytes, "the rocks of a tile of ground", &block));
  pl_ground_rocks *rocks = block;
  *rocks = (pl_ground_rocks){.count = all->count,
                             .bytes = bytes,
                             .origin = origin,
                             .rocks = (pl_ground_rock *)(void *)(rocks + 1)};
  rocks->first = (uint32_t *)(void *)(rocks->rocks + all->count);
  memcpy(rocks->rocks, all->rocks, list);
  for (size_t k = 0; k < all->count; k++) {
    const pl_ground_rock *rock = &rocks->rocks[k];
    const double away = pl_vec3_norm(pl_vec3_sub(rock->rock.center, origin));
    rocks->first[k] = (uint32_t)rocks->triangle_count;
    rocks->triangle_count += (size_t)pl_rock_field_spheres(all->field)[rock->lod].triangle_count;
    rocks->radius_m = fmax(rocks->radius_m, away + rock->variant->scale[rock->lod] *
                                                       PL_ROCK_SHAPE_REACH * rock->rock.diameter_m);
  }
  rocks->first[all->count] = (uint32_t)rocks->triangle_count;
  *out = rocks;
  return PL_OK;
}

double pl_ground_rocks_expected(const pl_rock_field *field, double radius_m, pl_ground_tile_id id) {
  const pl_rock_frame *frame = pl_rock_field_frame(field);
  const double cell_m = pl_cube_cell_m(pl_ground_tile_lattice(id), radius_m);
  const double side_m = PL_GROUND_TILE_CELLS * cell_m;
  const double least_m = fmax(frame->min_m, PL_ROCK_CELLS * cell_m);
  if (!(least_m < frame->max_m))
    return 0.0;
  return side_m * side_m *
         (pl_rock_density(&frame->law, least_m) - pl_rock_density(&frame->law, frame->max_m));
}

pl_status pl_ground_rocks_make(const pl_rock_field *field, const pl_terrain *terrain,
                               pl_ground_tile_id id, pl_vec3 origin, pl_ground_rocks **out) {
  const double cell_m = pl_cube_cell_m(pl_ground_tile_lattice(id), pl_terrain_radius_m(terrain));
  collection all = {.field = field, .terrain = terrain, .cell_m = cell_m};
  const pl_rock_square square = {id.face, id.level, id.i, id.j};
  *out = NULL;
  pl_status status = pl_rock_sites(field, terrain, &square, collect, &all);
  if (status == PL_OK && all.count > 0)
    status = keep(&all, origin, out);
  pl_free(all.rocks);
  return status;
}

void pl_ground_rocks_destroy(pl_ground_rocks *rocks) { pl_free(rocks); }

pl_status pl_ground_rocks_link(pl_ground_rocks *rocks, pl_rock_meshes *meshes) {
  for (size_t k = 0; k < rocks->count; k++) {
    pl_ground_rock *rock = &rocks->rocks[k];
    PL_TRY(pl_rock_meshes_add(meshes, rock->variant, rock->lod, &rock->mesh));
  }
  return PL_OK;
}

pl_vec3 pl_ground_rock_out(const pl_ground_rock *rock, pl_vec3 p) {
  const pl_vec3 s = rock->stretch;
  return pl_mat3_mul_vec(rock->rock.rotation, (pl_vec3){s.x * p.x, s.y * p.y, s.z * p.z});
}

static pl_vec3 over(pl_vec3 p, pl_vec3 s) { return (pl_vec3){p.x / s.x, p.y / s.y, p.z / s.z}; }

pl_vec3 pl_ground_rock_in(const pl_ground_rock *rock, pl_vec3 p) {
  return over(pl_mat3_mul_vec_t(rock->rock.rotation, p), rock->stretch);
}

pl_vec3 pl_ground_rock_normal(const pl_ground_rock *rock, pl_vec3 normal) {
  return pl_mat3_mul_vec(rock->rock.rotation, over(normal, rock->stretch));
}

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
