/* Memory of whole frames that have everything: textured meshes, a mapped body, lamps, smoke,
 * full silhouettes, automatic exposure, several threads. Every allocation is made to fail in turn.
 */
#include "harness.h"

#include "frames.h"
#include "graphs.h"

enum { WIDTH = PL_DRAWS(48, 24), HEIGHT = PL_DRAWS(36, 18), TEXELS = 8 };

typedef struct set {
  stage stage;
  pl_model *cube, *soup;
  pl_texture *map;
  pl_graph *graph;
  pl_volume smoke;
  pl_other_frame other; /* the same */
} set;

static pl_texture *checkers_create(int channels) {
  pl_image image;
  pl_texture *texture;
  assert_int_equal(pl_image_init(TEXELS, TEXELS, channels, &image), PL_OK);
  for (int i = 0; i < TEXELS * TEXELS * channels; i++)
    image.texels[i] = (i / channels + i / channels / TEXELS) % 2 != 0 ? 230 : 60;
  assert_int_equal(pl_texture_create(&image, true, PL_WRAP_REPEAT, PL_WRAP_REPEAT, &texture),
                   PL_OK);
  return texture;
}

/* Gives a model a texture of its colour and a lamp's light. */
static void model_paint(pl_model *model, float emissive) {
  model->uvs[0] = pl_alloc(2 * model->vertex_count, sizeof(float));
  model->textures = pl_alloc(1, sizeof *model->textures);
  assert_true(model->uvs[0] != NULL && model->textures != NULL);
  for (size_t v = 0; v < model->vertex_count; v++) {
    model->uvs[0][2 * v] = (float)(v % 4 == 1 || v % 4 == 2);
    model->uvs[0][2 * v + 1] = (float)(v % 4 > 1);
  }
  model->textures[0] = checkers_create(3);
  model->texture_count = 1;
  model->materials[0].base_color_map.texture = 0;
  for (int k = 0; k < 3; k++)
    model->materials[0].emissive[k] = emissive;
}

/* A ball that is denser on one side. */
static void smoke_init(set *s) {
  test_graph g = {0};
  const size_t where = graph_add(&g, "coordinates"), medium = graph_add(&g, "lambert");
  graph_link(&g, medium, "alpha", where, 0);
  assert_int_equal(graph_make(&g, &s->graph), PL_OK);
  s->smoke = (pl_volume){.name = "smoke",
                         .bound = &pl_bound_ellipsoid,
                         .size = {1.0, 1.0, 1.0},
                         .local = {{0.0, 0.0, -1.0}, PL_QUAT_IDENTITY},
                         .extinction = {1.0f, 1.0f, 1.0f},
                         .albedo = {1.0f, 1.0f, 1.0f},
                         .graph = s->graph};
  s->stage.placement.volumes = &s->smoke;
  s->stage.placement.volume_count = 1;
}

static void set_init(set *s) {
  test_random random = {.seed = 93};
  s->cube = cube_create(0.5);
  s->soup = soup_create(&random, 40);
  s->map = checkers_create(3);
  model_paint(s->cube, 0.0f);
  model_paint(s->soup, 40.0f);
  s->soup->materials[0].roughness = 0.3f;
  stage_init(&s->stage, WIDTH, HEIGHT, 40.0);
  stage_add_object(&s->stage, s->cube, (pl_vec3){-0.8, 0, 6}, random_rotation(&random), 2.0);
  stage_add_object(&s->stage, s->soup, (pl_vec3){0.8, 0, 7}, random_rotation(&random), 1.0);
  stage_add_object(&s->stage, s->cube, (pl_vec3){0, 0.3, 8}, random_rotation(&random), 1.5);
  stage_add_body(&s->stage, (pl_vec3){0, 4, 30}, (pl_vec3){9, 9, 8}, 0.6f);
  s->stage.scene.bodies[0].map = s->map;
  s->stage.placement.sun.position_m = (pl_vec3){0.5e11, -1.2e11, -0.7e11};
  smoke_init(s);
  s->other = (pl_other_frame){.placement = s->stage.placement};
}

/* Lets the camera and a cube move while the shutter is open, row by row. */
static void set_move(set *s) {
  s->stage.placement.shutter = (pl_shutter){.exposure_s = 0.02, .line_s = 0.001};
  s->stage.placement.camera.motion.close.t.x = 0.2;
  s->other = (pl_other_frame){.placement = s->stage.placement};
  s->stage.objects[0].motion.close.t.y += 0.1;
}

static void set_clear(set *s) {
  stage_clear(&s->stage);
  pl_model_destroy(s->cube);
  pl_model_destroy(s->soup);
  pl_texture_destroy(s->map);
  pl_graph_destroy(s->graph);
}

