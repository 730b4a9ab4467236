#include "terrain/crater_cells.h"

#include "math/philox.h"

/* What random numbers are for, behind those of pl_scatter_draw. */
enum { FOR_AGE = 2, FOR_RADIUS, FOR_HEIGHT, FOR_TERRACES };

/* Sets the range of coordinate k: as longitudes about the other axis. `across` and `outward` are
 * the components of the cone's axis along the coordinate and out of the face. */
static bool range_of(double across, double outward, double sine, int k, pl_scatter_window *range) {
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

/* Finds the cells of a face that the window's cone may meet: from low to high along s and t. */
static bool cells_of(const pl_crater_field *field, double angle, int level, int face,
                     pl_scatter_window *window, uint64_t low[2], uint64_t high[2]) {
  const double outward = pl_vec3_dot(window->axis, field->faces[face][0]);
  const double sine = angle < 0.5 * PL_PI ? sin(angle) : 2.0; /* 2: all cells */
  const uint64_t cells = UINT64_C(1) << level;
  for (int k = 0; k < 2; k++) {
    if (!range_of(pl_vec3_dot(window->axis, field->faces[face][k + 1]), outward, sine, k, window))
      return false;
    low[k] = (uint64_t)((window->from[k] + 1.0) * 0.5 * (double)cells);
    high[k] = (uint64_t)((window->to[k] + 1.0) * 0.5 * (double)cells);
    low[k] -= low[k] == cells;
    high[k] -= high[k] == cells;
  }
  return true;
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
  pl_scatter_window window; /* on a face, for the largest crater of an octave */
} cell_visit;

double pl_crater_left(const pl_crater_field *field, const pl_crater_model *model, pl_vec3 direction,
                      double diameter_m) {
  const double posts = field->frame.model_posts;
  if (model == NULL || model->left == NULL || diameter_m < posts * model->least_spacing_m)
    return 1.0;
  return model->left(model->context, direction, diameter_m, posts);
}

/* Whether models show a crater: its centre, and its rim on all sides. */
static bool modelled(const cell_visit *at, const pl_scatter_site *site) {
  enum { SIDES = 8 };
  const pl_crater_model *model = at->query->model;
  const pl_vec3 d = site->direction;
  if (model == NULL)
    return false;
  if (model->left == NULL)
    return site->diameter_m >= at->field->frame.model_posts * model->spacing_m(model->context, d);
  if (pl_crater_left(at->field, model, d, site->diameter_m) > 0.0)
    return false;
  const pl_vec3 other = fabs(d.z) < 0.7 ? (pl_vec3){0.0, 0.0, 1.0} : (pl_vec3){1.0, 0.0, 0.0};
  const pl_vec3 a = pl_vec3_unit(pl_vec3_cross(other, d)), b = pl_vec3_cross(d, a);
  const double radius = 0.5 * site->diameter_m / at->field->frame.radius_m;
  for (int k = 0; k < SIDES; k++) {
    const double turn = 2.0 * PL_PI * k / SIDES;
    const pl_vec3 side = pl_vec3_madd(pl_vec3_scale(a, cos(turn)), sin(turn), b);
    const pl_vec3 rim = pl_vec3_madd(pl_vec3_scale(d, cos(radius)), sin(radius), side);
    if (pl_crater_left(at->field, model, rim, site->diameter_m) > 0.0)
      return false;
  }
  return true;
}

static pl_status visit_site(const cell_visit *at, const pl_scatter_site *site) {
  const pl_crater_query *query = at->query;
  if (site->diameter_m < query->min_m || site->diameter_m >= query->max_m)
    return PL_OK;
  const pl_vec3 to = pl_vec3_sub(site->direction, query->axis);
  const double reach = query->reach * 0.5 * site->diameter_m / at->field->frame.radius_m;
  if (pl_vec3_dot(to, to) > chord2_of(query->angle_rad + reach) || modelled(at, site))
    return PL_OK;
  return at->visit(at->context, site);
}

static pl_status visit_face(cell_visit *at, double angle, int level, int face) {
  const pl_scatter *scatter = &at->field->scatter;
  uint64_t low[2], high[2];
  if (!cells_of(at->field, angle, level, face, &at->window, low, high))
    return PL_OK;
  pl_scatter_cell cell = {.level = level, .face = face};
  pl_scatter_site site;
  for (cell.i = low[0]; cell.i <= high[0]; cell.i++)
    for (cell.j = low[1]; cell.j <= high[1]; cell.j++) {
      const uint64_t count = pl_scatter_count(scatter, &cell);
      for (uint64_t n = 0; n < count; n++)
        if (pl_scatter_draw(scatter, &cell, n, &at->window, &site))
          PL_TRY(visit_site(at, &site));
    }
  return PL_OK;
}

pl_status pl_crater_visit(const pl_crater_field *field, const pl_crater_query *query,
                          pl_crater_visit_fn visit, void *context) {
  cell_visit at = {.field = field, .query = query, .visit = visit, .context = context};
  for (int level = field->scatter.first; level <= field->scatter.last; level++) {
    const pl_scatter_octave *octave = &field->scatter.octaves[level];
    if (octave->count <= 1 || octave->high_m <= query->min_m || octave->low_m >= query->max_m)
      continue;
    const double reach = query->reach * 0.5 * octave->high_m / field->frame.radius_m;
    const double angle = query->angle_rad + reach;
    at.window.axis = query->axis;
    at.window.chord2 = chord2_of(angle);
    for (int face = 0; face < PL_CUBE_FACES; face++)
      PL_TRY(visit_face(&at, angle, level, face));
  }
  return PL_OK;
}

double pl_crater_oldest_drawn_ga(const pl_crater_frame *frame, double diameter_m) {
  const double oldest = pl_crater_oldest_ga(&frame->law, diameter_m);
  const double tau =
      pl_crater_tau(diameter_m, oldest, frame->diffusivity_m2_per_myr, frame->diffusivity_exponent);
  return tau > PL_CRATER_TAU_COUNTED ? oldest * (PL_CRATER_TAU_COUNTED / tau) : oldest;
}

double pl_crater_draw_rank(const pl_crater_field *field, const pl_scatter_site *site) {
  uint64_t words[4];
  pl_scatter_words(&field->scatter, site->id, FOR_AGE, words);
  return pl_philox_double(words[0]);
}

void pl_crater_draw_age(const pl_crater_field *field, const pl_scatter_site *site,
                        pl_crater_draw *draw) {
  uint64_t words[4];
  pl_scatter_words(&field->scatter, site->id, FOR_AGE, words);
  const pl_crater_frame *frame = &field->frame;
  /* The rate of impacts was higher long ago: ages are uniform in the number of impacts. */
  const double most = pl_crater_chronology(pl_crater_oldest_drawn_ga(frame, site->diameter_m));
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

void pl_crater_draw_shape(const pl_crater_field *field, const pl_scatter_site *site,
                          pl_crater_draw *draw) {
  const double scale = field->frame.irregularity;
  uint64_t words[4];
  pl_scatter_words(&field->scatter, site->id, FOR_AGE, words);
  draw->axis_ratio = 1.0 - field->frame.ellipticity * pl_philox_double(words[1]);
  const double turn = 2.0 * PL_PI * pl_philox_double(words[2]);
  harmonic(words[3], OFFSET_AMPLITUDE * scale, draw->offset);
  /* Any axes tangent to the sphere: the turn is uniform. */
  const pl_vec3 d = site->direction;
  const pl_vec3 other = fabs(d.z) < 0.7 ? (pl_vec3){0.0, 0.0, 1.0} : (pl_vec3){1.0, 0.0, 0.0};
  const pl_vec3 a = pl_vec3_unit(pl_vec3_cross(other, d)), b = pl_vec3_cross(d, a);
  draw->major = pl_vec3_madd(pl_vec3_scale(a, cos(turn)), sin(turn), b);
  draw->minor = pl_vec3_cross(d, draw->major);
  pl_scatter_words(&field->scatter, site->id, FOR_RADIUS, words);
  for (int k = 0; k < PL_CRATER_RADIUS_ORDERS; k++)
    harmonic(words[k], RADIUS_AMPLITUDE * scale / (k + 2), draw->radius[k]);
  pl_scatter_words(&field->scatter, site->id, FOR_HEIGHT, words);
  for (int k = 0; k < PL_CRATER_HEIGHT_ORDERS; k++)
    harmonic(words[k], HEIGHT_AMPLITUDE * scale / (k + 1), draw->height[k]);
}

/* Terraces are 2 to 4; all these by eye. */
#define TREADS 0.75
#define WANDER 0.4
#define COME 0.7

void pl_crater_draw_terraces(const pl_crater_field *field, const pl_scatter_site *site,
                             double footprint_m, pl_crater_draw *draw) {
  const double diameter_m = site->diameter_m;
  draw->terraces = (pl_crater_terraces){.count = 0};
  const double complex = pl_crater_complex(diameter_m);
  if (!(complex > 0.0 && field->frame.terraces > 0.0))
    return;
  uint64_t words[4];
  pl_scatter_words(&field->scatter, site->id, FOR_TERRACES, words);
  pl_crater_terraces *out = &draw->terraces;
  out->count = 2 + (int)(3.0 * pl_philox_double(words[0]));
  out->floor = pl_crater_fresh(diameter_m).floor;
  /* Waves of a length wear off by diffusion at their rate. That diffusivity is the crater's own:
   * with the smaller one of their size, walls that are worn smooth would keep thin rings. */
  const double step = (1.0 - out->floor) / out->count, wave = 2.0 * PL_PI / step;
  out->depth = TREADS * field->frame.terraces * complex * exp(-wave * wave * draw->tau) *
               pl_crater_fade(0.5 * step * diameter_m, footprint_m);
  for (int k = 0; k < PL_CRATER_TERRACE_ORDERS; k++) {
    pl_scatter_words(&field->scatter, site->id, FOR_TERRACES + 1 + (uint64_t)k, words);
    harmonic(words[0], WANDER, out->wander[k]);
    harmonic(words[1], COME / (k + 1), out->come[k]);
  }
}

static double smooth(double t) {
  t = fmin(fmax(t, 0.0), 1.0);
  return t * t * (3.0 - 2.0 * t);
}

double pl_crater_fade(double diameter_m, double footprint_m) {
  if (diameter_m >= PL_CRATER_FADE_TO * footprint_m)
    return 1.0;
  return smooth((diameter_m / footprint_m - PL_CRATER_FADE_FROM) /
                (PL_CRATER_FADE_TO - PL_CRATER_FADE_FROM));
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
