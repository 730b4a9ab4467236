/* Sunlight by way of a flat mirror on a plate: a second sun; the density of draws; what the table
 * leaves out; noise, which falls with samples, and far below that of meeting the sun by chance. */
#include "harness.h"

#include "frames.h"
#include "graphs.h"
#include "jointed.h"
#include "math/sampler.h"
#include "render/caustics.h"
#include "render/geometry.h"
#include "scene/shot_frame.h"
#include "shade/reflectance.h"

static const double AU = 149597870700.0, SOLAR = 1361.0;
enum { SIDE = 8, PIXELS = SIDE * SIDE };

/* The plate faces the camera at the origin, with the sun behind it; the mirror lies behind the
 * camera and looks along z, too. */
static const pl_vec3 PLATE = {0, 0, 0.05}, SUN = {0.6, 0, 0.8}, MIRROR = {3, 0, -4};
static const double PLATE_HALF = 0.05, MIRROR_HALF = 3.0, ALBEDO = 0.5;

typedef struct world {
  stage s;
  pl_model *plate, *mirror, *screen;
  double tolerance_dn;
} world;

static void world_init(world *w, float roughness) {
  w->plate = square_create(PLATE_HALF);
  w->mirror = square_create(MIRROR_HALF);
  w->screen = NULL;
  w->tolerance_dn = 0.0;
  w->plate->materials[0].lambert = true;
  for (int k = 0; k < 3; k++) {
    w->plate->materials[0].base_color[k] = (float)ALBEDO;
    w->mirror->materials[0].base_color[k] = 1.0f;
  }
  w->mirror->materials[0].metallic = 1.0f;
  w->mirror->materials[0].roughness = roughness;
  stage_init(&w->s, SIDE, SIDE, 40.0);
  w->s.placement.sun.position_m = pl_vec3_scale(SUN, AU);
  stage_add_object(&w->s, w->plate, PLATE, PL_QUAT_IDENTITY, 1.0);
}

static void world_add_mirror(world *w, pl_quat turn) {
  stage_add_object(&w->s, w->mirror, MIRROR, turn, 1.0);
}

static void world_clear(world *w) {
  stage_clear(&w->s);
  pl_model_destroy(w->plate);
  pl_model_destroy(w->mirror);
  pl_model_destroy(w->screen);
}

/* Irradiance of the plate over the sun's: mean, and the deviation of one pixel. */
typedef struct found {
  double mean, deviation;
} found;

static found rendered(const world *w, int samples, bool table, int threads, film *keep) {
  film f;
  pl_renderer *renderer;
  film_init(&f, &w->s);
  pl_frame_request request = request_all(&w->s, &f);
  request.samples = samples;
  request.max_bounces = 1;
  request.threads = threads;
  request.wish = (pl_plan_wish){.tolerance_dn = w->tolerance_dn,
                                .force_off = table ? no_effects() : one_effect("caustics")};
  assert_int_equal(pl_renderer_create(&w->s.scene, &renderer), PL_OK);
  render(renderer, &request);
  found out = {0.0, 0.0};
  for (int i = 0; i < PIXELS; i++) {
    const double x = (double)f.radiance[3 * i + 1] * PL_PI / ALBEDO / SOLAR;
    out.mean += x / PIXELS;
    out.deviation += x * x / PIXELS;
  }
  out.deviation = sqrt(fmax(out.deviation - out.mean * out.mean, 0.0));
  pl_renderer_destroy(renderer);
  if (keep != NULL)
    *keep = f;
  else
    film_clear(&f);
  return out;
}

/* --- light ------------------------------------------------------------------------------------ */

/* A mirror that loses nothing shows a second sun: its irradiance counts by the cosine, 0.8. Of a
 * rough one some of the lobe passes beside the plate's view of the mirror. */
static void test_second_sun(void **state) {
  (void)state;
  static const struct mirror_case {
    float roughness;
    double tolerance; /* beside the noise */
  } cases[] = {{0.0f, 0.003}, {0.05f, 0.003}, {0.1f, 0.005}, {0.2f, 0.02}};
  for (size_t i = 0; i < sizeof cases / sizeof *cases; i++) {
    world w;
    world_init(&w, cases[i].roughness);
    world_add_mirror(&w, PL_QUAT_IDENTITY);
    const found table = rendered(&w, 1024, true, 1, NULL);
    const found chance = rendered(&w, 1024, false, 1, NULL);
    print_message("roughness %.2f: %.4f +- %.4f of the sun, by chance %.4f +- %.4f; exact 0.8\n",
                  (double)cases[i].roughness, table.mean, table.deviation, chance.mean,
                  chance.deviation);
    const double noise = table.deviation / sqrt(PIXELS);
    assert_true(fabs(table.mean - 0.8) < 0.8 * cases[i].tolerance + 4.0 * noise);
    assert_true(table.deviation < 0.1 * chance.deviation);
    /* The two agree within the noise of the second. A smooth mirror's light is found by chance once
     * or twice a frame or not at all, which says nothing: 0.83 +- 0.10 over 150 frames. */
    assert_true(cases[i].roughness == 0.0f ||
                fabs(chance.mean - table.mean) < 4.0 * chance.deviation / sqrt(PIXELS) + 1e-3);
    world_clear(&w);
  }
}

