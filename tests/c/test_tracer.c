/* The tracer against brute force: every triangle in double, every body by its equation. Rays may
 * run on several threads. */
#include "harness.h"

#include <stdio.h>

#include "base/parallel.h"
#include "geom/ellipsoid.h"
#include "render/geometry.h"
#include "traced.h"

enum { RAYS = 64 };

/* --- brute force ------------------------------------------------------------------------------ */

/* The nearest hits, each with how far the ray passes from the edges of its triangle (of 1) or the
 * rim of its body: rays within `EDGE` of a rim may fall on either side. */
typedef struct truth {
  pl_surface_id surface_id;
  uint32_t triangle;
  double t, next; /* m; `next` of the second nearest surface */
  bool doubtful;
} truth;
static const double EDGE = 1e-4;

static void offer(truth *best, pl_surface_id id, uint32_t triangle, double t) {
  if (t < best->t) {
    best->next = best->t;
    best->surface_id = id;
    best->triangle = triangle;
    best->t = t;
  } else {
    best->next = fmin(best->next, t);
  }
}

static void offer_triangle(truth *best, const pl_shot_object *object, uint32_t i, pl_vec3 origin,
                           pl_vec3 direction, double t_max) {
  const pl_model *model = object->object->model;
  pl_vec3 corner[3];
  for (int k = 0; k < 3; k++) {
    const pl_vec3 local = model_vertex(model, model->indices[3 * (size_t)i + (size_t)k]);
    corner[k] = pl_vec3_add(
        object->position,
        pl_mat3_mul_vec(object->rotation,
                        pl_vec3_scale(pl_vec3_sub(local, object->object->offset), object->scale)));
  }
  const pl_vec3 e1 = pl_vec3_sub(corner[1], corner[0]), e2 = pl_vec3_sub(corner[2], corner[0]);
  const pl_vec3 n = pl_vec3_cross(e1, e2);
  const double facing = pl_vec3_dot(n, direction), area2 = pl_vec3_dot(n, n);
  const double t = pl_vec3_dot(n, pl_vec3_sub(corner[0], origin)) / facing;
  const pl_vec3 p = pl_vec3_sub(pl_vec3_madd(origin, t, direction), corner[0]);
  const double u = pl_vec3_dot(pl_vec3_cross(p, e2), n) / area2;
  const double v = pl_vec3_dot(pl_vec3_cross(e1, p), n) / area2;
  const double inside = fmin(fmin(u, v), 1.0 - u - v);
  if (!(t > -EDGE) || t > t_max * (1 + EDGE) || inside < -EDGE)
    return;
  best->doubtful |=
      inside < EDGE || t < EDGE || t > t_max * (1 - EDGE) || fabs(facing) < 1e-3 * sqrt(area2);
  if (inside >= 0.0 && t > 0.0 && t < t_max)
    offer(best, object->id, i, t);
}

static void offer_body(truth *best, const pl_shot_body *body, pl_surface_id id, pl_vec3 origin,
                       pl_vec3 direction, double t_max) {
  const pl_vec3 r = body->state->radii_m;
  const pl_vec3 o = pl_mat3_mul_vec_t(body->rotation, pl_vec3_sub(origin, body->center));
  const pl_vec3 d = pl_mat3_mul_vec_t(body->rotation, direction);
  const pl_vec3 f = {o.x / r.x, o.y / r.y, o.z / r.z}, e = {d.x / r.x, d.y / r.y, d.z / r.z};
  const double a = pl_vec3_dot(e, e), b = -pl_vec3_dot(f, e), c = pl_vec3_dot(f, f) - 1.0;
  const double discriminant = b * b - a * c;
  best->doubtful |= fabs(discriminant) < EDGE * b * b;
  if (discriminant < 0.0)
    return;
  const double root = sqrt(discriminant);
  const double near = (b - root) / a, far = (b + root) / a, t = near > 0.0 ? near : far;
  best->doubtful |= fabs(t) < EDGE || fabs(t - t_max) < EDGE * t_max;
  if (t > 0.0 && t < t_max)
    offer(best, id, 0, t);
}

