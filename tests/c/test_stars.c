/* Stars: cells of the sky, aberration, the light that pixels get, and what the plan leaves out. */
#include "harness.h"

#include <string.h>

#include "frames.h"
#include "random.h"
#include "sky/stars.h"

enum { WIDTH = 80, HEIGHT = 64, STARS = 500 };
static const double FOCAL_PX = 100.0;

static pl_star star_at(pl_vec3 direction, double light, int number) {
  const float f = (float)light;
  return (pl_star){.direction = direction,
                   .light = {0.5f * f, f, 0.25f * f},
                   .magnitude = (float)number,
                   .number = number};
}

/* Direction that the test stage's camera sees at a pixel position: its axes are the root's. */
static pl_vec3 toward(double u, double v) {
  return (pl_vec3){(u - 0.5 * (WIDTH - 1)) / FOCAL_PX, (v - 0.5 * (HEIGHT - 1)) / FOCAL_PX, 1.0};
}

static pl_star_catalogue *catalogue_of(const pl_star *stars, size_t count) {
  pl_star_catalogue *catalogue;
  assert_int_equal(pl_star_catalogue_create(stars, count, &catalogue), PL_OK);
  return catalogue;
}

/* Stars all over the sky, of magnitudes 0 to 5; the first eight on the axes and a pole's diagonal.
 */
static pl_star_catalogue *random_sky(uint64_t seed) {
  test_random random = {.seed = seed};
  pl_star stars[STARS];
  for (int i = 0; i < STARS; i++)
    stars[i] = star_at(random_direction(&random), 1e-3 * random_scale(&random, 0.01, 1.0), i);
  for (int i = 0; i < 6; i++)
    stars[i].direction = (pl_vec3){i / 2 == 0 ? 1 - i % 2 * 2 : 0, i / 2 == 1 ? 1 - i % 2 * 2 : 0,
                                   i / 2 == 2 ? 1 - i % 2 * 2 : 0};
  stars[6].direction = (pl_vec3){1, 1, 1};
  stars[7].direction = (pl_vec3){-1, 1, -1};
  return catalogue_of(stars, STARS);
}

static void test_every_star_is_in_its_cell(void **state) {
  (void)state;
  pl_star_catalogue *catalogue = random_sky(1);
  size_t total = 0;
  bool met[STARS] = {false};
  for (size_t c = 0; c < PL_SKY_CELLS; c++) {
    const pl_sky_cell *cell = &catalogue->cells[c];
    double rest = 0.0;
    total += cell->count;
    for (size_t i = cell->first + cell->count; i-- > cell->first;) {
      const pl_star *star = &catalogue->stars[i];
      met[star->number] = true;
      assert_true(fabs(pl_vec3_norm(star->direction) - 1.0) < 1e-15);
      assert_true(fabs(catalogue->rest[i] - rest) <= 1e-12 * rest);
      rest += (double)pl_star_brightness(star);
      if (i > cell->first)
        assert_true(pl_star_brightness(star - 1) >= pl_star_brightness(star));
      const double sine = pl_vec3_norm(pl_vec3_cross(star->direction, cell->axis));
      assert_true(asin(sine) <= cell->half_angle_rad + 1e-12 && cell->half_angle_rad < 0.2);
    }
  }
  assert_int_equal(total, STARS);
  for (int i = 0; i < STARS; i++)
    assert_true(met[i]);
  pl_star_catalogue_destroy(catalogue);
}

static void test_bad_stars_are_refused(void **state) {
  (void)state;
  pl_star_catalogue *catalogue;
  const pl_star good = star_at((pl_vec3){0, 0, 1}, 1.0, 0);
  pl_star bad[4] = {good, good, good, good};
  bad[0].direction = (pl_vec3){0, 0, 0};
  bad[1].direction.x = NAN;
  bad[2].light[2] = -1.0f;
  bad[3].light[0] = INFINITY;
  for (int i = 0; i < 4; i++) {
    const pl_star stars[2] = {good, bad[i]};
    assert_int_equal(pl_star_catalogue_create(stars, 2, &catalogue), PL_E_RANGE);
    assert_non_null(strstr(pl_error_text(), "star 1:"));
  }
  catalogue = catalogue_of(NULL, 0);
  pl_star_catalogue_destroy(catalogue);
}

