/* Shapes of rocks: sizes, families, meshes of spheres. */
#include "harness.h"

#include <math.h>

#include "base/memory.h"
#include "random.h"
#include "terrain/rock_shadow.h"

static pl_rock_sphere *spheres;
static pl_rock_variant *variants;

static int open_shapes(void **state) {
  (void)state;
  assert_int_equal(pl_rock_spheres_create(&spheres), PL_OK);
  assert_int_equal(pl_rock_variants_create(spheres, NULL, 0, &variants), PL_OK);
  return 0;
}

static int close_shapes(void **state) {
  (void)state;
  pl_free(variants);
  pl_rock_spheres_destroy(spheres);
  return 0;
}

static pl_rock_shape draw(test_random *random, int family) {
  uint64_t words[3];
  for (int k = 0; k < 3; k++)
    words[k] = (uint64_t)(random_unit(random) * 0x1p53) * 2047u;
  pl_rock_shape shape;
  pl_rock_shape_draw(variants, (pl_rock_family_kind)family, words, &shape);
  assert_ptr_equal(shape.variant->family, &pl_rock_families[family]);
  return shape;
}

/* Point of the surface on the ray through a unit direction of the unstretched ball. */
static pl_vec3 shape_point(const pl_rock_shape *shape, pl_vec3 d) {
  const double r = pl_rock_variant_radius(shape->variant, d);
  return (pl_vec3){d.x * r * shape->axes.x, d.y * r * shape->axes.y, d.z * r * shape->axes.z};
}

static void test_points(void **state) {
  (void)state;
  test_random random = {.seed = 57};
  for (int family = 0; family < PL_ROCK_MODEL; family++)
    for (int k = 0; k < 20; k++) {
      const pl_rock_shape shape = draw(&random, family);
      for (int n = 0; n < 20; n++) {
        const pl_vec3 p = shape_point(&shape, random_direction(&random));
        const double r = pl_vec3_norm(p);
        assert_true(r > 0.02 && r <= shape.radius);
        assert_true(fabs(pl_rock_shape_depth(&shape, p) - 1.0) < 1e-9);
        assert_true(fabs(pl_rock_shape_depth(&shape, pl_vec3_scale(p, 0.5)) - 0.5) < 1e-9);
      }
      assert_true(pl_rock_shape_depth(&shape, (pl_vec3){0.0, 0.0, 0.0}) == 0.0);
    }
}

/* Plan diameters are 1, and extents along any axis those of many points, within 5 %. Heights over
 * plan diameters are about 0.6 for all families together (Demidov and Basilevsky 2014). */
static void test_extent(void **state) {
  (void)state;
  test_random random = {.seed = 58};
  double sum = 0.0;
  enum { EACH = 10, POINTS = 6000 };
  for (int family = 0; family < PL_ROCK_MODEL; family++)
    for (int k = 0; k < EACH; k++) {
      const pl_rock_shape shape = draw(&random, family);
      const pl_vec3 axis = random_direction(&random);
      pl_vec3 low = {0.0, 0.0, 0.0}, high = low;
      double least = 0.0, most = 0.0, from, to;
      for (int n = 0; n < POINTS; n++) {
        const pl_vec3 p = shape_point(&shape, random_direction(&random));
        low = (pl_vec3){fmin(low.x, p.x), fmin(low.y, p.y), fmin(low.z, p.z)};
        high = (pl_vec3){fmax(high.x, p.x), fmax(high.y, p.y), fmax(high.z, p.z)};
        least = fmin(least, pl_vec3_dot(p, axis));
        most = fmax(most, pl_vec3_dot(p, axis));
      }
      const double plan = sqrt((high.x - low.x) * (high.y - low.y));
      if (!(plan > 0.97 && plan < 1.02))
        fail_msg("%s: plan diameter %g", shape.variant->family->name, plan);
      pl_rock_shape_extent(&shape, axis, &from, &to);
      if (!(from < 0.95 * least && to > 0.95 * most && from > 1.04 * least && to < 1.04 * most))
        fail_msg("%s: from %g to %g, points from %g to %g", shape.variant->family->name, from, to,
                 least, most);
      sum += (high.z - low.z) / plan;
    }
  const double mean = sum / (PL_ROCK_MODEL * EACH);
  if (!(mean > 0.54 && mean < 0.66))
    fail_msg("mean height over plan diameter %g", mean);
}

/* The variants of a family differ, and so do rocks of one variant. */
static void test_variants(void **state) {
  (void)state;
  const pl_vec3 along = pl_vec3_unit((pl_vec3){0.3, -0.5, 0.8});
  for (int family = 0; family < PL_ROCK_MODEL; family++) {
    double low = INFINITY, high = 0.0;
    for (int k = 0; k < PL_ROCK_VARIANTS; k++) {
      const pl_rock_variant *ball = &variants[family * PL_ROCK_VARIANTS + k];
      assert_int_equal(ball->number, family * PL_ROCK_VARIANTS + k);
      low = fmin(low, pl_rock_variant_radius(ball, along));
      high = fmax(high, pl_rock_variant_radius(ball, along));
    }
    assert_true(high > 1.1 * low);
  }
  const uint64_t one[3] = {1, 2, 5}, other[3] = {3, 4, 5 + PL_ROCK_VARIANTS};
  pl_rock_shape a, b;
  pl_rock_shape_draw(variants, PL_ROCK_BLOCK, one, &a);
  pl_rock_shape_draw(variants, PL_ROCK_BLOCK, other, &b);
  assert_ptr_equal(a.variant, b.variant);
  assert_true(a.axes.z / a.axes.x != b.axes.z / b.axes.x);
}