static truth brute_force(const pl_snapshot *shot, const pl_ray *ray) {
  truth best = {.surface_id = PL_NO_SURFACE, .t = INFINITY, .next = INFINITY};
  const pl_vec3 o = ray->origin, d = ray->direction;
  const double t_max = ray->t_max;
  for (uint32_t i = 0; i < shot->object_count; i++)
    for (uint32_t k = 0;
         shot->objects[i].kept && k < shot->objects[i].object->model->triangle_count; k++)
      offer_triangle(&best, &shot->objects[i], k, o, d, t_max);
  for (uint32_t b = 0; b < shot->body_count; b++)
    if (ray->skip_body != b)
      offer_body(&best, &shot->bodies[b], pl_surface_of_body(b), o, d, t_max);
  best.doubtful |= best.next - best.t < EDGE * (1.0 + best.t);
  return best;
}

/* --- comparison ------------------------------------------------------------------------------- */

static void random_rays(test_random *random, pl_ray *rays) {
  for (int i = 0; i < RAYS; i++) {
    const pl_vec3 o = pl_vec3_scale(random_direction(random), random_range(random, 0.0, 6.0));
    const pl_vec3 target = pl_vec3_scale(random_direction(random), random_range(random, 0.0, 3.0));
    const bool limited = random_unit(random) < 0.3;
    rays[i] = (pl_ray){
        .origin = {o.x, o.y, o.z + 8.0},
        .direction = pl_vec3_unit(pl_vec3_sub(target, o)),
        .t_max = limited ? random_range(random, 0.1, 6.0) : INFINITY,
        .skip_body = random_unit(random) < 0.2 ? 0 : PL_NO_BODY,
    };
  }
}

/* Compares one set of rays in every way of asking; returns how many were compared. */
static int compare(const world *w, const pl_ray *rays, int *hit_count) {
  pl_hit single[RAYS], packet[RAYS];
  bool shadow[RAYS], shadow_packet[RAYS];
  int compared = 0;
  pl_tracer_closest(w->tracer, rays, single, RAYS, false, true);
  pl_tracer_closest(w->tracer, rays, packet, RAYS, true, true);
  pl_tracer_occluded(w->tracer, rays, shadow, RAYS, false);
  pl_tracer_occluded(w->tracer, rays, shadow_packet, RAYS, true);
  for (int i = 0; i < RAYS; i++) {
    const truth expected = brute_force(&w->shot, &rays[i]);
    if (expected.doubtful)
      continue;
    compared++;
    *hit_count += !pl_surface_is_none(expected.surface_id);
    assert_int_equal(single[i].surface_id.value, expected.surface_id.value);
    assert_int_equal(packet[i].surface_id.value, expected.surface_id.value);
    assert_int_equal(shadow[i], !pl_surface_is_none(expected.surface_id));
    assert_int_equal(shadow_packet[i], !pl_surface_is_none(expected.surface_id));
    if (pl_surface_is_none(expected.surface_id))
      continue;
    assert_true(fabs((double)single[i].t - expected.t) < 1e-6 * (20.0 + expected.t));
    assert_true(fabs((double)packet[i].t - expected.t) < 1e-6 * (20.0 + expected.t));
    if (!pl_surface_is_mesh(expected.surface_id))
      continue;
    assert_int_equal(single[i].triangle, expected.triangle);
    assert_int_equal(packet[i].triangle, expected.triangle);
    assert_true(fabsf(single[i].u - packet[i].u) < 1e-3f);
    assert_true(fabsf(single[i].v - packet[i].v) < 1e-3f);
  }
  return compared;
}

static pl_vec3 nearby(test_random *random) {
  const pl_vec3 d = pl_vec3_scale(random_direction(random), random_range(random, 0.0, 2.5));
  return (pl_vec3){d.x, d.y, d.z + 8.0};
}

