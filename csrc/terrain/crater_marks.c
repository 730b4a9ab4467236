#include "terrain/crater_marks.h"

#include <stdlib.h>

#include "terrain/crater_cells.h"
#include "terrain/terrain_parts.h"

/* More points than this are marked in parts, and so are those with more craters about them: of all
 * sizes, about 30 lie about one point where there are as many as a surface can hold. */
enum { POINTS = 64, SITES = 128 };

typedef enum verdict { UNKNOWN, COUNTS, COUNTS_NOT } verdict;

/* A crater about the points. */
typedef struct mark {
  pl_scatter_site site;
  pl_crater_draw draw;
  bool known; /* of the catalogue: the id is its number, and of what is drawn only the axes count */
  verdict large, deep;
} mark;

typedef struct marks {
  const pl_terrain *terrain;
  const pl_crater_field *field; /* NULL: none are drawn */
  const pl_crater_view *view;
  double least_rad; /* of diameter over distance */
  double stretch;   /* bound of a rim's radius over R */
  bool full;
  size_t count;
  mark sites[SITES];
} marks;

static pl_status keep(void *context, const pl_scatter_site *site) {
  marks *all = context;
  all->full = all->count == SITES;
  if (all->full)
    return PL_E_RANGE; /* ends the visit */
  mark *at = &all->sites[all->count++];
  at->site = *site;
  at->known = false;
  at->large = at->deep = UNKNOWN;
  pl_crater_draw_age(all->field, site, &at->draw);
  pl_crater_draw_shape(all->field, site, &at->draw);
  return PL_OK;
}

static int by_size(const void *a, const void *b) {
  const pl_scatter_site *x = &((const mark *)a)->site, *y = &((const mark *)b)->site;
  if (x->diameter_m != y->diameter_m)
    return x->diameter_m < y->diameter_m ? -1 : 1;
  return x->id < y->id ? -1 : x->id > y->id;
}

/* Whether the rim encloses a direction: that of pl_crater_add_heights. */
static bool encloses(const marks *all, const mark *at, pl_vec3 direction) {
  const pl_crater_draw *draw = &at->draw;
  const double radius = 0.5 * at->site.diameter_m / all->terrain->radius_m;
  const pl_vec3 to = pl_vec3_sub(direction, at->site.direction);
  const double chord2 = pl_vec3_dot(to, to), most = all->stretch * radius;
  if (chord2 > most * most)
    return false;
  const double sine2 = chord2 * (1.0 - 0.25 * chord2);
  const double arc = 1.0 + sine2 * (1.0 / 6.0 + sine2 * (3.0 / 40.0));
  const double root = sqrt(draw->axis_ratio), scale = arc / radius;
  const double u = scale * root * pl_vec3_dot(draw->major, to);
  const double v = scale / root * pl_vec3_dot(draw->minor, to);
  const double turn = atan2(v, u);
  double rim = 1.0;
  for (int k = 0; k < PL_CRATER_RADIUS_ORDERS; k++)
    rim += draw->radius[k][0] * cos((k + 2) * turn) + draw->radius[k][1] * sin((k + 2) * turn);
  return u * u + v * v < rim * rim;
}

/* Fraction of the relief of a crater that younger ones left in a direction. */
static double kept_at(const marks *all, const mark *at, pl_vec3 direction) {
  const pl_crater_model model = pl_terrain_crater_model(all->terrain);
  double kept =
      at->known ? 1.0 : pl_crater_left(all->field, &model, direction, at->site.diameter_m);
  for (size_t k = 0; k < all->count && !at->known; k++) {
    const mark *other = &all->sites[k];
    if (other->known || other->site.diameter_m <= PL_CRATER_ERASE_RATIO * at->site.diameter_m ||
        !pl_crater_younger(other->draw.age_ga, other->site.id, at->draw.age_ga, at->site.id))
      continue;
    const pl_vec3 to = pl_vec3_sub(direction, other->site.direction);
    kept *= 1.0 - pl_crater_erasure(other->site.diameter_m, at->site.diameter_m) *
                      pl_crater_erasure_at(pl_vec3_dot(to, to),
                                           0.5 * other->site.diameter_m / all->terrain->radius_m);
  }
  return kept;
}

static bool is_large(const marks *all, mark *at) {
  if (at->large == UNKNOWN) {
    const pl_vec3 up = at->site.direction;
    const int level = pl_terrain_level_of(all->terrain, 0.125 * at->site.diameter_m);
    const pl_vec3 center = pl_vec3_scale(up, pl_terrain_datum_m(all->terrain, up) +
                                                 pl_terrain_base_height(all->terrain, up, level));
    const double away_m = pl_vec3_norm(pl_vec3_sub(center, all->view->eye));
    at->large = at->site.diameter_m >= all->least_rad * away_m ? COUNTS : COUNTS_NOT;
  }
  return at->large == COUNTS;
}

static bool is_deep(const marks *all, mark *at) {
  if (at->known)
    return true;
  if (at->deep == UNKNOWN) {
    pl_crater crater = {.diameter_m = at->site.diameter_m, .tau = at->draw.tau};
    pl_crater_measure(all->field, &crater);
    const double least_m =
        all->view->criteria.least_depth * pl_crater_fresh(crater.diameter_m).depth_m;
    at->deep = crater.depth_m >= least_m ? COUNTS : COUNTS_NOT;
  }
  return at->deep == COUNTS;
}

