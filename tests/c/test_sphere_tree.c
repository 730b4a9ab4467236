/* Trees of spheres: searches along rays and before the sun against all spheres one by one. */
#include "harness.h"

#include "light/sun.h"
#include "random.h"
#include "trace/instance.h"
#include "trace/intersect.h"

enum { MOST = 500 };

/* Spheres about the origin, of sizes over two decades, and their tree. */
static pl_sphere_tree many_spheres(test_random *random, pl_arena *arena, size_t count,
                                   pl_sphere *spheres) {
  static pl_sphere leaves[MOST];
  pl_sphere_tree tree;
  for (size_t i = 0; i < count; i++)
    leaves[i] = spheres[i] =
        (pl_sphere){.center = pl_vec3_scale(random_direction(random), random_range(random, 1, 9)),
                    .radius_m = random_scale(random, 1e-2, 1.0)};
  assert_int_equal(pl_sphere_tree_build(arena, leaves, count, &tree), PL_OK);
  return tree;
}

/* Every sphere is a leaf once, and lies in all inner spheres above it. */
static void test_nodes_enclose(void **state) {
  (void)state;
  static pl_sphere spheres[MOST];
  test_random random = {.seed = 71};
  pl_arena arena;
  pl_arena_init(&arena);
  print_message("seed 71\n");
  for (size_t count = 0; count <= MOST; count = 2 * count + 1) {
    const pl_sphere_tree tree = many_spheres(&random, &arena, count, spheres);
    size_t leaves = 0, sum = 0;
    for (size_t n = 0; n < tree.count; n++) {
      const pl_sphere *node = &tree.nodes[n];
      assert_true(node->after > n && node->after <= tree.count);
      if (node->item != PL_INNER_NODE) {
        leaves++;
        sum += node->item;
        assert_true(node->radius_m == spheres[node->item].radius_m && node->after == n + 1);
      }
      for (size_t k = n + 1; node->item == PL_INNER_NODE && k < node->after; k++)
        assert_true(tree.nodes[k].item == PL_INNER_NODE ||
                    pl_vec3_norm(pl_vec3_sub(node->center, tree.nodes[k].center)) +
                            tree.nodes[k].radius_m <=
                        node->radius_m);
    }
    assert_true(leaves == count && sum == (count > 0 ? count * (count - 1) / 2 : 0));
  }
  pl_arena_clear(&arena);
}

/* All spheres that a ray meets before its limit are found, except the one it skips, and few others
 * are looked at. */
static void test_rays_find_bodies(void **state) {
  enum { ROUNDS = 2000 };
  (void)state;
  static pl_sphere spheres[MOST];
  test_random random = {.seed = 72};
  size_t met = 0, asked = 0;
  pl_arena arena;
  pl_arena_init(&arena);
  print_message("seed 72\n");
  const pl_snapshot shot = {.body_tree = many_spheres(&random, &arena, MOST, spheres)};
  for (int round = 0; round < ROUNDS; round++) {
    bool found[MOST] = {false};
    const pl_ray ray = {.origin = pl_vec3_scale(random_direction(&random), 5.0),
                        .direction = random_direction(&random),
                        .t_max = random_range(&random, 0.0, 12.0),
                        .skip_body = (uint32_t)(round % MOST)};
    size_t k = 0;
    for (uint32_t body; (body = pl_next_body(&shot, &ray, ray.t_max, &k)) != PL_NO_BODY; asked++)
      found[body] = true;
    assert_false(found[ray.skip_body]);
    for (uint32_t i = 0; i < MOST; i++) {
      double start_m;
      if (i == ray.skip_body ||
          !pl_ray_enter(&ray, ray.t_max, spheres[i].center, spheres[i].radius_m, &start_m))
        continue;
      assert_true(found[i]);
      met++;
    }
  }
  print_message("%zu bodies met, %zu looked at, of %d\n", met, asked, ROUNDS * MOST);
  assert_true(met > 300 && asked < ROUNDS * MOST / 5);
  pl_arena_clear(&arena);
}

/* The spheres before the sun are those of a test of each. */
static void test_the_sun_behind_spheres(void **state) {
  (void)state;
  static pl_sphere spheres[MOST];
  test_random random = {.seed = 73};
  size_t before = 0;
  pl_arena arena;
  pl_arena_init(&arena);
  print_message("seed 73\n");
  const pl_sphere_tree tree = many_spheres(&random, &arena, MOST, spheres);
  for (int round = 0; round < 500; round++) {
    const double sine = random_scale(&random, 1e-3, 0.9), margin_m = random_range(&random, 0, 0.1);
    const pl_vec3 point = pl_vec3_scale(random_direction(&random), random_range(&random, 0, 20));
    const pl_sun_view sun = {.direction = pl_vec3_to_float(random_direction(&random)),
                             .sin_radius = (float)sine,
                             .one_minus_cos = (float)(1.0 - sqrt(1.0 - sine * sine)),
                             .distance_m = 1e9f};
    bool found[MOST] = {false};
    size_t k = 0;
    for (uint32_t i; (i = pl_sun_next_sphere(&sun, &tree, point, margin_m, &k)) != PL_NO_ITEM;)
      found[i] = true;
    for (size_t i = 0; i < MOST; i++) {
      const double radius_m = spheres[i].radius_m + margin_m;
      assert_int_equal(found[i], pl_sun_behind_sphere(&sun, point, spheres[i].center, radius_m));
      before += found[i];
    }
  }
  print_message("%zu spheres before the sun\n", before);
  assert_true(before > 1000 && before < 400 * MOST);
  pl_arena_clear(&arena);
}

int main(void) {
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(test_nodes_enclose),
      cmocka_unit_test(test_rays_find_bodies),
      cmocka_unit_test(test_the_sun_behind_spheres),
  };
  return cmocka_run_group_tests(tests, NULL, NULL);
}
