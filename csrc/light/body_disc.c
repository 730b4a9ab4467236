/* Disc of a body as a sampling domain: its rings, the table of densities, sampling and density. */
#include "light/body_disc.h"

#include <math.h>

/* Edges of the rings. On the ground, as fractions of its disc from the limb inwards, for a body
 * with an atmosphere and for one without. In the atmosphere, as fractions of its height, where
 * light decreases with height. */
enum { AIR_RINGS = 3, GROUND_RINGS = PL_DISC_RINGS - AIR_RINGS };
static const double UNDER_AIR[GROUND_RINGS] = {0.006, 0.025, 0.07, 0.16, 0.33, 0.6, 1.0};
static const double BARE[PL_DISC_RINGS] = {0.0015, 0.006, 0.016, 0.04, 0.085,
                                           0.16,   0.28,  0.45,  0.7,  1.0};
static const double HEIGHTS[AIR_RINGS] = {0.12, 0.35, 1.0};
/* The light of a cell is evaluated at one point only. Its density is therefore at least BESIDE
 * times the light of its brightest neighbour, plus ANYWHERE times the mean. */
static const float BESIDE = 0.25f, ANYWHERE = 0.05f;

static pl_vec3 across(pl_vec3 z, pl_vec3 sun) {
  const pl_vec3 x = pl_vec3_madd(sun, -pl_vec3_dot(sun, z), z);
  if (pl_vec3_norm(x) > 1e-9)
    return pl_vec3_unit(x);
  return pl_vec3_unit(pl_vec3_cross(z, fabs(z.x) < 0.5 ? (pl_vec3){1, 0, 0} : (pl_vec3){0, 1, 0}));
}

/* 1 - cosine of the angle with this sine, without cancellation error. */
static double depth_of(double sine) {
  return sine * sine / (1.0 + sqrt(fmax(1.0 - sine * sine, 0.0)));
}

/* Height of the top of the atmosphere above the centre, in body radii: the atmosphere emits light
 * beyond the limb of the ground. From within the atmosphere only the ground counts. */
static double swelling(const pl_shot_body *body, double d) {
  const pl_air *air = body->body->air;
  const double out = air != NULL ? pl_air_reach_m(air, body->radius_m) / body->radius_m : 1.0;
  return d > out ? out : 1.0;
}

bool pl_body_disc_make(const pl_shot_body *body, pl_vec3 sun, pl_vec3 point, pl_body_disc *out) {
  const pl_vec3 from = pl_vec3_add(body->camera_unit, pl_mat3_mul_vec(body->to_unit, point));
  const pl_vec3 s = pl_vec3_unit(pl_mat3_mul_vec(body->to_unit, sun));
  const double norm = pl_vec3_norm(from), rim = swelling(body, norm), least = 1e-9;
  if (!(norm > rim * (1.0 + least)))
    return false;
  const pl_vec3 z = pl_vec3_scale(from, -1.0 / norm), x = across(z, s);
  const double most = depth_of(rim / norm);
  *out = (pl_body_disc){.body = body,
                        .x = x,
                        .y = pl_vec3_cross(z, x),
                        .z = z,
                        .most = most,
                        .ground = rim > 1.0 ? depth_of(1.0 / norm) / most : 1.0};
  return true;
}

void pl_disc_rings(const pl_body_disc *disc, pl_disc_table *table) {
  const bool air = disc->ground < 1.0;
  const int ground = air ? GROUND_RINGS : PL_DISC_RINGS;
  const double *steps = air ? UNDER_AIR : BARE;
  for (int i = 0; i <= ground; i++)
    table->edge[i] = (float)(disc->ground * (1.0 - (i == ground ? 0.0 : steps[ground - 1 - i])));
  /* The part is taken as linear in the height, since the atmosphere is thin. */
  for (int i = ground + 1; i <= PL_DISC_RINGS; i++)
    table->edge[i] = (float)(disc->ground + (1.0 - disc->ground) * HEIGHTS[i - ground - 1]);
  table->edge[PL_DISC_RINGS] = 1.0f;
}

/* Ratio of solid angles, scaled axes over root axes, |det M|/|M v|^3. `length` is |M v|, the length
 * of a unit vector of root axes after scaling. */
static double stretch(const pl_body_disc *disc, double length) {
  const pl_vec3 radii = disc->body->state->radii_m;
  return 1.0 / (radii.x * length * (radii.y * length) * (radii.z * length));
}

pl_vec3 pl_disc_direction(const pl_body_disc *disc, double part, double turn_rad, double *even) {
  const double depth = disc->most * part, sine = sqrt(depth * (2.0 - depth));
  const pl_vec3 w =
      pl_vec3_madd(pl_vec3_madd(pl_vec3_scale(disc->z, 1.0 - depth), sine * cos(turn_rad), disc->x),
                   sine * sin(turn_rad), disc->y);
  const pl_vec3 radii = disc->body->state->radii_m;
  const pl_vec3 v =
      pl_mat3_mul_vec(disc->body->rotation, (pl_vec3){radii.x * w.x, radii.y * w.y, radii.z * w.z});
  const double length = pl_vec3_norm(v);
  *even = stretch(disc, 1.0 / length) / (2.0 * PL_PI * disc->most);
  return pl_vec3_scale(v, 1.0 / length);
}

