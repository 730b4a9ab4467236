/* Graphs in the extras of glTF materials, as text. */
#include "harness.h"

#include "base/memory.h"
#include "gltf_files.h"

/* The second and third material are on a triangle. */
#define WITH(materials)                                                                            \
  ASSET "\"scenes\":[{\"nodes\":[0]}],\"nodes\":[{\"mesh\":0}],\"materials\":[" materials "],"     \
        "\"meshes\":[{\"primitives\":[{\"attributes\":{\"POSITION\":0},\"indices\":1,"             \
        "\"material\":1},{\"attributes\":{\"POSITION\":0},\"indices\":1,\"material\":2}]}]"        \
        "," SQUARE_DATA "}"
#define GRAPH(value) "\"extras\":{\"other\":1,\"perilune_graph\":" value "}"

static pl_status graphs_of(const char *text, char **out) {
  write_square();
  return pl_gltf_graphs(write_text("model.gltf", text), out);
}

static void expect(const char *text, const char *expected) {
  char *out;
  if (graphs_of(text, &out) != PL_OK)
    fail_msg("%s", pl_error_text());
  assert_string_equal(out, expected);
  pl_free(out);
}

/* Keys of objects come in the order of their names. */
static void test_graphs(void **state) {
  (void)state;
  expect(WITH("{\"name\":\"a\"," GRAPH("{\"nodes\":{}}") "},{\"name\":\"b\"," GRAPH(
             "{\"nodes\":[1,\"x\"]}") "},{" GRAPH("null") "}"),
         "[{\"index\":0,\"name\":\"a\"},"
         "{\"graph\":{\"nodes\":[1,\"x\"]},\"index\":1,\"name\":\"b\"},"
         "{\"graph\":null,\"index\":2,\"name\":\"material 2\"}]");
}

static void test_none(void **state) {
  (void)state;
  char *out;
  expect(WITH("{},{\"extras\":{}},{\"extras\":3}"), "[]");
  assert_int_equal(pl_gltf_graphs("/nowhere/at/all.glb", &out), PL_OK);
  assert_string_equal(out, "[]");
  pl_free(out);
}

static void test_broken(void **state) {
  (void)state;
  char *out;
  assert_int_equal(graphs_of("{\"perilune_graph\":", &out), PL_E_FORMAT);
  assert_null(out);
  assert_int_equal(graphs_of(WITH("{},{" GRAPH("1") "},7"), &out), PL_E_FORMAT);
  assert_null(out);
  print_message("%s\n", pl_error_text());
}

#define in_own_folder(test) cmocka_unit_test_setup_teardown(test, folder_create, folder_remove)

int main(void) {
  const struct CMUnitTest tests[] = {
      in_own_folder(test_graphs),
      in_own_folder(test_none),
      in_own_folder(test_broken),
  };
  return cmocka_run_group_tests(tests, NULL, NULL);
}
