/* Sets rocks on the ground. */
#include "math/philox.h"
#include "terrain/rock_parts.h"

/* What random numbers of a rock are for; those of its site have their own. */
enum { FOR_SEAT = 2, FOR_SHAPE };

/* Points of the ground on each of two rings: the first, as wide as the rock, tells the slope; the
 * second, in the plan of the rock, is where it must pass through the rock. */
enum { RING = 12 };
/* Levels between the cell of an octave and those of the ground: 1/16 to 1/32 of a diameter. */
enum { FINER = 8 };

#define TILT_MOST_RAD (20.0 * PL_PI / 180.0)
/* From this part of the slope of repose on, fewer rocks stay. */
#define REPOSE_FROM 0.7
/* Least part of a rock's height that must be over the ground. */
#define LEAST_EXPOSED 0.1
#define SINK_STEP 0.04
/* Points of contact are this deep inside, by the shape's own measure. */
#define INSIDE 0.93

/* The ground around a site. */
typedef struct footing {
  const pl_terrain *terrain;
  pl_vec3 direction;
  int level;
  double radius_m;          /* distance of the datum */
  pl_vec3 middle;           /* ground at the site, relative to the body's centre */
  pl_vec3 points[1 + RING]; /* of the second ring and at the site, relative to `middle` */
  pl_vec3 up;               /* unit normal of the plane through the first ring */
  double mean_m;            /* height of that plane over `middle`, along `up` */
  double slope_rad;
  double rough_m; /* what finer ground may be lower */
} footing;

static void axes_of(pl_vec3 up, pl_vec3 *a, pl_vec3 *b) {
  const pl_vec3 other = fabs(up.z) < 0.7 ? (pl_vec3){0.0, 0.0, 1.0} : (pl_vec3){1.0, 0.0, 0.0};
  *a = pl_vec3_unit(pl_vec3_cross(other, up));
  *b = pl_vec3_cross(up, *a);
}

static pl_vec3 around(pl_vec3 a, pl_vec3 b, double turn) {
  return pl_vec3_madd(pl_vec3_scale(a, cos(turn)), sin(turn), b);
}

/* Replaces offsets from the site by the ground there, relative to the body's centre. */
static void find_ground(const footing *at, pl_vec3 *points, size_t count) {
  pl_vec3 directions[1 + RING] = {{0.0, 0.0, 0.0}}; /* all are set: for GCC with sanitizers */
  double heights[1 + RING];
  for (size_t k = 0; k < count; k++)
    directions[k] = pl_vec3_unit(pl_vec3_madd(at->direction, 1.0 / at->radius_m, points[k]));
  pl_terrain_heights_below_fillets(at->terrain, directions, count, at->level, heights);
  for (size_t k = 0; k < count; k++)
    points[k] =
        pl_vec3_scale(directions[k], pl_terrain_datum_m(at->terrain, directions[k]) + heights[k]);
}

/* Finds the plane of the ground, by least squares. */
static void find_plane(const pl_terrain *terrain, const pl_scatter_site *site, footing *out) {
  const pl_vec3 d = site->direction;
  const double half_m = 0.5 * site->diameter_m;
  const int fine = site->cell.level + FINER, last = PL_CUBE_LEVELS - 1;
  *out = (footing){.terrain = terrain,
                   .direction = d,
                   .level = fine < last ? fine : last,
                   .radius_m = pl_terrain_datum_m(terrain, d)};
  pl_vec3 a, b, ring[1 + RING] = {{0.0, 0.0, 0.0}};
  axes_of(d, &a, &b);
  for (int k = 0; k < RING; k++)
    ring[1 + k] = pl_vec3_scale(around(a, b, 2.0 * PL_PI * k / RING), half_m);
  find_ground(out, ring, 1 + RING);
  out->middle = ring[0];
  pl_vec3 slope = {0.0, 0.0, 0.0};
  double mean_m = 0.0;
  for (int k = 1; k <= RING; k++) {
    const pl_vec3 to = pl_vec3_sub(ring[k], out->middle);
    const double height = pl_vec3_dot(to, d);
    slope = pl_vec3_madd(slope, height, pl_vec3_madd(to, -height, d));
    mean_m += height / (1 + RING);
  }
  slope = pl_vec3_scale(slope, 1.0 / (0.5 * RING * half_m * half_m));
  out->slope_rad = atan(pl_vec3_norm(slope));
  out->up = pl_vec3_unit(pl_vec3_sub(d, slope));
  out->mean_m = mean_m * cos(out->slope_rad);
  out->rough_m = 4.5 * pl_terrain_relief_m(terrain, out->level) + 0.01 * site->diameter_m;
}

/* Finds the ground at half the way from the rock's middle to its outline. */
static void find_contacts(footing *ground, const pl_rock *rock, const pl_rock_shape *shape) {
  pl_vec3 a, b;
  axes_of(rock->up, &a, &b);
  ground->points[0] = (pl_vec3){0.0, 0.0, 0.0};
  for (int k = 0; k < RING; k++) {
    const pl_vec3 along = around(a, b, 2.0 * PL_PI * k / RING);
    const double outline_m =
        rock->diameter_m / pl_rock_shape_depth(shape, pl_mat3_mul_vec_t(rock->rotation, along));
    ground->points[1 + k] = pl_vec3_scale(along, PL_ROCK_CONTACT * outline_m);
  }
  find_ground(ground, ground->points, 1 + RING);
  for (int k = 0; k <= RING; k++)
    ground->points[k] = pl_vec3_sub(ground->points[k], ground->middle);
}

