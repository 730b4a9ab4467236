/* Cells of the sky: the faces of a cube about the observer, divided into squares. This avoids
 * singular poles and a wrap of longitude. */
#include "sky/catalogue.h"

#include <stdlib.h>

#include "base/memory.h"

/* A star and its sort key: cell, then brightness, then index in the list. */
typedef struct entry {
  pl_star star;
  size_t cell, place;
} entry;

static size_t step_of(double coordinate) {
  const double step = floor(0.5 * (coordinate + 1.0) * PL_SKY_GRID);
  return (size_t)fmin(fmax(step, 0.0), PL_SKY_GRID - 1);
}

static size_t cell_of(pl_vec3 d) {
  const double along[3] = {d.x, d.y, d.z};
  int axis = fabs(d.y) > fabs(d.x) ? 1 : 0;
  if (fabs(d.z) > fabs(along[axis]))
    axis = 2;
  const double depth = fabs(along[axis]);
  const size_t face = 2 * (size_t)axis + (along[axis] < 0.0);
  const size_t column = step_of(along[(axis + 1) % 3] / depth);
  const size_t row = step_of(along[(axis + 2) % 3] / depth);
  return (face * PL_SKY_GRID + row) * PL_SKY_GRID + column;
}

static int compare(const void *left, const void *right) {
  const entry *a = left, *b = right;
  const float fa = pl_star_brightness(&a->star), fb = pl_star_brightness(&b->star);
  if (a->cell != b->cell)
    return a->cell < b->cell ? -1 : 1;
  if (fa != fb)
    return fa > fb ? -1 : 1;
  return a->place < b->place ? -1 : a->place > b->place;
}

static pl_status take(const pl_star *star, size_t place, entry *out) {
  const double norm = pl_vec3_norm(star->direction);
  if (!(norm > 0.0 && isfinite(norm)))
    return pl_fail(PL_E_RANGE, "star %zu: its direction must be finite and not zero", place);
  for (int band = 0; band < 3; band++)
    if (!(star->light[band] >= 0.0f && isfinite(star->light[band])))
      return pl_fail(PL_E_RANGE, "star %zu: its light must be finite and not negative", place);
  *out = (entry){*star, 0, place};
  out->star.direction = pl_vec3_scale(star->direction, 1.0 / norm);
  out->cell = cell_of(out->star.direction);
  return PL_OK;
}

static void bound_cell(const pl_star *stars, pl_sky_cell *cell) {
  pl_vec3 sum = {0.0, 0.0, 0.0};
  for (size_t i = 0; i < cell->count; i++)
    sum = pl_vec3_add(sum, stars[cell->first + i].direction);
  cell->axis = pl_vec3_unit(sum);
  for (size_t i = 0; i < cell->count; i++) {
    const pl_vec3 d = stars[cell->first + i].direction;
    const double sine = pl_vec3_norm(pl_vec3_cross(cell->axis, d));
    cell->half_angle_rad = fmax(cell->half_angle_rad, atan2(sine, pl_vec3_dot(cell->axis, d)));
  }
}

/* Fills the cells, and `rest`: the summed brightness of the fainter stars of the same cell. */
static void fill_cells(const entry *entries, pl_star_catalogue *catalogue) {
  for (size_t i = 0; i < catalogue->count; i++) {
    pl_sky_cell *cell = &catalogue->cells[entries[i].cell];
    if (cell->count++ == 0)
      cell->first = i;
    catalogue->stars[i] = entries[i].star;
  }
  for (size_t c = 0; c < PL_SKY_CELLS; c++) {
    pl_sky_cell *cell = &catalogue->cells[c];
    double rest = 0.0;
    for (size_t i = cell->count; i-- > 0;) {
      catalogue->rest[cell->first + i] = rest;
      rest += (double)pl_star_brightness(&catalogue->stars[cell->first + i]);
    }
    bound_cell(catalogue->stars, cell);
  }
}

static pl_status build(const pl_star *stars, size_t count, entry *entries,
                       pl_star_catalogue *catalogue) {
  void *sorted, *rest;
  for (size_t i = 0; i < count; i++)
    PL_TRY(take(&stars[i], i, &entries[i]));
  qsort(entries, count, sizeof *entries, compare);
  PL_TRY(pl_alloc_or_fail(count, sizeof(pl_star), "stars", &sorted));
  catalogue->stars = sorted;
  PL_TRY(pl_alloc_or_fail(count, sizeof(double), "stars", &rest));
  catalogue->rest = rest;
  catalogue->count = count;
  fill_cells(entries, catalogue);
  return PL_OK;
}

pl_status pl_star_catalogue_create(const pl_star *stars, size_t count, pl_star_catalogue **out) {
  void *memory, *entries;
  PL_TRY(pl_alloc_or_fail(1, sizeof(pl_star_catalogue), "a star catalogue", &memory));
  pl_star_catalogue *catalogue = memory;
  pl_status status = pl_alloc_or_fail(count, sizeof(entry), "stars", &entries);
  if (status == PL_OK) {
    status = build(stars, count, entries, catalogue);
    pl_free(entries);
  }
  if (status != PL_OK)
    pl_star_catalogue_destroy(catalogue);
  else
    *out = catalogue;
  return status;
}

void pl_star_catalogue_destroy(pl_star_catalogue *catalogue) {
  if (catalogue == NULL)
    return;
  pl_free(catalogue->stars);
  pl_free(catalogue->rest);
  pl_free(catalogue);
}
