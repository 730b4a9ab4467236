#include "terrain/crater_cells.h"

#include "math/philox.h"

/* What random numbers are for; part of their counter. */
enum { FOR_COUNT, FOR_SITE, FOR_AGE, FOR_RADIUS, FOR_HEIGHT };

#define KEY_CRATERS UINT64_C(0x6372617465727321)
enum { NUMBER_BITS = 10 };

static void words_of(const pl_crater_field *field, uint64_t id, uint64_t purpose,
                     uint64_t words[4]) {
  const uint64_t key[2] = {field->frame.seed, KEY_CRATERS}, counter[4] = {id, purpose, 0, 0};
  pl_philox(key, counter, words);
}

/* Number of a cell among those of all levels, from 1 on. */
static uint64_t cell_number(int level, int face, uint64_t i, uint64_t j) {
  const uint64_t one = 1, before = 2 * ((one << (2 * level)) - 1); /* 6 (4^level - 1) / 3 */
  return 1 + before + (((uint64_t)face << (2 * level)) | (i << level) | j);
}

/* Part of a face that a cone may meet: a range of each coordinate, and its cells. */
typedef struct cell_range {
  double from[2], to[2];
  int64_t low[2], high[2];
} cell_range;

/* Range of coordinate k: as longitudes about the other axis. `across` and `outward` are the
 * components of the cone's axis along the coordinate and out of the face. */
static bool range_of(double across, double outward, double sine, int k, cell_range *range) {
  const double long_axis = hypot(across, outward);
  range->from[k] = -1.0;
  range->to[k] = 1.0;
  if (long_axis <= sine)
    return true;
  const double half = asin(sine / long_axis), middle = atan2(across, outward);
  range->from[k] = fmax((middle - half) * (4.0 / PL_PI) - 1e-12, -1.0);
  range->to[k] = fmin((middle + half) * (4.0 / PL_PI) + 1e-12, 1.0);
  return range->from[k] <= range->to[k];
}

static bool cells_of(const pl_crater_field *field, pl_vec3 axis, double angle, int level, int face,
                     cell_range *range) {
  const double outward = pl_vec3_dot(axis, field->faces[face][0]);
  const double sine = angle < 0.5 * PL_PI ? sin(angle) : 2.0; /* 2: all cells */
  const int64_t cells = (int64_t)1 << level;
  for (int k = 0; k < 2; k++) {
    if (!range_of(pl_vec3_dot(axis, field->faces[face][k + 1]), outward, sine, k, range))
      return false;
    range->low[k] = (int64_t)((range->from[k] + 1.0) * 0.5 * (double)cells);
    range->high[k] = (int64_t)((range->to[k] + 1.0) * 0.5 * (double)cells);
    range->low[k] -= range->low[k] == cells;
    range->high[k] -= range->high[k] == cells;
  }
  return true;
}

static uint64_t count_of(const pl_crater_octave *octave, double u) {
  size_t low = 0, high = octave->count - 1;
  while (low < high) {
    const size_t middle = (low + high) / 2;
    if (octave->shares[middle] > u)
      high = middle;
    else
      low = middle + 1;
  }
  return low;
}

/* Chord of an angle, squared, with a margin for rounding. */
static double chord2_of(double angle) {
  const double chord = 2.0 * sin(0.5 * fmin(angle, PL_PI)) + 1e-13;
  return chord * chord;
}

typedef struct cell_visit {
  const pl_crater_field *field;
  const pl_crater_query *query;
  pl_crater_visit_fn visit;
  void *context;
  int level;
  double width; /* of a cell in s and t */
  double most2; /* chord^2 to the largest crater of the octave */
  cell_range range;
} cell_visit;

static bool modelled(const cell_visit *at, const pl_crater_site *site) {
  const pl_crater_model *model = at->query->model;
  return model != NULL && site->diameter_m >= at->field->frame.model_posts *
                                                  model->spacing_m(model->context, site->direction);
}

