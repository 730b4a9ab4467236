/* Articulated objects against equal ones that do not move: the same cubes with the motions baked
 * into their vertices. They differ by the rounding of float vertices. */
#include "scene/pieces.h"

#include "frames.h"
#include "jointed.h"

enum { WIDTH = 96, HEIGHT = 72, PIXELS = WIDTH * HEIGHT };

/* A hub, an arm on it, a hand on the arm. */
static const cube_node ARM[3] = {{-1, {{0, 0, 0}, {1, 0, 0, 0}, {1, 1, 1}}, false},
                                 {0, {{2.5, 0, 0}, {1, 0, 0, 0}, {1, 0.5, 0.75}}, false},
                                 {1, {{2.5, 0.5, 0}, {1, 0, 0, 0}, {1, 1, -0.5}}, false}};
static const int MOVING[2] = {1, 2};

/* The hand is single-sided and shines. */
static pl_model *arm_create(void) {
  pl_model *model = jointed_create(ARM, 3, 1);
  pl_free(model->materials[0].name);
  pl_free(model->materials);
  model->materials = pl_alloc(2, sizeof(pl_material));
  assert_non_null(model->materials);
  model->material_count = 2;
  model->materials[0] = plain_material();
  model->materials[1] = plain_material();
  model->materials[1].double_sided = false;
  for (int k = 0; k < 3; k++)
    model->materials[1].emissive[k] = 30.0f;
  model->parts[2].material = 1;
  return model;
}

static pl_model *bake(const pl_affine motions[2]) {
  pl_model *model = arm_create();
  for (size_t k = 0; k < 2; k++)
    model_map(model, 24 * (k + 1), 24, 12 * (k + 1), 12, &motions[k]);
  pl_model_measure(model);
  return model;
}

static void see(stage *s, const pl_model *model, pl_vec3 position, pl_quat q) {
  stage_init(s, WIDTH, HEIGHT, 90);
  s->placement.sun.position_m = (pl_vec3){-1.2e11, -0.5e11, -0.7e11};
  stage_add_object(s, model, position, q, 0.5);
}

static void articulate(stage *s, const pl_affine motions[2]) {
  assert_int_equal(pl_scene_articulate(&s->scene, 0, MOVING, 2), PL_OK);
  s->objects[0].movers = motions;
}

typedef struct shot {
  film film;
  pl_renderer *renderer;
} shot;

static shot take_picture(const stage *s, int threads) {
  shot out;
  film_init(&out.film, s);
  if (pl_renderer_create(&s->scene, &out.renderer) != PL_OK)
    fail_msg("%s", pl_error_text());
  pl_frame_request request = request_all(s, &out.film);
  request.threads = threads;
  render(out.renderer, &request);
  return out;
}

static void shot_clear(shot *s) {
  pl_renderer_destroy(s->renderer);
  film_clear(&s->film);
}

/* Pixels whose values differ by more than a tolerance, among those where both see the same part. */
static int differ(const shot *a, const shot *b, const char *name, int width, double tolerance) {
  const float *x = film_channel(&a->film, name), *y = film_channel(&b->film, name);
  int count = 0;
  for (int i = 0; i < width * PIXELS; i++)
    count += !(isnan(x[i]) && isnan(y[i])) && !(fabs((double)(x[i] - y[i])) <= tolerance);
  return count;
}

static int differ_in_part(const shot *a, const shot *b) {
  const uint16_t *x = film_channel(&a->film, "semantic"), *y = film_channel(&b->film, "semantic");
  int count = 0;
  for (int i = 0; i < 2 * PIXELS; i++)
    count += x[i] != y[i];
  return count;
}

static int differ_in_mask(const shot *a, const shot *b, size_t objects) {
  int count = 0;
  for (size_t i = 0; i < objects * PIXELS; i++)
    count += a->film.masks[i] != b->film.masks[i];
  return count;
}

/* Edges fall on other sides of a pixel's centre by rounding: at most a few pixels in a picture. */
static void check_same(const shot *a, const shot *b, size_t objects, int few) {
  assert_in_range(differ_in_part(a, b), 0, few);
  assert_in_range(differ(a, b, "depth", 1, 1e-4), 0, few);
  assert_in_range(differ(a, b, "normal", 3, 1e-4), 0, 3 * few);
  assert_in_range(differ(a, b, "object_coords", 3, 1e-4), 0, 3 * few);
  assert_in_range(differ_in_mask(a, b, objects), 0, few);
  for (size_t i = 0; i < objects; i++) {
    const pl_object_label *x = &a->film.objects[i], *y = &b->film.objects[i];
    assert_memory_equal(x->R_m2c, y->R_m2c, sizeof x->R_m2c);
    assert_memory_equal(x->t_m2c, y->t_m2c, sizeof x->t_m2c);
    assert_true(abs(x->px_count_all - y->px_count_all) <= few);
    assert_true(abs(x->px_count_visib - y->px_count_visib) <= few);
    for (int k = 0; k < 4 && few == 0; k++) {
      assert_int_equal(x->bbox_obj[k], y->bbox_obj[k]);
      assert_int_equal(x->bbox_visib[k], y->bbox_visib[k]);
    }
  }
  double difference = 0, sum = 0;
  for (size_t i = 0; i < 3 * PIXELS; i++) {
    difference += fabs((double)(a->film.radiance[i] - b->film.radiance[i]));
    sum += (double)a->film.radiance[i];
  }
  if (!(difference <= 0.01 * sum))
    fail_msg("radiances differ by %g of %g", difference, sum);
  assert_true(sum > 0);
}

