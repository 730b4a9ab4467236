/* Light through solids in frames: a slab's shift, absorption, a glass ball in a white furnace. */
#include "harness.h"

#include "frames.h"

enum { WIDTH = 64, HEIGHT = 8 };
static const double FOCAL = 200.0, GLOW = 100.0, INDEX = 1.5;

static void make_solid(pl_model *model, double index, double roughness) {
  pl_material *m = &model->materials[0];
  m->roughness = (float)roughness;
  for (int k = 0; k < 3; k++)
    m->base_color[k] = 1.0f;
  m->layered = true;
  m->layers = PL_MATERIAL_LAYERS_PLAIN;
  m->layers.transmission = 1.0f;
  m->layers.solid = true;
  m->layers.ior = (float)index;
}

static pl_model *box_create(double half_x, double half_y, double half_z) {
  pl_model *model = cube_create(1.0);
  const double half[3] = {half_x, half_y, half_z};
  for (size_t i = 0; i < 3 * model->vertex_count; i++)
    model->positions[i] *= (float)half[i % 3];
  pl_model_measure(model);
  return model;
}

/* What shines: black but for its light. */
static void make_lamp(pl_model *model) {
  model->materials[0].lambert = true; /* Lambert */
  for (int k = 0; k < 3; k++) {
    model->materials[0].base_color[k] = 0.0f;
    model->materials[0].emissive[k] = (float)GLOW;
  }
}

typedef struct shot {
  stage stage;
  film film;
} shot;

static void take(shot *s, int samples) {
  pl_renderer *renderer;
  s->stage.placement.sun.position_m.y = -1e11; /* not in any mirror */
  film_init(&s->film, &s->stage);
  pl_frame_request request = request_all(&s->stage, &s->film);
  request.samples = samples;
  request.max_bounces = 32;
  request.wish.force_on = two_effects("antialiasing", "bounces");
  assert_int_equal(pl_renderer_create(&s->stage.scene, &renderer), PL_OK);
  const pl_frame_result result = render(renderer, &request);
  assert_int_equal(result.plan.rows[pl_effect_find("transmission")].value, 1);
  pl_renderer_destroy(renderer);
}

static void shot_clear(shot *s) {
  film_clear(&s->film);
  stage_clear(&s->stage);
}

static double radiance(const shot *s, int x, int y, int band) {
  return (double)s->film.radiance[3 * (y * WIDTH + x) + band];
}

/* --- the shift of a slab ---------------------------------------------------------------------- */

static const double SLAB = 0.5, TILT = 0.6, WALL_Z = 6.0; /* thickness and distance m, rad */

/* x at the wall of the ray that leaves the camera at `angle` towards +x, through the slab: a slab
 * of thickness d shifts a ray by d sin(i - t)/cos(t), at right angles to it. */
static double x_at_wall(double angle, double side) {
  const double i = angle - side * TILT, t = asin(sin(i) / INDEX);
  return WALL_Z * tan(angle) - SLAB * sin(i - t) / cos(t) / cos(angle);
}

/* The edge of a lamp at x > 0 appears in the column whose ray comes to x = 0. */
static double column_of_edge(double side) {
  double low = -0.3, high = 0.3;
  for (int k = 0; k < 60; k++) {
    const double middle = 0.5 * (low + high);
    *(x_at_wall(middle, side) < 0.0 ? &low : &high) = middle;
  }
  return 0.5 * (WIDTH - 1) + FOCAL * tan(low);
}

/* Lit columns of the middle rows, in units of those that are lit whole. */
static double lit_columns(const shot *s) {
  enum { WHOLE = 16 };
  double sum = 0.0, lit = 0.0;
  for (int y = 2; y < HEIGHT - 2; y++)
    for (int x = 0; x < WIDTH; x++) {
      sum += radiance(s, x, y, 0) / (HEIGHT - 4);
      lit += x < WIDTH - WHOLE ? 0.0 : radiance(s, x, y, 0) / (HEIGHT - 4) / WHOLE;
    }
  return sum / lit;
}

static void test_slab_shifts(void **state) {
  (void)state;
  pl_model *slab = box_create(4.0, 4.0, 0.5 * SLAB), *lamp = square_create(3.0);
  make_solid(slab, INDEX, 0.0);
  make_lamp(lamp);
  for (int side = -1; side <= 1; side += 2) {
    shot s;
    stage_init(&s.stage, WIDTH, HEIGHT, FOCAL);
    stage_add_object(&s.stage, slab, (pl_vec3){0, 0, 3},
                     pl_quat_axis_angle((pl_vec3){0, 1, 0}, side * TILT), 1.0);
    stage_add_object(&s.stage, lamp, (pl_vec3){3, 0, WALL_Z}, PL_QUAT_IDENTITY, 1.0);
    take(&s, PL_DRAWS(64, 16));
    const double edge = WIDTH - 0.5 - lit_columns(&s), expected = column_of_edge(side);
    print_message("tilted by %+.1f: edge in column %.2f, by Snell %.2f, unshifted %.2f\n",
                  side * TILT, edge, expected, 0.5 * (WIDTH - 1));
    assert_true(fabs(expected - 0.5 * (WIDTH - 1)) > 3.0 &&
                fabs(edge - expected) < PL_DRAWS(0.15, 0.5));
    shot_clear(&s);
  }
  pl_model_destroy(slab);
  pl_model_destroy(lamp);
}