static void test_random_scenes(void **state) {
  (void)state;
  test_random random = {.seed = 41};
  int compared = 0, hits = 0;
  print_message("seed 41\n");
  for (int round = 0; round < 12; round++) {
    pl_model *models[2] = {soup_create(&random, 40), cube_create(0.7)};
    world w;
    world_init(&w);
    for (int i = 0; i < 5; i++)
      stage_add_object(&w.stage, models[i % 2], nearby(&random), random_rotation(&random),
                       random_range(&random, 0.3, 1.2));
    for (int i = 0; i < round % 3; i++)
      stage_add_body(&w.stage, nearby(&random),
                     (pl_vec3){random_range(&random, 0.2, 1), random_range(&random, 0.2, 1),
                               random_range(&random, 0.2, 1)},
                     0.5f);
    for (int frame = 0; frame < 4; frame++) { /* everything moves; some are left out */
      for (size_t i = 0; i < 5; i++)
        w.stage.objects[i].motion = still(nearby(&random), random_rotation(&random));
      for (size_t i = 0; i < w.stage.scene.body_count; i++)
        w.stage.bodies[i].motion = still(nearby(&random), random_rotation(&random));
      world_set(&w);
      pl_shot_object objects[STAGE_THINGS];
      for (size_t i = 0; i < w.shot.object_count; i++) {
        objects[i] = w.shot.objects[i];
        objects[i].kept = i >= 5 || random_unit(&random) < 0.8;
      }
      w.shot.objects = objects;
      assert_int_equal(pl_geometry_tracer(w.kept, &w.shot, &w.arena, &w.tracer), PL_OK);
      for (int k = 0; k < 12; k++) {
        pl_ray rays[RAYS];
        random_rays(&random, rays);
        compared += compare(&w, rays, &hits);
      }
    }
    world_clear(&w);
    pl_model_destroy(models[0]);
    pl_model_destroy(models[1]);
  }
  print_message("compared %d rays, %d hits\n", compared, hits);
  assert_true(compared > 25000 && hits > 8000);
}

/* Counts that are no multiple of the packet, and none at all. */
static void test_ragged_counts(void **state) {
  (void)state;
  test_random random = {.seed = 42};
  pl_model *model = cube_create(2.0);
  world w;
  world_init(&w);
  stage_add_object(&w.stage, model, (pl_vec3){0, 0, 8}, PL_QUAT_IDENTITY, 1.0);
  world_set(&w);
  pl_ray rays[RAYS];
  random_rays(&random, rays);
  pl_hit all[RAYS];
  pl_tracer_closest(w.tracer, rays, all, RAYS, true, true);
  for (size_t count = 0; count < 20; count++) {
    pl_hit hits[21];
    bool occluded[21];
    hits[count].surface_id.value = 77;
    occluded[count] = true;
    pl_tracer_closest(w.tracer, rays, hits, count, true, true);
    pl_tracer_occluded(w.tracer, rays, occluded, count, true);
    for (size_t i = 0; i < count; i++) {
      assert_int_equal(hits[i].surface_id.value, all[i].surface_id.value);
      assert_int_equal(occluded[i], !pl_surface_is_none(all[i].surface_id));
    }
    assert_int_equal(hits[count].surface_id.value, 77);
    assert_true(occluded[count]);
  }
  pl_tracer_closest(w.tracer, rays, all, RAYS, true, false); /* meshes left out */
  for (int i = 0; i < RAYS; i++)
    assert_true(pl_surface_is_none(all[i].surface_id));
  world_clear(&w);
  pl_model_destroy(model);
}

/* The models of one index change between scenes of one tracer, and objects come and go. */
static void test_models_change(void **state) {
  (void)state;
  test_random random = {.seed = 43};
  pl_model *models[3] = {soup_create(&random, 20), cube_create(0.8), square_create(1.0)};
  world w;
  int hits = 0;
  world_init(&w);
  for (int round = 0; round < 12; round++) {
    stage_clear(&w.stage);
    stage_init(&w.stage, 64, 64, 64.0);
    for (int i = 0; i < (round * 5) % 4; i++)
      stage_add_object(&w.stage, models[(round + i) % 3], nearby(&random), random_rotation(&random),
                       1.0);
    world_set(&w);
    pl_ray rays[RAYS];
    random_rays(&random, rays);
    compare(&w, rays, &hits);
  }
  assert_true(hits > 20);
  world_clear(&w);
  for (int i = 0; i < 3; i++)
    pl_model_destroy(models[i]);
}

