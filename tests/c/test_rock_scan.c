/* Shapes of measured rocks: distances beside an ellipsoid's, what is refused, meshes of several. */
#include "harness.h"

#include <math.h>
#include <string.h>

#include "base/memory.h"
#include "math/rotation.h"
#include "random.h"
#include "terrain/rock_mesh.h"
#include "terrain/rock_shape.h"

enum { LEVEL = 4, VERTICES = 2562 };

static pl_rock_sphere *spheres;
static double positions[VERTICES][3];

static int open_spheres(void **state) {
  (void)state;
  assert_int_equal(pl_rock_spheres_create(&spheres), PL_OK);
  return 0;
}

static int close_spheres(void **state) {
  (void)state;
  pl_rock_spheres_destroy(spheres);
  return 0;
}

/* An ellipsoid with these half axes, turned and moved. */
static pl_rock_model ellipsoid(pl_vec3 half, pl_quat turn, pl_vec3 to) {
  const pl_rock_sphere *sphere = &spheres[LEVEL];
  const pl_mat3 m = pl_mat3_from_quat(turn);
  for (int k = 0; k < sphere->vertex_count; k++) {
    const pl_vec3 d = sphere->vertices[k];
    const pl_vec3 p =
        pl_vec3_add(to, pl_mat3_mul_vec(m, (pl_vec3){half.x * d.x, half.y * d.y, half.z * d.z}));
    memcpy(positions[k], (double[]){p.x, p.y, p.z}, sizeof positions[k]);
  }
  return (pl_rock_model){(const double(*)[3])positions, (size_t)sphere->vertex_count,
                         (const uint32_t(*)[3])sphere->triangles, (size_t)sphere->triangle_count};
}

static double ellipsoid_radius(pl_vec3 half, pl_vec3 d) {
  const pl_vec3 q = {d.x / half.x, d.y / half.y, d.z / half.z};
  return 1.0 / pl_vec3_norm(q);
}

/* Whatever its size, place and axes, an ellipsoid has its longest axis along x, its shortest along
 * z. Meshes and tables are some 1e-3 coarse. */
static void test_ellipsoids(void **state) {
  (void)state;
  test_random random = {.seed = 11};
  const pl_vec3 axes[] = {{1.0, 0.7, 0.45}, {0.45, 1.0, 0.7}, {0.7, 0.45, 1.0}};
  for (int k = 0; k < 6; k++) {
    const double size = pow(10.0, 8.0 * random_unit(&random) - 4.0);
    const pl_quat turn = pl_quat_unit((pl_quat){random_unit(&random), random_unit(&random) - 0.5,
                                                random_unit(&random) - 0.5, random_unit(&random)});
    const pl_vec3 to = pl_vec3_scale(random_direction(&random), 30.0 * size);
    const pl_rock_model model = ellipsoid(pl_vec3_scale(axes[k % 3], size), turn, to);
    pl_rock_scan scan;
    assert_int_equal(pl_rock_scan_create(&model, &scan), PL_OK);
    assert_true(scan.folded == 0.0);
    for (int n = 0; n < 500; n++) {
      const pl_vec3 d = random_direction(&random);
      const double expected = ellipsoid_radius(axes[0], d);
      assert_true(fabs(pl_rock_scan_radius(&scan, d) / expected - 1.0) < 2e-3);
    }
    pl_rock_scan_clear(&scan);
  }
}

/* Folds of the map of directions: distances there are those beside them. */
static void test_folds(void **state) {
  (void)state;
  const pl_rock_model model =
      ellipsoid((pl_vec3){1.0, 0.9, 0.8}, PL_QUAT_IDENTITY, (pl_vec3){0.0, 0.0, 0.0});
  pl_rock_scan scan;
  assert_int_equal(pl_rock_scan_create(&model, &scan), PL_OK);
  for (int k = 0; k < 200; k++) {
    const double a = 2.0 * PL_PI * k / 200.0;
    const pl_vec3 edges[] = {{cos(a), sin(a), 0.0}, {cos(a), 0.0, sin(a)}, {0.0, cos(a), sin(a)}};
    for (int e = 0; e < 3; e++) {
      const pl_vec3 across = {e == 2, e == 1, e == 0};
      const double here = pl_rock_scan_radius(&scan, edges[e]);
      for (int side = -1; side <= 1; side += 2) {
        const pl_vec3 near = pl_vec3_unit(pl_vec3_madd(edges[e], 1e-9 * side, across));
        assert_true(fabs(pl_rock_scan_radius(&scan, near) - here) < 1e-7);
      }
    }
  }
  pl_rock_scan_clear(&scan);
}