static pl_status visit_site(const cell_visit *at, int face, double s, double t,
                            const uint64_t words[4], uint64_t id) {
  const double a = pl_cube_tangent(s), b = pl_cube_tangent(t), a1 = 1.0 + a * a, b1 = 1.0 + b * b;
  const double q = a1 + b * b;
  /* Solid angle of a piece of the lattice, over that at the centre of a face: candidates are kept
   * with this probability, so that they are uniform on the sphere. */
  if (pl_philox_double(words[2]) * q * sqrt(q) >= a1 * b1)
    return PL_OK;
  pl_crater_site site = {id, pl_cube_tangent_direction(face, a, b), 0.0};
  const pl_vec3 to = pl_vec3_sub(site.direction, at->query->axis);
  const double chord2 = pl_vec3_dot(to, to);
  if (chord2 > at->most2)
    return PL_OK;
  const pl_crater_field *field = at->field;
  const pl_crater_octave *octave = &field->octaves[at->level];
  const pl_crater_query *query = at->query;
  site.diameter_m =
      pl_size_table_draw(field->sizes, octave->low_m, octave->high_m, pl_philox_double(words[3]));
  if (site.diameter_m < query->min_m || site.diameter_m >= query->max_m)
    return PL_OK;
  const double reach = query->reach * 0.5 * site.diameter_m / field->frame.radius_m;
  if (chord2 > chord2_of(query->angle_rad + reach) || modelled(at, &site))
    return PL_OK;
  return at->visit(at->context, &site);
}

static pl_status visit_cell(const cell_visit *at, int face, int64_t i, int64_t j) {
  const uint64_t cell = cell_number(at->level, face, (uint64_t)i, (uint64_t)j) << NUMBER_BITS;
  const cell_range *range = &at->range;
  uint64_t words[4];
  words_of(at->field, cell, FOR_COUNT, words);
  const uint64_t count = count_of(&at->field->octaves[at->level], pl_philox_double(words[0]));
  for (uint64_t n = 0; n < count; n++) {
    words_of(at->field, cell | n, FOR_SITE, words);
    const double s = -1.0 + at->width * ((double)i + pl_philox_double(words[0]));
    const double t = -1.0 + at->width * ((double)j + pl_philox_double(words[1]));
    if (s >= range->from[0] && s <= range->to[0] && t >= range->from[1] && t <= range->to[1])
      PL_TRY(visit_site(at, face, s, t, words, cell | n));
  }
  return PL_OK;
}

pl_status pl_crater_visit(const pl_crater_field *field, const pl_crater_query *query,
                          pl_crater_visit_fn visit, void *context) {
  cell_visit at = {.field = field, .query = query, .visit = visit, .context = context};
  for (at.level = field->first; at.level <= field->last; at.level++) {
    const pl_crater_octave *octave = &field->octaves[at.level];
    if (octave->count <= 1 || octave->high_m <= query->min_m || octave->low_m >= query->max_m)
      continue;
    const double reach = query->reach * 0.5 * octave->high_m / field->frame.radius_m;
    const double angle = query->angle_rad + reach;
    at.width = ldexp(2.0, -at.level);
    at.most2 = chord2_of(angle);
    for (int face = 0; face < PL_CUBE_FACES; face++) {
      if (!cells_of(field, query->axis, angle, at.level, face, &at.range))
        continue;
      for (int64_t i = at.range.low[0]; i <= at.range.high[0]; i++)
        for (int64_t j = at.range.low[1]; j <= at.range.high[1]; j++)
          PL_TRY(visit_cell(&at, face, i, j));
    }
  }
  return PL_OK;
}

void pl_crater_draw_age(const pl_crater_field *field, const pl_crater_site *site,
                        pl_crater_draw *draw) {
  uint64_t words[4];
  words_of(field, site->id, FOR_AGE, words);
  const pl_crater_frame *frame = &field->frame;
  /* The rate of impacts was higher long ago: ages are uniform in the number of impacts. */
  const double most = pl_crater_chronology(pl_crater_oldest_ga(&frame->law, site->diameter_m));
  draw->age_ga = pl_crater_chronology_age_ga(pl_philox_double(words[0]) * most);
  draw->tau = pl_crater_tau(site->diameter_m, draw->age_ga, frame->diffusivity_m2_per_myr,
                            frame->diffusivity_exponent);
}

