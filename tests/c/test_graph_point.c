/* Points of graphs on posed objects, and the holes that graphs cut: for sight, shadows and labels.
 */
#include "graphs.h"

#include <math.h>

#include "base/memory.h"
#include "frames.h"
#include "scene/graph_point.h"

enum { WIDTH = 48, HEIGHT = 36 };

/* There where the object's x is above `edge`. */
static pl_graph *half_create(float edge) {
  test_graph g = {0};
  pl_graph *graph;
  const size_t where = graph_add(&g, "coordinates"), split = graph_add(&g, "vector_math");
  const size_t side = graph_add(&g, "math"), surface = graph_add(&g, "lambert");
  graph_choose(&g, split, "function", "dot");
  graph_link(&g, split, "a", where, 0);
  graph_set(&g, split, "b", 1.0f, 0.0f, 0.0f);
  graph_choose(&g, side, "function", "greater_than");
  graph_link(&g, side, "a", split, 1);
  graph_set(&g, side, "b", edge, edge, edge);
  graph_set(&g, surface, "base_color", 0.5f, 0.5f, 0.5f);
  graph_link(&g, surface, "alpha", side, 0);
  assert_int_equal(graph_make(&g, &graph), PL_OK);
  return graph;
}

static void put_on(stage *s, size_t object, const pl_graph *graph) {
  const int32_t both[2] = {0, 0};
  assert_int_equal(pl_scene_set_materials(&s->scene, object, &graph, 1, both), PL_OK);
}

static void test_points_follow_the_pose(void **state) {
  (void)state;
  test_random random = {.seed = 3};
  pl_graph *graph = half_create(0.0f);
  for (int i = 0; i < 50; i++) {
    pl_model *square = square_create(1.0);
    pl_snapshot shot;
    pl_arena arena;
    stage s;
    stage_init(&s, WIDTH, HEIGHT, 40.0);
    const pl_quat turn = random_rotation(&random);
    const double scale = random_scale(&random, 0.1, 10.0);
    const pl_vec3 at = {random_range(&random, -5.0, 5.0), 2.0, 30.0};
    stage_add_object(&s, square, at, turn, scale);
    s.scene.objects[0].offset = (pl_vec3){0.25, -0.5, 1.0};
    put_on(&s, 0, graph);
    pl_arena_init(&arena);
    assert_int_equal(pl_snapshot_build(&s.scene, &s.placement, &arena, &shot), PL_OK);
    const float w[3] = {0.2f, 0.5f, 0.3f}; /* triangle 1: (-1, -1), (1, 1), (-1, 1) */
    const pl_vec3f view = {0.0f, 0.0f, -1.0f};
    const pl_graph_point p = pl_shot_graph_point(&shot.objects[0], 1, w, view);
    const pl_vec3 object = pl_vec3_scale((pl_vec3){0.0 - 0.25, 0.6 + 0.5, -1.0}, scale);
    const pl_vec3 world = pl_quat_rotate(turn, object);
    const pl_vec3 normal = pl_quat_rotate(turn, (pl_vec3){0, 0, 1});
    assert_true(pl_vec3_norm(pl_vec3_sub(pl_vec3f_to_double(p.object), object)) < 1e-5 * scale);
    assert_true(pl_vec3_norm(pl_vec3_sub(pl_vec3f_to_double(p.world), world)) < 1e-5 * scale);
    assert_true(pl_vec3_norm(pl_vec3_sub(pl_vec3f_to_double(p.n), normal)) < 1e-5);
    assert_true(pl_vec3_norm(pl_vec3_sub(pl_vec3f_to_double(p.ng), normal)) < 1e-5);
    assert_true(p.view.z == -1.0f && p.radius == 0.0f);
    pl_arena_clear(&arena);
    stage_clear(&s);
    pl_model_destroy(square);
  }
  pl_graph_destroy(graph);
}

/* A square of 20 x 20 pixels about pixel position (19.5, 15.5). */
static size_t add_square(stage *s, const pl_model *square, double z) {
  const pl_camera *camera = &s->placement.camera;
  const double size = z / camera->fx;
  const pl_vec3 middle = {(19.5 - camera->cx) * size, (15.5 - camera->cy) * size, z};
  return stage_add_object(s, square, middle, PL_QUAT_IDENTITY, 20.0 * size);
}

static film shoot(const stage *s) {
  film f;
  pl_renderer *renderer;
  film_init(&f, s);
  pl_frame_request request = request_all(s, &f);
  assert_int_equal(pl_renderer_create(&s->scene, &renderer), PL_OK);
  render(renderer, &request);
  pl_renderer_destroy(renderer);
  return f;
}

/* Through the left half of a square one behind it is seen. */
static void test_labels_have_holes(void **state) {
  (void)state;
  pl_model *square = square_create(0.5);
  pl_graph *graph = half_create(0.0f);
  stage s;
  stage_init(&s, WIDTH, HEIGHT, 40.0);
  put_on(&s, add_square(&s, square, 10.0), graph);
  add_square(&s, square, 11.0);
  film f = shoot(&s);
  for (size_t i = 0; i < 2; i++) {
    assert_int_equal(f.objects[i].px_count_visib, 200);
    assert_int_equal(f.objects[i].px_count_all, i == 0 ? 200 : 400);
    assert_int_equal(f.objects[i].bbox_visib[0], i == 0 ? 20 : 10);
    assert_int_equal(f.objects[i].bbox_visib[2], 9);
  }
  assert_int_equal(f.objects[0].bbox_obj[0], 20);
  film_clear(&f);
  stage_clear(&s);
  pl_model_destroy(square);
  pl_graph_destroy(graph);
}