static void refuse(const pl_rock_model *model, const char *text) {
  pl_rock_scan scan;
  assert_int_equal(pl_rock_scan_create(model, &scan), PL_E_RANGE);
  assert_non_null(strstr(pl_error_text(), text));
  assert_null(scan.radii);
}

static void test_refused(void **state) {
  (void)state;
  const pl_vec3 half = {1.0, 0.9, 0.8}, none = {0.0, 0.0, 0.0};
  pl_rock_model model = ellipsoid(half, PL_QUAT_IDENTITY, none);
  model.triangle_count -= 1; /* a hole of one triangle */
  refuse(&model, "does not surround");
  model.triangle_count = 0;
  refuse(&model, "area");
  model = ellipsoid(half, PL_QUAT_IDENTITY, none);
  model.vertex_count -= 1;
  refuse(&model, "vertex 2561 of 2561");
  model.vertex_count += 1;
  positions[7][1] = (double)NAN;
  refuse(&model, "vertex 7");
  model = ellipsoid((pl_vec3){0.0, 0.0, 0.0}, PL_QUAT_IDENTITY, none);
  refuse(&model, "area");
}

/* Two rocks of one number in a pool keep meshes of their own; needles are refused. */
static void test_variants(void **state) {
  (void)state;
  const pl_vec3 none = {0.0, 0.0, 0.0};
  pl_rock_scan round, flat, needle;
  pl_rock_model model = ellipsoid((pl_vec3){1.0, 1.0, 1.0}, PL_QUAT_IDENTITY, none);
  assert_int_equal(pl_rock_scan_create(&model, &round), PL_OK);
  model = ellipsoid((pl_vec3){1.0, 0.9, 0.3}, PL_QUAT_IDENTITY, none);
  assert_int_equal(pl_rock_scan_create(&model, &flat), PL_OK);
  model = ellipsoid((pl_vec3){1.0, 0.1, 0.1}, PL_QUAT_IDENTITY, none);
  assert_int_equal(pl_rock_scan_create(&model, &needle), PL_OK);
  const pl_rock_scan *lists[] = {&round, &flat, &needle};
  pl_rock_variant *all[2], *refused;
  pl_rock_meshes meshes = {0};
  pl_rock_mesh *made[2], *again;
  for (int k = 0; k < 2; k++) {
    assert_int_equal(pl_rock_variants_create(spheres, &lists[k], 1, &all[k]), PL_OK);
    const pl_rock_variant *variant = &all[k][PL_ROCK_MODEL * PL_ROCK_VARIANTS];
    assert_int_equal(pl_rock_meshes_add(&meshes, variant, 3, &made[k]), PL_OK);
    assert_int_equal(pl_rock_mesh_fill(made[k], &meshes, variant), PL_OK);
    assert_int_equal(pl_rock_meshes_add(&meshes, variant, 3, &again), PL_OK);
    assert_ptr_equal(again, made[k]);
  }
  const double *scale = all[0][PL_ROCK_MODEL * PL_ROCK_VARIANTS].scale;
  assert_true(fabs(scale[1] - 1.04) < 0.005); /* a quarter of the surface of the ball's mesh */
  assert_true(scale[3] > 1.0 && scale[3] < 1.004 && scale[PL_ROCK_LODS - 1] == 1.0);
  assert_true(fabs((double)made[0]->high[2] - 1.0) < 1e-2);
  assert_true(fabs((double)made[1]->high[2] - 0.3) < 1e-2);
  pl_rock_meshes_drop(&meshes, 1);
  const pl_rock_variant *first = &all[0][PL_ROCK_MODEL * PL_ROCK_VARIANTS];
  assert_int_equal(pl_rock_meshes_add(&meshes, first, 3, &again), PL_OK);
  assert_ptr_equal(again, made[0]);
  pl_rock_meshes_clear(&meshes);
  assert_int_equal(pl_rock_variants_create(spheres, &lists[2], 1, &refused), PL_E_RANGE);
  assert_non_null(strstr(pl_error_text(), "too long for its width"));
  assert_null(refused);
  for (int k = 0; k < 2; k++)
    pl_free(all[k]);
  pl_rock_scan_clear(&round);
  pl_rock_scan_clear(&flat);
  pl_rock_scan_clear(&needle);
}

int main(void) {
  const struct CMUnitTest tests[] = {cmocka_unit_test(test_ellipsoids),
                                     cmocka_unit_test(test_folds), cmocka_unit_test(test_refused),
                                     cmocka_unit_test(test_variants)};
  return cmocka_run_group_tests(tests, open_spheres, close_spheres);
}