/* At least as n^-0.4 (by chance it is flat at first). */
static void test_converges(void **state) {
  (void)state;
  world w;
  world_init(&w, 0.1f);
  world_add_mirror(&w, PL_QUAT_IDENTITY);
  const found few = rendered(&w, 4, true, 1, NULL), many = rendered(&w, 1024, true, 1, NULL);
  const double slope = log(many.deviation / few.deviation) / log(256.0);
  print_message("deviation %.4f with 4 samples, %.5f with 1024: n^%.2f\n", few.deviation,
                many.deviation, slope);
  assert_true(slope < -0.4);
  assert_true(few.deviation < 0.5 * few.mean);
  world_clear(&w);
}

/* The table takes a mirror for free and flat. Behind a screen it sends nothing all the same, and a
 * mirror half of which is in the screen's way sends what is met by chance. */
static void test_hidden_mirror(void **state) {
  (void)state;
  for (int half = 0; half < 2; half++) {
    world w;
    world_init(&w, 0.2f);
    world_add_mirror(&w, PL_QUAT_IDENTITY);
    w.screen = square_create(1.0);
    w.screen->materials[0].lambert = true;
    for (int k = 0; k < 3; k++)
      w.screen->materials[0].base_color[k] = 0.0f;
    const double x = 0.5 * MIRROR.x + (half ? 1.0 : 0.0);
    stage_add_object(&w.s, w.screen, (pl_vec3){x, 0, 0.5 * MIRROR.z}, PL_QUAT_IDENTITY, 1.0);
    const found table = rendered(&w, 1024, true, 1, NULL);
    const found chance = rendered(&w, 4096, false, 1, NULL);
    const double noise = hypot(table.deviation, chance.deviation) / sqrt(PIXELS);
    print_message("screen: %.5f of the sun, by chance %.5f +- %.5f\n", table.mean, chance.mean,
                  noise);
    assert_true(fabs(table.mean - chance.mean) < 4.0 * noise + 1e-6);
    if (!half)
      assert_true(table.mean < 0.05);
    else
      assert_true(table.mean > 0.1 && table.mean < 0.7);
    world_clear(&w);
  }
}

/* Edges of the light stay sharp where pixels share what they find: at a tolerance errors fall on.
 */
static void test_edges(void **state) {
  (void)state;
  world w;
  film exact, film;
  double square = 0.0;
  world_init(&w, 0.1f);
  world_add_mirror(&w, PL_QUAT_IDENTITY);
  w.screen = square_create(1.0);
  w.screen->materials[0].lambert = true;
  for (int k = 0; k < 3; k++)
    w.screen->materials[0].base_color[k] = 0.0f;
  /* Its shadow's edge crosses the plate. */
  const pl_vec3 near = pl_vec3_madd(PLATE, 0.02, (pl_vec3){0.6, 0, -0.8});
  stage_add_object(&w.s, w.screen, pl_vec3_add(near, (pl_vec3){1.0, 0, 0}), PL_QUAT_IDENTITY, 1.0);
  const found whole = rendered(&w, 4096, true, 1, &exact);
  w.tolerance_dn = 1.0;
  rendered(&w, 256, true, 1, &film);
  for (int i = 0; i < 3 * PIXELS; i++)
    square += pow((double)(film.radiance[i] - exact.radiance[i]), 2.0) / (3 * PIXELS);
  const double error = sqrt(square) * PL_PI / ALBEDO / SOLAR;
  print_message("edge: %.3f +- %.3f of the sun, off by %.4f\n", whole.mean, whole.deviation, error);
  assert_true(whole.deviation > 0.2);
  assert_true(error < 0.03);
  film_clear(&exact);
  film_clear(&film);
  world_clear(&w);
}

static void test_same_bits(void **state) {
  (void)state;
  world w;
  film a, b;
  world_init(&w, 0.1f);
  world_add_mirror(&w, PL_QUAT_IDENTITY);
  rendered(&w, 16, true, 1, &a);
  rendered(&w, 16, true, 3, &b);
  assert_memory_equal(a.memory, b.memory, a.bytes);
  film_clear(&a);
  film_clear(&b);
  world_clear(&w);
}

