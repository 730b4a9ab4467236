/* Volumes in frames: what a pixel shows of them in closed form, and that leaving them out changes
 * no pixel by more than the row's bound. */
#include "harness.h"

#include "differences.h"
#include "graphs.h"

enum { SAMPLES = 8, SCENES = PL_DRAWS(24, 6) };

static const double AU = 149597870700.0;

static pl_volume box(double x, double y, double z, float extinction) {
  return (pl_volume){.name = "mist",
                     .bound = &pl_bound_box,
                     .size = {x, y, z},
                     .local = {{0, 0, 0}, PL_QUAT_IDENTITY},
                     .extinction = {extinction, extinction, extinction},
                     .albedo = {1.0f, 1.0f, 1.0f}};
}

static void shoot(const stage *s, film *f, pl_plan_wish wish) {
  pl_renderer *renderer;
  pl_frame_request request = request_all(s, f);
  request.wish = wish;
  assert_int_equal(pl_renderer_create(&s->scene, &renderer), PL_OK);
  render(renderer, &request);
  pl_renderer_destroy(renderer);
}

static void near(double found, double expected, double relative) {
  if (!(fabs(found - expected) <= relative * fabs(expected)))
    fail_msg("%.8g, not %.8g within %g", found, expected, relative);
}

/* A slab before a white wall, the sun behind the camera: the wall's light is dimmed on both ways,
 * and the slab sends back (1 - exp(-2 s h)) / 2 of phase and irradiance. Labels see through. */
static void test_wall_behind_slab(void **state) {
  (void)state;
  stage s;
  film f;
  stage_init(&s, 5, 5, 500.0);
  pl_model *wall = square_create(50.0);
  stage_add_object(&s, wall, (pl_vec3){0, 0, 100}, PL_QUAT_IDENTITY, 1.0);
  pl_volume volume = box(1e5, 1e5, 4.0, 0.2f);
  volume.local.t.z = -40.0;
  s.placement.volumes = &volume;
  s.placement.volume_count = 1;
  film_init(&f, &s);
  const size_t middle = 12;
  shoot(&s, &f, (pl_plan_wish){.force_off = one_effect("volumes")});
  const double bare = (double)f.radiance[3 * middle];
  const float *depth = film_channel(&f, "depth");
  near((double)depth[middle], 100.0, 1e-5);
  shoot(&s, &f, (pl_plan_wish){.tolerance_dn = 0.0, .force_off = one_effect("bounces")});
  const double back = 1361.0 / (4.0 * PL_PI) * 0.5 * (1.0 - exp(-1.6));
  near((double)f.radiance[3 * middle], bare * exp(-1.6) + back, 2e-3);
  near((double)depth[middle], 100.0, 1e-5);
  film_clear(&f);
  stage_clear(&s);
  pl_model_destroy(wall);
}

/* In a body's shadow a volume is dark; it glows there if it emits. Nothing else is in the frame. */
static void test_shadow_of_a_body(void **state) {
  (void)state;
  stage s;
  film f;
  stage_init(&s, 5, 5, 500.0);
  stage_add_body(&s, (pl_vec3){0, 0, -9e6}, (pl_vec3){6e6, 6e6, 6e6}, 0.3f);
  pl_volume volume = box(2.0, 2.0, 4.0, 0.2f);
  volume.local.t.z = 9e6 + 40.0;
  s.placement.volumes = &volume;
  s.placement.volume_count = 1;
  film_init(&f, &s);
  shoot(&s, &f, (pl_plan_wish){.tolerance_dn = 0.0});
  assert_true(f.radiance[3 * 12] == 0.0f);
  volume.emission[1] = 3.0f;
  shoot(&s, &f, (pl_plan_wish){.tolerance_dn = 0.0});
  near((double)f.radiance[3 * 12 + 1], 3.0 * (1.0 - exp(-0.8)) / 0.2, 1e-3);
  assert_true(f.radiance[3 * 12] == 0.0f);
  s.bodies[0].motion = still((pl_vec3){0, 2e7, -9e6}, PL_QUAT_IDENTITY);
  volume.local.t.y = -2e7;
  shoot(&s, &f, (pl_plan_wish){.tolerance_dn = 0.0});
  near((double)f.radiance[3 * 12], 1361.0 / (4.0 * PL_PI) * 0.5 * (1.0 - exp(-1.6)), 2e-3);
  film_clear(&f);
  stage_clear(&s);
}

/* A glow that takes no light: its radiance is what it emits times the way through it. Without the
 * row `emission` there is none of it, and the row's bound says how much that is; a volume behind it
 * adds to that. */
