/* Relief of a field of craters: gathers the craters that touch a block, then sums their profiles.
 */
#include <string.h>

#include "base/memory.h"
#include "terrain/cone.h"
#include "terrain/crater_cells.h"

/* What most tests need of a crater over a block; apart, so that it stays in the nearest cache. */
typedef struct bound {
  pl_vec3 direction;
  double reach;  /* chord beyond which it has no relief */
  double radius; /* over that of the body */
} bound;

/* A crater over a block. */
typedef struct touching {
  pl_vec3 u, v; /* tangent axes over the semi-axes: they give x along major and minor */
  double fade;
  double offset[2];
  double by_radius[PL_CRATER_RADIUS_ORDERS][2], by_height[PL_CRATER_HEIGHT_ORDERS][2];
  pl_crater_terraces terraces;
  bool partial; /* models may show a part of it */
  double age_ga, diameter_m;
  uint64_t id;
  size_t first_eraser, eraser_count;
  float profile[PL_CRATER_KNOTS]; /* m */
} touching;

/* A younger crater that removes a fraction of an older one within its rim. */
typedef struct eraser {
  size_t crater;
  double fraction;
} eraser;

typedef struct gathered {
  const pl_crater_field *field;
  const pl_crater_model *model; /* or NULL */
  double footprint_m;
  bound *bounds; /* of the craters */
  touching *craters;
  eraser *erasers;
  size_t *near; /* craters near the points at hand: `count` elements */
  size_t count, capacity, bound_capacity, eraser_count, eraser_capacity;
} gathered;

static pl_status grow(void **items, size_t size, size_t count, size_t *capacity) {
  if (count < *capacity)
    return PL_OK;
  const size_t more = *capacity > 0 ? 2 * *capacity : 64;
  void *grown = pl_realloc(*items, more, size);
  if (grown == NULL)
    return pl_fail(PL_E_MEMORY, "out of memory for %zu craters", more);
  *items = grown;
  *capacity = more;
  return PL_OK;
}

static pl_status touch(void *context, const pl_scatter_site *site) {
  gathered *all = context;
  const pl_crater_field *field = all->field;
  PL_TRY(grow((void **)&all->craters, sizeof *all->craters, all->count, &all->capacity));
  PL_TRY(grow((void **)&all->bounds, sizeof *all->bounds, all->count, &all->bound_capacity));
  pl_crater_draw draw;
  pl_crater_draw_age(field, site, &draw);
  pl_crater_draw_shape(field, site, &draw);
  pl_crater_draw_terraces(field, site, all->footprint_m, &draw);
  const double radius = 0.5 * site->diameter_m / field->frame.radius_m;
  const double chord = 2.0 * sin(0.5 * fmin(PL_CRATER_REACH * field->stretch * radius, PL_PI));
  all->bounds[all->count] = (bound){site->direction, chord, radius};
  touching *crater = &all->craters[all->count++];
  const double root = sqrt(draw.axis_ratio);
  crater->u = pl_vec3_scale(draw.major, root / radius);
  crater->v = pl_vec3_scale(draw.minor, 1.0 / (root * radius));
  crater->fade = pl_crater_fade(site->diameter_m, all->footprint_m);
  crater->terraces = draw.terraces;
  crater->partial = all->model != NULL && all->model->left != NULL &&
                    site->diameter_m >= field->frame.model_posts * all->model->least_spacing_m;
  memcpy(crater->offset, draw.offset, sizeof draw.offset);
  memcpy(crater->by_radius, draw.radius, sizeof draw.radius);
  memcpy(crater->by_height, draw.height, sizeof draw.height);
  crater->age_ga = draw.age_ga;
  crater->diameter_m = site->diameter_m;
  crater->id = site->id;
  crater->first_eraser = crater->eraser_count = 0;
  const pl_crater_dimensions fresh = pl_crater_fresh(site->diameter_m);
  pl_crater_profile(field->shapes, &fresh, draw.tau, crater->profile);
  return PL_OK;
}

static bool overlap(const bound *younger, const bound *older) {
  const pl_vec3 to = pl_vec3_sub(younger->direction, older->direction);
  const double reach = PL_CRATER_ERASE_TO * younger->radius + older->reach;
  return pl_vec3_dot(to, to) < reach * reach;
}

