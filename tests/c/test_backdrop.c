/* Pictures behind everything: places, seams, what is in front of them, and their row. */
#include "harness.h"

#include "plan/effects.h"
#include <string.h>

#include "frames.h"
#include "random.h"
#include "sky/backdrop.h"

enum { WIDTH = 72, HEIGHT = 48 };

static const pl_mat3 UPRIGHT = {{{1, 0, 0}, {0, 1, 0}, {0, 0, 1}}};

typedef void (*paint_fn)(double lon, double lat, uint8_t *texel);

static pl_texture *painted(int width, int height, paint_fn paint, pl_wrap wrap_u) {
  pl_image image;
  pl_texture *texture;
  assert_int_equal(pl_image_init(width, height, 3, &image), PL_OK);
  for (int y = 0; y < height; y++)
    for (int x = 0; x < width; x++)
      paint(2.0 * PL_PI * ((x + 0.5) / width - 0.5), PL_PI * (0.5 - (y + 0.5) / height),
            image.texels + 3 * (y * width + x));
  assert_int_equal(pl_texture_create(&image, false, wrap_u, PL_WRAP_CLAMP, &texture), PL_OK);
  return texture;
}

/* Red, green and blue grow along x, y and z. */
static void paint_axes(double lon, double lat, uint8_t *texel) {
  const double d[3] = {cos(lat) * cos(lon), cos(lat) * sin(lon), sin(lat)};
  for (int k = 0; k < 3; k++)
    texel[k] = (uint8_t)lround(255.0 * (0.5 + 0.5 * d[k]));
}
static void paint_even(double lon, double lat, uint8_t *texel) {
  (void)lon;
  (void)lat;
  texel[0] = 51;
  texel[1] = 102;
  texel[2] = 255;
}

static pl_backdrop map_of(const pl_texture *texture, float white) {
  return (pl_backdrop){PL_BACKDROP_MAP, texture, UPRIGHT, {white, white, white}};
}

static pl_frame_result render_sky(stage *s, const pl_sky *sky, double white_radiance,
                                  pl_plan_wish wish, int threads, film *f) {
  pl_renderer *renderer;
  pl_frame_request request = request_all(s, f);
  assert_int_equal(pl_renderer_create(&s->scene, &renderer), PL_OK);
  request.sky = sky;
  request.threads = threads;
  request.wish = wish;
  request.exposure.white_radiance = white_radiance;
  const pl_frame_result result = render(renderer, &request);
  pl_renderer_destroy(renderer);
  return result;
}

static const pl_plan_wish PLAIN = {.tolerance_dn = 0.5};

/* In any direction, on poles and the date line, at wide and narrow angles: the painted function. */
static void test_map_is_seamless(void **state) {
  (void)state;
  test_random random = {.seed = 9};
  pl_texture *texture = painted(512, 256, paint_axes, PL_WRAP_REPEAT);
  const pl_sky sky = {.backdrop = map_of(texture, 2.0f)};
  for (int k = 0; k < 24; k++) {
    stage s;
    film f;
    const pl_vec3 axes[3] = {{0, 0, 1}, {0, 0, -1}, {-1, 0, 0}};
    const pl_vec3 forward = k < 12 ? axes[k % 3] : random_direction(&random);
    stage_init(&s, WIDTH, HEIGHT, random_scale(&random, 10.0, 4000.0));
    s.placement.sun.irradiance_au = 0.0; /* its disc is in some frames */
    const pl_vec3 right = pl_vec3_unit(pl_vec3_cross(forward, random_direction(&random)));
    const pl_vec3 down = pl_vec3_cross(forward, right);
    const pl_mat3 axes_of_camera = pl_mat3_transpose((pl_mat3){{right, down, forward}});
    s.placement.camera.motion = still((pl_vec3){0, 0, 0}, pl_quat_from_mat3(axes_of_camera));
    film_init(&f, &s);
    render_sky(&s, &sky, 1.0, PLAIN, 1, &f);
    for (int i = 0; i < WIDTH * HEIGHT; i++) {
      const pl_vec3 ray = pl_vec3_unit(pl_mat3_mul_vec(
          axes_of_camera, pl_camera_ray(&s.placement.camera, i % WIDTH, i / WIDTH)));
      const double want[3] = {1.0 + ray.x, 1.0 + ray.y, 1.0 + ray.z};
      for (int band = 0; band < 3; band++) /* a texel is 0.7 degrees, its step in value 0.008 */
        assert_true(fabs((double)f.radiance[3 * i + band] - want[band]) < 0.02);
    }
    film_clear(&f);
    stage_clear(&s);
  }
  pl_texture_destroy(texture);
}