static void test_a_glow_is_emission(void **state) {
  (void)state;
  stage s;
  film f;
  stage_init(&s, 5, 5, 500.0);
  stage_add_body(&s, (pl_vec3){0, 0, -9e6}, (pl_vec3){6e6, 6e6, 6e6}, 0.3f);
  pl_volume volumes[2] = {box(2.0, 2.0, 4.0, 0.0f), box(2.0, 2.0, 3.0, 0.0f)};
  for (int i = 0; i < 2; i++) {
    volumes[i].local.t.z = 9e6 + 40.0 + 10.0 * i;
    volumes[i].emission[1] = 3.0f;
  }
  s.placement.volumes = volumes;
  s.placement.volume_count = 2;
  film_init(&f, &s);
  shoot(&s, &f, (pl_plan_wish){.tolerance_dn = 0.0});
  near((double)f.radiance[3 * 12 + 1], 3.0 * (4.0 + 3.0), 1e-4);
  shoot(&s, &f, (pl_plan_wish){.tolerance_dn = 0.0, .force_off = one_effect("emitted_light")});
  for (size_t k = 0; k < 3 * f.pixels; k++)
    assert_true(f.radiance[k] == 0.0f);
  film_clear(&f);
  stage_clear(&s);
}

/* The camera in a volume, and a body that is a dot behind one: each is dimmed once, wherever it is.
 */
static void test_dot_behind_slab(void **state) {
  (void)state;
  stage s;
  film f;
  double sums[2];
  stage_init(&s, 9, 9, 100.0);
  stage_add_body(&s, (pl_vec3){0, 0, 1e9}, (pl_vec3){2e6, 2e6, 2e6}, 0.5f);
  pl_volume volume = box(1e4, 1e4, 40.0, 0.02f);
  for (int k = 0; k < 3; k++)
    volume.albedo[k] = 0.0f;
  volume.local.t.z = -1e9 + 20.0; /* the camera is in its near side */
  s.placement.volumes = &volume;
  film_init(&f, &s);
  for (int k = 0; k < 2; k++) {
    s.placement.volume_count = (size_t)k;
    shoot(&s, &f, (pl_plan_wish){.tolerance_dn = 0.01});
    sums[k] = 0.0;
    for (size_t i = 0; i < f.pixels; i++)
      sums[k] += (double)f.radiance[3 * i];
  }
  assert_true(sums[0] > 0.0);
  near(sums[1] / sums[0], exp(-0.8), 1e-3); /* the sun is behind the camera, at the slab's end */
  film_clear(&f);
  stage_clear(&s);
}

/* The night side of a body, and a glow beside the image that alone lights it. */
static void test_glow_on_a_body(void **state) {
  (void)state;
  double sums[2] = {0.0, 0.0};
  stage s;
  film f;
  stage_init(&s, 16, 16, 60.0);
  s.placement.sun.position_m = (pl_vec3){0, AU, AU};
  stage_add_body(&s, (pl_vec3){0, 0, 60}, (pl_vec3){10, 10, 10}, 0.8f);
  pl_volume volume = box(8.0, 8.0, 8.0, 0.0f);
  volume.local.t = (pl_vec3){20.0, 0.0, -30.0};
  volume.emission[0] = 50.0f;
  s.placement.volumes = &volume;
  s.placement.volume_count = 1;
  film_init(&f, &s);
  for (int k = 0; k < 2; k++) {
    shoot(&s, &f,
          (pl_plan_wish){.tolerance_dn = 0.5, .force_on = k == 0 ? all_effects() : no_effects()});
    for (size_t i = 0; i < f.pixels; i++)
      sums[k] += (double)f.radiance[3 * i] / (double)f.pixels;
  }
  assert_true(sums[0] > 1.0);
  near(sums[1], sums[0], 0.5); /* of 256 paths few meet the glow */
  film_clear(&f);
  stage_clear(&s);
}

/* Out of the frame, and with its shadow on no entity: it matters where it may shade rings. */
static void test_shadow_on_rings(void **state) {
  (void)state;
  const pl_effect *row = pl_effects[pl_effect_find("volumes")];
  pl_view_entity body = {.is_body = true,
                         .in_frame = true,
                         .center_m = {0, 0, 100},
                         .distance_m = 100,
                         .radius_m = 1,
                         .albedo_max = 0.5,
                         .irradiance = 1361.0};
  const pl_view_volume volume = {
      .center_m = {50, 0, 0}, .distance_m = 50, .radius_m = 1, .depth = 0.5, .scattered = 1.0};
  const pl_view view = {.white_radiance = 100.0,
                        .sun_position_m = {0, 0, -AU},
                        .sun_radius_m = 7e8,
                        .entities = &body,
                        .entity_count = 1,
                        .volumes = &volume,
                        .volume_count = 1,
                        .volume_steps = 32,
                        .sky = {.white_radiance = 100.0}};
  assert_non_null(row->absent(&view));
  body.rings = &(pl_view_rings){.radius_m = 60.0};
  assert_null(row->absent(&view));
  assert_true(row->bound_dn(&view, 0) > 20.0);
  assert_true(row->bound_dn(&view, 31) == row->bound_dn(&view, 0));
  assert_true(row->bound_dn(&view, 32) == 0.0);
}

/* --- the bound -------------------------------------------------------------------------------- */

