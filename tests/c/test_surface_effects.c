/* The rows emission, bump_detail and texture_filter, each by itself: what a frame changes without
 * it, or at a lower value, is within the row's bound. Random scenes of mapped bodies and of meshes
 * with maps and graphs; everything else is kept in both frames. */
#include "harness.h"

#include "differences.h"
#include "graphs.h"

enum { SAMPLES = 16, SCENES = PL_DRAWS(24, 6) };

static const double AU = 149597870700.0;

/* Noise of a given contrast about a random mean. */
static pl_texture *speckle(test_random *random, int width, double contrast, bool srgb) {
  pl_image image;
  pl_texture *texture;
  const double mean = random_range(random, 0.5 * contrast, 1.0 - 0.5 * contrast);
  assert_int_equal(pl_image_init(width, width / 2, 3, &image), PL_OK);
  for (int i = 0; i < width * (width / 2) * 3; i++)
    image.texels[i] = (uint8_t)(255 * (mean + contrast * (random_unit(random) - 0.5)));
  assert_int_equal(pl_texture_create(&image, srgb, PL_WRAP_REPEAT, PL_WRAP_CLAMP, &texture), PL_OK);
  return texture;
}

/* A square with texture coordinates and tangents; textures: colour, normals. */
static pl_model *mapped_square(test_random *random) {
  static const float uv[] = {0, 0, 4, 0, 4, 4, 0, 4};
  pl_model *model = square_create(1.0);
  pl_material *m = &model->materials[0];
  model->uvs[0] = pl_alloc(8, sizeof(float));
  model->tangents = pl_alloc(16, sizeof(float));
  model->textures = pl_alloc(2, sizeof(pl_texture *));
  assert_true(model->uvs[0] && model->tangents && model->textures);
  memcpy(model->uvs[0], uv, sizeof uv);
  for (int v = 0; v < 4; v++)
    for (int k = 0; k < 4; k++)
      model->tangents[4 * v + k] = k == 0 || k == 3 ? 1.0f : 0.0f;
  model->texture_count = 2;
  model->textures[0] = speckle(random, 32, random_unit(random), true);
  model->textures[1] = speckle(random, 32, random_unit(random), false);
  m->lambert = random_unit(random) < 0.5;
  m->roughness = (float)random_range(random, 0.2, 1.0);
  if (random_unit(random) < 0.7)
    m->base_color_map.texture = 0;
  if (random_unit(random) < 0.6)
    m->normal_map.texture = 1;
  if (random_unit(random) < 0.4)
    for (int k = 0; k < 3; k++)
      m->emissive[k] = (float)random_scale(random, 1e-3, 300.0);
  return model;
}

/* Diffuse, with dents. */
static pl_graph *dented(test_random *random) {
  test_graph g = {.count = 0};
  pl_graph *graph;
  const size_t where = graph_add(&g, "coordinates");
  const size_t noise = graph_add(&g, "noise");
  graph_link(&g, noise, "vector", where, 0);
  const float scale = (float)random_scale(random, 0.3, 30.0);
  graph_set(&g, noise, "scale", scale, scale, scale);
  const size_t bump = graph_add(&g, "bump");
  graph_link(&g, bump, "height", noise, 0);
  const float depth = (float)random_scale(random, 1e-4, 0.3);
  graph_set(&g, bump, "distance_m", depth, depth, depth);
  const size_t skin = graph_add(&g, "lambert");
  graph_link(&g, skin, "normal", bump, 0);
  assert_int_equal(graph_make(&g, &graph), PL_OK);
  return graph;
}

typedef struct world {
  stage stage;
  pl_model *model;
  pl_graph *graph;
  pl_texture *map;
} world;

static void add_squares(world *w, test_random *random) {
  static const int32_t everywhere[] = {0, 0};
  const int count = 1 + random_below(random, 2);
  for (int i = 0; i < count; i++) {
    const double reach = random_scale(random, 3.0, 400.0);
    const pl_vec3 d = {random_range(random, -0.2, 0.2), random_range(random, -0.2, 0.2),
                       random_unit(random) < 0.2 ? -1.0 : 1.0};
    const size_t object =
        stage_add_object(&w->stage, w->model, pl_vec3_scale(d, reach), random_rotation(random),
                         reach * random_scale(random, 0.02, 0.4));
    if (random_unit(random) < 0.5) {
      const pl_graph *graph = w->graph;
      assert_int_equal(pl_scene_set_materials(&w->stage.scene, object, &graph, 1, everywhere),
                       PL_OK);
    }
  }
}