/* Fraction of directions in which no plane cuts the ball of a family's variants. */
static double round_fraction(pl_rock_family_kind family) {
  enum { DIRECTIONS = 300 };
  test_random random = {.seed = 59};
  int round = 0;
  for (int k = 0; k < PL_ROCK_VARIANTS; k++) {
    const pl_rock_variant *ball = &variants[(int)family * PL_ROCK_VARIANTS + k];
    assert_int_equal(ball->planes, ball->family->planes + ball->family->chips);
    for (int n = 0; n < DIRECTIONS; n++) {
      const pl_vec3 d = random_direction(&random);
      double most = 0.0;
      for (int m = 0; m < ball->planes; m++)
        most = fmax(most, pl_vec3_dot(ball->normals[m], d));
      round += most < 1.0;
    }
  }
  return round / (double)(PL_ROCK_VARIANTS * DIRECTIONS);
}

/* Angular rocks are all faces; worn ones keep the ball. */
static void test_faces(void **state) {
  (void)state;
  static const pl_rock_family_kind angular[] = {PL_ROCK_BLOCK, PL_ROCK_CUBE, PL_ROCK_WEDGE,
                                                PL_ROCK_SLAB, PL_ROCK_SHARD};
  for (size_t k = 0; k < sizeof angular / sizeof *angular; k++)
    if (!(round_fraction(angular[k]) < 0.06))
      fail_msg("%s: %g is round", pl_rock_families[angular[k]].name, round_fraction(angular[k]));
  assert_true(round_fraction(PL_ROCK_EGG) > 0.5);
}

/* Every edge of a closed mesh is in two triangles, once in each direction. */
static void check_closed(const pl_rock_sphere *sphere) {
  enum { MOST = 10242 };
  static int balance[MOST], degree[MOST];
  for (int k = 0; k < sphere->vertex_count; k++)
    balance[k] = degree[k] = 0;
  double volume = 0.0;
  for (int k = 0; k < sphere->triangle_count; k++) {
    const uint32_t *t = sphere->triangles[k];
    for (int c = 0; c < 3; c++) {
      const int from = (int)t[c], to = (int)t[(c + 1) % 3];
      assert_true(from != to && from < sphere->vertex_count);
      /* Weights that no other edges cancel, but by chance. */
      balance[from] += to * 31 % 1009;
      balance[to] -= from * 31 % 1009;
      degree[from]++;
    }
    volume += pl_vec3_dot(sphere->vertices[t[0]],
                          pl_vec3_cross(sphere->vertices[t[1]], sphere->vertices[t[2]])) /
              6.0;
  }
  for (int k = 0; k < sphere->vertex_count; k++) {
    assert_true(degree[k] == 5 || degree[k] == 6);
    assert_int_equal(balance[k], 0);
  }
  assert_true(volume > 2.5 && volume < 4.19);
  assert_int_equal(sphere->vertex_count, sphere->triangle_count / 2 + 2);
}

static void test_spheres(void **state) {
  (void)state;
  for (int lod = 0; lod < PL_ROCK_LODS; lod++) {
    assert_int_equal(spheres[lod].triangle_count, 20 << (2 * lod));
    check_closed(&spheres[lod]);
  }
}

/* Meshes of all levels throw the same shadow, on the mean over variants of a family. */
static void test_shadows(void **state) {
  (void)state;
  enum { EACH = 6, FINEST = 4 };
  for (int family = 0; family < PL_ROCK_MODEL; family++) {
    double sums[FINEST + 1] = {0.0};
    for (int k = 0; k < EACH; k++) {
      const pl_rock_variant *variant = &variants[family * PL_ROCK_VARIANTS + 5 * k];
      for (int lod = 1; lod <= FINEST; lod++) {
        double area;
        assert_int_equal(pl_rock_shadow_mean(&spheres[lod], variant, &area), PL_OK);
        sums[lod] += variant->scale[lod] * variant->scale[lod] * area;
      }
    }
    for (int lod = 1; lod < FINEST; lod++)
      if (!(fabs(sums[lod] / sums[FINEST] - 1.0) < (lod == 1 ? 0.02 : 0.012)))
        fail_msg("%s, level %d: %g", pl_rock_families[family].name, lod, sums[lod] / sums[FINEST]);
  }
}

/* Beside the exact shadow of a ball's mesh, a quarter of the surface of any convex body. */
static void test_shadow_of_a_ball(void **state) {
  (void)state;
  pl_rock_variant ball = {.family = &pl_rock_families[PL_ROCK_MODEL]};
  double surface = 0.0, shadow;
  for (int k = 0; k < spheres[1].triangle_count; k++) {
    const uint32_t *t = spheres[1].triangles[k];
    const pl_vec3 a = spheres[1].vertices[t[0]];
    surface += 0.5 * pl_vec3_norm(pl_vec3_cross(pl_vec3_sub(spheres[1].vertices[t[1]], a),
                                                pl_vec3_sub(spheres[1].vertices[t[2]], a)));
  }
  assert_int_equal(pl_rock_shadow_mean(&spheres[1], &ball, &shadow), PL_OK);
  assert_true(fabs(shadow / (0.25 * surface) - 1.0) < 0.002);
}

int main(void) {
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(test_points),          cmocka_unit_test(test_extent),
      cmocka_unit_test(test_variants),        cmocka_unit_test(test_faces),
      cmocka_unit_test(test_spheres),         cmocka_unit_test(test_shadows),
      cmocka_unit_test(test_shadow_of_a_ball)};
  return cmocka_run_group_tests(tests, open_shapes, close_shapes);
}