/* --- the table -------------------------------------------------------------------------------- */

static void build(const world *w, pl_arena *arena, pl_accelerators **kept, pl_snapshot *shot,
                  pl_caustics *out) {
  pl_arena_init(arena);
  assert_int_equal(pl_snapshot_build(&w->s.scene, &w->s.placement, arena, shot), PL_OK);
  const pl_tracer *tracer;
  assert_int_equal(pl_accelerators_create(kept), PL_OK);
  assert_int_equal(pl_geometry_tracer(*kept, shot, arena, &tracer), PL_OK);
  pl_caustics_build(shot, tracer, PL_DETAIL_FULL, out);
}

static size_t count_mirrors(const world *w) {
  pl_arena arena;
  pl_accelerators *kept;
  pl_snapshot shot;
  pl_caustics caustics;
  build(w, &arena, &kept, &shot, &caustics);
  pl_accelerators_destroy(kept);
  pl_arena_clear(&arena);
  return caustics.count;
}

/* What is rough, lies in shadow, or throws its light beside everything, is not in it. */
static void test_table(void **state) {
  (void)state;
  static const struct table_case {
    float roughness;
    double turn_rad;
    bool shaded;
    size_t count;
  } cases[] = {{0.1f, 0.0, false, 1},
               {0.38f, 0.0, false, 1},
               {0.6f, 0.0, false, 0},
               {0.1f, 0.6, false, 0},
               {0.1f, 0.0, true, 0}};
  for (size_t i = 0; i < sizeof cases / sizeof *cases; i++) {
    world w;
    world_init(&w, cases[i].roughness);
    world_add_mirror(&w, pl_quat_axis_angle((pl_vec3){0, 1, 0}, cases[i].turn_rad));
    if (cases[i].shaded) {
      w.screen = square_create(20.0);
      w.screen->materials[0].lambert = true;
      stage_add_object(&w.s, w.screen, pl_vec3_madd(MIRROR, 60.0, SUN), PL_QUAT_IDENTITY, 1.0);
    }
    assert_int_equal(count_mirrors(&w), cases[i].count);
    world_clear(&w);
  }
}

static pl_graph *crumpled(float depth_m) {
  test_graph g = {.count = 0};
  pl_graph *graph;
  const size_t where = graph_add(&g, "coordinates"), noise = graph_add(&g, "noise");
  const size_t bump = graph_add(&g, "bump"), skin = graph_add(&g, "principled");
  graph_link(&g, noise, "vector", where, 0);
  graph_set(&g, noise, "scale", 20.0f, 20.0f, 20.0f);
  graph_link(&g, bump, "height", noise, 0);
  graph_set(&g, bump, "distance_m", depth_m, depth_m, depth_m);
  graph_link(&g, skin, "normal", bump, 0);
  graph_set(&g, skin, "metallic", 1.0f, 1.0f, 1.0f);
  graph_set(&g, skin, "roughness", 0.1f, 0.1f, 0.1f);
  assert_int_equal(graph_make(&g, &graph), PL_OK);
  return graph;
}

/* Crumpled foil has no image of the sun to draw to, however smooth it is at each point. */
static void test_bumps_count_as_roughness(void **state) {
  (void)state;
  static const int32_t everywhere[] = {0, 0};
  static const struct bumps_case {
    float depth_m;
    size_t count;
  } cases[] = {{1e-4f, 1}, {0.05f, 0}};
  for (size_t i = 0; i < sizeof cases / sizeof *cases; i++) {
    world w;
    world_init(&w, 0.1f);
    world_add_mirror(&w, PL_QUAT_IDENTITY);
    pl_graph *graph = crumpled(cases[i].depth_m);
    const pl_graph *all = graph;
    assert_int_equal(pl_scene_set_materials(&w.s.scene, 1, &all, 1, everywhere), PL_OK);
    assert_int_equal(count_mirrors(&w), cases[i].count);
    world_clear(&w);
    pl_graph_destroy(graph);
  }
}