static void add_body(world *w, test_random *random) {
  const double radius = random_scale(random, 1.0, 1e6), far = random_scale(random, 2.0, 100.0);
  const pl_vec3 d = {random_range(random, -0.1, 0.1), random_range(random, -0.1, 0.1), 1.0};
  const size_t body =
      stage_add_body(&w->stage, pl_vec3_scale(d, 500.0 + far * radius),
                     (pl_vec3){radius, random_range(random, 0.6, 1.0) * radius, 0.8 * radius},
                     (float)random_scale(random, 0.02, 1.0));
  w->stage.scene.bodies[body].map = w->map;
  if (random_unit(random) < 0.3)
    w->stage.bodies[body].emission[0] = (float)random_scale(random, 1e-3, 100.0);
}

static void world_init(world *w, test_random *random) {
  stage_init(&w->stage, WIDTH, HEIGHT, random_scale(random, 20.0, 200.0));
  w->stage.placement.sun.position_m =
      pl_vec3_scale(random_direction(random), AU * random_scale(random, 0.5, 30.0));
  w->map = speckle(random, random_unit(random) < 0.5 ? 64 : 256, random_unit(random), true);
  w->model = mapped_square(random);
  w->graph = dented(random);
  if (random_unit(random) < 0.7)
    add_squares(w, random);
  if (w->stage.scene.object_count == 0 || random_unit(random) < 0.5)
    add_body(w, random);
}

static void world_clear(world *w) {
  stage_clear(&w->stage);
  pl_graph_destroy(w->graph);
  pl_model_destroy(w->model);
  pl_texture_destroy(w->map);
}

/* How often a row changed something, and the tightest bound that it kept. */
typedef struct tally {
  int changed, small;
} tally;

/* The largest change of any mean. */
static double largest(const statistic *a, const statistic *b) {
  double out = 0.0;
  for (size_t i = 0; i < 3 * PIXELS; i++)
    out = fmax(out, fabs(encode(a->mean[i]) - encode(b->mean[i])));
  return out;
}

static void compare(const world *w, pl_renderer *renderer, const char *name, int value,
                    const statistic *full, tally *tally) {
  static statistic less;
  asked asked = {SAMPLES, PL_FILTER_FINEST, {.force_on = all_effects()}};
  if (value > 0) {
    asked.texture_filter = value;
  } else {
    asked.wish.force_on = all_effects_but(name);
    asked.wish.force_off = one_effect(name);
  }
  const pl_frame_result result = measure(&w->stage, renderer, asked, &less);
  const pl_plan_row *row = &result.plan.rows[pl_effect_find(name)];
  assert_int_equal(row->value, value);
  const double found = excess(full, &less, row->residual_dn);
  if (found > 0.0)
    fail_msg("%s at %d: differs by %.3g DN, bound %.3g", name, value, found, row->residual_dn);
  const double change = largest(full, &less);
  tally->changed += change > 0.5;
  tally->small += change > 0.05 && row->residual_dn < 64.0;
}

static void test_each_row_stays_below_its_bound(void **state) {
  (void)state;
  static const char *const names[] = {"emitted_light", "bump_detail", "texture_filter"};
  static statistic full;
  test_random random = {.seed = 96};
  tally tallies[3] = {{0}};
  for (int round = 0; round < SCENES; round++) {
    world w = {.model = NULL};
    pl_renderer *renderer;
    world_init(&w, &random);
    assert_int_equal(pl_renderer_create(&w.stage.scene, &renderer), PL_OK);
    const asked all = {SAMPLES, PL_FILTER_FINEST, {.force_on = all_effects()}};
    measure(&w.stage, renderer, all, &full);
    for (int i = 0; i < 3; i++)
      compare(&w, renderer, names[i], 0, &full, &tallies[i]);
    compare(&w, renderer, names[2], PL_FILTER_NEAREST + round % (PL_FILTER_FINEST - 1), &full,
            &tallies[2]);
    pl_renderer_destroy(renderer);
    world_clear(&w);
  }
  for (int i = 0; i < 3; i++) {
    print_message("%s: changed %d frames, %d of them with a bound below 64 DN\n", names[i],
                  tallies[i].changed, tallies[i].small);
    assert_true(PL_SEEN(tallies[i].changed, 3));
    assert_true(PL_SEEN(tallies[i].small, 0) || i == 1);
  }
}

int main(void) {
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(test_each_row_stays_below_its_bound),
  };
  return cmocka_run_group_tests(tests, NULL, NULL);
}