static int64_t find(marks *all, pl_vec3 direction) {
  const double least = all->view->criteria.least_kept;
  for (size_t k = 0; k < all->count; k++) {
    mark *at = &all->sites[k];
    if (encloses(all, at, direction) && is_large(all, at) && is_deep(all, at) &&
        kept_at(all, at, direction) >= least)
      return at->known ? -(int64_t)at->site.id : (int64_t)at->site.id;
  }
  return 0;
}

static void keep_known(marks *all, const pl_numbered_crater *from) {
  all->full = all->full || all->count == SITES;
  if (all->full)
    return;
  const pl_vec3 d = from->crater.direction;
  const pl_vec3 other = fabs(d.z) < 0.7 ? (pl_vec3){0.0, 0.0, 1.0} : (pl_vec3){1.0, 0.0, 0.0};
  mark *at = &all->sites[all->count++];
  *at = (mark){
      .site = {.id = (uint64_t)from->number, .direction = d, .diameter_m = from->crater.diameter_m},
      .draw = {.axis_ratio = 1.0, .major = pl_vec3_unit(pl_vec3_cross(other, d))},
      .known = true};
  at->draw.minor = pl_vec3_cross(d, at->draw.major);
}

/* Adds craters of the catalogue, which is sorted by z. */
static void add_known(marks *all, const pl_crater_query *query) {
  const pl_terrain *terrain = all->terrain;
  const double most = query->angle_rad + 0.5 * terrain->known_most_m / terrain->radius_m;
  size_t first = 0, end = terrain->known_count;
  while (first < end) {
    const size_t middle = first + (end - first) / 2;
    if (terrain->known[middle].crater.direction.z < query->axis.z - most)
      first = middle + 1;
    else
      end = middle;
  }
  for (size_t k = first; k < terrain->known_count; k++) {
    const pl_known_crater *crater = &terrain->known[k].crater;
    if (crater->direction.z > query->axis.z + most)
      return;
    const pl_vec3 to = pl_vec3_sub(crater->direction, query->axis);
    const double reach = query->angle_rad + 0.5 * crater->diameter_m / terrain->radius_m;
    if (crater->diameter_m >= query->min_m && pl_vec3_dot(to, to) <= reach * reach)
      keep_known(all, &terrain->known[k]);
  }
}

/* Gathers the craters about points, the smallest first. Of too many, the largest octaves. */
static void gather(marks *all, const pl_vec3 *directions, const pl_vec3 *points, size_t count) {
  const pl_crater_model model = pl_terrain_crater_model(all->terrain);
  pl_vec3 sum = {0.0, 0.0, 0.0};
  double near_m = INFINITY, chord2 = 0.0;
  for (size_t k = 0; k < count; k++) {
    sum = pl_vec3_add(sum, directions[k]);
    near_m = fmin(near_m, pl_vec3_norm(pl_vec3_sub(points[k], all->view->eye)));
  }
  const pl_vec3 axis = pl_vec3_norm(sum) > 0.0 ? pl_vec3_unit(sum) : directions[0];
  for (size_t k = 0; k < count; k++) {
    const pl_vec3 to = pl_vec3_sub(directions[k], axis);
    chord2 = fmax(chord2, pl_vec3_dot(to, to));
  }
  /* The centre of a crater about a point may be nearer by a few of its radii; those that remove
   * some of it may be smaller than it. */
  const double least_m = all->least_rad * near_m / (1.0 + 2.0 * all->least_rad);
  const pl_crater_query query = {.model = &model,
                                 .axis = axis,
                                 .angle_rad = 2.0 * asin(fmin(0.5 * sqrt(chord2), 1.0)),
                                 .reach = fmax(all->stretch, PL_CRATER_ERASE_TO),
                                 .min_m = 0.7 * PL_CRATER_ERASE_RATIO * least_m,
                                 .max_m = INFINITY};
  all->count = 0;
  all->full = false;
  if (all->field != NULL)
    pl_crater_visit(all->field, &query, keep, all);
  add_known(all, &query);
  qsort(all->sites, all->count, sizeof all->sites[0], by_size);
}

static void mark_part(marks *all, const pl_vec3 *directions, const pl_vec3 *points, size_t count,
                      int64_t *ids) {
  gather(all, directions, points, count);
  if (all->full && count > 1) {
    const size_t half = count / 2;
    mark_part(all, directions, points, half, ids);
    mark_part(all, directions + half, points + half, count - half, ids + half);
    return;
  }
  for (size_t k = 0; k < count; k++)
    ids[k] = find(all, directions[k]);
}

void pl_crater_marks(const pl_terrain *terrain, const pl_crater_view *view, const pl_vec3 *points,
                     size_t count, int64_t *ids) {
  marks all = {.terrain = terrain,
               .field = terrain->craters,
               .view = view,
               .least_rad = view->criteria.least_px * view->pixel_rad,
               .stretch = terrain->craters != NULL ? terrain->craters->stretch : 1.0};
  pl_vec3 directions[POINTS];
  for (size_t done = 0; done < count; done += POINTS) {
    const size_t part = count - done < POINTS ? count - done : POINTS;
    for (size_t k = 0; k < part; k++)
      directions[k] = pl_vec3_unit(points[done + k]);
    if (terrain->craters != NULL || terrain->known_count > 0)
      mark_part(&all, directions, points + done, part, ids + done);
    else
      for (size_t k = 0; k < part; k++)
        ids[done + k] = 0;
  }
}