static pl_affine random_motion(test_random *random, pl_vec3 scale) {
  const pl_trs trs = {{random_range(random, -0.4, 0.4), random_range(random, -0.4, 0.4),
                       random_range(random, -0.4, 0.4)},
                      pl_quat_axis_angle(random_direction(random), random_range(random, -3, 3)),
                      scale};
  return pl_trs_affine(&trs);
}

/* Random poses and motions; mirrored and stretched ones too. Another object stands before it and a
 * body behind, and the object is partly outside the picture. */
static void moved_pieces_look_like_baked_ones(void **state) {
  (void)state;
  test_random random = {11, 0};
  pl_model *model = arm_create(), *cube = cube_create(0.3);
  const pl_vec3 scales[4] = {{1, 1, 1}, {-1, 1, 1}, {0.6, 1.3, 1}, {-1, -0.7, -1}};
  for (int i = 0; i < 12; i++) {
    const pl_affine motions[2] = {random_motion(&random, scales[i % 4]),
                                  random_motion(&random, scales[(i + i / 4) % 4])};
    const pl_vec3 at = {random_range(&random, -2, 2), random_range(&random, -2, 2), 7};
    const pl_quat q = pl_quat_axis_angle(random_direction(&random), random_range(&random, 0, 3));
    pl_model *baked = bake(motions);
    stage moved, still;
    see(&moved, model, at, q);
    articulate(&moved, motions);
    see(&still, baked, at, q);
    stage *const both[2] = {&moved, &still};
    for (int k = 0; k < 2; k++) {
      stage_add_object(both[k], cube, (pl_vec3){0.7 * at.x, 0.7 * at.y, 4}, PL_QUAT_IDENTITY, 1);
      stage_add_body(both[k], (pl_vec3){0, 6, 16}, (pl_vec3){5, 5, 5}, 0.5f);
    }
    shot a = take_picture(&moved, 1), b = take_picture(&still, 1);
    assert_in_range(a.film.objects[0].px_count_all, 300, 5000);
    check_same(&a, &b, 2, 6);
    shot_clear(&a);
    shot_clear(&b);
    stage_clear(&moved);
    stage_clear(&still);
    pl_model_destroy(baked);
  }
  pl_model_destroy(cube);
  pl_model_destroy(model);
}

/* Motions that are exact in float give the same labels to the last pixel: quarter turns and whole
 * steps. */
static void exact_motions_give_equal_labels(void **state) {
  (void)state;
  pl_model *model = arm_create();
  const pl_affine motions[2] = {
      {{{{0, -1, 0}, {1, 0, 0}, {0, 0, 1}}}, {0, 0.5, 0}},
      {{{{0, 0, 1}, {0, 1, 0}, {-1, 0, 0}}}, {0.25, 0, 1}},
  };
  pl_model *baked = bake(motions);
  stage moved, still;
  see(&moved, model, (pl_vec3){0.5, 0.25, 8}, PL_QUAT_IDENTITY);
  articulate(&moved, motions);
  see(&still, baked, (pl_vec3){0.5, 0.25, 8}, PL_QUAT_IDENTITY);
  shot a = take_picture(&moved, 1), b = take_picture(&still, 1);
  check_same(&a, &b, 1, 0);
  shot_clear(&a);
  shot_clear(&b);
  stage_clear(&moved);
  stage_clear(&still);
  pl_model_destroy(baked);
  pl_model_destroy(model);
}

/* A cube moved by two of its sides leaves the sphere of the rest pose: it must not be culled, nor
 * its rays spared. */
static void bounds_follow_the_pieces(void **state) {
  (void)state;
  pl_model *model = arm_create();
  pl_affine motions[2] = {PL_AFFINE_IDENTITY, PL_AFFINE_IDENTITY};
  motions[1].t = (pl_vec3){40, 0, 0};
  stage s;
  see(&s, model, (pl_vec3){-22.5, 0, 12}, PL_QUAT_IDENTITY);
  articulate(&s, motions);
  shot a = take_picture(&s, 1);
  assert_true(a.film.objects[0].in_view == 1);
  assert_in_range(a.film.objects[0].px_count_visib, 20, 400); /* the hand alone: 1 m at 12 m */
  shot_clear(&a);
  stage_clear(&s);
  pl_model_destroy(model);
}

