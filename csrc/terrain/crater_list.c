/* Lists the craters of a region. */
#include "base/memory.h"
#include "terrain/crater_cells.h"

typedef struct crater_list {
  const pl_crater_field *field;
  const pl_crater_model *model;
  pl_crater *craters;
  size_t count, capacity;
} crater_list;

typedef struct crater_kept {
  const pl_crater_field *field;
  const pl_crater *older;
  double kept;
} crater_kept;

static pl_status erase(void *context, const pl_scatter_site *site) {
  crater_kept *kept = context;
  pl_crater_draw draw;
  pl_crater_draw_age(kept->field, site, &draw);
  if (!pl_crater_younger(draw.age_ga, site->id, kept->older->age_ga, kept->older->id))
    return PL_OK;
  const pl_vec3 to = pl_vec3_sub(site->direction, kept->older->direction);
  kept->kept *=
      1.0 - pl_crater_erasure(site->diameter_m, kept->older->diameter_m) *
                pl_crater_erasure_at(pl_vec3_dot(to, to),
                                     0.5 * site->diameter_m / kept->field->frame.radius_m);
  return PL_OK;
}

static pl_status find_kept(const crater_list *list, pl_crater *crater) {
  const pl_crater_query query = {list->model,
                                 crater->direction,
                                 0.0,
                                 PL_CRATER_ERASE_TO,
                                 PL_CRATER_ERASE_RATIO * crater->diameter_m,
                                 INFINITY};
  crater_kept kept = {list->field, crater, 1.0};
  PL_TRY(pl_crater_visit(list->field, &query, erase, &kept));
  crater->kept =
      kept.kept * pl_crater_left(list->field, list->model, crater->direction, crater->diameter_m);
  return PL_OK;
}

void pl_crater_measure(const pl_crater_field *field, pl_crater *crater) {
  float profile[PL_CRATER_KNOTS];
  const pl_crater_dimensions fresh = pl_crater_fresh(crater->diameter_m);
  pl_crater_profile(field->shapes, &fresh, crater->tau, profile);
  float low = 0.0f, high = 0.0f;
  for (int k = 0; k < PL_CRATER_KNOTS; k++) {
    low = fminf(low, profile[k]);
    high = fmaxf(high, profile[k]);
  }
  crater->rim_m = (double)high;
  crater->depth_m = (double)high - (double)low;
}

static pl_status append(void *context, const pl_scatter_site *site) {
  crater_list *list = context;
  if (list->count == list->capacity) {
    const size_t more = list->capacity > 0 ? 2 * list->capacity : 64;
    pl_crater *grown = pl_realloc(list->craters, more, sizeof *grown);
    if (grown == NULL)
      return pl_fail(PL_E_MEMORY, "out of memory for a list of %zu craters", more);
    list->craters = grown;
    list->capacity = more;
  }
  pl_crater_draw draw;
  pl_crater_draw_age(list->field, site, &draw);
  pl_crater_draw_shape(list->field, site, &draw);
  pl_crater *crater = &list->craters[list->count++];
  *crater = (pl_crater){.id = site->id,
                        .direction = site->direction,
                        .major = draw.major,
                        .diameter_m = site->diameter_m,
                        .axis_ratio = draw.axis_ratio,
                        .age_ga = draw.age_ga,
                        .tau = draw.tau};
  pl_crater_measure(list->field, crater);
  return find_kept(list, crater);
}

static pl_status check_count(const pl_crater_field *field, double angle, double min_m,
                             double max_m) {
  const double half = sin(0.5 * angle), r = field->frame.radius_m;
  const double area = 4.0 * PL_PI * r * r * half * half;
  const double from = fmax(min_m, field->frame.min_m), to = fmin(max_m, field->frame.max_m);
  if (from >= to)
    return PL_OK;
  const double expected = area * (pl_size_table_density(field->scatter.sizes, from) -
                                  pl_size_table_density(field->scatter.sizes, to));
  if (expected <= PL_CRATER_LIST_MOST)
    return PL_OK;
  return pl_fail(
      PL_E_RANGE,
      "a list of about %.3g craters of %g m or more; at most %g can be listed: raise the "
      "least diameter or lower the radius",
      expected, from, PL_CRATER_LIST_MOST);
}

pl_status pl_crater_list(const pl_crater_field *field, const pl_crater_model *model,
                         pl_vec3 direction, double radius_m, double min_m, double max_m,
                         pl_crater **out, size_t *count) {
  *out = NULL;
  *count = 0;
  const double angle = fmin(radius_m / field->frame.radius_m, PL_PI);
  if (!(angle >= 0.0) || !(pl_vec3_norm(direction) > 0.0) || !pl_vec3_finite(direction))
    return pl_fail(PL_E_RANGE,
                   "craters within %g m of (%g, %g, %g); need a direction and a radius "
                   "of 0 or more",
                   radius_m, direction.x, direction.y, direction.z);
  PL_TRY(check_count(field, angle, min_m, max_m));
  const pl_crater_query query = {model, pl_vec3_unit(direction), angle, 0.0, min_m, max_m};
  crater_list list = {.field = field, .model = model};
  const pl_status status = pl_crater_visit(field, &query, append, &list);
  if (status != PL_OK) {
    pl_free(list.craters);
    return status;
  }
  *out = list.craters;
  *count = list.count;
  return PL_OK;
}
