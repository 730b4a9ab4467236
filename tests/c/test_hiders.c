/* What may hide an object, found by trees: the same as by trying every pair, in a number of steps
 * that grows in proportion to the number of objects. */
#include "harness.h"

#include "annotate/hiders.h"
#include "random.h"

enum { MOST = 3200, BODIES = 400 };

typedef struct crowd {
  pl_snapshot shot;
  pl_shot_object objects[MOST];
  pl_shot_body bodies[BODIES];
  pl_outline outlines[MOST];
} crowd;

/* As dense for any number: every rectangle meets a few others. */
static void place(test_random *random, size_t objects, size_t bodies, crowd *c) {
  const double side = 60.0 * sqrt((double)objects);
  c->shot = (pl_snapshot){
      .objects = c->objects, .object_count = objects, .bodies = c->bodies, .body_count = bodies};
  for (size_t i = 0; i < objects; i++) {
    const double z = random_range(random, 100, 1000), r = random_scale(random, 0.01, 0.1);
    const int x = (int)random_range(random, 0, side), y = (int)random_range(random, 0, side);
    const int w = (int)random_below(random, 60), h = (int)random_below(random, 60);
    c->objects[i] = (pl_shot_object){
        .center = pl_vec3_scale(random_direction(random), z), .radius_m = r, .in_frame = true};
    c->outlines[i] =
        (pl_outline){.rect = {x, y, x + w, y + h}, .z0_m = z - r, .z1_m = z + r, .far_m = z + r};
    if (random_below(random, 20) == 0)
      c->outlines[i].rect = (pl_rect){0, 0, -1, -1};
  }
  for (size_t i = 0; i < bodies; i++) {
    const double r = random_scale(random, 0.1, 2.0);
    c->bodies[i] = (pl_shot_body){
        .center = pl_vec3_scale(random_direction(random), random_range(random, 50, 1000)),
        .radius_m = r,
        .outer_m = 1.5 * r,
        .in_frame = random_below(random, 4) > 0};
  }
}

static bool by_pairs(const crowd *c, size_t index) {
  const pl_outline *own = &c->outlines[index];
  const pl_shot_object *object = &c->objects[index];
  bool any = false;
  for (size_t i = 0; i < c->shot.object_count; i++) {
    const pl_outline *o = &c->outlines[i];
    any |= i != index && o->z0_m <= own->z1_m && o->rect.x0 <= own->rect.x1 &&
           o->rect.x1 >= own->rect.x0 && o->rect.y0 <= own->rect.y1 && o->rect.y1 >= own->rect.y0;
  }
  for (size_t i = 0; i < c->shot.body_count; i++) {
    const pl_shot_body *body = &c->bodies[i];
    const double away = pl_vec3_norm(object->center);
    any |= body->in_frame && pl_vec3_norm(body->center) - body->outer_m <= own->far_m &&
           pl_sphere_in_cone(body->center, body->outer_m, pl_vec3_unit(object->center),
                             asin(object->radius_m / away) + 1e-6);
  }
  return any;
}

static size_t compare(test_random *random, size_t objects, size_t bodies, crowd *c) {
  pl_arena arena;
  pl_hiders hiders;
  size_t hidden = 0;
  pl_arena_init(&arena);
  place(random, objects, bodies, c);
  assert_int_equal(pl_hiders_build(&c->shot, c->outlines, &arena, &hiders), PL_OK);
  for (size_t i = 0; i < objects; i++) {
    const bool found = pl_hiders_any(&hiders, i);
    hidden += found;
    assert_true(found == by_pairs(c, i));
  }
  print_message("%zu objects, %zu bodies: %zu may be hidden, %zu steps\n", objects, bodies, hidden,
                hiders.steps);
  assert_true(hidden > objects / 20 && hidden < objects - objects / 20);
  pl_arena_clear(&arena);
  return hiders.steps;
}

static void test_same_as_pairs_in_fewer_steps(void **state) {
  static crowd c;
  (void)state;
  test_random random = {.seed = 90};
  print_message("seed 90\n");
  compare(&random, 40, 0, &c);
  compare(&random, 300, BODIES, &c);
  const size_t few = compare(&random, MOST / 10, BODIES / 10, &c);
  const size_t many = compare(&random, MOST, BODIES, &c);
  assert_true(many < 25 * few); /* by pairs it is a hundred times as many */
}

int main(void) {
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(test_same_as_pairs_in_fewer_steps),
  };
  return cmocka_run_group_tests(tests, NULL, NULL);
}