/* Rocks roll down where it is steep. */
static bool stays(const pl_rock_field *field, double slope_rad, double u) {
  const double from = REPOSE_FROM * field->frame.repose_rad;
  return u * (field->frame.repose_rad - from) < field->frame.repose_rad - slope_rad;
}

static pl_mat3 orient(pl_vec3 up, double yaw, double tilt, double towards) {
  pl_vec3 a, b, x, y;
  axes_of(up, &a, &b);
  const pl_vec3 z = pl_vec3_madd(pl_vec3_scale(up, cos(tilt)), sin(tilt), around(a, b, towards));
  axes_of(z, &x, &y);
  const pl_vec3 along = around(x, y, yaw);
  return pl_mat3_transpose((pl_mat3){{along, pl_vec3_cross(z, along), z}});
}

/* Where the ground is at a point: inside the rock, below it, or above. */
typedef enum contact { WITHIN, BELOW, ABOVE } contact;

static contact contact_at(const pl_rock *rock, const pl_rock_shape *shape, pl_vec3 from_center) {
  const pl_vec3 own = pl_mat3_mul_vec_t(rock->rotation, from_center);
  if (pl_rock_shape_depth(shape, pl_vec3_scale(own, 1.0 / rock->diameter_m)) <= INSIDE)
    return WITHIN;
  return pl_vec3_dot(from_center, rock->up) < 0.0 ? BELOW : ABOVE;
}

static contact contact_all(const pl_rock *rock, const pl_rock_shape *shape, const footing *ground,
                           double height_m) {
  for (int k = 0; k <= RING; k++) {
    const pl_vec3 from = pl_vec3_madd(ground->points[k], -height_m, rock->up);
    contact at = contact_at(rock, shape, pl_vec3_madd(from, -ground->rough_m, rock->up));
    if (at == WITHIN)
      at = contact_at(rock, shape, from);
    if (at != WITHIN)
      return at;
  }
  return WITHIN;
}

/* Sinks the rock until the ground is inside it at all points of contact. */
static bool sink(const footing *ground, const pl_rock_shape *shape, double burial, pl_rock *rock) {
  const pl_vec3 own_up = pl_mat3_mul_vec_t(rock->rotation, rock->up);
  double low, high;
  pl_rock_shape_extent(shape, own_up, &low, &high);
  low *= rock->diameter_m;
  high *= rock->diameter_m;
  for (; burial <= 1.0 - LEAST_EXPOSED; burial += SINK_STEP) {
    const double height_m = ground->mean_m - low - burial * (high - low);
    const contact at = contact_all(rock, shape, ground, height_m);
    if (at == ABOVE)
      return false;
    if (at == BELOW)
      continue;
    rock->burial = burial;
    rock->height_m = (1.0 - burial) * (high - low);
    rock->center = pl_vec3_add(ground->middle, pl_vec3_scale(rock->up, height_m));
    return true;
  }
  return false;
}

static pl_rock_family_kind family_of(const pl_rock_field *field, double u) {
  int k = 0;
  while (k < PL_ROCK_FAMILIES - 1 && field->families[k] <= u)
    k++;
  return (pl_rock_family_kind)k;
}

static void draw_shape(const pl_rock_field *field, uint64_t id, pl_rock_shape *shape) {
  uint64_t words[4];
  pl_scatter_words(&field->scatter, id, FOR_SHAPE, words);
  pl_rock_shape_draw(field->variants, family_of(field, pl_philox_double(words[3])), words, shape);
}

/* Least part of the height that is below the ground, of the third random word of a seat. */
static double burial_of(const pl_rock_field *field, uint64_t word) {
  const pl_rock_frame *frame = &field->frame;
  return frame->least_burial + (frame->most_burial - frame->least_burial) * pl_philox_double(word);
}

double pl_rock_height_bound_m(const pl_rock_field *field, const pl_scatter_site *site) {
  pl_rock_shape shape;
  uint64_t seat[4];
  draw_shape(field, site->id, &shape);
  pl_scatter_words(&field->scatter, site->id, FOR_SEAT, seat);
  return 2.0 * shape.radius * site->diameter_m * (1.0 - burial_of(field, seat[3]));
}

bool pl_rock_set(const pl_rock_field *field, const pl_terrain *terrain, const pl_scatter_site *site,
                 pl_rock *rock, pl_rock_shape *shape) {
  uint64_t seat[4];
  footing ground;
  const pl_wheel_tracks *tracks = pl_terrain_tracks(terrain);
  if (tracks != NULL && pl_wheel_tracks_touch(tracks, site->direction, 0.5 * site->diameter_m))
    return false;
  pl_scatter_words(&field->scatter, site->id, FOR_SEAT, seat);
  find_plane(terrain, site, &ground);
  if (!stays(field, ground.slope_rad, pl_philox_double(seat[0])))
    return false;
  draw_shape(field, site->id, shape);
  *rock = (pl_rock){.id = site->id,
                    .family = shape->variant->family - pl_rock_families,
                    .diameter_m = site->diameter_m,
                    .slope_rad = ground.slope_rad,
                    .direction = site->direction,
                    .up = ground.up};
  const double yaw = 2.0 * PL_PI * pl_philox_double(seat[1]);
  /* Uniform over the cap of tilts; both halves of one word. */
  const double tilt = TILT_MOST_RAD * sqrt((double)(seat[2] >> 32) * 0x1p-32);
  const double towards = 2.0 * PL_PI * (double)(seat[2] & 0xffffffffu) * 0x1p-32;
  rock->rotation = orient(ground.up, yaw, tilt, towards);
  find_contacts(&ground, rock, shape);
  return sink(&ground, shape, burial_of(field, seat[3]), rock);
}
