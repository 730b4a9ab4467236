/* Pieces of a model: every triangle in one, by the nearest moving node above it. */
#include "geom/cut.h"

#include <stdlib.h>

#include "jointed.h"

/* 0 and its children 1 and 2, 3 below 2; 4 apart. */
static const cube_node TREE[5] = {{-1, {{0, 0, 0}, {1, 0, 0, 0}, {1, 1, 1}}, false},
                                  {0, {{4, 0, 0}, {1, 0, 0, 0}, {1, 1, 1}}, false},
                                  {0, {{0, 4, 0}, {1, 0, 0, 0}, {1, 1, 1}}, true},
                                  {2, {{0, 4, 0}, {1, 0, 0, 0}, {1, 1, 1}}, false},
                                  {-1, {{0, 0, 9}, {1, 0, 0, 0}, {1, 1, 1}}, false}};

static pl_cut *cut_at(const pl_model *model, const int *nodes, size_t count) {
  pl_cut *cut;
  assert_int_equal(pl_cut_create(model, nodes, count, &cut), PL_OK);
  return cut;
}

/* Triangles come from where `original` says, and all of them come. */
static void check_order(const pl_model *model, const pl_cut *cut) {
  char seen[128] = {0};
  assert_int_equal(cut->whole.triangle_count, model->triangle_count);
  for (uint32_t t = 0; t < model->triangle_count; t++) {
    const size_t from = cut->original[t], k = pl_cut_piece(cut, t);
    assert_int_equal(seen[from]++, 0);
    assert_memory_equal(cut->whole.indices + 3 * (size_t)t, model->indices + 3 * from, 12);
    assert_int_equal(cut->whole.triangle_part[t], model->triangle_part[from]);
    assert_in_range(t, cut->first[k], cut->first[k + 1] - 1);
    assert_ptr_equal(cut->pieces[k].positions, model->positions);
    assert_memory_equal(cut->pieces[k].indices + 3 * (t - cut->first[k]), model->indices + 3 * from,
                        12);
  }
}

static void triangles_follow_their_node(void **state) {
  (void)state;
  pl_model *model = jointed_create(TREE, 5, 1);
  const int nodes[3] = {3, 0, 1};
  pl_cut *cut = cut_at(model, nodes, 3);
  check_order(model, cut);
  const size_t triangles[4] = {12, 12, 12, 12}; /* 4; 3; 0; 1 */
  const float low_z[4] = {8, -1, -1, -1}, low_y[4] = {-1, 7, -1, -1};
  for (size_t k = 0; k < 4; k++) {
    assert_int_equal(cut->pieces[k].triangle_count, triangles[k]);
    assert_true(cut->pieces[k].bounds_min[2] == low_z[k]);
    assert_true(cut->pieces[k].bounds_min[1] == low_y[k]);
  }
  pl_cut_destroy(cut);
  pl_model_destroy(model);
}

static void pieces_may_be_empty(void **state) {
  (void)state;
  pl_model *model = jointed_create(TREE, 4, 1);
  const int nodes[3] = {0, 2, 3};
  pl_cut *cut = cut_at(model, nodes, 3);
  check_order(model, cut);
  assert_int_equal(cut->pieces[0].triangle_count, 0);
  assert_int_equal(cut->pieces[1].triangle_count, 24);
  assert_int_equal(cut->pieces[2].triangle_count, 0); /* 2 bears only 3, which moves by itself */
  assert_int_equal(cut->pieces[3].triangle_count, 12);
  pl_cut_destroy(cut);
  const int none[1] = {4};
  assert_int_equal(pl_cut_create(model, none, 1, &cut), PL_E_RANGE);
  pl_model_destroy(model);
}

static void *fail_at(void *context, size_t size) {
  int *left = context;
  return (*left)-- == 0 ? NULL : malloc(size);
}

static void no_memory_is_an_error(void **state) {
  (void)state;
  pl_model *model = jointed_create(TREE, 5, 1);
  const int nodes[1] = {1};
  for (int n = 0;; n++) {
    int left = n;
    pl_cut *cut = NULL;
    pl_memory_hook(fail_at, &left);
    const pl_status status = pl_cut_create(model, nodes, 1, &cut);
    pl_memory_hook(NULL, NULL);
    if (status == PL_OK) {
      assert_true(n > 4);
      pl_cut_destroy(cut);
      break;
    }
    assert_int_equal(status, PL_E_MEMORY);
  }
  pl_model_destroy(model);
}

int main(void) {
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(triangles_follow_their_node),
      cmocka_unit_test(pieces_may_be_empty),
      cmocka_unit_test(no_memory_is_an_error),
  };
  return cmocka_run_group_tests(tests, NULL, NULL);
}