/* A node scaled to nothing is not there, and comes back. */
static void flattened_pieces_vanish(void **state) {
  (void)state;
  pl_model *model = arm_create();
  pl_affine motions[2] = {PL_AFFINE_IDENTITY, PL_AFFINE_IDENTITY};
  stage s;
  see(&s, model, (pl_vec3){-2, 0, 8}, PL_QUAT_IDENTITY);
  articulate(&s, motions);
  shot a = take_picture(&s, 1);
  pl_frame_request request = request_all(&s, &a.film);
  const int32_t all = a.film.objects[0].px_count_all;
  motions[1].m = (pl_mat3){{{0, 0, 0}, {0, 0, 0}, {0, 0, 0}}};
  render(a.renderer, &request);
  const int32_t without = a.film.objects[0].px_count_all;
  assert_in_range(without, 1, all - 30);
  motions[0].m.row[1] = (pl_vec3){0, 0, 0}; /* flat, not gone: no inverse */
  render(a.renderer, &request);
  assert_in_range(a.film.objects[0].px_count_all, 1, without - 30);
  motions[0] = motions[1] = PL_AFFINE_IDENTITY;
  render(a.renderer, &request);
  assert_int_equal(a.film.objects[0].px_count_all, all);
  shot_clear(&a);
  stage_clear(&s);
  pl_model_destroy(model);
}

/* One cover a model, of the objects on which nothing moves. */
static void covers_are_shared(void **state) {
  (void)state;
  pl_model *model = arm_create(), *other = arm_create();
  pl_model *const models[4] = {model, other, model, model};
  stage s;
  stage_init(&s, 8, 8, 8.0);
  for (int i = 0; i < 4; i++)
    stage_add_object(&s, models[i], (pl_vec3){0, 0, 9}, PL_QUAT_IDENTITY, 1);
  const pl_object *objects = s.scene.objects;
  assert_int_equal(s.scene.cover_count, 2);
  assert_ptr_equal(objects[0].cover, objects[2].cover);
  assert_ptr_not_equal(objects[0].cover, objects[1].cover);
  assert_ptr_equal(objects[1].cover->model, other);
  assert_int_equal(pl_scene_articulate(&s.scene, 0, MOVING, 2), PL_OK);
  assert_int_equal(pl_scene_articulate(&s.scene, 2, MOVING, 2), PL_OK);
  assert_null(objects[0].cover);
  assert_int_equal(s.scene.cover_count, 2);
  assert_ptr_equal(objects[3].cover->model, model);
  assert_int_equal(pl_scene_articulate(&s.scene, 3, MOVING, 2), PL_OK); /* the last one */
  assert_int_equal(s.scene.cover_count, 1);
  assert_ptr_equal(objects[1].cover->model, other);
  for (size_t k = 0; k < 3; k++)
    assert_ptr_equal(objects[0].cut->covers[k].model, &objects[0].cut->pieces[k]);
  stage_clear(&s);
  pl_model_destroy(other);
  pl_model_destroy(model);
}

static void *fail_at_zero(void *context, size_t size) {
  long *left = context;
  return (*left)-- == 0 ? NULL : malloc(size);
}

static pl_status build_scene(pl_scene *scene, const pl_model *model) {
  const int32_t ids[3] = {1, 2, 3};
  const uint16_t classes[3] = {1, 1, 1};
  const pl_part_table parts = {.count = model->part_count, .part_ids = ids, .class_ids = classes};
  assert_in_range(model->part_count, 1, 3);
  for (int i = 0; i < 2; i++)
    PL_TRY(pl_scene_add_object(scene, "arm", model, (pl_vec3){0, 0, 0}, i, i, &parts));
  return pl_scene_articulate(scene, 1, MOVING, 2);
}

/* The n-th allocation fails, for every n until all succeed: a leak checker has to be content. */
static void memory_runs_out(void **state) {
  (void)state;
  pl_model *model = arm_create();
  pl_status status = PL_E_MEMORY;
  long failures = 0;
  for (; status != PL_OK; failures++) {
    pl_scene scene;
    long left = failures;
    assert_int_equal(pl_scene_init(1, &scene), PL_OK);
    pl_memory_hook(fail_at_zero, &left);
    status = build_scene(&scene, model);
    pl_memory_hook(NULL, NULL);
    assert_true(status == PL_OK || status == PL_E_MEMORY);
    pl_scene_clear(&scene);
    assert_in_range(failures, 0, 200);
  }
  assert_in_range(failures, 15, 200);
  pl_model_destroy(model);
}

