/* Graphs that change on a scene: the bounds of what is there now, the order of pieces, failures. */
#include "graphs.h"
#include "harness.h"
#include "jointed.h"
#include "scenes.h"

#include "base/memory.h"

/* A surface of a base colour and an emission, W m-2 sr-1. */
static pl_graph *plain(float color, float emission) {
  test_graph g = {.count = 0};
  pl_graph *graph;
  const size_t skin = graph_add(&g, "lambert");
  graph_set(&g, skin, "base_color", color, color, color);
  graph_set(&g, skin, "emission_color", emission, emission, emission);
  graph_set(&g, skin, "emission_strength", 1, 1, 1);
  assert_int_equal(graph_make(&g, &graph), PL_OK);
  return graph;
}

static const cube_node two[] = {{-1, {{0, 0, 0}, {1, 0, 0, 0}, {1, 1, 1}}, false},
                                {0, {{3, 0, 0}, {1, 0, 0, 0}, {1, 1, 1}}, false}};
enum { TRIANGLES = 24 };

static void test_bounds_are_those_of_the_graphs_now(void **state) {
  (void)state;
  stage s;
  pl_model *model = jointed_create(two, 2, 0.5);
  pl_graph *dim = plain(0.2f, 0.0f), *lamp = plain(0.9f, 7.0f);
  const pl_graph *const both[] = {dim, lamp};
  int32_t first[TRIANGLES], second[TRIANGLES], none[TRIANGLES];
  for (int t = 0; t < TRIANGLES; t++) {
    first[t] = 0;
    second[t] = t % 2;
    none[t] = -1;
  }
  stage_init(&s, 8, 8, 8.0);
  stage_add_object(&s, model, (pl_vec3){0, 0, 10}, PL_QUAT_IDENTITY, 1.0);
  const pl_object *object = &s.scene.objects[0];
  const pl_model_summary before = object->summary;
  assert_int_equal(pl_scene_set_materials(&s.scene, 0, both, 2, second), PL_OK);
  assert_true(object->summary.emission_max >= 7.0);
  assert_int_equal(pl_scene_set_materials(&s.scene, 0, &both[0], 1, first), PL_OK);
  assert_true(object->summary.emission_max == before.emission_max);
  assert_ptr_equal(pl_object_materials_at(object->materials, 5)->graph, dim);
  assert_int_equal(pl_scene_set_materials(&s.scene, 0, NULL, 0, none), PL_OK);
  assert_memory_equal(&object->summary, &before, sizeof before);
  assert_null(pl_object_materials_at(object->materials, 5));
  stage_clear(&s);
  pl_graph_destroy(dim);
  pl_graph_destroy(lamp);
  pl_model_destroy(model);
}

static void test_triangles_of_pieces(void **state) {
  /* Node 1 moves; its triangles are the model's last 12, wherever the pieces put them. */
  (void)state;
  stage s[2];
  const int mover = 0;
  pl_model *model = jointed_create(two, 2, 0.5);
  pl_graph *graphs[] = {plain(0.2f, 0.0f), plain(0.9f, 0.0f)};
  const pl_graph *const borrowed[] = {graphs[0], graphs[1]};
  int32_t places[TRIANGLES], others[TRIANGLES];
  for (int t = 0; t < TRIANGLES; t++) {
    places[t] = t % 3 - 1;
    others[t] = -1;
  }
  for (int k = 0; k < 2; k++) {
    stage_init(&s[k], 8, 8, 8.0);
    stage_add_object(&s[k], model, (pl_vec3){0, 0, 10}, PL_QUAT_IDENTITY, 1.0);
    if (k == 0)
      assert_int_equal(pl_scene_set_materials(&s[k].scene, 0, borrowed, 2, places), PL_OK);
    assert_int_equal(pl_scene_articulate(&s[k].scene, 0, &mover, 1), PL_OK);
  }
  assert_int_equal(pl_scene_set_materials(&s[1].scene, 0, borrowed, 2, others), PL_OK);
  assert_int_equal(pl_scene_set_materials(&s[1].scene, 0, borrowed, 2, places), PL_OK);
  assert_memory_equal(s[0].scene.objects[0].materials->triangle_graph,
                      s[1].scene.objects[0].materials->triangle_graph, sizeof places);
  for (int k = 0; k < 2; k++) {
    stage_clear(&s[k]);
    pl_graph_destroy(graphs[k]);
  }
  pl_model_destroy(model);
}

static void test_failures_change_nothing(void **state) {
  (void)state;
  stage s;
  pl_model *model = jointed_create(two, 2, 0.5);
  pl_graph *graph = plain(0.2f, 3.0f);
  const pl_graph *const borrowed[] = {graph};
  int32_t places[TRIANGLES] = {0}, wrong[TRIANGLES] = {0};
  wrong[20] = 1;
  stage_init(&s, 8, 8, 8.0);
  stage_add_object(&s, model, (pl_vec3){0, 0, 10}, PL_QUAT_IDENTITY, 1.0);
  assert_int_equal(pl_scene_set_materials(&s.scene, 0, borrowed, 1, places), PL_OK);
  const pl_object_materials *there = s.scene.objects[0].materials;
  const pl_model_summary summary = s.scene.objects[0].summary;
  assert_int_equal(pl_scene_set_materials(&s.scene, 0, borrowed, 1, wrong), PL_E_RANGE);
  assert_non_null(strstr(pl_error_text(), "triangle 20 has graph 1 of 1"));
  assert_int_equal(pl_scene_set_materials(&s.scene, 1, borrowed, 1, places), PL_E_ARGUMENT);
  assert_ptr_equal(s.scene.objects[0].materials, there);
  assert_memory_equal(&s.scene.objects[0].summary, &summary, sizeof summary);
  stage_clear(&s);
  pl_graph_destroy(graph);
  pl_model_destroy(model);
}

static void test_graphs_of_bodies(void **state) {
  (void)state;
  stage s;
  pl_graph *lamp = plain(0.9f, 7.0f);
  stage_init(&s, 8, 8, 8.0);
  stage_add_body(&s, (pl_vec3){0, 0, 10}, (pl_vec3){1, 1, 1}, 0.5f);
  pl_body *body = &s.scene.bodies[0];
  const pl_model_summary before = body->summary;
  pl_body_set_graph(body, lamp);
  assert_ptr_equal(body->graph, lamp);
  assert_true(body->summary.emission_max >= 7.0);
  pl_body_set_graph(body, NULL);
  assert_null(body->graph);
  assert_memory_equal(&body->summary, &before, sizeof before);
  stage_clear(&s);
  pl_graph_destroy(lamp);
}

int main(void) {
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(test_bounds_are_those_of_the_graphs_now),
      cmocka_unit_test(test_triangles_of_pieces),
      cmocka_unit_test(test_failures_change_nothing),
      cmocka_unit_test(test_graphs_of_bodies),
  };
  return cmocka_run_group_tests(tests, NULL, NULL);
}
