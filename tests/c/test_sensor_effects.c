/* The bounds of the sensor's rows, each by itself: what an image changes when the stage is left
 * out, or done in its cheaper way, is within what the row says; and rows that say that they cannot
 * matter change not a bit. Random sensors and images from black to far beyond the full well.
 *
 * The bound of a random row is a quantile: normal numbers within 6 standard deviations, counts
 * within what one in 1e9 passes; of the 1e6 numbers that are drawn here none should. A change of
 * the mean makes `shot_noise` draw other numbers and lets other pixels bloom: with those two rows,
 * and with `black_sun`, where more light is less charge, the others are not compared. */
#include "harness.h"

#include "differences.h"
#include "random.h"
#include "plan/effects.h"
#include "sensors.h"

enum { ROUNDS = PL_DRAWS(100, 25) };

static double random_or_none(test_random *random, double low, double high) {
  return random_unit(random) < 0.3 ? 0.0 : random_scale(random, low, high);
}

enum { KERNEL_MAX = 60 };

static pl_psf random_psf(test_random *random) {
  static double kernel[KERNEL_MAX * KERNEL_MAX]; /* of the last sensor made */
  const int width = 1 + random_below(random, KERNEL_MAX), height = 1 + random_below(random, 30);
  double sum = 0.0;
  for (int i = 0; i < width * height; i++)
    sum += kernel[i] = pow(random_unit(random), 1.0 + i % 40);
  for (int i = 0; i < width * height; i++)
    kernel[i] /= sum;
  return (pl_psf){.kernel = kernel,
                  .kernel_width = width,
                  .kernel_height = height,
                  .core = (pl_psf_core)random_below(random, PL_PSF_CORES),
                  .sigma_px = random_scale(random, 0.1, 20.0),
                  .wings = random_or_none(random, 1e-4, 1.0),
                  .wing_radius_px = random_scale(random, 0.1, 20.0),
                  .wing_beta = random_range(random, 1.1, 4.0)};
}

static pl_shading random_shading(test_random *random) {
  static float flat[6]; /* of the last sensor made */
  pl_shading shading = {.power = random_or_none(random, 0.1, 10.0)};
  if (random_unit(random) < 0.3) {
    shading.count = 3;
    for (int i = 0; i < 3; i++) {
      shading.angle_rad[i] = 0.3 * i + random_range(random, 0.0, 0.2);
      shading.factor[i] = random_unit(random);
    }
  }
  for (int i = 0; i < 6; i++)
    flat[i] = (float)random_range(random, 0.3, 1.5);
  if (random_unit(random) < 0.3)
    assert_int_equal(pl_shading_set_flat(&shading, flat, 3, 2), PL_OK);
  return shading;
}

static pl_flare random_flare(test_random *random) {
  pl_flare flare = {.count = random_below(random, 4),
                    .baffle_rad = {0.3, random_range(random, 0.3, 1.5)}};
  for (int i = 0; i < flare.count; i++) {
    flare.ghosts[i] = (pl_ghost){.scale = i == 0 ? 0.0 : random_range(random, -2.0, 2.0),
                                 .radius_rad = random_scale(random, 1e-3, 1.0)};
    for (int band = 0; band < 3; band++)
      flare.ghosts[i].part[band] = random_or_none(random, 1e-6, 0.1);
  }
  return flare;
}

