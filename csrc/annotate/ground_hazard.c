/* Where a lander cannot stand: the ground and its rocks within the footprint about each point. */
#include <math.h>

#include "annotate/ground_channels.h"
#include "terrain/rock_field.h"

enum { GROUP = PL_GROUND_ROWS * PL_GROUND_ROWS };

/* Extent of points in footprints up to which their rocks are looked for together. */
#define TOGETHER 4.0

/* A search for the rocks about some points. */
typedef struct search {
  const pl_terrain *terrain;
  const pl_hazard_limits *limits;
  const pl_vec3 *directions;
  size_t count;
  uint8_t *bits;
  pl_rock_memo *memos;
} search;

/* Square of the chord at which a rock touches a footprint. */
static double touch2(const search *at, double diameter_m) {
  const double angle =
      0.5 * (at->limits->footprint_m + diameter_m) / pl_terrain_radius_m(at->terrain);
  const double chord = 2.0 * sin(fmin(0.5 * angle, 0.5 * PL_PI));
  return chord * chord;
}

static double chord2(pl_vec3 a, pl_vec3 b) {
  const pl_vec3 to = pl_vec3_sub(a, b);
  return pl_vec3_dot(to, to);
}

/* Height of a site's rock over the ground; 0 if there is none. */
static double height_of(const search *at, const pl_scatter_site *site) {
  const pl_rock_field *rocks = pl_terrain_rocks(at->terrain);
  pl_rock_memo *memo = &at->memos[(site->id * UINT64_C(0x9e3779b97f4a7c15) >> 32) % PL_ROCK_MEMOS];
  pl_rock rock;
  pl_rock_shape shape;
  if (memo->id != site->id || memo->terrain != at->terrain) {
    const bool high = pl_rock_height_bound_m(rocks, site) > at->limits->rock_m &&
                      pl_rock_set(rocks, at->terrain, site, &rock, &shape);
    *memo = (pl_rock_memo){site->id, at->terrain, high ? rock.height_m : 0.0};
  }
  return memo->height_m;
}

/* Rocks are set on the ground only if they may change a pixel. */
static pl_status mark(void *context, const pl_scatter_site *site) {
  const search *at = context;
  const double near2 = touch2(at, site->diameter_m);
  size_t first = 0;
  while (first < at->count && ((at->bits[first] & PL_HAZARD_ROCK) != 0 ||
                               chord2(site->direction, at->directions[first]) > near2))
    first++;
  if (first == at->count || !(height_of(at, site) > at->limits->rock_m))
    return PL_OK;
  for (size_t k = first; k < at->count; k++)
    if (chord2(site->direction, at->directions[k]) <= near2)
      at->bits[k] |= PL_HAZARD_ROCK;
  return PL_OK;
}

static pl_status find_rocks(const search *at) {
  const pl_rock_field *rocks = pl_terrain_rocks(at->terrain);
  pl_vec3 middle = {0.0, 0.0, 0.0};
  double spread2 = 0.0;
  for (size_t k = 0; k < at->count; k++)
    middle = pl_vec3_add(middle, at->directions[k]);
  middle = pl_vec3_norm(middle) > 0.0 ? pl_vec3_unit(middle) : at->directions[0];
  for (size_t k = 0; k < at->count; k++)
    spread2 = fmax(spread2, chord2(middle, at->directions[k]));
  const double spread_m =
      2.0 * asin(fmin(0.5 * sqrt(spread2), 1.0)) * pl_terrain_radius_m(at->terrain);
  if (at->count > 1 && spread_m > TOGETHER * at->limits->footprint_m) {
    search half[2] = {*at, *at};
    half[0].count = at->count / 2;
    half[1].count -= half[0].count;
    half[1].directions += half[0].count;
    half[1].bits += half[0].count;
    PL_TRY(find_rocks(&half[0]));
    return find_rocks(&half[1]);
  }
  const double exposed = 1.0 - pl_rock_field_frame(rocks)->least_burial;
  const pl_rock_reach reach = {.radius_m = spread_m + 0.5 * at->limits->footprint_m,
                               .diameters = 0.5,
                               .min_m = at->limits->rock_m / (PL_ROCK_HEIGHT_MOST * exposed),
                               .max_m = INFINITY};
  search own = *at;
  return pl_rock_sites_near(rocks, at->terrain, middle, &reach, mark, &own);
}

static pl_status find_hazards(const pl_ground_group *group, uint8_t *bits) {
  const pl_hazard_limits *limits = &group->map->settings->hazard;
  pl_plane_fit fits[GROUP];
  PL_TRY(pl_plane_fits(group->terrain, &group->map->disc, group->directions, group->count,
                       limits->footprint_m, fits));
  for (size_t k = 0; k < group->count; k++)
    bits[k] = (uint8_t)((fits[k].slope_rad > limits->slope_rad ? PL_HAZARD_SLOPE : 0) |
                        (fits[k].rms_m > limits->rms_m ? PL_HAZARD_ROUGH : 0));
  const search at = {group->terrain, limits, group->directions, group->count, bits, group->memos};
  return pl_terrain_rocks(group->terrain) != NULL ? find_rocks(&at) : PL_OK;
}

pl_status pl_write_hazard(const pl_ground_group *group) {
  uint8_t *image = group->map->images[PL_GROUND_HAZARD], bits[GROUP];
  if (group->terrain != NULL)
    PL_TRY(find_hazards(group, bits));
  for (size_t k = 0; k < group->count; k++)
    image[group->pixels[k]] = group->terrain != NULL ? bits[k] : PL_HAZARD_UNKNOWN;
  return PL_OK;
}