/* A map of one texel is the same everywhere. */
static void test_one_texel(void **state) {
  (void)state;
  stage s;
  film f;
  pl_texture *texture = painted(1, 1, paint_even, PL_WRAP_REPEAT);
  const pl_sky sky = {.backdrop = map_of(texture, 10.0f)};
  stage_init(&s, WIDTH, HEIGHT, 30.0);
  film_init(&f, &s);
  render_sky(&s, &sky, 10.0, PLAIN, 1, &f);
  for (int i = 0; i < WIDTH * HEIGHT; i++) {
    assert_true(fabsf(f.radiance[3 * i] - 2.0f) < 1e-5f);
    assert_true(fabsf(f.radiance[3 * i + 1] - 4.0f) < 1e-5f);
    assert_true(fabsf(f.radiance[3 * i + 2] - 10.0f) < 1e-5f);
  }
  assert_true(fabs(pl_backdrop_max(&sky.backdrop) - 10.0) < 1e-5);
  film_clear(&f);
  pl_texture_destroy(texture);
  stage_clear(&s);
}

/* Behind a body in the dark: black inside its limb, the sky outside, both on the limb, and the same
 * radiance in tiles with and without the body. Labels are those of no sky. */
static void test_body_in_front(void **state) {
  (void)state;
  stage s;
  film with, without;
  pl_texture *texture = painted(1, 1, paint_even, PL_WRAP_REPEAT);
  const pl_sky sky = {.backdrop = map_of(texture, 1.0f)};
  stage_init(&s, WIDTH, HEIGHT, 60.0);
  stage_add_body(&s, (pl_vec3){-2e6, 0, 1e7}, (pl_vec3){1.5e6, 1.5e6, 1.5e6}, 0.5f);
  s.placement.sun.position_m = (pl_vec3){-3e10, 0, 1.5e11}; /* behind the body */
  film_init(&with, &s);
  film_init(&without, &s);
  render_sky(&s, &sky, 1.0, PLAIN, 1, &with);
  render_sky(&s, NULL, 1.0, PLAIN, 1, &without);
  const int32_t *instance = film_channel(&with, "instance");
  int behind = 0, limb = 0;
  for (int i = 0; i < WIDTH * HEIGHT; i++) {
    const float added = with.radiance[3 * i + 2] - without.radiance[3 * i + 2];
    assert_true(added >= -1e-6f && added <= 1.0f + 1e-6f);
    behind += added > 0.999999f && instance[i] == 0;
    limb += added > 0.01f && added < 0.99f;
    if (added > 0.999999f)
      assert_int_equal(instance[i], 0);
  }
  assert_true(behind > 2500 && limb > 30 && limb < 200);
  assert_memory_equal(film_channel(&with, "instance"), film_channel(&without, "instance"),
                      sizeof(int32_t) * WIDTH * HEIGHT);
  film_clear(&with);
  film_clear(&without);
  pl_texture_destroy(texture);
  stage_clear(&s);
}

/* Left half black, right half white, above; below the other way round. */
static void paint_quarters(double lon, double lat, uint8_t *texel) {
  memset(texel, (lon > 0.0) == (lat > 0.0) ? 255 : 0, 3);
}

/* An image of 2:1 in a frame of 3:2: stretched, its edge columns are the frame's; as a cover, an
 * eighth of it is cut off on either side. */
