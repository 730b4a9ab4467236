/* Rays: gathers the fresh craters about a block, then sums their patterns. */
#include "terrain/crater_rays.h"

#include <string.h>

#include "base/memory.h"
#include "math/noise.h"
#include "math/philox.h"
#include "terrain/crater_cells.h"

enum { BINS = 256, RAYS_MIN = 12, RAYS_MOST = 24 };
/* Random words of a crater, by purpose; its others are in crater_cells.c. */
enum { FOR_RAYS = 16 };

/* Craters of this diameter or more keep their rays for the whole time, m. */
static const double LASTING_M = 3000.0;
/* The halo has half of its brightness at this distance, radii. */
static const double HALO = 1.5;
/* Cells of noise per radius, and what it adds or takes away. */
static const double GRAIN[2] = {1.7, 5.3}, UNEVEN = 1.4;

/* By diameter, in equal steps of its logarithm. */
struct pl_crater_brightness {
  double low, step;          /* log of the least diameter, and of the ratio of two */
  double fraction[BINS + 1]; /* of craters of a diameter that are not faded, or a little more */
  double mean[BINS];         /* of the excess by craters of a bin */
};

typedef struct ray {
  double cosine, sine; /* of its azimuth */
  double width, length, strength;
} ray;

/* A fresh crater; lengths over its radius. */
typedef struct fresh {
  pl_vec3 direction, major, minor;
  double chord2, radius; /* of its reach; radius over that of the body */
  double diameter_m;
  double blur2;        /* of the footprint */
  double light, reach; /* brightness with age and size on the mesh */
  float fade[2];       /* of noise */
  uint32_t pattern;
  int count;
  ray rays[RAYS_MOST];
} fresh;

/* Craters are as bright as they are from this many footprints of diameter on, and left out below
 * half of it: a halo is wider than its crater. */
#define FADE_TO 1.0
#define FADE_FROM 0.5

static double fade_of(double diameter_m, double footprint_m) {
  if (diameter_m >= FADE_TO * footprint_m)
    return 1.0;
  const double t = (diameter_m / footprint_m - FADE_FROM) / (FADE_TO - FADE_FROM);
  return t > 0.0 ? t * t * (3.0 - 2.0 * t) : 0.0;
}

/* --- one crater ------------------------------------------------------------------------------- */

static double life_ga(const pl_crater_rays *rays, double diameter_m) {
  return rays->fade_ga * fmin(1.0, diameter_m / LASTING_M);
}

double pl_crater_freshness(const pl_crater_rays *rays, double diameter_m, double age_ga) {
  const double left = 1.0 - age_ga / life_ga(rays, diameter_m);
  return left > 0.0 ? left * left : 0.0;
}

/* A fraction from 16 bits of a word. */
static double part(uint64_t word, int k) { return (double)(word >> 16 * k & 0xffff) * 0x1p-16; }

static void draw_rays(const pl_scatter *scatter, uint64_t id, double reach, fresh *out) {
  uint64_t words[4];
  pl_scatter_words(scatter, id, FOR_RAYS, words);
  out->pattern = (uint32_t)words[0];
  out->reach = reach;
  out->count = RAYS_MIN + (int)(part(words[1], 0) * (RAYS_MOST - RAYS_MIN + 1));
  const double side = 2.0 * PL_PI * part(words[1], 1), lean = 0.8 * part(words[1], 2);
  for (int k = 0; k < out->count; k++) {
    if (k % 4 == 0)
      pl_scatter_words(scatter, id, FOR_RAYS + 1 + (uint64_t)k / 4, words);
    const uint64_t word = words[k % 4];
    const double turn = 2.0 * PL_PI * part(word, 0), far = part(word, 1), fair = part(word, 2);
    const double more = 1.0 + lean * cos(turn - side);
    out->rays[k] = (ray){.cosine = cos(turn),
                         .sine = sin(turn),
                         .width = 0.1 + 0.3 * part(word, 3),
                         .length = 2.0 + (reach - 2.0) * fmin(far * far * more, 1.0),
                         .strength = (0.15 + 0.75 * fair * fair) * fmin(more, 1.0)};
  }
}

/* Brightness at a place, in radii along the axes; without noise. */
static double pattern_at(const fresh *of, double u, double v) {
  const double x2 = u * u + v * v, out = sqrt(x2) / of->reach;
  double rays = 0.0;
  for (int k = 0; k < of->count; k++) {
    const ray *ray = &of->rays[k];
    const double along = u * ray->cosine + v * ray->sine, t = along / ray->length;
    if (along <= 0.0 || t >= 1.0)
      continue;
    const double across = v * ray->cosine - u * ray->sine, width = ray->width * (0.5 + 0.3 * along);
    const double wide2 = width * width + of->blur2;
    if (across * across > 8.0 * wide2)
      continue;
    const double end = (1.0 - t * t) * along * along / (0.5 + along * along);
    rays += ray->strength * end * (width / sqrt(wide2)) * exp(-across * across / wide2);
  }
  const double wide2 = HALO * HALO + of->blur2, h = x2 / wide2;
  const double halo = HALO * HALO / wide2 / (1.0 + h * h);
  const double rim = out > 0.7 ? (1.0 - out) / 0.3 : 1.0;
  return (halo + (1.0 - halo) * fmin(rays, 1.0)) * rim * rim * (3.0 - 2.0 * rim);
}