/* Within what pl_sensor_check takes, and what there is. */
static pl_sensor random_sensor(test_random *random) {
  pl_sensor s = sensor_plain();
  s.pixel_m = random_scale(random, 1e-6, 30e-6);
  s.f_number = random_scale(random, 0.7, 20.0);
  s.shading = random_shading(random);
  s.psf = random_psf(random);
  s.flare = random_flare(random);
  s.mosaic = (pl_mosaic)random_below(random, PL_MOSAIC_COUNT);
  for (int band = 0; band < 3; band++)
    s.quantum_efficiency[band] = random_range(random, 0.05, 1.0);
  s.mixed = s.mosaic != PL_MOSAIC_MONO && random_unit(random) < 0.7;
  for (int band = 0; band < 3; band++) {
    const double foreign = random_scale(random, 1e-5, 1.0), part = random_unit(random);
    s.mix[band][band] = 1.0 - foreign;
    s.mix[band][(band + 1) % 3] = foreign * part;
    s.mix[band][(band + 2) % 3] = foreign * (1.0 - part);
  }
  s.serial = (uint64_t)random_below(random, 1 << 30);
  s.exposure_s = random_scale(random, 1e-5, 100.0);
  s.full_well = random_scale(random, 100.0, 1e6);
  s.bits = 1 + random_below(random, 16);
  s.black_level = random_range(random, 0.0, 0.5) * ((1 << s.bits) - 2);
  s.gain = random_scale(random, 0.3, 3.0) * s.full_well / ((1 << s.bits) - 1);
  s.prnu = random_or_none(random, 1e-4, 0.5);
  s.dark_current = random_or_none(random, 1e-4, 1.0) * s.full_well / s.exposure_s;
  s.dark_nonuniform = random_or_none(random, 0.01, 10.0);
  s.hot_pixels = random_or_none(random, 1e-3, 0.5);
  s.hot_current = random_scale(random, 1e-4, 9.0) * s.full_well / s.exposure_s;
  s.dead_pixels = random_or_none(random, 1e-3, 0.1);
  s.shift_s = random_or_none(random, 1e-6, 0.1) * s.exposure_s;
  s.drain = random_or_none(random, 0.1, 1.0);
  s.ray_flux =
      fmin(1e15, random_or_none(random, 1e-4, 1.0) / (s.pixel_m * s.pixel_m * s.exposure_s));
  s.ray_depth_m = random_scale(random, 0.1, 30.0) * s.pixel_m;
  s.ray_electrons_per_m = random_scale(random, 1e-4, 1.0) * s.full_well / s.ray_depth_m;
  s.read_noise = random_or_none(random, 1e-5, 0.1) * s.full_well;
  s.reset_s = random_or_none(random, 1e-8, 0.3) * s.exposure_s;
  s.column_noise = random_or_none(random, 1e-5, 0.1) * s.full_well;
  s.column_flicker = random_unit(random) * s.column_noise;
  s.row_noise = random_unit(random) * s.column_noise;
  return s;
}

/* A scene of one entity, as bright as its view says at most, under any camera. */
typedef struct scene {
  pl_sensor sensor;
  pl_view_entity entity;
  pl_view view;
  int width, height;
  double focal_px[2], centre_px[2];
  uint64_t seed;
  float brightest; /* radiance */
  float tint[3];   /* of the light; the largest is 1 */
  int pattern;
} scene;

static void scene_init(scene *s, test_random *random) {
  *s = (scene){.sensor = random_sensor(random),
               .width = 1 + random_below(random, 40),
               .height = 1 + random_below(random, 30),
               .seed = (uint64_t)random_below(random, 1 << 30),
               .pattern = random_below(random, 5),
               .tint = {1.0f, 1.0f, 1.0f}};
  s->tint[random_below(random, 3)] = (float)random_unit(random);
  for (int axis = 0; axis < 2; axis++) {
    s->focal_px[axis] = random_scale(random, 10.0, 1000.0);
    s->centre_px[axis] = random_range(random, -20.0, 60.0);
  }
  assert_int_equal(pl_sensor_check(&s->sensor), PL_OK);
  /* night, dim, and up to 1e4 times white */
  const double white = pl_sensor_white_electrons(&s->sensor) / pl_sensor_response_white(&s->sensor);
  s->entity = (pl_view_entity){.is_body = true,
                               .in_frame = true,
                               .distance_m = 10.0,
                               .radius_m = 1.0,
                               .albedo_max = 0.02,
                               .ggx_alpha_min = 1.0,
                               .irradiance = white * random_or_none(random, 1e-2, 1e6)};
  const double u = fmax(s->centre_px[0], s->width - 1 - s->centre_px[0]) / s->focal_px[0];
  const double v = fmax(s->centre_px[1], s->height - 1 - s->centre_px[1]) / s->focal_px[1];
  s->view = (pl_view){.width = s->width,
                      .height = s->height,
                      .white_radiance = 1.0,
                      .corner_tangent = hypot(fmax(u, -s->centre_px[0] / s->focal_px[0]),
                                              fmax(v, -s->centre_px[1] / s->focal_px[1])),
                      .pixel_rad = 1.0 / fmax(s->focal_px[0], s->focal_px[1]),
                      .sun_axis_rad = random_range(random, 0.0, 2.0),
                      .sun_irradiance = white * random_or_none(random, 1e-6, 1e3),
                      .entities = &s->entity,
                      .entity_count = 1,
                      .sensor = &s->sensor};
  s->brightest = (float)pl_sensor_radiance_max(&s->view);
}