static void test_images_fill_the_frame(void **state) {
  (void)state;
  pl_texture *texture = painted(200, 100, paint_axes, PL_WRAP_CLAMP);
  pl_texture *quarters = painted(64, 32, paint_quarters, PL_WRAP_CLAMP);
  for (int stretch = 0; stretch < 2; stretch++) {
    stage s;
    film f;
    pl_sky sky = {.backdrop = map_of(texture, 1.0f), .by_display = true};
    sky.backdrop.kind = stretch ? PL_BACKDROP_STRETCH : PL_BACKDROP_COVER;
    stage_init(&s, WIDTH, HEIGHT, 60.0);
    film_init(&f, &s);
    render_sky(&s, &sky, 50.0, PLAIN, 1, &f);
    for (int x = 0; x < WIDTH; x += 7) {
      const double part = (x + 0.5) / WIDTH - 0.5;
      const double lon = 2.0 * PL_PI * part * (stretch ? 1.0 : 0.75);
      const double want = 50.0 * (0.5 + 0.5 * cos(lon)); /* red, on the middle row */
      assert_true(fabs((double)f.radiance[3 * (HEIGHT / 2 * WIDTH + x)] - want) < 0.5);
    }
    sky.backdrop.texture = quarters;
    render_sky(&s, &sky, 50.0, PLAIN, 1, &f);
    assert_int_equal(f.rgb[0], 0);
    assert_int_equal(f.rgb[3 * (WIDTH - 1)], 255);
    assert_int_equal(f.rgb[3 * (WIDTH * HEIGHT - 1)], 0);
    assert_int_equal(f.rgb[3 * (WIDTH * (HEIGHT - 1))], 255);
    film_clear(&f);
    stage_clear(&s);
  }
  pl_texture_destroy(texture);
  pl_texture_destroy(quarters);
}

/* The row's bound holds at any exposure, and decides. */
static void test_bound(void **state) {
  (void)state;
  pl_texture *texture = painted(64, 32, paint_axes, PL_WRAP_REPEAT);
  const pl_sky sky = {.backdrop = map_of(texture, 1e-3f)};
  int on = 0;
  for (int k = 0; k < 8; k++) {
    stage s;
    film with, without;
    const double white = 1e-3 * pow(10.0, k);
    stage_init(&s, WIDTH, HEIGHT, 20.0);
    stage_add_body(&s, (pl_vec3){2e6, 0, 1e7}, (pl_vec3){1.5e6, 1.5e6, 1.5e6}, 0.5f);
    film_init(&with, &s);
    film_init(&without, &s);
    const pl_plan_wish forced = {.force_on = one_effect("sky_background")};
    const pl_plan_wish off = {.force_off = one_effect("sky_background")};
    render_sky(&s, &sky, white, forced, 1, &with);
    const pl_frame_result result = render_sky(&s, &sky, white, off, 1, &without);
    const double bound = result.plan.rows[pl_effect_find("sky_background")].bound_dn;
    for (size_t i = 0; i < 3 * with.pixels; i++)
      assert_true(abs(with.rgb[i] - without.rgb[i]) <= bound + 1.0);
    const pl_frame_result planned = render_sky(&s, &sky, white, PLAIN, 1, &without);
    const int value = pl_plan_value(&planned.plan, &pl_effect_sky_background);
    assert_int_equal(value, bound > 0.5);
    on += value;
    film_clear(&with);
    film_clear(&without);
    stage_clear(&s);
  }
  assert_true(on > 1 && on < 7);
  pl_texture_destroy(texture);
}

static void test_threads(void **state) {
  (void)state;
  stage s;
  film one, many;
  pl_texture *texture = painted(64, 32, paint_axes, PL_WRAP_REPEAT);
  const pl_sky sky = {.backdrop = map_of(texture, 1.0f)};
  stage_init(&s, WIDTH, HEIGHT, 20.0);
  stage_add_body(&s, (pl_vec3){2e6, 0, 1e7}, (pl_vec3){1.5e6, 1.5e6, 1.5e6}, 0.5f);
  film_init(&one, &s);
  film_init(&many, &s);
  render_sky(&s, &sky, 1.0, PLAIN, 1, &one);
  render_sky(&s, &sky, 1.0, PLAIN, 3, &many);
  assert_memory_equal(one.memory, many.memory, one.bytes);
  film_clear(&one);
  film_clear(&many);
  pl_texture_destroy(texture);
  stage_clear(&s);
}

int main(void) {
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(test_map_is_seamless), cmocka_unit_test(test_one_texel),
      cmocka_unit_test(test_body_in_front),   cmocka_unit_test(test_images_fill_the_frame),
      cmocka_unit_test(test_bound),           cmocka_unit_test(test_threads),
  };
  return cmocka_run_group_tests(tests, NULL, NULL);
}
