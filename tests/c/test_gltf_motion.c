/* Reading nodes and animations. Axes: the file is y-up, the model z-up: (x, y, z) -> (x, -z, y). */
#include "io/gltf.h"

#include <math.h>

#include "gltf_files.h"
#include "node_globals.h"

#define near(a, b) assert_true(fabs((double)(a) - (b)) < 1e-6)

static void nodes_are_kept_in_the_models_axes(void **state) {
  (void)state;
  pl_model *model = load_nodes(
      "{\"children\":[1],\"name\":\"boom\",\"translation\":[1,2,3],\"scale\":[2,3,4]},"
      "{\"mesh\":0,\"rotation\":[0,0.6,0,0.8]},{\"matrix\":[1,0,0,0,0,1,0,0,0,0,1,0,5,6,7,1]}");
  assert_int_equal(model->nodes.count, 3);
  const pl_node *n = model->nodes.items;
  assert_string_equal(n[0].name, "boom");
  assert_string_equal(n[1].name, "node 1");
  assert_int_equal(n[0].parent, -1);
  assert_int_equal(n[1].parent, 0);
  near(n[0].trs.t.x, 1);
  near(n[0].trs.t.y, -3);
  near(n[0].trs.t.z, 2);
  near(n[0].trs.s.y, 4);
  near(n[0].trs.s.z, 3);
  near(n[1].trs.q.w, 0.8);
  near(n[1].trs.q.z, 0.6); /* the file's y is up */
  assert_true(n[2].has_matrix && !n[0].has_matrix);
  near(n[2].local.t.y, -7);
  for (int i = 0; i < 2; i++) { /* two readings of one transform */
    const pl_affine local = pl_trs_affine(&n[i].trs);
    assert_true(pl_vec3_norm(pl_vec3_sub(local.t, n[i].local.t)) < 1e-12);
    for (int k = 0; k < 3; k++)
      assert_true(pl_vec3_norm(pl_vec3_sub(local.m.row[k], n[i].local.m.row[k])) < 1e-12);
  }
  /* The square's second corner is (1, 0, 0) on its node. */
  pl_affine globals[3];
  node_globals(&model->nodes, NULL, globals);
  const pl_vec3 p = pl_affine_apply(&globals[1], (pl_vec3){1, 0, 0});
  vector_near(corner(model, 0, 1), p.x, p.y, p.z);
  pl_model_destroy(model);
}

/* As if the roots were below a node of that scale, in the model's axes. */
static void a_stretched_model_has_stretched_nodes(void **state) {
  (void)state;
  char path[512];
  pl_model *plain = load_nodes("{\"children\":[1],\"translation\":[1,2,3]},"
                               "{\"mesh\":0,\"rotation\":[0,0.6,0,0.8]}");
  snprintf(path, sizeof path, "%s", in_folder("model.gltf"));
  pl_model *model = NULL;
  assert_int_equal(pl_gltf_load(path, (const double[3]){2, 3, 4}, &model), PL_OK);
  pl_affine from[2], to[2];
  node_globals(&plain->nodes, NULL, from);
  node_globals(&model->nodes, NULL, to);
  near(model->nodes.items[0].trs.t.x, 1); /* what the file says of a node stays */
  near(to[0].t.x, 2);
  near(to[0].t.y, -9);
  near(to[0].t.z, 8);
  for (size_t v = 0; v < 4; v++) {
    const float *p = plain->positions + 3 * v, *q = model->positions + 3 * v;
    const pl_vec3 a = pl_model_point(plain, (pl_vec3){p[0], p[1], p[2]});
    const pl_vec3 b = pl_model_point(model, (pl_vec3){q[0], q[1], q[2]});
    near(b.x, 2 * a.x);
    near(b.y, 3 * a.y);
    near(b.z, 4 * a.z);
  }
  pl_model_destroy(model);
  pl_model_destroy(plain);
}

/* Times 1 and 3, and two values of 4 numbers, after the square. */
#define ANIMATED(channels, samplers, more)                                                         \
  ASSET "\"buffers\":[{\"byteLength\":88,\"uri\":\"square.bin\"},"                                 \
        "{\"byteLength\":40,\"uri\":\"keys.bin\"}],\"bufferViews\":["                              \
        "{\"buffer\":0,\"byteLength\":48},{\"buffer\":0,\"byteOffset\":48,\"byteLength\":6},"      \
        "{\"buffer\":1,\"byteLength\":8},{\"buffer\":1,\"byteOffset\":8,\"byteLength\":32}],"      \
        "\"accessors\":["                                                                          \
        "{\"bufferView\":0,\"componentType\":5126,\"count\":4,\"type\":\"VEC3\"},"                 \
        "{\"bufferView\":1,\"componentType\":5121,\"count\":6,\"type\":\"SCALAR\"},"               \
        "{\"bufferView\":2,\"componentType\":5126,\"count\":2,\"type\":\"SCALAR\"},"               \
        "{\"bufferView\":3,\"componentType\":5126,\"count\":2,\"type\":\"VEC4\"},"                 \
        "{\"bufferView\":3,\"componentType\":5126,\"count\":2,\"type\":\"VEC3\"},"                 \
        "{\"componentType\":5126,\"count\":9007199254740991,\"type\":\"SCALAR\"}],"                \
        "\"nodes\":[{\"mesh\":0},{\"matrix\":[1,0,0,0,0,1,0,0,0,0,1,0,0,0,0,1]}],"                 \
        "\"animations\":[{\"name\":\"turn\",\"channels\":[" channels "],\"samplers\":[" samplers   \
        "]" more "}]," SQUARE_MESH "}"