static pl_frame_request request_whole(const set *s, const film *f, int threads) {
  pl_frame_request request = request_all(&s->stage, f);
  request.threads = threads;
  request.samples = PL_DRAWS(request.samples, 2);
  request.amodal = true;
  request.exposure = (pl_exposure){.automatic = true, .percentile = 90, .key = 0.7};
  request.others[PL_FLOW_NEXT] = request.others[PL_FLOW_PREVIOUS] = &s->other;
  return request;
}

static void *fail_at_zero(void *context, size_t size) {
  long *left = context;
  return (*left)-- == 0 ? NULL : malloc(size);
}

static pl_status frame_with_failure(const set *s, const pl_frame_request *request, long n,
                                    pl_renderer **renderer) {
  pl_frame_result result;
  long left = n;
  pl_memory_hook(fail_at_zero, &left);
  pl_status status = pl_renderer_create(&s->stage.scene, renderer);
  if (status == PL_OK)
    status = pl_renderer_frame(*renderer, request, &result);
  pl_memory_hook(NULL, NULL);
  return status;
}

/* Each allocation has its own way back, which leaks or does not: all of them where the address
 * sanitizer tells, some elsewhere, which is enough for races. */
#if defined(__SANITIZE_ADDRESS__)
enum { STEP = 1 };
#else
enum { STEP = 9 };
#endif

/* What is not given back is found by the leak check of the address sanitizer's run. */
static void fail_every_allocation(int threads, bool moving) {
  set s;
  set_init(&s);
  if (moving)
    set_move(&s);
  film good, other;
  film_init(&good, &s.stage);
  film_init(&other, &s.stage);
  pl_renderer *first;
  const pl_frame_request request = request_whole(&s, &good, threads);
  const pl_frame_request again = request_whole(&s, &other, threads);
  assert_int_equal(pl_renderer_create(&s.stage.scene, &first), PL_OK);
  render(first, &request);
  pl_renderer_destroy(first);
  int failures = 0;
  pl_status status = PL_E_MEMORY;
  for (long n = 0; status != PL_OK; n += STEP) {
    pl_renderer *renderer = NULL;
    status = frame_with_failure(&s, &again, n, &renderer);
    if (status != PL_OK && status != PL_E_MEMORY)
      fail_msg("allocation %ld: %s", n, pl_status_name(status));
    failures += status != PL_OK;
    if (renderer != NULL) { /* the next frame is none the worse */
      memset(other.memory, 0xa5, other.bytes);
      memcpy(other.objects, good.objects, s.stage.scene.object_count * sizeof *good.objects);
      render(renderer, &again);
      assert_memory_equal(good.rgb, other.rgb, 3 * good.pixels);
      assert_memory_equal(film_channel(&good, "depth"), film_channel(&other, "depth"),
                          good.pixels * sizeof(float));
    }
    pl_renderer_destroy(renderer);
    assert_true(n < 2000);
  }
  print_message("%d threads: %d allocations failed in turn\n", threads, failures);
  assert_true(failures * STEP > 12);
  film_clear(&good);
  film_clear(&other);
  set_clear(&s);
}

static void test_memory_runs_out_alone(void **state) {
  (void)state;
  fail_every_allocation(1, false);
}

static void test_memory_runs_out(void **state) {
  (void)state;
  fail_every_allocation(3, false);
  fail_every_allocation(2, true);
}

/* From the second frame on nothing is allocated, whatever moves. */
static void steady_state(bool moving) {
  set s;
  set_init(&s);
  if (moving)
    set_move(&s);
  film f;
  film_init(&f, &s.stage);
  pl_renderer *renderer;
  assert_int_equal(pl_renderer_create(&s.stage.scene, &renderer), PL_OK);
  for (int threads = 1; threads <= 3; threads++) {
    pl_frame_request request = request_whole(&s, &f, threads);
    render(renderer, &request);
    const uint64_t before = pl_memory_allocations();
    for (int i = 0; i < 3; i++) {
      s.stage.objects[0].motion = still((pl_vec3){-1.0 + 0.3 * i, 0, 6}, PL_QUAT_IDENTITY);
      s.stage.objects[0].motion.close.t.x += moving ? 0.2 : 0.0;
      request.index = (uint64_t)i;
      render(renderer, &request);
      assert_int_equal(pl_memory_allocations(), before);
    }
  }
  pl_renderer_destroy(renderer);
  film_clear(&f);
  set_clear(&s);
}

static void test_steady_state_allocates_nothing(void **state) {
  (void)state;
  steady_state(false);
  steady_state(true);
}

int main(void) {
  const struct CMUnitTest tests[] = {
      serial_unit_test(test_memory_runs_out_alone),
      cmocka_unit_test(test_memory_runs_out),
      cmocka_unit_test(test_steady_state_allocates_nothing),
  };
  return cmocka_run_group_tests(tests, NULL, NULL);
}