/* Nearer of a body and a mesh, to a metre at 1e6 m. */
static void test_order_of_body_and_mesh(void **state) {
  (void)state;
  pl_model *model = square_create(1e5);
  for (int side = -1; side <= 1; side += 2) {
    world w;
    world_init(&w);
    stage_add_object(&w.stage, model, (pl_vec3){0, 0, 1e6 + 2.0 * side}, PL_QUAT_IDENTITY, 1.0);
    stage_add_body(&w.stage, (pl_vec3){0, 0, 2e6}, (pl_vec3){1e6, 1e6, 1e6}, 0.5f);
    world_set(&w);
    const pl_ray ray = {.direction = {0, 0, 1}, .t_max = INFINITY, .skip_body = PL_NO_BODY};
    pl_hit hit;
    pl_tracer_closest(w.tracer, &ray, &hit, 1, true, true);
    assert_int_equal(hit.surface_id.value,
                     side < 0 ? w.shot.objects[0].id.value : pl_surface_of_body(0).value);
    world_clear(&w);
  }
  pl_model_destroy(model);
}

/* The left half of a square is cut out by its colour map's alpha. */
static void test_cut_out(void **state) {
  (void)state;
  pl_model *model = square_create(1.0);
  pl_image image;
  assert_int_equal(pl_image_init(2, 1, 4, &image), PL_OK);
  image.texels[7] = 255;
  model->textures = pl_alloc(1, sizeof *model->textures);
  model->texture_count = 1;
  assert_int_equal(
      pl_texture_create(&image, true, PL_WRAP_CLAMP, PL_WRAP_CLAMP, &model->textures[0]), PL_OK);
  model->materials[0].alpha_mode = PL_ALPHA_MASK;
  model->materials[0].base_color_map.texture = 0;
  model->uvs[0] = pl_alloc(8, sizeof(float));
  const float uvs[8] = {0, 0, 1, 0, 1, 1, 0, 1};
  memcpy(model->uvs[0], uvs, sizeof uvs);
  world w;
  world_init(&w);
  stage_add_object(&w.stage, model, (pl_vec3){0, 0, 5}, PL_QUAT_IDENTITY, 1.0);
  world_set(&w);
  for (int i = 0; i < 2; i++) {
    const pl_ray ray = {.origin = {i == 0 ? -0.8 : 0.8, 0.3, 0},
                        .direction = {0, 0, 1},
                        .t_max = INFINITY,
                        .skip_body = PL_NO_BODY};
    for (int coherent = 0; coherent < 2; coherent++) {
      pl_hit hit;
      bool occluded;
      pl_tracer_closest(w.tracer, &ray, &hit, 1, coherent, true);
      pl_tracer_occluded(w.tracer, &ray, &occluded, 1, coherent);
      assert_int_equal(pl_surface_is_none(hit.surface_id), i == 0);
      assert_int_equal(occluded, i == 1);
    }
  }
  world_clear(&w);
  pl_model_destroy(model);
}

/* A single-sided square is not seen from behind, nor in the way of light that comes from there: a
 * ray towards a light meets it if the light sees it. */
static void test_single_sided(void **state) {
  (void)state;
  pl_model *model = square_create(1.0); /* faces +z */
  model->materials[0].double_sided = false;
  world w;
  world_init(&w);
  stage_add_object(&w.stage, model, (pl_vec3){0, 0, 5}, PL_QUAT_IDENTITY, 1.0);
  world_set(&w);
  for (int front = 0; front < 2; front++) {
    const pl_ray ray = {.origin = {0.3, 0.2, front ? 10 : 0},
                        .direction = {0, 0, front ? -1 : 1},
                        .t_max = INFINITY,
                        .skip_body = PL_NO_BODY};
    for (int coherent = 0; coherent < 2; coherent++) {
      pl_hit hit;
      bool occluded;
      pl_tracer_closest(w.tracer, &ray, &hit, 1, coherent, true);
      pl_tracer_occluded(w.tracer, &ray, &occluded, 1, coherent);
      assert_int_equal(pl_surface_is_none(hit.surface_id), !front);
      assert_int_equal(occluded, !front);
    }
  }
  world_clear(&w);
  pl_model_destroy(model);
}