/* Noise for a density. */
static pl_graph *cloudy(test_random *random) {
  test_graph g = {.count = 0};
  pl_graph *graph;
  const size_t where = graph_add(&g, "coordinates"), noise = graph_add(&g, "noise");
  graph_link(&g, noise, "vector", where, 0);
  const float scale = (float)random_scale(random, 0.1, 10.0);
  graph_set(&g, noise, "scale", scale, scale, scale);
  const size_t medium = graph_add(&g, "lambert");
  graph_link(&g, medium, "alpha", noise, 0);
  graph_set(&g, medium, "base_color", 0.9f, 0.7f, 0.5f);
  assert_int_equal(graph_make(&g, &graph), PL_OK);
  return graph;
}

typedef struct world {
  stage stage;
  pl_model *model;
  pl_graph *graph;
  pl_volume volumes[3];
} world;

static void add_volume(world *w, test_random *random) {
  const double reach = random_scale(random, 3.0, 300.0);
  const double size = reach * random_scale(random, 0.05, 0.8);
  const float depth = (float)random_scale(random, 1e-6, 10.0);
  pl_volume *v = &w->volumes[w->stage.placement.volume_count++];
  *v = (pl_volume){.name = "mist",
                   .bound = pl_bounds[random_below(random, 3)],
                   .size = {size, size * random_range(random, 0.3, 1.0), size},
                   .g = (float)random_range(random, -0.5, 0.7),
                   .graph = random_unit(random) < 0.4 ? w->graph : NULL};
  v->local = (pl_pose){{reach * random_range(random, -0.2, 0.2),
                        reach * random_range(random, -0.2, 0.2), reach - 100.0},
                       random_rotation(random)};
  for (int k = 0; k < 3; k++) {
    v->extinction[k] = depth * (float)random_range(random, 0.3, 1.0) / (float)size;
    v->albedo[k] = (float)random_unit(random);
    if (random_unit(random) < 0.2)
      v->emission[k] = (float)(random_scale(random, 1e-4, 30.0) / size);
  }
}

static void world_init(world *w, test_random *random) {
  stage *s = &w->stage;
  stage_init(s, WIDTH, HEIGHT, random_scale(random, 20.0, 200.0));
  s->placement.sun.position_m =
      pl_vec3_scale(random_direction(random), AU * random_scale(random, 0.5, 30.0));
  w->model = square_create(random_range(random, 2.0, 40.0));
  w->graph = cloudy(random);
  const pl_quat turn = random_unit(random) < 0.5 ? PL_QUAT_IDENTITY : random_rotation(random);
  stage_add_object(s, w->model, (pl_vec3){0, 0, 100}, turn, 1.0);
  if (random_unit(random) < 0.5)
    stage_add_body(s, (pl_vec3){0, 600.0, 900.0}, (pl_vec3){500.0, 500.0, 400.0}, 0.4f);
  s->placement.volumes = w->volumes;
  for (int i = 0; i < 1 + random_below(random, 3); i++)
    add_volume(w, random);
  if (turn.w != 1.0) /* volumes are in front of the camera, however its parent is turned */
    for (size_t i = 0; i < s->placement.volume_count; i++)
      w->volumes[i].local.t = pl_quat_rotate_inverse(turn, w->volumes[i].local.t);
}

static void world_clear(world *w) {
  stage_clear(&w->stage);
  pl_model_destroy(w->model);
  pl_graph_destroy(w->graph);
}

static void test_row_stays_below_its_bound(void **state) {
  (void)state;
  static statistic full, less;
  test_random random = {.seed = 41};
  int changed = 0, small = 0;
  for (int round = 0; round < SCENES; round++) {
    world w = {.model = NULL};
    pl_renderer *renderer;
    world_init(&w, &random);
    assert_int_equal(pl_renderer_create(&w.stage.scene, &renderer), PL_OK);
    asked asked = {SAMPLES, PL_FILTER_FINEST, {.force_on = all_effects()}};
    measure(&w.stage, renderer, asked, &full);
    asked.wish.force_on = all_effects_but("volumes");
    asked.wish.force_off = one_effect("volumes");
    const pl_frame_result result = measure(&w.stage, renderer, asked, &less);
    const pl_plan_row *row = &result.plan.rows[pl_effect_find("volumes")];
    const double found = excess(&full, &less, row->residual_dn);
    if (found > 0.0)
      fail_msg("round %d: differs by %.3g DN, bound %.3g", round, found, row->residual_dn);
    double change = 0.0;
    for (size_t i = 0; i < 3 * PIXELS; i++)
      change = fmax(change, fabs(encode(full.mean[i]) - encode(less.mean[i])));
    changed += change > 0.5;
    small += change > 0.05 && row->residual_dn < 64.0;
    pl_renderer_destroy(renderer);
    world_clear(&w);
  }
  print_message("changed %d frames, %d with a bound below 64 DN\n", changed, small);
  assert_true(PL_SEEN(changed, 3) && PL_SEEN(small, 0));
}

int main(void) {
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(test_wall_behind_slab),
      cmocka_unit_test(test_shadow_of_a_body),
      cmocka_unit_test(test_dot_behind_slab),
      cmocka_unit_test(test_shadow_on_rings),
      cmocka_unit_test(test_glow_on_a_body),
      cmocka_unit_test(test_a_glow_is_emission),
      cmocka_unit_test(test_row_stays_below_its_bound),
  };
  return cmocka_run_group_tests(tests, NULL, NULL);
}