static double ray_brightness_at(const fresh *of, pl_vec3 direction) {
  const pl_vec3 to = pl_vec3_sub(direction, of->direction);
  const double chord2 = pl_vec3_dot(to, to);
  if (chord2 >= of->chord2)
    return 0.0;
  double u = pl_vec3_dot(of->major, to), v = pl_vec3_dot(of->minor, to);
  const double flat = hypot(u, v), angle = 2.0 * asin(0.5 * sqrt(chord2));
  const double scale = flat > 0.0 ? angle / (flat * of->radius) : 0.0;
  u *= scale;
  v *= scale;
  double ray_brightness = of->light * pattern_at(of, u, v);
  if (!(ray_brightness > 1e-4))
    return ray_brightness;
  double noise = 0.0;
  for (int k = 0; k < 2; k++)
    if (of->fade[k] > 0.0f)
      noise += (double)(of->fade[k] * pl_noise((pl_vec3){GRAIN[k] * u, GRAIN[k] * v, 0.37},
                                               of->pattern + (uint32_t)k));
  const double x2 = u * u + v * v; /* walls are even */
  return ray_brightness * fmax(1.0 + UNEVEN * noise * x2 / (1.0 + x2), 0.0);
}

/* --- the mean --------------------------------------------------------------------------------- */

/* Mean area of patterns, over the squares of their radii. */
static double pattern_area(const pl_crater_field *field) {
  enum { CRATERS = 128, TURNS = 8, STEPS = 24 };
  const double reach = field->frame.rays.reach;
  double sum = 0.0;
  for (int n = 0; n < CRATERS; n++) {
    fresh of = {.light = 1.0};
    draw_rays(&field->scatter, (uint64_t)n + 1, reach, &of);
    for (int j = 0; j < TURNS; j++)
      for (int i = 0; i < STEPS; i++) {
        const double t = (i + 0.5) / STEPS, x = reach * t * t; /* denser within */
        const double turn = 2.0 * PL_PI * (j + (double)n / CRATERS) / TURNS;
        sum += 2.0 * t * reach * x * pattern_at(&of, x * cos(turn), x * sin(turn));
      }
  }
  return 2.0 * PL_PI * sum / ((double)CRATERS * TURNS * STEPS);
}

/* Fraction of the craters of a diameter that are not faded; `mean`: of the freshness of all. */
static double fresh_fraction(const pl_crater_frame *frame, double diameter_m, double *mean) {
  enum { AGES = 16 };
  const double oldest_ga = pl_crater_oldest_drawn_ga(frame, diameter_m);
  const double all = pl_crater_chronology(oldest_ga);
  const double some = pl_crater_chronology(fmin(life_ga(&frame->rays, diameter_m), oldest_ga));
  *mean = 0.0;
  if (!(all > 0.0))
    return 0.0;
  for (int k = 0; k < AGES; k++)
    *mean += pl_crater_freshness(&frame->rays, diameter_m,
                                 pl_crater_chronology_age_ga(some * (k + 0.5) / AGES));
  *mean *= some / all / AGES;
  return some / all;
}

pl_status pl_crater_brightness_create(const pl_crater_field *field, pl_crater_brightness **out) {
  const pl_crater_frame *frame = &field->frame;
  *out = NULL;
  if (!(frame->rays.brightness > 0.0))
    return PL_OK;
  void *memory;
  PL_TRY(pl_alloc_or_fail(1, sizeof(pl_crater_brightness), "rays of craters", &memory));
  pl_crater_brightness *made = memory;
  made->low = log(frame->min_m);
  made->step = log(frame->max_m / frame->min_m) / BINS;
  const double area = 0.25 * pattern_area(field); /* over the squares of diameters */
  for (int k = 0; k <= BINS; k++) {
    const double from_m = exp(made->low + k * made->step), to_m = from_m * exp(made->step);
    const double middle_m = sqrt(from_m * to_m);
    double mean, unused;
    made->fraction[k] = fresh_fraction(frame, from_m, &unused);
    fresh_fraction(frame, middle_m, &mean);
    if (k < BINS)
      made->mean[k] = area * middle_m * middle_m * mean *
                      (pl_size_table_density(field->scatter.sizes, from_m) -
                       pl_size_table_density(field->scatter.sizes, to_m));
  }
  *out = made;
  return PL_OK;
}

void pl_crater_brightness_destroy(pl_crater_brightness *brightness) { pl_free(brightness); }

/* sums[k]: mean of the excess by craters below bin k. */
static void sum_means(const pl_crater_brightness *of, double footprint_m, double sums[BINS + 1]) {
  sums[0] = 0.0;
  for (int k = 0; k < BINS; k++)
    sums[k + 1] = sums[k] + of->mean[k] * fade_of(exp(of->low + (k + 0.5) * of->step), footprint_m);
}