/* A mirror that moves on its craft throws its light where it has turned to. */
static void test_moving_part(void **state) {
  (void)state;
  static const cube_node nodes[2] = {
      {.parent = -1, .trs = {{0, 0, 0}, {1, 0, 0, 0}, {1, 1, 1}}, .empty = true},
      {.parent = 0, .trs = {{0, 0, 0}, {1, 0, 0, 0}, {1, 1, 1}}}};
  static const int moving[1] = {1};
  const pl_quat tilt = pl_quat_axis_angle((pl_vec3){0, 1, 0}, 0.6);
  const pl_quat back = pl_quat_axis_angle((pl_vec3){0, 1, 0}, -0.6);
  for (int turned = 0; turned < 2; turned++) {
    world w;
    world_init(&w, 0.1f);
    w.screen = jointed_create(nodes, 2, MIRROR_HALF);
    pl_free(w.screen->materials[0].name);
    w.screen->materials[0] = w.mirror->materials[0];
    w.screen->materials[0].name = pl_strdup("mirror");
    pl_affine motion = PL_AFFINE_IDENTITY;
    if (turned)
      motion.m = pl_mat3_from_quat(back);
    const pl_vec3 below = pl_vec3_madd(MIRROR, -MIRROR_HALF, (pl_vec3){0, 0, 1});
    stage_add_object(&w.s, w.screen, below, tilt, 1.0);
    assert_int_equal(pl_scene_articulate(&w.s.scene, 1, moving, 1), PL_OK);
    w.s.objects[1].movers = &motion;
    assert_int_equal(count_mirrors(&w), turned);
    const found table = rendered(&w, 256, true, 1, NULL);
    print_message("moving part: %.4f of the sun\n", table.mean);
    assert_true(turned ? fabs(table.mean - 0.8) < 0.01 : table.mean < 0.01);
    world_clear(&w);
  }
}

/* --- draws ------------------------------------------------------------------------------------ */

/* Draws from points beside and within the beam: the mean of a function over its density is its
 * integral over the directions that can be drawn. */
static void test_density(void **state) {
  (void)state;
  enum { DRAWS = 200000 };
  static const pl_vec3 places[] = {{0, 0, 0}, {0.9, 0.2, -2}, {4.2, 0, 0}, {0, 0, 30}};
  world w;
  pl_arena arena;
  pl_accelerators *kept;
  pl_snapshot shot;
  pl_caustics caustics;
  world_init(&w, 0.2f);
  world_add_mirror(&w, PL_QUAT_IDENTITY);
  build(&w, &arena, &kept, &shot, &caustics);
  assert_int_equal(caustics.count, 1);
  const pl_caustic_mirror *m = &caustics.mirrors[0];
  for (size_t i = 0; i < sizeof places / sizeof *places; i++) {
    pl_vertex vertex = {.position = places[i]};
    pl_caustic_draws draws;
    vertex.surface = (pl_surface){.color = {0.5f, 0.5f, 0.5f},
                                  .reflectance = &pl_reflectance_lambert,
                                  .ng = {0.0f, 0.0f, -1.0f}};
    pl_surface_set_frame(&vertex.surface, vertex.surface.ng, (pl_vec3f){1, 0, 0}, 1.0f);
    assert_true(pl_caustics_at(&caustics, &vertex, (pl_vec3f){0, 0, 1}, &draws) > 0.0f);
    assert_int_equal(draws.count, 1);
    /* Of all draws one in a cone about the image of the sun, of so many alphas. */
    for (int wide = 1; wide <= 4; wide *= 4) {
      const float cosine = cosf(2.0f * (float)wide * m->alpha);
      double sum = 0.0;
      for (uint32_t k = 0; k < DRAWS; k++) {
        float u[2], choice[2];
        pl_vec3f direction;
        pl_sample_2d(k, 11, 0, u);
        pl_sample_2d(k, 11, 1, choice);
        if (!pl_caustics_sample(&draws, u, choice[0], &direction))
          continue;
        const float density = pl_caustics_pdf(&draws, direction);
        assert_true(density > 0.0f && isfinite(density));
        assert_float_equal(pl_vec3f_norm(direction), 1.0f, 1e-5);
        sum += pl_vec3f_dot(direction, m->image) > cosine ? 1.0 / (double)density : 0.0;
      }
      const double solid_angle = 2.0 * PL_PI * (1.0 - (double)cosine);
      print_message("place %zu, %d alphas: %.4f of the cone\n", i, wide, sum / DRAWS / solid_angle);
      assert_true(fabs(sum / DRAWS / solid_angle - 1.0) < 0.015 * wide + 0.005);
    }
  }
  pl_accelerators_destroy(kept);
  pl_arena_clear(&arena);
  world_clear(&w);
}

int main(void) {
  const struct CMUnitTest tests[] = {
      converging_unit_test(test_second_sun),
      converging_unit_test(test_converges),
      converging_unit_test(test_hidden_mirror),
      cmocka_unit_test(test_same_bits),
      serial_unit_test(test_table),
      serial_unit_test(test_bumps_count_as_roughness),
      converging_unit_test(test_density),
      serial_unit_test(test_edges),
      serial_unit_test(test_moving_part),
  };
  return cmocka_run_group_tests(tests, NULL, NULL);
}
