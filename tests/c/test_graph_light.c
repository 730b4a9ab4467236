/* Lamps that graphs make against those of materials: drawn by power, and met by chance. */
#include "graphs.h"

#include <math.h>

#include "base/memory.h"
#include "frames.h"

enum { SIDE = 24 };
static const float RADIANCE = 50.0f; /* W m-2 sr-1 */
static const pl_vec3 LAMP_AT = {0.5, -0.3, 8.0};

/* A stage without a sun: a black lamp over Lambert ground. `graph` may be NULL. */
typedef struct room {
  pl_model *lamp, *ground;
  stage stage;
} room;

static void room_init(room *r, pl_model *lamp, const pl_graph *graph, const pl_value *params) {
  const int32_t glowing[4] = {0, 0, -1, -1};
  r->lamp = lamp;
  r->ground = square_create(40.0);
  r->ground->materials[0].lambert = lamp->materials[0].lambert = true;
  for (int k = 0; k < 3; k++)
    lamp->materials[0].base_color[k] = 0.0f;
  stage_init(&r->stage, SIDE, SIDE, 20.0);
  r->stage.placement.sun.irradiance_au = 0.0;
  stage_add_object(&r->stage, lamp, LAMP_AT, PL_QUAT_IDENTITY, 1.0);
  stage_add_object(&r->stage, r->ground, (pl_vec3){0, 0, 10.0}, PL_QUAT_IDENTITY, 1.0);
  if (graph != NULL)
    assert_int_equal(pl_scene_set_materials(&r->stage.scene, 0, &graph, 1, glowing), PL_OK);
  r->stage.objects[0].parameters = params;
}
static void room_clear(room *r) {
  stage_clear(&r->stage);
  pl_model_destroy(r->lamp);
  pl_model_destroy(r->ground);
}

static film shoot(const room *r, int samples, int max_bounces) {
  film f;
  pl_renderer *renderer;
  film_init(&f, &r->stage);
  pl_frame_request request = request_all(&r->stage, &f);
  request.samples = samples;
  request.max_bounces = max_bounces;
  request.wish = (pl_plan_wish){0.0, max_bounces > 0 ? all_effects() : no_effects(), no_effects()};
  assert_int_equal(pl_renderer_create(&r->stage.scene, &renderer), PL_OK);
  render(renderer, &request);
  pl_renderer_destroy(renderer);
  return f;
}

static film shoot_lamp(pl_model *lamp, const pl_graph *graph, const pl_value *params, int bounces) {
  room r;
  room_init(&r, lamp, graph, params);
  film f = shoot(&r, PL_DRAWS(256, 64), bounces);
  room_clear(&r);
  return f;
}

static pl_model *glowing(pl_model *lamp, float radiance) {
  for (int k = 0; k < 3; k++)
    lamp->materials[0].emissive[k] = radiance;
  return lamp;
}

/* The half of the lamp with x > 0, and with `whole` the other one, too, which is black: the first
 * two triangles glow. */
static pl_model *half_create(bool whole) {
  pl_model *half = model_create(whole ? 8 : 4, whole ? 4 : 2);
  model_set_face(half, 0, (pl_vec3){0, -1, 0}, (pl_vec3){1, 0, 0}, (pl_vec3){0, 2, 0});
  if (whole)
    model_set_face(half, 1, (pl_vec3){-1, -1, 0}, (pl_vec3){1, 0, 0}, (pl_vec3){0, 2, 0});
  pl_model_measure(half);
  return half;
}

/* 1 where the object's x is above 0. */
static size_t add_half(test_graph *g) {
  const size_t where = graph_add(g, "coordinates"), along = graph_add(g, "vector_math");
  const size_t side = graph_add(g, "math");
  graph_choose(g, along, "function", "dot");
  graph_link(g, along, "a", where, 0);
  graph_set(g, along, "b", RADIANCE, 0.0f, 0.0f);
  graph_choose(g, side, "function", "greater_than");
  graph_link(g, side, "a", along, 1);
  graph_set(g, side, "b", 0.0f, 0.0f, 0.0f);
  return side;
}

static pl_graph *made(const test_graph *g) {
  pl_graph *graph;
  if (graph_make(g, &graph) != PL_OK)
    fail_msg("%s", pl_error_text());
  return graph;
}

static double mean_of(const film *f) {
  double sum = 0.0;
  for (size_t i = 0; i < 3 * f->pixels; i++)
    sum += (double)f->radiance[i];
  return sum / (3.0 * (double)f->pixels);
}