/* A frame with half a square cut off is that of half a square: its sights, and its shadow on a
 * wall. Rounding of the edge may move a pixel or two of the shadow. */
static void test_light_passes_holes(void **state) {
  (void)state;
  pl_model *square = square_create(0.5), *half = square_create(0.5), *wall = square_create(30.0);
  pl_graph *graph = half_create(0.0f), *all = half_create(-1e3f);
  film films[3];
  half->materials[0].base_color[0] = 0.5f;
  for (size_t v = 0; v < 4; v++)
    half->positions[3 * v] = fmaxf(half->positions[3 * v], 0.0f);
  pl_model_measure(half);
  for (int i = 0; i < 3; i++) {
    stage s;
    stage_init(&s, WIDTH, HEIGHT, 40.0);
    s.placement.sun.position_m = (pl_vec3){6e10, 2e10, -1.3e11};
    put_on(&s, add_square(&s, i == 1 ? half : square, 10.0), i == 0 ? graph : all);
    stage_add_object(&s, wall, (pl_vec3){0, 0, 14.0}, PL_QUAT_IDENTITY, 1.0);
    films[i] = shoot(&s);
    stage_clear(&s);
  }
  int shadows = 0, others = 0, differ = 0;
  assert_memory_equal(film_channel(&films[0], "semantic"), film_channel(&films[1], "semantic"),
                      films[0].pixels * 2 * sizeof(uint16_t));
  for (size_t i = 0; i < films[0].pixels; i++) {
    const float light = films[0].radiance[3 * i];
    shadows += light < 40.0f; /* lit grey has 175, 1361 / 2 pi times the sun's cosine */
    differ += fabsf(light - films[1].radiance[3 * i]) > 40.0f;
    others += fabsf(light - films[2].radiance[3 * i]) > 40.0f;
  }
  assert_true(shadows > 50 && others > 50 && differ <= 6);
  for (int i = 0; i < 3; i++)
    film_clear(&films[i]);
  pl_graph_destroy(graph);
  pl_graph_destroy(all);
  pl_model_destroy(square);
  pl_model_destroy(half);
  pl_model_destroy(wall);
}

/* A driver may make a thing come and go. */
static void test_driven_alpha(void **state) {
  (void)state;
  pl_model *square = square_create(0.5);
  test_graph g = {.parameters = 1};
  pl_graph *graph;
  graph_drive(&g, graph_add(&g, "lambert"), "alpha", 0);
  assert_int_equal(graph_make(&g, &graph), PL_OK);
  assert_true(pl_graph_cuts(graph));
  static const float alpha[] = {0.0f, 0.49f, 0.5f, 1.0f};
  for (size_t i = 0; i < 4; i++) {
    const pl_value params[1] = {{alpha[i], alpha[i], alpha[i], 0.0f}};
    stage s;
    stage_init(&s, WIDTH, HEIGHT, 40.0);
    put_on(&s, add_square(&s, square, 10.0), graph);
    s.objects[0].parameters = params;
    film f = shoot(&s);
    assert_int_equal(f.objects[0].px_count_visib, i < 2 ? 0 : 400);
    assert_int_equal(f.objects[0].px_count_all, i < 2 ? 0 : 400);
    film_clear(&f);
    stage_clear(&s);
  }
  pl_graph_destroy(graph);
  pl_model_destroy(square);
}

/* Half a square is not there by its material, the other half not by the graph. */
static void test_neither_material_nor_graph(void **state) {
  (void)state;
  pl_model *square = square_create(0.5);
  pl_graph *graph = half_create(0.0f);
  stage s;
  square->materials[0].alpha_mode = PL_ALPHA_MASK;
  square->colors = pl_alloc(16, sizeof(float));
  for (size_t v = 0; v < 4; v++) /* opaque below */
    square->colors[4 * v + 3] = square->positions[3 * v + 1] > 0.0f ? 1.0f : 0.0f;
  stage_init(&s, WIDTH, HEIGHT, 40.0);
  put_on(&s, add_square(&s, square, 10.0), graph);
  film f = shoot(&s);
  assert_int_equal(f.objects[0].px_count_visib, 100);
  assert_int_equal(f.objects[0].px_count_all, 100);
  film_clear(&f);
  stage_clear(&s);
  pl_graph_destroy(graph);
  pl_model_destroy(square);
}

static void test_what_cuts(void **state) {
  (void)state;
  static const float alpha[] = {0.0f, 0.499f, 0.5f, 1.0f, 7.0f};
  for (size_t i = 0; i < 5; i++) {
    test_graph g = {0};
    pl_graph *graph;
    graph_set(&g, graph_add(&g, "principled"), "alpha", alpha[i], alpha[i], alpha[i]);
    assert_int_equal(graph_make(&g, &graph), PL_OK);
    assert_true(pl_graph_cuts(graph) == (i < 2));
    assert_int_equal(pl_graph_instruction_count(graph), 0);
    pl_graph_destroy(graph);
  }
  test_graph g = {0};
  pl_graph *graph;
  graph_add(&g, "principled");
  assert_int_equal(graph_make(&g, &graph), PL_OK);
  assert_false(pl_graph_cuts(graph));
  pl_graph_destroy(graph);
}

int main(void) {
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(test_points_follow_the_pose),     cmocka_unit_test(test_labels_have_holes),
      cmocka_unit_test(test_light_passes_holes),         cmocka_unit_test(test_driven_alpha),
      cmocka_unit_test(test_neither_material_nor_graph), cmocka_unit_test(test_what_cuts),
  };
  return cmocka_run_group_tests(tests, NULL, NULL);
}
