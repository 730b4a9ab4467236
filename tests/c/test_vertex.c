/* Secondary rays: the triangle that a ray starts on is not hit again, however coarse the floats. */
#include "harness.h"

#include <stdio.h>

#include "random.h"
#include "render/geometry.h"
#include "render/vertex.h"
#include "scenes.h"

enum { RAYS = 20000 };

static double range(test_random *random, double low, double high) {
  return random_range(random, low, high);
}

/* One tilted triangle of sides of 2e5 units whose corners lie 5e6 units from the model's origin:
 * floats are 0.5 units apart there. */
static pl_model *huge_triangle(void) {
  pl_model *model = model_create(3, 1);
  const pl_vec3 corner = {4.0e6, -2.8e6, 1.6e6};
  const pl_vec3 a = {1.7e5, 0.3e5, 0.9e5}, b = {-0.6e5, 1.9e5, 0.2e5};
  const pl_vec3 n = pl_vec3_unit(pl_vec3_cross(a, b));
  model_set_vertex(model, 0, corner, n);
  model_set_vertex(model, 1, pl_vec3_add(corner, a), n);
  model_set_vertex(model, 2, pl_vec3_add(corner, b), n);
  for (uint32_t i = 0; i < 3; i++)
    model->indices[i] = i;
  pl_model_measure(model);
  return model;
}

/* How many rays from points of the triangle, in all directions and many of them grazing, meet it
 * again; `skip` as pl_vertex_ray makes them, or by the offset alone. Both kinds of query, single
 * rays and packets. */
static size_t count_self_hits(const pl_snapshot *shot, const pl_tracer *tracer, bool skip,
                              test_random *random) {
  enum { BATCH = 20 };
  const pl_model *model = shot->objects[0].object->model;
  size_t found = 0, hits = 0;
  pl_ray rays[BATCH];
  pl_hit again[BATCH];
  bool occluded[BATCH];
  for (int i = 0; i < RAYS; i += BATCH) {
    for (int k = 0; k < BATCH; k++) {
      double u = range(random, 0.05, 0.9), v = range(random, 0.0, 0.95 - u);
      pl_vec3 p = {0, 0, 0};
      const double w[3] = {1.0 - u - v, u, v};
      for (size_t c = 0; c < 3; c++)
        p = pl_vec3_madd(p, w[c], model_vertex(model, c));
      p = pl_vec3_add(
          shot->objects[0].position,
          pl_mat3_mul_vec(shot->objects[0].rotation, pl_vec3_scale(p, shot->objects[0].scale)));
      const pl_beam beam = {.direction = pl_vec3_unit(p)};
      const pl_ray first = {
          .t_max = INFINITY, .direction = beam.direction, .skip_body = PL_NO_BODY};
      pl_hit hit;
      pl_vertex vertex;
      pl_tracer_closest(tracer, &first, &hit, 1, false, true);
      rays[k] = first;
      if (pl_surface_is_none(hit.surface_id))
        continue;
      found++;
      pl_vertex_locate(shot, &beam, &hit, false, &vertex);
      pl_vertex_orient(shot, &beam, &vertex);
      pl_vec3 d = {range(random, -1, 1), range(random, -1, 1), range(random, -1, 1)};
      const pl_vec3 n = pl_vec3f_to_double(vertex.surface.ng);
      d = pl_vec3_madd(d, -pl_vec3_dot(d, n), n);
      d = pl_vec3_madd(pl_vec3_unit(d), pow(10.0, range(random, -5, 0)), n);
      rays[k] = pl_vertex_ray(&vertex, shot, pl_vec3_to_float(pl_vec3_unit(d)), INFINITY);
      if (!skip)
        rays[k].from_triangle = 0;
      pl_tracer_closest(tracer, &rays[k], &hit, 1, false, true);
      hits += !pl_surface_is_none(hit.surface_id);
    }
    for (int k = 0; k < BATCH; k++)
      if (rays[k].origin.x == 0.0 && rays[k].origin.y == 0.0) /* the camera's, which missed */
        rays[k].t_max = 0.0f;
    pl_tracer_occluded(tracer, rays, occluded, BATCH, true);
    pl_tracer_closest(tracer, rays, again, BATCH, true, true);
    for (int k = 0; k < BATCH; k++)
      hits += (size_t)occluded[k] + (size_t)(!pl_surface_is_none(again[k].surface_id));
  }
  assert_true(found > RAYS * 9 / 10);
  return hits;
}

/* Seen from a few tenths of its size away, at scales of 1e-3 to 1e3. */
static void test_own_triangle(void **state) {
  (void)state;
  const double scales[] = {1e-3, 1.0, 1e3};
  size_t without = 0;
  for (int i = 0; i < 3; i++) {
    pl_model *model = huge_triangle();
    stage s;
    pl_arena arena;
    pl_snapshot shot;
    pl_accelerators *kept;
    const pl_tracer *tracer;
    test_random random = {.seed = 41};
    stage_init(&s, 64, 64, 64.0);
    const double scale = scales[i];
    const pl_quat turn = pl_quat_axis_angle((pl_vec3){0.36, 0.48, 0.8}, 1.1);
    pl_vec3 middle = {0, 0, 0};
    for (size_t c = 0; c < 3; c++)
      middle = pl_vec3_madd(middle, scale / 3.0, model_vertex(model, c));
    middle = pl_mat3_mul_vec(pl_mat3_from_quat(turn), middle);
    stage_add_object(&s, model, pl_vec3_sub((pl_vec3){0, 0, 6e4 * scale}, middle), turn, scale);
    pl_arena_init(&arena);
    assert_int_equal(pl_accelerators_create(&kept), PL_OK);
    assert_int_equal(pl_snapshot_build(&s.scene, &s.placement, &arena, &shot), PL_OK);
    assert_int_equal(pl_geometry_tracer(kept, &shot, &arena, &tracer), PL_OK);
    without += count_self_hits(&shot, tracer, false, &random);
    assert_int_equal(count_self_hits(&shot, tracer, true, &random), 0);
    pl_accelerators_destroy(kept);
    pl_arena_clear(&arena);
    stage_clear(&s);
    pl_model_destroy(model);
  }
  print_message("by the offset alone %zu of %d rays hit their own triangle\n", without, 9 * RAYS);
  assert_true(without < RAYS / 100); /* faces beside it are kept off by no more */
}

int main(void) {
  const struct CMUnitTest tests[] = {cmocka_unit_test(test_own_triangle)};
  return cmocka_run_group_tests(tests, NULL, NULL);
}