/* Largest difference of pixels, part of the brightest. */
static double worst_of(const film *a, const film *b) {
  double worst = 0.0, brightest = 0.0;
  for (size_t i = 0; i < 3 * a->pixels; i++) {
    worst = fmax(worst, fabs((double)a->radiance[i] - (double)b->radiance[i]));
    brightest = fmax(brightest, (double)b->radiance[i]);
  }
  return worst / brightest;
}

/* Even lamps, also those of a driver, are those of materials bit by bit. */
static void test_even_lamps(void **state) {
  (void)state;
  const pl_value params[1] = {{RADIANCE, RADIANCE, RADIANCE, 0.0f}};
  for (int driven = 0; driven < 2; driven++) {
    test_graph g = {.parameters = 1};
    const size_t surface = graph_add(&g, "lambert");
    graph_set(&g, surface, "base_color", 0.0f, 0.0f, 0.0f);
    graph_set(&g, surface, "emission_strength", RADIANCE, RADIANCE, RADIANCE);
    if (driven)
      graph_drive(&g, surface, "emission_strength", 0);
    pl_graph *graph = made(&g);
    assert_true(pl_graph_emits(graph) && pl_graph_emits_evenly(graph));
    for (int bounces = 0; bounces < 2; bounces++) {
      film a = shoot_lamp(square_create(1.0), graph, params, bounces);
      film b = shoot_lamp(glowing(square_create(1.0), RADIANCE), NULL, NULL, bounces);
      assert_true(mean_of(&b) > 0.05);
      assert_memory_equal(a.radiance, b.radiance, 3 * a.pixels * sizeof(float));
      film_clear(&a);
      film_clear(&b);
    }
    pl_graph_destroy(graph);
  }
}

/* Half a lamp glows, by its pattern or by a hole, and lights the ground as half a lamp does: 256
 * stratified samples, a quarter of them under sanitizers; the bounds are those of test_emitters.c
 * with half of the draws lost. */
static void test_half_lamps(void **state) {
  (void)state;
  for (int hole = 0; hole < 2; hole++) {
    test_graph g = {0};
    const size_t half = add_half(&g), glow = graph_add(&g, "math"),
                 surface = graph_add(&g, "lambert");
    graph_choose(&g, glow, "function", "multiply");
    graph_link(&g, glow, "a", half, 0);
    graph_set(&g, glow, "b", RADIANCE, RADIANCE, RADIANCE);
    graph_set(&g, surface, "base_color", 0.0f, 0.0f, 0.0f);
    graph_set(&g, surface, "emission_strength", RADIANCE, RADIANCE, RADIANCE);
    graph_link(&g, surface, hole ? "alpha" : "emission_strength", hole ? half : glow, 0);
    test_graph even = {0};
    const size_t lamp = graph_add(&even, "lambert");
    graph_set(&even, lamp, "base_color", 0.0f, 0.0f, 0.0f);
    graph_set(&even, lamp, "emission_strength", RADIANCE, RADIANCE, RADIANCE);
    pl_graph *graph = made(&g), *on_half = made(&even);
    assert_true(pl_graph_emits_evenly(graph) == (hole != 0));
    for (int bounces = 0; bounces < 2; bounces++) {
      film a = shoot_lamp(square_create(1.0), graph, NULL, bounces);
      film b = shoot_lamp(half_create(hole == 0), on_half, NULL, bounces);
      const double worst = worst_of(&a, &b), mean = mean_of(&a) / mean_of(&b) - 1.0;
      print_message("hole %d, bounces %d: worst %.4f, mean %.5f\n", hole, bounces, worst, mean);
      assert_true(worst < PL_DRAWS(0.02, 0.08) && fabs(mean) < PL_DRAWS(3e-3, 0.012));
      film_clear(&a);
      film_clear(&b);
    }
    pl_graph_destroy(graph);
    pl_graph_destroy(on_half);
  }
}