static double mean_below(const pl_crater_brightness *of, const double sums[BINS + 1],
                         double most_m) {
  const double place = fmin(fmax((log(most_m) - of->low) / of->step, 0.0), BINS);
  const int k = place < BINS ? (int)place : BINS - 1;
  return sums[k] + (place - k) * (sums[k + 1] - sums[k]);
}

/* --- a block ---------------------------------------------------------------------------------- */

typedef struct gathered {
  const pl_crater_field *field;
  double footprint_m;
  fresh *list;
  size_t count, capacity;
} gathered;

/* Whether a crater can be fresh, which is seldom, at little cost. */
static bool may_be_fresh(const gathered *all, const pl_scatter_site *site) {
  const pl_crater_brightness *of = all->field->brightness;
  const double place = (log(site->diameter_m) - of->low) / of->step;
  const int k = place <= 0.0 ? 0 : place < BINS ? (int)place : BINS - 1;
  return pl_crater_draw_rank(all->field, site) <= 1.02 * fmax(of->fraction[k], of->fraction[k + 1]);
}

static pl_status keep(void *context, const pl_scatter_site *site) {
  gathered *all = context;
  const pl_crater_frame *frame = &all->field->frame;
  if (!may_be_fresh(all, site))
    return PL_OK;
  pl_crater_draw draw;
  pl_crater_draw_age(all->field, site, &draw);
  const double light = pl_crater_freshness(&frame->rays, site->diameter_m, draw.age_ga);
  if (!(light > 0.0))
    return PL_OK;
  if (all->count == all->capacity) {
    const size_t more = all->capacity > 0 ? 2 * all->capacity : 32;
    fresh *grown = pl_realloc(all->list, more, sizeof *grown);
    if (grown == NULL)
      return pl_fail(PL_E_MEMORY, "out of memory for rays of %zu craters", more);
    all->list = grown;
    all->capacity = more;
  }
  fresh *of = &all->list[all->count++];
  pl_crater_draw_shape(all->field, site, &draw);
  const double radius_m = 0.5 * site->diameter_m, blur = 0.5 * all->footprint_m / radius_m;
  const double radius = radius_m / frame->radius_m;
  const double chord = 2.0 * sin(0.5 * fmin(frame->rays.reach * radius, PL_PI));
  *of = (fresh){.direction = site->direction,
                .major = draw.major,
                .minor = draw.minor,
                .chord2 = chord * chord,
                .radius = radius,
                .diameter_m = site->diameter_m,
                .blur2 = blur * blur,
                .light = light * fade_of(site->diameter_m, all->footprint_m)};
  draw_rays(&all->field->scatter, site->id, frame->rays.reach, of);
  for (int k = 0; k < 2; k++)
    of->fade[k] = pl_noise_fade((float)(2.0 * blur * GRAIN[k]));
  return PL_OK;
}

static void sum_at(const gathered *all, const pl_crater_model *model, const double *sums,
                   const pl_vec3 *directions, size_t count, float *out) {
  const pl_crater_frame *frame = &all->field->frame;
  for (size_t k = 0; k < count; k++) {
    double sum = 0.0, most_m = frame->max_m;
    for (size_t n = 0; n < all->count; n++)
      sum += ray_brightness_at(&all->list[n], directions[k]) *
             pl_crater_left(all->field, model, directions[k], all->list[n].diameter_m);
    if (model != NULL)
      most_m = fmin(most_m, frame->model_posts * model->spacing_m(model->context, directions[k]));
    out[k] = (float)(fmin(sum, 1.0) - mean_below(all->field->brightness, sums, most_m));
  }
}

pl_status pl_crater_add_rays(const pl_crater_field *field, const pl_crater_model *model,
                             const pl_vec3 *directions, size_t count, double footprint_m,
                             float *out) {
  memset(out, 0, count * sizeof *out);
  if (count == 0 || field->brightness == NULL)
    return PL_OK;
  pl_vec3 sum = {0.0, 0.0, 0.0};
  for (size_t k = 0; k < count; k++)
    sum = pl_vec3_add(sum, directions[k]);
  pl_crater_query query = {.model = model,
                           .axis = pl_vec3_norm(sum) > 0.0 ? pl_vec3_unit(sum) : directions[0],
                           .reach = field->frame.rays.reach,
                           .min_m = FADE_FROM * footprint_m,
                           .max_m = INFINITY};
  double chord2 = 0.0, sums[BINS + 1];
  for (size_t k = 0; k < count; k++) {
    const pl_vec3 to = pl_vec3_sub(directions[k], query.axis);
    chord2 = fmax(chord2, pl_vec3_dot(to, to));
  }
  query.angle_rad = 2.0 * asin(fmin(0.5 * sqrt(chord2), 1.0));
  gathered all = {.field = field, .footprint_m = footprint_m};
  const pl_status status = pl_crater_visit(field, &query, keep, &all);
  sum_means(field->brightness, footprint_m, sums);
  if (status == PL_OK)
    sum_at(&all, model, sums, directions, count, out);
  pl_free(all.list);
  return status;
}