/* The case of ERFA's own test of eraAb (t_erfa_c.c), which adds at most 2e-8 of gravity. */
static void test_aberration(void **state) {
  (void)state;
  const pl_vec3 p = {-0.76321968546737951, -0.60869453983060384, -0.21676408580639883};
  const pl_vec3 beta = {2.1044018893653786e-5, -8.9108923304429319e-5, -3.8633714797716569e-5};
  const pl_vec3 want = {-0.7631631094219556269, -0.6087553082505590832, -0.2167926269368471279};
  const pl_vec3 seen = pl_star_aberrate(p, beta);
  assert_true(pl_vec3_norm(pl_vec3_sub(seen, want)) < 2e-8);
  assert_true(fabs(pl_vec3_norm(seen) - 1.0) < 1e-15);
  assert_true(pl_vec3_norm(pl_vec3_sub(pl_star_aberrate(p, (pl_vec3){0, 0, 0}), pl_vec3_unit(p))) <
              1e-15);
  /* Fast: Einstein's formula, cos' = (cos + b) / (1 + b cos). */
  const pl_vec3 fast = pl_star_aberrate((pl_vec3){0, 1, 0}, (pl_vec3){0.6, 0, 0});
  assert_true(fabs(fast.x - 0.6) < 1e-15 && fabs(fast.y - 0.8) < 1e-15);
}

/* A pinhole's pixel between angles: the integral of cos^3 over the plane, exactly by arctangents
 * (the solid angle of a rectangle seen from a point over its corner). */
static double corner_angle(double x, double y) { return atan2(x * y, sqrt(1.0 + x * x + y * y)); }
static double pinhole_angle(int x, int y) {
  const pl_vec3 a = toward(x - 0.5, y - 0.5), b = toward(x + 0.5, y + 0.5);
  return corner_angle(b.x, b.y) - corner_angle(a.x, b.y) - corner_angle(b.x, a.y) +
         corner_angle(a.x, a.y);
}

static void render_sky(stage *s, const pl_sky *sky, pl_effect_set on, double tolerance_dn,
                       int threads, film *f, pl_frame_result *result) {
  pl_renderer *renderer;
  pl_frame_request request = request_all(s, f);
  assert_int_equal(pl_renderer_create(&s->scene, &renderer), PL_OK);
  request.sky = sky;
  request.threads = threads;
  request.wish = (pl_plan_wish){.tolerance_dn = tolerance_dn, .force_on = on};
  *result = render(renderer, &request);
  result->stars = NULL; /* the renderer's */
  pl_renderer_destroy(renderer);
}

/* Energy, place and colour of one star in an empty frame, by the green band: sums of radiance times
 * solid angle. */
typedef struct found {
  double energy, u, v;
} found;

static found measure_star(const film *f) {
  found out = {0};
  for (int y = 0; y < HEIGHT; y++)
    for (int x = 0; x < WIDTH; x++) {
      const float *rgb = f->radiance + 3 * (y * WIDTH + x);
      const double energy = (double)rgb[1] * pinhole_angle(x, y);
      assert_true(rgb[0] == 0.5f * rgb[1] && rgb[2] == 0.25f * rgb[1]);
      out.energy += energy;
      out.u += energy * x;
      out.v += energy * y;
    }
  out.u /= out.energy;
  out.v /= out.energy;
  return out;
}

/* On a pixel, between pixels, on a corner of four tiles, in the image's corners. */
static void test_energy_and_place(void **state) {
  (void)state;
  const double at[][2] = {{40, 20},   {10.3, 50.8}, {31.5, 31.5}, {31.99, 31.01}, {63.25, 32},
                          {0.0, 0.0}, {79, 63},     {0.5, 62.5},  {31.5, 10.0},   {12.125, 31.5}};
  for (size_t i = 0; i < sizeof at / sizeof at[0]; i++) {
    stage s;
    film f;
    pl_frame_result result;
    stage_init(&s, WIDTH, HEIGHT, FOCAL_PX);
    film_init(&f, &s);
    const pl_star star = star_at(toward(at[i][0], at[i][1]), 2e-3, 7);
    pl_star_catalogue *catalogue = catalogue_of(&star, 1);
    const pl_sky sky = {.stars = catalogue};
    render_sky(&s, &sky, no_effects(), 0.5, 1, &f, &result);
    const found seen = measure_star(&f);
    assert_int_equal(result.star_count, 1);
    assert_true(fabs(seen.energy / 2e-3 - 1.0) < 1e-6);
    assert_true(fabs(seen.u - at[i][0]) < 1e-4 && fabs(seen.v - at[i][1]) < 1e-4);
    pl_star_catalogue_destroy(catalogue);
    film_clear(&f);
    stage_clear(&s);
  }
}