/* All bright; a bright half; one bright pixel; one dark pixel in each column; noise. */
static float light_at(const scene *s, size_t i, size_t pixels, test_random *random) {
  const size_t width = (size_t)s->width, x = i % width, y = i / width;
  const float noise = (float)random_unit(random);
  switch (s->pattern) {
  case 0:
    return s->brightest;
  case 1:
    return 2 * x < width ? s->brightest : 0.0f;
  case 2:
    return i == pixels / 2 ? s->brightest : 0.0f;
  case 3:
    return y == (7 * x) % (size_t)s->height ? 0.0f : s->brightest;
  default:
    return noise * s->brightest;
  }
}

static void develop(const scene *s, const pl_plan *plan, sensor_shot *shot) {
  test_random random = {.seed = s->seed};
  sensor_shot_init(shot, &s->sensor, s->width, s->height);
  for (int axis = 0; axis < 2; axis++) {
    shot->frame.focal_px[axis] = s->focal_px[axis];
    shot->frame.centre_px[axis] = s->centre_px[axis];
  }
  const pl_view *view = &s->view; /* the sun in the image, wherever the view says that it is */
  const double sun = view->sun_irradiance * pl_flare_baffle(&s->sensor.flare, view->sun_axis_rad);
  shot->frame.sun = (pl_flare_sun){.on = sun > 0.0,
                                   .place_px = {0.3 * s->width, 0.6 * s->height},
                                   .radius_px = 1.0,
                                   .light = sun * s->focal_px[0] * s->focal_px[1]};
  shot->frame.seed = s->seed;
  for (size_t i = 0; i < shot->pixels; i++) {
    const float light = light_at(s, i, shot->pixels, &random);
    shot->frame.bands[i] = (pl_vec3f){s->tint[0] * light, s->tint[1] * light, s->tint[2] * light};
  }
  assert_int_equal(pl_sensor_run(&shot->frame, plan), PL_OK);
}

/* What the display shows of a pixel's charge in its own band, not rounded to digital numbers. */
static double shown(const sensor_shot *shot, size_t pixel) {
  const pl_sensor *s = shot->frame.sensor;
  const double most = (double)((1u << s->bits) - 1u) - s->black_level;
  const double number = fmin(fmax(shot->frame.electrons[pixel] / s->gain, -s->black_level), most);
  const size_t width = (size_t)shot->frame.width;
  const int band = pl_sensor_band(s->mosaic, (int)(pixel % width), (int)(pixel / width));
  return encode(pl_sensor_balance(s, band) * number * s->gain / pl_sensor_white_electrons(s));
}

static double largest_change(const sensor_shot *a, const sensor_shot *b) {
  double out = 0.0;
  for (size_t i = 0; i < a->pixels; i++)
    out = fmax(out, fabs(shown(a, i) - shown(b, i)));
  return out;
}

/* Of the picture: bound, and one step of the digital numbers, each rounded to 8 bits. */
static double picture_allowance(const scene *s, double bound_dn) {
  const double step = pl_sensor_dn(&s->view, s->sensor.gain);
  return fmin(255.0, bound_dn + step + 1.0);
}

static int largest_step(const sensor_shot *a, const sensor_shot *b) {
  int out = 0;
  for (size_t i = 0; i < 3 * a->pixels; i++)
    out =
        abs(a->frame.rgb[i] - b->frame.rgb[i]) > out ? abs(a->frame.rgb[i] - b->frame.rgb[i]) : out;
  return out;
}

typedef struct tally {
  int absent, changed, useful; /* useful: changed, and the bound is less than all */
  double tightest;             /* largest change over the bound, of the useful ones */
} tally;

static pl_plan plan_of(const pl_effect *row, int value) {
  pl_plan plan = sensor_plan(1, NULL);
  for (size_t i = 0; i < plan.count; i++) {
    const pl_effect *effect = plan.rows[i].effect;
    if (effect == &pl_effect_shot_noise || effect == &pl_effect_blooming ||
        effect == &pl_effect_black_sun)
      plan.rows[i].value = 0;
    if (effect == row)
      plan.rows[i].value = value;
  }
  return plan;
}

