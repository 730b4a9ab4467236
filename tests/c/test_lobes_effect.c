/* Walls that let light pass and clear coats in frames, and the effect rows that leave them out. */
#include "harness.h"

#include "frames.h"

enum { WIDTH = 8, HEIGHT = 8, CENTRE = (4 * WIDTH + 4) * 3 };

/* A wall across the view before a glowing body; the sun is behind the camera. */
typedef struct room {
  pl_model *wall;
  stage stage;
  film film;
  pl_renderer *renderer;
} room;

static void room_init(room *r) {
  r->wall = square_create(3.0);
  pl_material *m = &r->wall->materials[0];
  m->roughness = 0.0f;
  m->base_color[0] = 1.0f;
  m->base_color[1] = 0.5f;
  m->base_color[2] = 0.25f;
  m->layered = true;
  m->layers = PL_MATERIAL_LAYERS_PLAIN;
}

static void room_open(room *r, double wall_z) {
  stage_init(&r->stage, WIDTH, HEIGHT, 20.0);
  stage_add_object(&r->stage, r->wall, (pl_vec3){0, 0, wall_z}, PL_QUAT_IDENTITY, 1.0);
  const size_t body = stage_add_body(&r->stage, (pl_vec3){0, 0, 30}, (pl_vec3){8, 8, 8}, 0.0f);
  for (int k = 0; k < 3; k++)
    r->stage.bodies[body].emission[k] = 100.0f;
  film_init(&r->film, &r->stage);
  assert_int_equal(pl_renderer_create(&r->stage.scene, &r->renderer), PL_OK);
}

static void room_close(room *r) {
  pl_renderer_destroy(r->renderer);
  film_clear(&r->film);
  stage_clear(&r->stage);
}

static pl_frame_result take(room *r, int max_bounces, const char *off) {
  pl_frame_request request = request_all(&r->stage, &r->film);
  request.samples = 64;
  request.max_bounces = max_bounces;
  request.wish.force_on = one_effect("antialiasing");
  if (off != NULL)
    request.wish.force_off = one_effect(off);
  return render(r->renderer, &request);
}

static int value_of(const pl_frame_result *result, const char *name) {
  return result->plan.rows[pl_effect_find(name)].value;
}

/* Index 1 and no roughness: the wall does nothing but tint what is behind. */
static void test_clear_wall_tints(void **state) {
  (void)state;
  room r;
  room_init(&r);
  r.wall->materials[0].layers.transmission = 1.0f;
  r.wall->materials[0].layers.ior = 1.0f;
  room_open(&r, 5.0);
  const pl_frame_result result = take(&r, 3, NULL);
  assert_int_equal(value_of(&result, "transmission"), 1);
  assert_int_equal(value_of(&result, "clear_coat"), 0);
  const float expected[] = {100.0f, 50.0f, 25.0f};
  for (int k = 0; k < 3; k++)
    if (fabsf(r.film.radiance[CENTRE + k] / expected[k] - 1.0f) > 0.01f)
      fail_msg("band %d: %g, not %g", k, (double)r.film.radiance[CENTRE + k], (double)expected[k]);
  room_close(&r);
  pl_model_destroy(r.wall);
}

/* Index 1.5: what Schlick's formula mirrors at normal incidence, 4 %, is missing. */
static void test_glass_mirrors_its_part(void **state) {
  (void)state;
  room r;
  room_init(&r);
  r.wall->materials[0].layers.transmission = 1.0f;
  room_open(&r, 5.0);
  r.stage.placement.sun.position_m.y = -1e11; /* not in the mirror */
  take(&r, 3, NULL);
  assert_true(fabsf(r.film.radiance[CENTRE] / 96.0f - 1.0f) < 0.01f);
  room_close(&r);
  pl_model_destroy(r.wall);
}

/* Left out, or with no bounce to follow the light, the wall scatters the sun back: Lambert but for
 * index 1's missing mirror. */
static void test_without_transmission_it_is_a_wall(void **state) {
  (void)state;
  room r;
  room_init(&r);
  r.wall->materials[0].layers.transmission = 1.0f;
  r.wall->materials[0].layers.ior = 1.0f;
  room_open(&r, 5.0);
  for (int i = 0; i < 2; i++) {
    const pl_frame_result result = take(&r, i == 0 ? 3 : 0, i == 0 ? "transmission" : NULL);
    assert_int_equal(value_of(&result, "transmission"), 0);
    const float expected = 1361.0f / PL_PI_F;
    assert_true(fabsf(r.film.radiance[CENTRE] / expected - 1.0f) < 0.01f);
  }
  room_close(&r);
  pl_model_destroy(r.wall);
}