/* Half of a star on the image's edge is in the image; one behind the camera is nowhere. */
static void test_edge_and_behind(void **state) {
  (void)state;
  const pl_vec3 behind = pl_vec3_scale(toward(40, 20), -1.0);
  const struct {
    pl_vec3 direction;
    double fraction;
  } cases[] = {{toward(-0.5, 20), 0.5},        {toward(79.5, 20), 0.5}, {toward(30, 63.75), 0.25},
               {toward(-0.75, -0.5), 0.125},   {toward(-1.0, 20), 0.0}, {behind, 0.0},
               {(pl_vec3){1.0, 0.0, 0.0}, 0.0}};
  for (size_t i = 0; i < sizeof cases / sizeof cases[0]; i++) {
    stage s;
    film f;
    pl_frame_result result;
    double energy = 0.0;
    stage_init(&s, WIDTH, HEIGHT, FOCAL_PX);
    film_init(&f, &s);
    const pl_star star = star_at(cases[i].direction, 2e-3, 7);
    pl_star_catalogue *catalogue = catalogue_of(&star, 1);
    const pl_sky sky = {.stars = catalogue};
    render_sky(&s, &sky, one_effect("stars"), 0.5, 1, &f, &result);
    for (int k = 0; k < WIDTH * HEIGHT; k++)
      energy += (double)f.radiance[3 * k + 1] * pinhole_angle(k % WIDTH, k / WIDTH);
    assert_true(fabs(energy / 2e-3 - cases[i].fraction) < 1e-6);
    pl_star_catalogue_destroy(catalogue);
    film_clear(&f);
    stage_clear(&s);
  }
}

/* A body hides the stars behind it and no others; one 1e-5 rad off the limb is seen, as is one on
 * the other side of it not. */
static void test_limb_hides(void **state) {
  (void)state;
  const double radius = 1.7e6, distance = 2e7, limb = asin(radius / distance);
  for (int side = -1; side <= 1; side += 2) {
    stage s;
    film f;
    pl_frame_result result;
    stage_init(&s, WIDTH, HEIGHT, FOCAL_PX);
    stage_add_body(&s, (pl_vec3){0, 0, distance}, (pl_vec3){radius, radius, radius}, 0.5f);
    film_init(&f, &s);
    const double angle = limb + side * 1e-5;
    const pl_star star = star_at((pl_vec3){sin(angle), 0, cos(angle)}, 2e-3, 7);
    pl_star_catalogue *catalogue = catalogue_of(&star, 1);
    const pl_sky sky = {.stars = catalogue};
    render_sky(&s, &sky, no_effects(), 0.5, 1, &f, &result);
    assert_int_equal(result.star_count, side > 0);
    pl_star_catalogue_destroy(catalogue);
    film_clear(&f);
    stage_clear(&s);
  }
}

/* The same bits on any number of threads, with tiles full of stars. */
static void test_threads(void **state) {
  (void)state;
  stage s;
  film one, many;
  pl_frame_result result;
  pl_star_catalogue *catalogue = random_sky(5);
  const pl_sky sky = {.stars = catalogue, .beta = {1e-4, 0, 2e-5}};
  stage_init(&s, WIDTH, HEIGHT, 20.0);
  stage_add_body(&s, (pl_vec3){1e6, 0, 2e7}, (pl_vec3){3e6, 3e6, 3e6}, 0.5f);
  film_init(&one, &s);
  film_init(&many, &s);
  render_sky(&s, &sky, no_effects(), 0.5, 1, &one, &result);
  assert_true(result.star_count > 50);
  render_sky(&s, &sky, no_effects(), 0.5, 3, &many, &result);
  assert_memory_equal(one.memory, many.memory, one.bytes);
  film_clear(&one);
  film_clear(&many);
  pl_star_catalogue_destroy(catalogue);
  stage_clear(&s);
}