/* Lists for each crater the younger ones that remove some of it. */
static pl_status find_erasers(gathered *all) {
  for (size_t k = 0; k < all->count; k++) {
    touching *older = &all->craters[k];
    older->first_eraser = all->eraser_count;
    for (size_t m = 0; m < all->count; m++) {
      const touching *younger = &all->craters[m];
      /* Octaves come in the order of size: behind are only smaller ones. */
      if (younger->diameter_m < 0.25 * older->diameter_m)
        break;
      if (younger->diameter_m <= PL_CRATER_ERASE_RATIO * older->diameter_m ||
          !pl_crater_younger(younger->age_ga, younger->id, older->age_ga, older->id) ||
          !overlap(&all->bounds[m], &all->bounds[k]))
        continue;
      PL_TRY(grow((void **)&all->erasers, sizeof *all->erasers, all->eraser_count,
                  &all->eraser_capacity));
      all->erasers[all->eraser_count++] =
          (eraser){m, younger->fade * pl_crater_erasure(younger->diameter_m, older->diameter_m)};
    }
    older->eraser_count = all->eraser_count - older->first_eraser;
  }
  return PL_OK;
}

static double chord2_to(const bound *crater, pl_vec3 direction) {
  const pl_vec3 to = pl_vec3_sub(direction, crater->direction);
  return pl_vec3_dot(to, to);
}

/* Radius at which the smooth wall has the height of the terraced one at x: a step leads down
 * quickly at its outer side and slowly on its tread. */
static double terraced(const pl_crater_terraces *of, double x, double c, double s) {
  const double t = (x - of->floor) / (1.0 - of->floor);
  if (!(t > 0.0 && t < 1.0))
    return x;
  double wander = 0.0, come = 1.0, cm = c, sm = s;
  for (int k = 0; k < PL_CRATER_TERRACE_ORDERS; k++) {
    wander += of->wander[k][0] * cm + of->wander[k][1] * sm;
    come += of->come[k][0] * cm + of->come[k][1] * sm;
    const double next = cm * c - sm * s;
    sm = sm * c + cm * s;
    cm = next;
  }
  const double window = 16.0 * t * t * (1.0 - t) * (1.0 - t);
  const double turn = 2.0 * PL_PI * (of->count * t + wander);
  return x - of->depth * fmin(fmax(come, 0.0), 1.3) * window * sin(turn) * (1.0 - of->floor) /
                 (2.0 * PL_PI * of->count);
}

/* Height of one crater at a direction: its profile, at a radius and with a height that vary with
 * the azimuth. */
static double relief(const touching *crater, const bound *at, pl_vec3 direction) {
  const pl_vec3 to = pl_vec3_sub(direction, at->direction);
  const double chord2 = pl_vec3_dot(to, to);
  if (chord2 >= at->reach * at->reach)
    return 0.0;
  /* Tangent components are sines of angles; the series gives angles, to 1e-3 at the reach of the
   * largest craters. */
  const double sine2 = chord2 * (1.0 - 0.25 * chord2);
  const double arc = 1.0 + sine2 * (1.0 / 6.0 + sine2 * (3.0 / 40.0));
  double u = arc * pl_vec3_dot(crater->u, to), v = arc * pl_vec3_dot(crater->v, to);
  const double inside = fmax(1.0 - u * u - v * v, 0.0);
  u += crater->offset[0] * inside * inside;
  v += crater->offset[1] * inside * inside;
  const double r2 = u * u + v * v, r = sqrt(r2);
  const double c = r > 0.0 ? u / r : 1.0, s = r > 0.0 ? v / r : 0.0;
  double radius = 1.0, height = 0.0, cm = c, sm = s;
  for (int order = 1; order < PL_CRATER_RADIUS_ORDERS + 2; order++) {
    if (order >= 2)
      radius += crater->by_radius[order - 2][0] * cm + crater->by_radius[order - 2][1] * sm;
    if (order <= PL_CRATER_HEIGHT_ORDERS)
      height += crater->by_height[order - 1][0] * cm + crater->by_height[order - 1][1] * sm;
    const double next = cm * c - sm * s;
    sm = sm * c + cm * s;
    cm = next;
  }
  double x = r / radius;
  if (crater->terraces.count > 0)
    x = terraced(&crater->terraces, x, c, s);
  const double z = pl_crater_profile_height(crater->profile, x);
  return crater->fade * z * (1.0 + height * r2 / (r2 + 0.25));
}