static void threads_and_memory(void **state) {
  (void)state;
  test_random random = {5, 0};
  pl_model *model = arm_create();
  pl_affine motions[2] = {random_motion(&random, (pl_vec3){1, 1, 1}),
                          random_motion(&random, (pl_vec3){1, 1, 1})};
  stage s;
  see(&s, model, (pl_vec3){-1, 0.5, 7}, PL_QUAT_IDENTITY);
  articulate(&s, motions);
  stage_add_object(&s, model, (pl_vec3){1, 0, 12}, PL_QUAT_IDENTITY, 1);
  assert_int_equal(pl_scene_articulate(&s.scene, 1, MOVING, 2), PL_OK);
  s.objects[1].movers = motions;
  assert_int_equal(s.scene.cut_count, 1); /* shared */
  shot a = take_picture(&s, 1), b = take_picture(&s, 3);
  assert_memory_equal(a.film.memory, b.film.memory, a.film.bytes);
  pl_frame_request request = request_all(&s, &a.film);
  const uint64_t before = pl_memory_allocations();
  for (int i = 0; i < 3; i++) {
    motions[i % 2] = random_motion(&random, (pl_vec3){1, 1, 1});
    render(a.renderer, &request);
  }
  assert_true(pl_memory_allocations() == before);
  shot_clear(&a);
  shot_clear(&b);
  stage_clear(&s);
  pl_model_destroy(model);
}

/* Parts that the user cut by triangle stay with their triangles. */
static void part_tables_follow_the_order(void **state) {
  (void)state;
  pl_model *model = arm_create();
  uint32_t parts[36];
  int32_t ids[36];
  uint16_t classes[36];
  pl_scene scene;
  for (int i = 0; i < 36; i++) {
    parts[i] = (uint32_t)i;
    ids[i] = i;
    classes[i] = 0;
  }
  assert_int_equal(pl_scene_init(1, &scene), PL_OK);
  const pl_part_table table = {36, parts, ids, classes};
  assert_int_equal(pl_scene_add_object(&scene, "arm", model, (pl_vec3){0, 0, 0}, 1, 1, &table),
                   PL_OK);
  const int nodes[2] = {2, 1};
  assert_int_equal(pl_scene_articulate(&scene, 0, nodes, 2), PL_OK);
  assert_int_equal(pl_object_part(&scene.objects[0], 0), 0);
  assert_int_equal(pl_object_part(&scene.objects[0], 12), 24);
  assert_int_equal(pl_object_part(&scene.objects[0], 35), 23);
  assert_int_equal(pl_scene_articulate(&scene, 0, nodes, 2), PL_E_ARGUMENT);
  assert_int_equal(pl_scene_articulate(&scene, 1, nodes, 2), PL_E_ARGUMENT);
  pl_scene_clear(&scene);
  pl_model_destroy(model);
}

static void impossible_motions_are_refused(void **state) {
  (void)state;
  pl_model *model = arm_create();
  pl_affine motions[2] = {PL_AFFINE_IDENTITY, PL_AFFINE_IDENTITY};
  stage s;
  see(&s, model, (pl_vec3){0, 0, 8}, PL_QUAT_IDENTITY);
  articulate(&s, motions);
  assert_int_equal(pl_placement_check(&s.scene, &s.placement), PL_OK);
  for (int i = 0; i < 4; i++) {
    motions[1] = PL_AFFINE_IDENTITY;
    if (i == 0)
      motions[1].t.y = NAN;
    else if (i == 1)
      motions[1].m.row[1].z = INFINITY;
    else if (i == 2)
      motions[1].t.x = 1e5;
    else
      motions[1].m.row[0].x = NAN;
    assert_int_equal(pl_placement_check(&s.scene, &s.placement), PL_E_RANGE);
    assert_non_null(strstr(pl_error_text(), "'cube 2'"));
  }
  s.objects[0].movers = NULL;
  assert_int_equal(pl_placement_check(&s.scene, &s.placement), PL_E_ARGUMENT);
  stage_clear(&s);
  pl_model_destroy(model);
}

int main(void) {
  const struct CMUnitTest tests[] = {
      serial_unit_test(moved_pieces_look_like_baked_ones),
      serial_unit_test(exact_motions_give_equal_labels),
      serial_unit_test(bounds_follow_the_pieces),
      serial_unit_test(flattened_pieces_vanish),
      serial_unit_test(covers_are_shared),
      serial_unit_test(memory_runs_out),
      cmocka_unit_test(threads_and_memory),
      serial_unit_test(part_tables_follow_the_order),
      serial_unit_test(impossible_motions_are_refused),
  };
  return cmocka_run_group_tests(tests, NULL, NULL);
}