/* A lamp that glows to the side: what is drawn alone, and with paths that meet it, is the same. */
static void test_lamps_that_glow_aslant(void **state) {
  (void)state;
  test_graph g = {0};
  const size_t facing = graph_add(&g, "layer_weight"), surface = graph_add(&g, "lambert");
  graph_set(&g, surface, "base_color", 0.0f, 0.0f, 0.0f);
  graph_set(&g, surface, "emission_color", RADIANCE, RADIANCE, RADIANCE);
  graph_link(&g, surface, "emission_strength", facing, 1);
  pl_graph *graph = made(&g);
  film drawn = shoot_lamp(square_create(1.0), graph, NULL, 0);
  film both = shoot_lamp(square_create(1.0), graph, NULL, 1);
  const double worst = worst_of(&drawn, &both), mean = mean_of(&drawn) / mean_of(&both) - 1.0;
  print_message("aslant: worst %.4f, mean %.5f\n", worst, mean);
  assert_true(mean_of(&both) > 0.05 && worst < PL_DRAWS(0.1, 0.3) &&
              fabs(mean) < PL_DRAWS(5e-3, 0.02));
  film_clear(&drawn);
  film_clear(&both);
  pl_graph_destroy(graph);
}

/* What a driver says is of the frame, and takes no memory; a lamp that is off is no light. */
static void test_drivers_each_frame(void **state) {
  (void)state;
  test_graph g = {.parameters = 1};
  const size_t surface = graph_add(&g, "lambert");
  graph_set(&g, surface, "base_color", 0.0f, 0.0f, 0.0f);
  graph_drive(&g, surface, "emission_strength", 0);
  pl_graph *graph = made(&g);
  pl_value params[1] = {{0.0f}};
  room r;
  room_init(&r, square_create(1.0), graph, (const pl_value *)params);
  film f;
  pl_renderer *renderer;
  film_init(&f, &r.stage);
  pl_frame_request request = request_all(&r.stage, &f);
  request.max_bounces = 0;
  assert_int_equal(pl_renderer_create(&r.stage.scene, &renderer), PL_OK);
  double means[4];
  uint64_t allocations = 0;
  for (int i = 0; i < 4; i++) {
    for (int k = 0; k < 3; k++)
      params[0][k] = (float)((i + 1) % 4) * 10.0f; /* 10, 20, 30, 0 */
    render(renderer, &request);
    means[i] = mean_of(&f);
    if (i > 0)
      assert_int_equal(pl_memory_allocations(), allocations);
    allocations = pl_memory_allocations();
  }
  assert_true(fabs(means[1] / means[0] - 2.0) < 0.02 && fabs(means[2] / means[0] - 3.0) < 0.02);
  assert_true(means[3] == 0.0);
  pl_renderer_destroy(renderer);
  film_clear(&f);
  room_clear(&r);
  pl_graph_destroy(graph);
}

/* A body that glows evenly by its graph is one that glows by itself. */
static void test_glowing_bodies(void **state) {
  (void)state;
  const pl_value params[1] = {{RADIANCE, RADIANCE, RADIANCE, 0.0f}};
  test_graph g = {.parameters = 1};
  const size_t surface = graph_add(&g, "lambert");
  graph_set(&g, surface, "base_color", 0.0f, 0.0f, 0.0f);
  graph_drive(&g, surface, "emission_strength", 0);
  pl_graph *graph = made(&g);
  film films[2];
  for (int i = 0; i < 2; i++) {
    pl_model *ground = square_create(100.0);
    room r = {.ground = ground};
    ground->materials[0].lambert = true;
    stage_init(&r.stage, SIDE, SIDE, 60.0);
    r.stage.placement.sun.irradiance_au = 0.0;
    stage_add_object(&r.stage, ground, (pl_vec3){0, 0, 30.0}, PL_QUAT_IDENTITY, 1.0);
    stage_add_body(&r.stage, (pl_vec3){0, -30, 20}, (pl_vec3){9, 9, 9}, 0.0f);
    if (i == 0) {
      r.stage.scene.bodies[0].graph = graph;
      pl_graph_summarise(graph, &r.stage.scene.bodies[0].summary);
      r.stage.bodies[0].parameters = params;
    }
    for (int k = 0; k < 3; k++)
      r.stage.bodies[0].emission[k] = i == 0 ? 0.0f : RADIANCE;
    films[i] = shoot(&r, 16, 0);
    stage_clear(&r.stage);
    pl_model_destroy(ground);
  }
  assert_true(mean_of(&films[1]) > 0.5);
  assert_memory_equal(films[0].radiance, films[1].radiance, 3 * films[0].pixels * sizeof(float));
  film_clear(&films[0]);
  film_clear(&films[1]);
  pl_graph_destroy(graph);
}

int main(void) {
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(test_even_lamps),
      cmocka_unit_test(test_half_lamps),
      cmocka_unit_test(test_lamps_that_glow_aslant),
      cmocka_unit_test(test_drivers_each_frame),
      cmocka_unit_test(test_glowing_bodies),
  };
  return cmocka_run_group_tests(tests, NULL, NULL);
}