/* --- absorption ------------------------------------------------------------------------------- */

/* Beer and Lambert over the way in the slab, between Fresnel's losses at two boundaries, with what
 * goes to and fro once: at normal incidence, F = 0.04. The object is twice the model's size. */
static void test_absorption(void **state) {
  (void)state;
  pl_model *slab = box_create(2.0, 2.0, 0.25), *lamp = square_create(3.0);
  make_solid(slab, INDEX, 0.0);
  slab->materials[0].layers.extinction[1] = 1.0f;
  slab->materials[0].layers.extinction[2] = 4.0f;
  make_lamp(lamp);
  shot s;
  stage_init(&s.stage, WIDTH, HEIGHT, 2000.0);
  stage_add_object(&s.stage, slab, (pl_vec3){0, 0, 3}, PL_QUAT_IDENTITY, 2.0);
  stage_add_object(&s.stage, lamp, (pl_vec3){0, 0, WALL_Z}, PL_QUAT_IDENTITY, 1.0);
  take(&s, PL_DRAWS(64, 16));
  const double extinction[3] = {0.0, 1.0, 4.0};
  for (int band = 0; band < 3; band++) {
    const double way = exp(-extinction[band] * 0.5), f = 0.04;
    const double expected = GLOW * (1 - f) * (1 - f) * way / (1 - f * f * way * way);
    double mean = 0.0;
    for (int x = 0; x < WIDTH; x++)
      for (int y = 0; y < HEIGHT; y++)
        mean += radiance(&s, x, y, band) / (WIDTH * HEIGHT);
    print_message("band %d: %.3f, expected %.3f\n", band, mean, expected);
    assert_true(fabs(mean / expected - 1.0) < 0.01);
  }
  shot_clear(&s);
  pl_model_destroy(slab);
  pl_model_destroy(lamp);
}

/* --- the furnace ------------------------------------------------------------------------------ */

enum { RINGS = 16, SECTORS = 32 };

static pl_vec3 on_ball(int ring, int sector) {
  const double a = PL_PI * ring / RINGS, b = 2.0 * PL_PI * sector / SECTORS;
  return (pl_vec3){sin(a) * cos(b), sin(a) * sin(b), cos(a)};
}

/* Flat faces, wound outwards; triangles at the poles have no area and are never hit. */
static pl_model *ball_create(void) {
  pl_model *model = model_create(4 * RINGS * SECTORS, 2 * RINGS * SECTORS);
  uint32_t face = 0;
  for (int r = 0; r < RINGS; r++)
    for (int k = 0; k < SECTORS; k++, face++) {
      const pl_vec3 p[4] = {on_ball(r, k), on_ball(r + 1, k), on_ball(r + 1, k + 1),
                            on_ball(r, k + 1)};
      const pl_vec3 n =
          pl_vec3_unit(pl_vec3_cross(pl_vec3_sub(p[2], p[0]), pl_vec3_sub(p[3], p[1])));
      const uint32_t v = 4 * face, order[6] = {v, v + 1, v + 2, v, v + 2, v + 3};
      for (uint32_t c = 0; c < 4; c++)
        model_set_vertex(model, v + c, p[c], n);
      memcpy(model->indices + 6 * face, order, sizeof order);
    }
  pl_model_measure(model);
  return model;
}

/* Inside a room that glows the same everywhere nothing is to be seen of a clear ball. */
static void test_glass_ball_in_a_furnace(void **state) {
  (void)state;
  static const double index[] = {1.5, 2.4, 1.5}, roughness[] = {0.0, 0.0, 0.2};
  pl_model *room = cube_create(10.0), *ball = ball_create();
  make_lamp(room);
  for (int i = 0; i < 3; i++) {
    make_solid(ball, index[i], roughness[i]);
    shot s;
    double mean = 0.0, least = INFINITY;
    stage_init(&s.stage, WIDTH, HEIGHT, 100.0);
    stage_add_object(&s.stage, room, (pl_vec3){0, 0, 0}, PL_QUAT_IDENTITY, 1.0);
    stage_add_object(&s.stage, ball, (pl_vec3){0, 0, 3}, PL_QUAT_IDENTITY, 1.0);
    take(&s, PL_DRAWS(256, 32));
    for (int x = 0; x < WIDTH; x++)
      for (int y = 0; y < HEIGHT; y++) {
        mean += radiance(&s, x, y, 0) / (WIDTH * HEIGHT);
        least = fmin(least, radiance(&s, x, y, 0));
      }
    print_message("index %.1f, roughness %.1f: mean %.3f, least %.2f of %g\n", index[i],
                  roughness[i], mean, least, GLOW);
    /* Noise of a quarter of a per cent, and paths that 32 bounces do not end: up to 0.8 %. */
    assert_true(fabs(mean / GLOW - 1.0) < PL_DRAWS(0.015, 0.03));
    shot_clear(&s);
  }
  pl_model_destroy(room);
  pl_model_destroy(ball);
}

int main(void) {
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(test_slab_shifts),
      cmocka_unit_test(test_absorption),
      cmocka_unit_test(test_glass_ball_in_a_furnace),
  };
  return cmocka_run_group_tests(tests, NULL, NULL);
}