static double height_at(const gathered *all, size_t near_count, pl_vec3 direction) {
  double sum = 0.0;
  for (size_t k = 0; k < near_count; k++) {
    const touching *crater = &all->craters[all->near[k]];
    double z = relief(crater, &all->bounds[all->near[k]], direction);
    if (z != 0.0 && crater->partial)
      z *= pl_crater_left(all->field, all->model, direction, crater->diameter_m);
    if (z == 0.0)
      continue;
    const eraser *erasers = all->erasers + crater->first_eraser;
    for (size_t m = 0; m < crater->eraser_count; m++) {
      const bound *younger = &all->bounds[erasers[m].crater];
      z *= 1.0 - erasers[m].fraction *
                     pl_crater_erasure_at(chord2_to(younger, direction), younger->radius);
    }
    sum += z;
  }
  return sum;
}

/* Finds the craters that touch any of a few points, in their order. Returns their number. */
static size_t find_near(const gathered *all, const pl_vec3 *directions, size_t count) {
  pl_vec3 middle = {0.0, 0.0, 0.0};
  for (size_t k = 0; k < count; k++)
    middle = pl_vec3_madd(middle, 1.0 / (double)count, directions[k]);
  double spread2 = 0.0;
  for (size_t k = 0; k < count; k++) {
    const pl_vec3 to = pl_vec3_sub(directions[k], middle);
    spread2 = fmax(spread2, pl_vec3_dot(to, to));
  }
  const double spread = sqrt(spread2) + 1e-12;
  size_t found = 0;
  for (size_t k = 0; k < all->count; k++) {
    const double reach = all->bounds[k].reach + spread;
    if (chord2_to(&all->bounds[k], middle) < reach * reach)
      all->near[found++] = k;
  }
  return found;
}

/* Points that share a list of craters near them: half of a row of a tile. */
enum { RUN = 18 };

static pl_status add_all(gathered *all, const pl_vec3 *directions, size_t count, double *heights) {
  PL_TRY(find_erasers(all));
  PL_TRY(pl_alloc_or_fail(all->count, sizeof *all->near, "craters", (void **)&all->near));
  for (size_t k = 0; k < count; k += RUN) {
    const size_t run = count - k < RUN ? count - k : RUN;
    const size_t near_count = find_near(all, directions + k, run);
    for (size_t m = k; m < k + run; m++)
      heights[m] += height_at(all, near_count, directions[m]);
  }
  return PL_OK;
}

/* Radius of a block over its footprint beyond which it is halved: far more craters would touch it
 * than each of its points. */
#define WIDEST_BLOCK 128.0

pl_status pl_crater_add_heights(const pl_crater_field *field, const pl_crater_model *model,
                                const pl_vec3 *directions, size_t count, double footprint_m,
                                double *heights) {
  if (count == 0)
    return PL_OK;
  const pl_cone cone = pl_cone_of(directions, count);
  pl_crater_query query = {.model = model,
                           .axis = cone.axis,
                           .angle_rad = cone.angle_rad,
                           .reach = PL_CRATER_REACH * field->stretch,
                           .min_m = PL_CRATER_FADE_FROM * footprint_m,
                           .max_m = INFINITY};
  const double finest_m = fmax(footprint_m, field->frame.min_m / PL_CRATER_FADE_FROM);
  if (count > 1 && query.angle_rad * field->frame.radius_m > WIDEST_BLOCK * finest_m) {
    const size_t half = count / 2;
    PL_TRY(pl_crater_add_heights(field, model, directions, half, footprint_m, heights));
    return pl_crater_add_heights(field, model, directions + half, count - half, footprint_m,
                                 heights + half);
  }
  gathered all = {.field = field, .model = model, .footprint_m = footprint_m};
  pl_status status = pl_crater_visit(field, &query, touch, &all);
  if (status == PL_OK)
    status = add_all(&all, directions, count, heights);
  pl_free(all.bounds);
  pl_free(all.craters);
  pl_free(all.erasers);
  pl_free(all.near);
  return status;
}