#define TURN "{\"sampler\":0,\"target\":{\"node\":0,\"path\":\"rotation\"}}"
#define KEYS "{\"input\":2,\"output\":3}"

static pl_model *load_animated(const char *text) {
  const float keys[10] = {1, 3, 0, 0, 0, 1, 0.6f, 0, 0, 0.8f};
  write_file("keys.bin", keys, sizeof keys);
  return load_text(text);
}

static void animations_are_read_in_the_models_axes(void **state) {
  (void)state;
  pl_model *model = load_animated(ANIMATED(TURN, KEYS, ""));
  assert_string_equal(model->warnings, "");
  assert_int_equal(model->animation_count, 1);
  const pl_animation *a = &model->animations[0];
  assert_string_equal(a->name, "turn");
  near(a->start_s, 1);
  near(a->stop_s, 3);
  assert_int_equal(a->count, 1);
  assert_int_equal(a->tracks[0].interpolation, PL_LINEAR);
  pl_trs trs = {{0, 0, 0}, PL_QUAT_IDENTITY, {1, 1, 1}};
  pl_track_sample(&a->tracks[0], 3, &trs);
  near(trs.q.w, 0.8);
  near(trs.q.x, 0.6);
  pl_model_destroy(model);
}

/* Broken animations are named and left out: the model is whole without them. */
static void broken_animations_are_left_out(void **state) {
  (void)state;
  const char *const cases[][2] = {
      {ANIMATED("{\"sampler\":1,\"target\":{\"node\":0,\"path\":\"scale\"}}", KEYS, ""),
       "channels[0].sampler: must be an index below 1"},
      {ANIMATED("{\"sampler\":0,\"target\":{\"node\":2,\"path\":\"scale\"}}", KEYS, ""),
       "channels[0].target.node"},
      {ANIMATED("{\"sampler\":0,\"target\":{\"node\":0,\"path\":7}}", KEYS, ""), "target.path"},
      {ANIMATED("{\"sampler\":0,\"target\":{\"node\":0,\"path\":\"scale\"}}", KEYS, ""),
       "output: must be VEC3"},
      {ANIMATED("{\"sampler\":0,\"target\":{\"node\":0,\"path\":\"weights\"}}", KEYS, ""),
       "moves no node"},
      {ANIMATED("{\"sampler\":0,\"target\":{\"path\":\"scale\"}}", KEYS, ""), "moves no node"},
      {ANIMATED("{\"sampler\":0,\"target\":{\"node\":1,\"path\":\"rotation\"}}", KEYS, ""),
       "has a matrix"},
      {ANIMATED(TURN "," TURN, KEYS, ""), "two channels"},
      {ANIMATED("7", KEYS, ""), "channels[0]: must be an object"},
      {ANIMATED(TURN, "{\"input\":3,\"output\":3}", ""), "must be SCALAR"},
      {ANIMATED(TURN, "{\"input\":2,\"output\":99}", ""), "below 6"},
      {ANIMATED(TURN, "{\"input\":5,\"output\":3}", ""), "too many keys"},
      {ANIMATED(TURN, "{\"input\":2,\"output\":3,\"interpolation\":\"CUBICSPLINE\"}", ""),
       "2 values for 2 keys, must be 6"},
      {ANIMATED(TURN, "{\"input\":2,\"output\":3,\"interpolation\":\"WILD\"}", ""), "STEP"},
      {ANIMATED(TURN, KEYS, ",\"channels\":{}"), "channels: must be an array"},
  };
  for (size_t i = 0; i < sizeof cases / sizeof cases[0]; i++) {
    pl_model *model = load_animated(cases[i][0]);
    assert_int_equal(model->animation_count, 0);
    warned(model, "animations[0] is left out: ");
    warned(model, cases[i][1]);
    pl_model_destroy(model);
  }
}

static void times_must_grow(void **state) {
  (void)state;
  const float last[3] = {1, 0.5f, NAN};
  for (int i = 0; i < 3; i++) {
    const float keys[10] = {1, last[i], 0, 0, 0, 1, 0.6f, 0, 0, 0.8f};
    write_file("keys.bin", keys, sizeof keys);
    pl_model *model = load_text(ANIMATED(TURN, KEYS, ""));
    warned(model, "times must be finite and grow");
    pl_model_destroy(model);
  }
}

#define in_own_folder(test) cmocka_unit_test_setup_teardown(test, folder_create, folder_remove)

int main(void) {
  const struct CMUnitTest tests[] = {
      in_own_folder(nodes_are_kept_in_the_models_axes),
      in_own_folder(a_stretched_model_has_stretched_nodes),
      in_own_folder(animations_are_read_in_the_models_axes),
      in_own_folder(broken_animations_are_left_out),
      in_own_folder(times_must_grow),
  };
  return cmocka_run_group_tests(tests, NULL, NULL);
}
