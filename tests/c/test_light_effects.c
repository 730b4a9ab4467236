/* The rows soft_sun, limb_darkening and distortion, each by itself: what a frame changes without it
 * is within the row's bound. Random scenes with shadows, terminators and glints under suns from a
 * point to a tenth of the sky; everything else is kept in both frames. Rows that say that they
 * cannot matter change not a bit. */
#include "harness.h"

#include "differences.h"

enum { SAMPLES = 32, SCENES = PL_DRAWS(40, 4) };

static const double AU = 149597870700.0;

typedef struct world {
  stage stage;
  pl_model *ground, *caster;
} world;

static void paint(pl_model *model, test_random *random) {
  pl_material *m = &model->materials[0];
  m->lambert = random_unit(random) < 0.7; /* Lambert */
  m->roughness = (float)random_range(random, 0.3, 1.0);
  m->metallic = (float)random_unit(random);
}

static void add_lens(pl_camera *camera, test_random *random) {
  double c[8] = {0.0};
  for (int i = 0; i < 4; i++) /* moves corners by a hundredth of a pixel to some pixels */
    c[i] = (random_unit(random) < 0.5 ? -1.0 : 1.0) * random_scale(random, 1e-5, 1e-2);
  assert_int_equal(pl_lens_init(&pl_lens_models[0], c, &camera->lens), PL_OK);
}

/* A ground or a body that fills much of the frame, and something between it and the sun. */
static void world_init(world *w, test_random *random) {
  stage *s = &w->stage;
  stage_init(s, WIDTH, HEIGHT, random_scale(random, 20.0, 60.0));
  w->ground = square_create(300.0);
  w->caster = square_create(1.0);
  paint(w->ground, random);
  paint(w->caster, random);
  const pl_vec3 to_sun = pl_vec3_unit((pl_vec3){
      random_range(random, -1, 1), random_range(random, -1, 1), random_range(random, -1, 0.3)});
  s->placement.sun.position_m = pl_vec3_scale(to_sun, AU * random_scale(random, 0.05, 30.0));
  if (random_unit(random) < 0.8)
    add_lens(&s->placement.camera, random);
  if (random_unit(random) < 0.2) { /* nothing to be seen */
    stage_add_object(s, w->ground, (pl_vec3){0, 0, -1000.0}, PL_QUAT_IDENTITY, 1.0);
    return;
  }
  const bool body = random_unit(random) < 0.5;
  if (body)
    stage_add_body(s, (pl_vec3){0, 0, 300.0}, (pl_vec3){150.0, 150.0, 120.0}, 0.7f);
  else
    stage_add_object(s, w->ground, (pl_vec3){0, 0, 100.0}, PL_QUAT_IDENTITY, 1.0);
  const pl_vec3 foot = {random_range(random, -20, 20), random_range(random, -20, 20),
                        body ? 150.0 : 100.0};
  const pl_vec3 at = pl_vec3_madd(foot, random_scale(random, 5.0, 1000.0), to_sun);
  const double size = random_scale(random, 0.5, 30.0);
  if (random_unit(random) < 0.3 || pl_vec3_norm(at) < size + 1.0)
    return;
  if (random_unit(random) < 0.5)
    stage_add_object(s, w->caster, at, random_rotation(random), size);
  else
    stage_add_body(s, at, (pl_vec3){size, size, size}, 0.5f);
}

static void world_clear(world *w) {
  stage_clear(&w->stage);
  pl_model_destroy(w->ground);
  pl_model_destroy(w->caster);
}

typedef struct tally {
  int absent, changed, useful; /* useful: changed, and the bound is less than all */
} tally;

static double largest(const statistic *a, const statistic *b) {
  double out = 0.0;
  for (size_t i = 0; i < 3 * PIXELS; i++)
    out = fmax(out, fabs(encode(a->mean[i]) - encode(b->mean[i])));
  return out;
}

static void compare(const world *w, pl_renderer *renderer, const char *name, const statistic *full,
                    tally *tally) {
  static statistic less;
  asked asked = {SAMPLES, PL_FILTER_FINEST, {.force_on = all_effects_but(name)}};
  asked.wish.force_off = one_effect(name);
  const pl_plan plan = measure(&w->stage, renderer, asked, &less).plan;
  const pl_plan_row *row = &plan.rows[pl_effect_find(name)];
  const double change = largest(full, &less);
  /* A point has no limb. */
  const bool limb = strcmp(name, "soft_sun") == 0;
  const double allowed =
      row->bound_dn + (limb ? plan.rows[pl_effect_find("limb_darkening")].bound_dn : 0.0);
  const double found = excess(full, &less, allowed);
  assert_int_equal(row->value, 0);
  if (found > 0.0)
    fail_msg("%s: differs by %.3g DN, bound %.3g", name, found, allowed);
  if (row->bound_dn == 0.0) {
    tally->absent++;
    assert_memory_equal(full->mean, less.mean, sizeof less.mean);
  }
  tally->changed += change > 0.5;
  tally->useful += change > 0.05 && row->bound_dn < 100.0;
}

static void test_each_row_stays_below_its_bound(void **state) {
  (void)state;
  static const char *const names[] = {"soft_sun", "limb_darkening", "distortion"};
  static statistic full;
  test_random random = {.seed = 98};
  tally tallies[3] = {{0}};
  for (int round = 0; round < SCENES; round++) {
    world w;
    pl_renderer *renderer;
    world_init(&w, &random);
    assert_int_equal(pl_renderer_create(&w.stage.scene, &renderer), PL_OK);
    const asked all = {SAMPLES, PL_FILTER_FINEST, {.force_on = all_effects()}};
    measure(&w.stage, renderer, all, &full);
    for (int i = 0; i < 3; i++)
      compare(&w, renderer, names[i], &full, &tallies[i]);
    pl_renderer_destroy(renderer);
    world_clear(&w);
  }
  for (int i = 0; i < 3; i++) {
    print_message("%s: absent %d times, changed %d frames, %d of them with a bound below 100 DN\n",
                  names[i], tallies[i].absent, tallies[i].changed, tallies[i].useful);
    assert_true(PL_SEEN(tallies[i].absent, 1) && PL_SEEN(tallies[i].changed, 3) &&
                PL_SEEN(tallies[i].useful, 2));
  }
}

int main(void) {
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(test_each_row_stays_below_its_bound),
  };
  return cmocka_run_group_tests(tests, NULL, NULL);
}
