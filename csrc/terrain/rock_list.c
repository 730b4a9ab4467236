/* Lists the rocks of a region. */
#include "base/memory.h"
#include "terrain/rock_parts.h"

/* A search for sites. */
typedef struct region {
  const pl_scatter *scatter;
  pl_rock_region rocks;
  pl_vec3 axis;
  double angle_rad, more; /* more: angle a metre of diameter */
  double min_m, max_m;
  pl_rock_site_fn visit;
  void *context;
} region;

typedef struct rock_list {
  const pl_rock_field *field;
  const pl_terrain *terrain;
  pl_vec3 axis;
  double angle_rad, min_m, max_m;
  pl_rock *rocks;
  size_t count, capacity;
} rock_list;

static double angle_between(pl_vec3 a, pl_vec3 b) {
  return 2.0 * asin(fmin(0.5 * pl_vec3_norm(pl_vec3_sub(a, b)), 1.0));
}

static pl_status visit_site(const region *at, const pl_scatter_site *site) {
  if (site->diameter_m < at->min_m || site->diameter_m >= at->max_m ||
      angle_between(site->direction, at->axis) > at->angle_rad + at->more * site->diameter_m)
    return PL_OK;
  return at->visit(at->context, site);
}

/* Visits the sites of a cell, then those of its four parts on the finer lattices. */
static pl_status visit(const region *at, const pl_scatter_cell *cell) {
  const pl_scatter *scatter = at->scatter;
  const pl_vec3 middle =
      pl_cube_direction(cell->face, ldexp((double)cell->i + 0.5, 1 - cell->level) - 1.0,
                        ldexp((double)cell->j + 0.5, 1 - cell->level) - 1.0);
  const bool used = cell->level >= scatter->first;
  const pl_scatter_octave *octave = &scatter->octaves[used ? cell->level : scatter->first];
  /* Half the diagonal of a cell is below 0.71 of its width. */
  const double reach = 0.71 * ldexp(0.5 * PL_PI, -cell->level) + at->more * octave->high_m;
  if (angle_between(middle, at->axis) > at->angle_rad + reach)
    return PL_OK;
  if (used && octave->high_m > at->min_m && octave->low_m < at->max_m) {
    uint64_t laws;
    const uint64_t count = pl_rock_candidates(&at->rocks, cell, &laws);
    pl_scatter_site site;
    for (uint64_t n = 0; n < count; n++)
      if (pl_rock_draw(&at->rocks, cell, n, laws, &site))
        PL_TRY(visit_site(at, &site));
  }
  if (cell->level >= scatter->last || (used && octave->low_m <= at->min_m))
    return PL_OK;
  for (uint64_t part = 0; part < 4; part++) {
    const pl_scatter_cell inner = {cell->level + 1, cell->face, 2 * cell->i + part % 2,
                                   2 * cell->j + part / 2};
    PL_TRY(visit(at, &inner));
  }
  return PL_OK;
}

pl_status pl_rock_sites_near(const pl_rock_field *field, const pl_terrain *terrain,
                             pl_vec3 direction, const pl_rock_reach *reach,
                             pl_rock_site_fn visit_one, void *context) {
  const double per_m = 1.0 / field->frame.radius_m;
  region at = {.scatter = &field->scatter,
               .axis = direction,
               .angle_rad = fmin(reach->radius_m * per_m, PL_PI),
               .more = reach->diameters * per_m,
               .min_m = reach->min_m,
               .max_m = reach->max_m,
               .visit = visit_one,
               .context = context};
  const double widest_m = fmin(reach->max_m, field->frame.max_m);
  pl_status status =
      pl_rock_region_init(field, terrain, direction, at.angle_rad + at.more * widest_m, &at.rocks);
  for (int face = 0; face < PL_CUBE_FACES && field->scatter.last >= 0 && status == PL_OK; face++) {
    const pl_scatter_cell cell = {0, face, 0, 0};
    status = visit(&at, &cell);
  }
  pl_rock_region_clear(&at.rocks);
  return status;
}

static pl_status append(void *context, const pl_scatter_site *site) {
  rock_list *list = context;
  if (list->count == list->capacity) {
    const size_t more = list->capacity > 0 ? 2 * list->capacity : 64;
    pl_rock *grown = pl_realloc(list->rocks, more, sizeof *grown);
    if (grown == NULL)
      return pl_fail(PL_E_MEMORY, "out of memory for a list of %zu rocks", more);
    list->rocks = grown;
    list->capacity = more;
  }
  pl_rock_shape shape;
  list->count += pl_rock_set(list->field, list->terrain, site, &list->rocks[list->count], &shape);
  return PL_OK;
}

static pl_status check(const rock_list *list) {
  const pl_rock_frame *frame = &list->field->frame;
  const double half = sin(0.5 * list->angle_rad), r = frame->radius_m;
  const double area = 4.0 * PL_PI * r * r * half * half;
  const double from = fmax(list->min_m, frame->min_m), to = fmin(list->max_m, frame->max_m);
  const pl_size_table *sizes = list->field->scatter.sizes;
  const double expected =
      from < to ? area * (pl_size_table_density(sizes, from) - pl_size_table_density(sizes, to))
                : 0.0;
  if (expected <= PL_ROCK_LIST_MOST)
    return PL_OK;
  return pl_fail(PL_E_RANGE,
                 "a list of about %.3g rocks of %g m or more; at most %g can be listed: raise the "
                 "least diameter or lower the radius",
                 expected, from, PL_ROCK_LIST_MOST);
}

pl_status pl_rock_list(const pl_rock_field *field, const pl_terrain *terrain, pl_vec3 direction,
                       double radius_m, double min_m, double max_m, pl_rock **out, size_t *count) {
  rock_list list = {.field = field,
                    .terrain = terrain,
                    .axis = pl_vec3_unit(direction),
                    .angle_rad = fmin(radius_m / field->frame.radius_m, PL_PI),
                    .min_m = min_m,
                    .max_m = max_m};
  *out = NULL;
  *count = 0;
  if (!(list.angle_rad >= 0.0) || !(pl_vec3_norm(direction) > 0.0) || !pl_vec3_finite(direction))
    return pl_fail(PL_E_RANGE,
                   "rocks within %g m of (%g, %g, %g); need a direction and a radius of 0 or more",
                   radius_m, direction.x, direction.y, direction.z);
  PL_TRY(check(&list));
  const pl_rock_reach reach = {radius_m, 0.0, min_m, max_m};
  const pl_status status = pl_rock_sites_near(field, terrain, list.axis, &reach, append, &list);
  if (status != PL_OK) {
    pl_free(list.rocks);
    return status;
  }
  *out = list.rocks;
  *count = list.count;
  return PL_OK;
}