/* A ray that leaves a mesh passes its backs as far as it says, 5 m away, and fronts only where the
 * normals say that they are backs. */
static void test_leaving(void **state) {
  (void)state;
  pl_model *model = square_create(1.0); /* faces +z */
  world w;
  world_init(&w);
  stage_add_object(&w.stage, model, (pl_vec3){0, 0, 5}, PL_QUAT_IDENTITY, 3.0);
  world_set(&w);
  for (int i = 0; i < 32; i++) {
    const bool front = i & 1, far = i & 2, own = i & 4, turned = i & 16;
    for (int v = 0; v < 4; v++)
      model->normals[3 * v + 2] = turned ? -1.0f : 1.0f;
    const pl_ray ray = {.origin = {0.3, 0.2, front ? 10 : 0},
                        .direction = {0, 0, front ? -1 : 1},
                        .t_max = INFINITY,
                        .skip_body = PL_NO_BODY,
                        .from_surface = own ? w.shot.objects[0].id : PL_NO_SURFACE,
                        .from_triangle = 9,
                        .leaves = far ? 5.1f : 4.9f};
    const bool passes = own && far && (!front || turned);
    pl_hit hit;
    bool occluded;
    pl_tracer_closest(w.tracer, &ray, &hit, 1, i & 8, true);
    pl_tracer_occluded(w.tracer, &ray, &occluded, 1, i & 8);
    assert_int_equal(pl_surface_is_none(hit.surface_id), passes);
    assert_int_equal(occluded, !passes);
  }
  world_clear(&w);
  pl_model_destroy(model);
}

typedef struct shared {
  const world *w;
  const pl_ray *rays;
  pl_hit hits[32][RAYS];
} shared;

static pl_status trace_item(void *context, size_t item, int worker) {
  shared *s = context;
  (void)worker;
  pl_tracer_closest(s->w->tracer, s->rays, s->hits[item], RAYS, item % 2 == 0, true);
  return PL_OK;
}

static void test_threads_agree(void **state) {
  (void)state;
  test_random random = {.seed = 44};
  pl_model *model = soup_create(&random, 200);
  world w;
  world_init(&w);
  stage_add_object(&w.stage, model, (pl_vec3){0, 0, 8}, PL_QUAT_IDENTITY, 2.0);
  stage_add_body(&w.stage, (pl_vec3){0, 0, 9}, (pl_vec3){1, 1, 1}, 0.5f);
  world_set(&w);
  pl_ray rays[RAYS];
  random_rays(&random, rays);
  static shared s;
  s.w = &w;
  s.rays = rays;
  assert_int_equal(pl_parallel_for(4, 32, trace_item, &s, NULL), PL_OK);
  for (size_t i = 2; i < 32; i++)
    for (size_t k = 0; k < RAYS; k++) {
      assert_int_equal(s.hits[i][k].surface_id.value, s.hits[i % 2][k].surface_id.value);
      if (!pl_surface_is_none(s.hits[i][k].surface_id))
        assert_true(s.hits[i][k].t == s.hits[i % 2][k].t);
    }
  world_clear(&w);
  pl_model_destroy(model);
}

int main(void) {
  const struct CMUnitTest tests[] = {
      serial_unit_test(test_random_scenes), serial_unit_test(test_ragged_counts),
      serial_unit_test(test_models_change), serial_unit_test(test_order_of_body_and_mesh),
      serial_unit_test(test_cut_out),       serial_unit_test(test_single_sided),
      serial_unit_test(test_leaving),       cmocka_unit_test(test_threads_agree),
  };
  return cmocka_run_group_tests(tests, NULL, NULL);
}