pl_vec3 pl_disc_middle(const pl_body_disc *disc, const pl_disc_table *table, int turn, int ring) {
  const double part = 0.5 * ((double)table->edge[ring] + (double)table->edge[ring + 1]);
  double even;
  return pl_disc_direction(disc, part, 2.0 * PL_PI * (turn + 0.5) / PL_DISC_TURNS, &even);
}

static float brightest_beside(const float light[PL_DISC_TURNS][PL_DISC_RINGS], int turn, int ring) {
  const int before = (turn + PL_DISC_TURNS - 1) % PL_DISC_TURNS, after = (turn + 1) % PL_DISC_TURNS;
  float most = fmaxf(light[before][ring], light[after][ring]);
  if (ring > 0)
    most = fmaxf(most, light[turn][ring - 1]);
  if (ring + 1 < PL_DISC_RINGS)
    most = fmaxf(most, light[turn][ring + 1]);
  return most;
}

void pl_disc_table_fill(const float light[PL_DISC_TURNS][PL_DISC_RINGS], pl_disc_table *table) {
  float mean = 0.0f, sum = 0.0f;
  for (int k = 0; k < PL_DISC_TURNS; k++)
    for (int j = 0; j < PL_DISC_RINGS; j++) {
      const float wide = (table->edge[j + 1] - table->edge[j]) / PL_DISC_TURNS;
      const float own = fmaxf(light[k][j], BESIDE * brightest_beside(light, k, j));
      table->density[k][j] = own;
      mean += own * wide;
    }
  table->turn[0] = 0.0f;
  for (int k = 0; k < PL_DISC_TURNS; k++) {
    float column = 0.0f;
    table->ring[k][0] = 0.0f;
    for (int j = 0; j < PL_DISC_RINGS; j++) {
      const float wide = table->edge[j + 1] - table->edge[j];
      table->density[k][j] = (table->density[k][j] / mean + ANYWHERE) / (1.0f + ANYWHERE);
      table->ring[k][j + 1] = column += table->density[k][j] * wide;
    }
    for (int j = 1; j < PL_DISC_RINGS; j++)
      table->ring[k][j] /= column;
    table->ring[k][PL_DISC_RINGS] = 1.0f;
    table->turn[k + 1] = sum += column / PL_DISC_TURNS;
  }
  table->turn[PL_DISC_TURNS] = 1.0f;
}

/* Index of the one of `count` steps of an increasing table that contains u. *part: position within
 * the step, 0..1. */
static int find_step(const float *table, int count, float u, double *part) {
  int low = 0, high = count;
  while (high - low > 1) {
    const int middle = (low + high) / 2;
    if (u < table[middle])
      high = middle;
    else
      low = middle;
  }
  const float wide = table[low + 1] - table[low];
  *part = wide > 0.0f ? fmin(fmax((double)(u - table[low]) / (double)wide, 0.0), 1.0) : 0.5;
  return low;
}

pl_vec3f pl_disc_sample(const pl_body_disc *disc, const pl_disc_table *table, const float u[2],
                        float *pdf) {
  double turn, along, density;
  const int k = find_step(table->turn, PL_DISC_TURNS, u[0], &turn);
  const int j = find_step(table->ring[k], PL_DISC_RINGS, u[1], &along);
  const double from = (double)table->edge[j], to = (double)table->edge[j + 1];
  const pl_vec3 v = pl_disc_direction(disc, from + along * (to - from),
                                      2.0 * PL_PI * (k + turn) / PL_DISC_TURNS, &density);
  *pdf = (float)((double)table->density[k][j] * density);
  return pl_vec3_to_float(v);
}

float pl_disc_pdf(const pl_body_disc *disc, const pl_disc_table *table, pl_vec3f direction) {
  const pl_vec3 v = pl_mat3_mul_vec(disc->body->to_unit, pl_vec3f_to_double(direction));
  const double ahead = pl_vec3_dot(v, disc->z), length = pl_vec3_norm(v);
  if (!(ahead > 0.0))
    return 0.0f;
  const double right = pl_vec3_dot(v, disc->x), up = pl_vec3_dot(v, disc->y);
  const double square = (right * right + up * up) / (length * length);
  const double part = square / (1.0 + ahead / length) / disc->most;
  if (!(part < 1.0))
    return 0.0f;
  const double turn = atan2(up, right) * (0.5 / PL_PI);
  const int k = (int)((turn < 0.0 ? turn + 1.0 : turn) * PL_DISC_TURNS) % PL_DISC_TURNS;
  double along;
  const int j = find_step(table->edge, PL_DISC_RINGS, (float)part, &along);
  return (float)((double)table->density[k][j] * stretch(disc, length) / (2.0 * PL_PI * disc->most));
}
