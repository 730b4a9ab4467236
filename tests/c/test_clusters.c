/* Boxes of triangles: they hold every triangle, are few, and none spans the model. */
#include "harness.h"

#include <stdio.h>

#include "annotate/clusters.h"
#include "models.h"

static bool holds(const pl_cluster *box, const float *p) {
  for (int k = 0; k < 3; k++)
    if (!(p[k] >= box->low[k] && p[k] <= box->high[k]))
      return false;
  return true;
}

static bool held(const pl_clusters *clusters, const pl_model *model, size_t triangle) {
  for (size_t i = 0; i < clusters->count; i++) {
    int corners = 0;
    for (size_t k = 0; k < 3; k++)
      corners += holds(&clusters->boxes[i],
                       model->positions + 3 * (size_t)model->indices[3 * triangle + k]);
    if (corners == 3)
      return true;
  }
  return false;
}

/* Triangles of side up to 0.01 in the cube of half side 1, so that boxes can be small. */
static pl_model *dust_create(test_random *random, size_t triangles) {
  pl_model *model = soup_create(random, triangles);
  for (size_t t = 0; t < triangles; t++)
    for (size_t k = 3; k < 9; k++) {
      float *corner = model->positions + 9 * t;
      corner[k] = corner[k % 3] + 0.01f * (corner[k] - corner[k % 3]);
    }
  pl_model_measure(model);
  return model;
}

static void test_boxes_hold_all(void **state) {
  (void)state;
  static const size_t sizes[] = {1, 2, 5, 63, 1000, 9000};
  test_random random = {.seed = 95};
  print_message("seed 95\n");
  for (size_t s = 0; s < sizeof sizes / sizeof sizes[0]; s++) {
    pl_model *model = dust_create(&random, sizes[s]);
    pl_cluster_cache cache;
    pl_clusters clusters, again;
    pl_cluster_cache_init(&cache);
    assert_int_equal(pl_cluster_cache_get(&cache, model, &clusters), PL_OK);
    assert_int_equal(pl_cluster_cache_get(&cache, model, &again), PL_OK);
    assert_ptr_equal(clusters.boxes, again.boxes);
    assert_in_range(clusters.count, 1, 4 * 1024);
    for (size_t t = 0; t < sizes[s]; t++)
      assert_true(held(&clusters, model, t));
    double volume = 0.0; /* of the boxes; the model's is 8 */
    for (size_t i = 0; i < clusters.count; i++) {
      const pl_cluster *b = &clusters.boxes[i];
      volume += (double)(b->high[0] - b->low[0]) * (double)(b->high[1] - b->low[1]) *
                (double)(b->high[2] - b->low[2]);
    }
    assert_true(volume <= 8.1);
    pl_cluster_cache_clear(&cache);
    pl_model_destroy(model);
  }
}

/* Many triangles in one place cannot be parted: one box. A flat model has no third dimension. */
static void test_degenerate_models(void **state) {
  (void)state;
  test_random random = {.seed = 96};
  pl_model *model = soup_create(&random, 500), *square = square_create(1.0);
  pl_cluster_cache cache;
  pl_clusters clusters;
  for (size_t i = 0; i < 9 * model->triangle_count; i++)
    model->positions[i] = model->positions[i % 9];
  pl_model_measure(model);
  pl_cluster_cache_init(&cache);
  assert_int_equal(pl_cluster_cache_get(&cache, model, &clusters), PL_OK);
  assert_int_equal(clusters.count, 1);
  assert_true(held(&clusters, model, 499));
  model->triangle_count = 0;
  pl_cluster_cache_clear(&cache);
  assert_int_equal(pl_cluster_cache_get(&cache, model, &clusters), PL_OK);
  assert_int_equal(clusters.count, 0);
  assert_int_equal(pl_cluster_cache_get(&cache, square, &clusters), PL_OK);
  assert_true(held(&clusters, square, 0) && held(&clusters, square, 1));
  pl_cluster_cache_clear(&cache);
  pl_model_destroy(model);
  pl_model_destroy(square);
}

int main(void) {
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(test_boxes_hold_all),
      cmocka_unit_test(test_degenerate_models),
  };
  return cmocka_run_group_tests(tests, NULL, NULL);
}
