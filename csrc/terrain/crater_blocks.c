#include "terrain/crater_blocks.h"

#include "base/memory.h"
#include "terrain/crater_cells.h"

/* In radii; density within the rim over that at it. */
#define REACH 5.0
#define FALL 0.7
#define WITHIN 0.05
/* Degradation (pl_crater.tau) of craters that have none left. */
#define WORN 0.02

typedef struct gathered {
  const pl_crater_field *field;
  const pl_crater_blocks *blocks;
  pl_crater_source *list;
  size_t count, capacity;
} gathered;

static pl_status keep(void *context, const pl_scatter_site *site) {
  gathered *all = context;
  pl_crater_draw draw;
  pl_crater_draw_age(all->field, site, &draw);
  const double left = 1.0 - fmax(draw.age_ga / all->blocks->life_ga, draw.tau / WORN);
  if (!(left > 0.0))
    return PL_OK;
  if (all->count == all->capacity) {
    const size_t more = all->capacity > 0 ? 2 * all->capacity : 16;
    pl_crater_source *grown = pl_realloc(all->list, more, sizeof *grown);
    if (grown == NULL)
      return pl_fail(PL_E_MEMORY, "out of memory for the blocks of %zu craters", more);
    all->list = grown;
    all->capacity = more;
  }
  all->list[all->count++] =
      (pl_crater_source){.direction = site->direction,
                         .radius = 0.5 * site->diameter_m / all->field->frame.radius_m,
                         .fraction = left * left * left,
                         .most_m = 0.25 * pow(site->diameter_m, 0.7)};
  return PL_OK;
}

pl_status pl_crater_sources(const pl_crater_field *field, const pl_crater_model *model,
                            const pl_crater_blocks *blocks, pl_vec3 axis, double angle_rad,
                            pl_crater_source **out, size_t *count) {
  *out = NULL;
  *count = 0;
  if (field == NULL)
    return PL_OK;
  const pl_crater_query query = {.model = model,
                                 .axis = axis,
                                 .angle_rad = angle_rad,
                                 .reach = REACH,
                                 .min_m = blocks->least_m,
                                 .max_m = INFINITY};
  gathered all = {.field = field, .blocks = blocks};
  const pl_status status = pl_crater_visit(field, &query, keep, &all);
  if (status != PL_OK) {
    pl_free(all.list);
    return status;
  }
  *out = all.list;
  *count = all.count;
  return PL_OK;
}

double pl_crater_blocks_at(const pl_crater_source *sources, size_t count, pl_vec3 direction,
                           double diameter_m) {
  double sum = 0.0;
  for (size_t k = 0; k < count; k++) {
    const pl_crater_source *from = &sources[k];
    const pl_vec3 to = pl_vec3_sub(direction, from->direction);
    const double x = sqrt(pl_vec3_dot(to, to)) / from->radius;
    if (x < REACH && diameter_m <= from->most_m)
      sum += from->fraction * (x < 1.0 ? WITHIN : exp((1.0 - x) / FALL));
  }
  return fmin(sum, 1.0);
}