/* Amplitudes of a harmonic from one word: of random phase, and uniform up to twice `mean`. */
static void harmonic(uint64_t word, double mean, double out[2]) {
  const double size = 2.0 * mean * (double)(word >> 32) * 0x1p-32;
  const double phase = 2.0 * PL_PI * (double)(word & 0xffffffffu) * 0x1p-32;
  out[0] = size * cos(phase);
  out[1] = size * sin(phase);
}

/* Mean amplitude of the harmonics of the radius times their order, of those of the height over the
 * rim's, and of the floor's offset over R. */
#define RADIUS_AMPLITUDE 0.02
#define HEIGHT_AMPLITUDE 0.10
#define OFFSET_AMPLITUDE 0.025

double pl_crater_stretch(const pl_crater_frame *frame) {
  double sum = 1.0;
  for (int k = 0; k < PL_CRATER_RADIUS_ORDERS; k++)
    sum += 2.0 * RADIUS_AMPLITUDE * frame->irregularity / (k + 2);
  return sum / sqrt(1.0 - frame->ellipticity);
}

void pl_crater_draw_shape(const pl_crater_field *field, const pl_crater_site *site,
                          pl_crater_draw *draw) {
  const double scale = field->frame.irregularity;
  uint64_t words[4];
  words_of(field, site->id, FOR_AGE, words);
  draw->axis_ratio = 1.0 - field->frame.ellipticity * pl_philox_double(words[1]);
  const double turn = 2.0 * PL_PI * pl_philox_double(words[2]);
  harmonic(words[3], OFFSET_AMPLITUDE * scale, draw->offset);
  /* Any axes tangent to the sphere: the turn is uniform. */
  const pl_vec3 d = site->direction;
  const pl_vec3 other = fabs(d.z) < 0.7 ? (pl_vec3){0.0, 0.0, 1.0} : (pl_vec3){1.0, 0.0, 0.0};
  const pl_vec3 a = pl_vec3_unit(pl_vec3_cross(other, d)), b = pl_vec3_cross(d, a);
  draw->major = pl_vec3_madd(pl_vec3_scale(a, cos(turn)), sin(turn), b);
  draw->minor = pl_vec3_cross(d, draw->major);
  words_of(field, site->id, FOR_RADIUS, words);
  for (int k = 0; k < PL_CRATER_RADIUS_ORDERS; k++)
    harmonic(words[k], RADIUS_AMPLITUDE * scale / (k + 2), draw->radius[k]);
  words_of(field, site->id, FOR_HEIGHT, words);
  for (int k = 0; k < PL_CRATER_HEIGHT_ORDERS; k++)
    harmonic(words[k], HEIGHT_AMPLITUDE * scale / (k + 1), draw->height[k]);
}

static double smooth(double t) {
  t = fmin(fmax(t, 0.0), 1.0);
  return t * t * (3.0 - 2.0 * t);
}

double pl_crater_erasure(double younger_m, double older_m) {
  const double from = log(PL_CRATER_ERASE_RATIO);
  return smooth((log(younger_m / older_m) - from) / (-2.0 * from));
}

double pl_crater_erasure_at(double chord2, double radius) {
  const double x2 = chord2 / (radius * radius);
  if (x2 >= PL_CRATER_ERASE_TO * PL_CRATER_ERASE_TO)
    return 0.0;
  if (x2 <= PL_CRATER_ERASE_FROM * PL_CRATER_ERASE_FROM)
    return 1.0;
  return 1.0 -
         smooth((sqrt(x2) - PL_CRATER_ERASE_FROM) / (PL_CRATER_ERASE_TO - PL_CRATER_ERASE_FROM));
}