/* Whatever the plan leaves out changes no pixel by more than it says, at any exposure; and it
 * leaves out stars one by one, not all or none. */
static void test_bound(void **state) {
  (void)state;
  int between = 0;
  for (int k = 0; k < 12; k++) {
    stage s;
    film all, planned;
    pl_frame_result result;
    pl_star_catalogue *catalogue = random_sky(100 + (uint64_t)k);
    const pl_sky sky = {.stars = catalogue};
    const double tolerance_dn = 1.0;
    stage_init(&s, WIDTH, HEIGHT, 25.0);
    film_init(&all, &s);
    film_init(&planned, &s);
    pl_renderer *renderer;
    assert_int_equal(pl_renderer_create(&s.scene, &renderer), PL_OK);
    pl_frame_request request = request_all(&s, &all);
    request.sky = &sky;
    request.exposure.white_radiance = pow(10.0, 0.4 * k - 1.0);
    request.wish = (pl_plan_wish){.force_on = one_effect("stars")};
    result = render(renderer, &request);
    const size_t full = result.star_count;
    request = request_all(&s, &planned);
    request.sky = &sky;
    request.exposure.white_radiance = pow(10.0, 0.4 * k - 1.0);
    request.wish = (pl_plan_wish){.tolerance_dn = tolerance_dn};
    result = render(renderer, &request);
    const pl_plan_row *row = &result.plan.rows[pl_effect_find("stars")];
    between += result.star_count > 0 && result.star_count < full;
    assert_true(row->residual_dn <= tolerance_dn);
    assert_true(row->value > 0 || row->bound_dn <= tolerance_dn);
    for (size_t i = 0; i < 3 * all.pixels; i++)
      assert_true(fabs((double)all.rgb[i] - (double)planned.rgb[i]) <= row->residual_dn + 1.0);
    pl_renderer_destroy(renderer);
    film_clear(&all);
    film_clear(&planned);
    pl_star_catalogue_destroy(catalogue);
    stage_clear(&s);
  }
  assert_true(between >= 4);
}

/* Cells of the sky whose stars are too faint together are not even looked at, and count. */
static void test_faint_cells_are_skipped(void **state) {
  (void)state;
  stage s;
  pl_snapshot shot;
  pl_arena arena;
  pl_star_field some, all;
  pl_view_sky view = {0}, full = {0};
  pl_star_catalogue *catalogue = random_sky(3);
  pl_arena_init(&arena);
  stage_init(&s, WIDTH, HEIGHT, 25.0);
  assert_int_equal(pl_snapshot_build(&s.scene, &s.placement, &arena, &shot), PL_OK);
  const pl_vec3 still_camera = {0, 0, 0};
  assert_int_equal(pl_star_field_gather(catalogue, &shot, still_camera, 0, &arena, &all, &full),
                   PL_OK);
  assert_int_equal(pl_star_field_gather(catalogue, &shot, still_camera, 20.0, &arena, &some, &view),
                   PL_OK);
  assert_true(some.count < all.count && some.count > 0 && full.star_left[full.star_levels] == 0.0f);
  const float left = view.star_left[view.star_levels];
  assert_true(left > 0.0f && left <= 20.0f);
  for (size_t i = 1; i < all.count; i++)
    assert_true(all.stars[i].level >= all.stars[i - 1].level);
  for (int i = 1; i <= full.star_levels; i++)
    assert_true(full.star_left[i] <= full.star_left[i - 1]);
  stage_clear(&s);
  pl_arena_clear(&arena);
  pl_star_catalogue_destroy(catalogue);
}

int main(void) {
  const struct CMUnitTest tests[] = {
      serial_unit_test(test_every_star_is_in_its_cell),
      serial_unit_test(test_bad_stars_are_refused),
      serial_unit_test(test_aberration),
      serial_unit_test(test_energy_and_place),
      serial_unit_test(test_edge_and_behind),
      serial_unit_test(test_limb_hides),
      cmocka_unit_test(test_threads),
      serial_unit_test(test_bound),
      serial_unit_test(test_faint_cells_are_skipped),
  };
  return cmocka_run_group_tests(tests, NULL, NULL);
}