static bool same_bits(const sensor_shot *a, const sensor_shot *b) {
  return memcmp(a->frame.raw, b->frame.raw, a->pixels * sizeof *a->frame.raw) == 0 &&
         memcmp(a->frame.rgb, b->frame.rgb, 3 * a->pixels) == 0;
}

static void compare(const scene *s, const pl_effect *row, int value, tally *tally) {
  const bool absent = row->absent(&s->view) != NULL;
  const int full = row->ceiling(&s->view);
  const pl_plan on = plan_of(row, full), off = plan_of(row, value);
  sensor_shot shots[2];
  develop(s, &on, &shots[0]);
  develop(s, &off, &shots[1]);
  const double change = largest_change(&shots[0], &shots[1]);
  if (absent) {
    tally->absent++;
    if (!same_bits(&shots[0], &shots[1]))
      fail_msg("%s is absent (%s) and changes %g DN", row->name, row->absent(&s->view), change);
  } else {
    const double bound = row->bound_dn(&s->view, value);
    assert_true(row->bound_dn(&s->view, full) == 0.0);
    if (!(change <= bound + 1e-4)) /* radiances are floats */
      fail_msg("%s at %d changes %g DN, bound %g (pattern %d, %dx%d)", row->name, value, change,
               bound, s->pattern, s->width, s->height);
    const int step = largest_step(&shots[0], &shots[1]);
    if (!(step <= picture_allowance(s, bound)))
      fail_msg("%s at %d changes the picture by %d DN, bound %g", row->name, value, step, bound);
    tally->changed += change > 0.0;
    tally->useful += change > 0.0 && bound < 200.0;
    if (bound > 0.1 && bound < 200.0)
      tally->tightest = fmax(tally->tightest, change / bound);
  }
  sensor_shot_clear(&shots[0]);
  sensor_shot_clear(&shots[1]);
}

/* What the bounds say of charge holds of the pixels, before they bloom. */
static void charge_is_bounded(const scene *s) {
  sensor_shot shot;
  pl_plan plan = sensor_plan(1, "blooming");
  for (size_t i = 0; i < plan.count; i++)
    if (plan.rows[i].effect == &pl_effect_read_noise)
      plan.rows[i].value = 0;
  scene open = *s;
  open.sensor.full_well = 1e12;
  open.view.sensor = &open.sensor;
  develop(&open, &plan, &shot);
  const double most = pl_sensor_charge_max(&s->view);
  for (size_t i = 0; i < shot.pixels; i++)
    if (!(shot.frame.electrons[i] <= most * (1.0 + 1e-6)))
      fail_msg("a charge of %g, said to be at most %g", shot.frame.electrons[i], most);
  sensor_shot_clear(&shot);
}

static void test_each_row_stays_below_its_bound(void **state) {
  (void)state;
  test_random random = {.seed = 97};
  tally tallies[PL_PLAN_ROWS_MAX] = {{0}};
  for (int round = 0; round < ROUNDS; round++) {
    scene s;
    scene_init(&s, &random);
    charge_is_bounded(&s);
    for (size_t i = 0; i < pl_sensor_stage_count; i++) {
      const pl_effect *row = pl_sensor_stages[i].effect;
      for (int value = 0; row != NULL && value < row->ceiling(&s.view); value++)
        compare(&s, row, value, &tallies[i]);
    }
  }
  for (size_t i = 0; i < pl_sensor_stage_count; i++) {
    const tally *t = &tallies[i];
    if (pl_sensor_stages[i].effect == NULL)
      continue;
    print_message("%s: absent %d times, changed %d images, %d of them by a bound that says "
                  "something, up to %.2g of it\n",
                  pl_sensor_stages[i].name, t->absent, t->changed, t->useful, t->tightest);
    assert_true(PL_SEEN(t->changed, 10));
    assert_true(PL_SEEN(t->useful, 5) || pl_sensor_stages[i].effect == &pl_effect_blooming);
    assert_true(PL_SEEN(t->absent, 5) || pl_sensor_stages[i].effect == &pl_effect_shot_noise);
  }
}

int main(void) {
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(test_each_row_stays_below_its_bound),
  };
  return cmocka_run_group_tests(tests, NULL, NULL);
}