/* A smooth coat takes Fresnel's part from the light that a diffuse wall gets and sends, 0.04 at 18
 * degrees and at normal incidence, and throws back to the wall what of it does not leave: of even
 * light 0.0918 is mirrored for an index of 1.5. Reciprocal, and white in a furnace. */
static void test_coat_over_a_base(void **state) {
  (void)state;
  room r;
  room_init(&r);
  r.wall->materials[0].layers.coat = 1.0f;
  r.wall->materials[0].layers.ior = 1.0f;
  room_open(&r, 5.0);
  r.stage.placement.sun.position_m = (pl_vec3){0.0, -5e10, -149597870700.0};
  take(&r, 0, "clear_coat");
  const float bare = r.film.radiance[CENTRE];
  const pl_frame_result result = take(&r, 0, NULL);
  assert_int_equal(value_of(&result, "clear_coat"), 1);
  const float expected = 0.96f * 0.96f / (1.0f - 0.0918f);
  assert_true(fabsf(r.film.radiance[CENTRE] / bare - expected) < 0.005f);
  room_close(&r);
  pl_model_destroy(r.wall);
}

/* Behind the camera the layers matter less the further they are. */
static void test_bounds_fall_with_distance(void **state) {
  (void)state;
  static const char *const names[] = {"clear_coat", "transmission"};
  room r;
  room_init(&r);
  r.wall->materials[0].layers.coat = r.wall->materials[0].layers.transmission = 0.5f;
  for (int i = 0; i < 2; i++) {
    double bound[3];
    const double z[] = {5.0, -1e3, -1e5};
    for (int k = 0; k < 3; k++) {
      room_open(&r, z[k]);
      r.stage.bodies[0].albedo[0] = 0.5f;
      const pl_frame_result result = take(&r, 3, NULL);
      bound[k] = result.plan.rows[pl_effect_find(names[i])].bound_dn;
      if (k != 1) /* near the tolerance */
        assert_int_equal(value_of(&result, names[i]), k == 0);
      room_close(&r);
    }
    print_message("%s: %g, %g, %g DN\n", names[i], bound[0], bound[1], bound[2]);
    assert_true(bound[1] > bound[2]);
  }
  pl_model_destroy(r.wall);
}

/* IEC 61966-2-1, not rounded. */
static double encode(double x) {
  const double v = fmin(fmax(x, 0.0), 1.0);
  return 255.0 * (v <= 0.0031308 ? 12.92 * v : 1.055 * pow(v, 1.0 / 2.4) - 0.055);
}

/* What a layer behind the camera changes on the body that it faces is within its row's bound, and
 * is something. 0.2: noise. */
static void test_left_out_stays_below_its_bound(void **state) {
  (void)state;
  static const char *const names[] = {"clear_coat", "transmission"};
  for (int i = 0; i < 2; i++) {
    room r;
    room_init(&r);
    r.wall->materials[0].roughness = 0.6f;
    r.wall->materials[0].layers.coat = i == 0 ? 1.0f : 0.0f;
    r.wall->materials[0].layers.transmission = i == 0 ? 0.0f : 1.0f;
    room_open(&r, -150.0);
    r.stage.objects[0].scale = 3.0;
    r.stage.placement.sun.position_m = (pl_vec3){0.0, 1e11, 1e11};
    for (int k = 0; k < 3; k++) {
      r.stage.bodies[0].albedo[k] = 1.0f;
      r.stage.bodies[0].emission[k] = 0.0f;
    }
    const double white = 1361.0 / PL_PI;
    const pl_frame_result without = take(&r, 3, names[i]);
    const double bound = without.plan.rows[pl_effect_find(names[i])].residual_dn;
    double off[3 * WIDTH * HEIGHT], sum = 0.0;
    for (int k = 0; k < 3 * WIDTH * HEIGHT; k++)
      off[k] = encode((double)r.film.radiance[k] / white);
    take(&r, 3, NULL);
    for (int k = 0; k < 3 * WIDTH * HEIGHT; k++) {
      const double change = fabs(encode((double)r.film.radiance[k] / white) - off[k]);
      sum += change;
      assert_true(change <= bound + 0.2);
    }
    print_message("%s: mean change %.3g DN, bound %.3g\n", names[i], sum / (3 * WIDTH * HEIGHT),
                  bound);
    assert_true(sum > 0.0);
    room_close(&r);
    pl_model_destroy(r.wall);
  }
}

int main(void) {
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(test_clear_wall_tints),
      cmocka_unit_test(test_glass_mirrors_its_part),
      cmocka_unit_test(test_without_transmission_it_is_a_wall),
      cmocka_unit_test(test_coat_over_a_base),
      cmocka_unit_test(test_bounds_fall_with_distance),
      cmocka_unit_test(test_left_out_stays_below_its_bound),
  };
  return cmocka_run_group_tests(tests, NULL, NULL);
}
