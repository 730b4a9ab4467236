/* Patterns seen from ever farther away: the light of a patterned sphere over that of a plain one
 * stays what it was, to half a per cent, while it recedes over four octaves to a disc of eight
 * pixels: maps on bodies and on meshes, from cells of three pixels at first to a fifth of one;
 * nodes that are patterns, from cells that samples resolve to such that have faded. Cells are so
 * many that the half that is seen has the mean of all; waves meet the sphere as rings about its
 * axis, too. */
#include "harness.h"

#include "frames.h"
#include "graphs.h"

enum { SIDE = 136, OCTAVES = PL_DRAWS(4, 2), AROUND = 64, ACROSS = 32 };
static const double FOCAL_PX = 400.0;
static const double NEAR_PX = 64.0; /* radius of the sphere in the first image */
static const double TOLERANCE = PL_DRAWS(0.005, 0.03);

/* Squares of white and black, `cells` around; 8 bits hold both exactly. */
static pl_texture *checker(int width, int height, int cells) {
  pl_image image;
  pl_texture *texture;
  assert_int_equal(pl_image_init(width, height, 1, &image), PL_OK);
  for (int y = 0; y < height; y++)
    for (int x = 0; x < width; x++)
      image.texels[y * width + x] =
          (x * cells / width + y * (cells / 2) / height) % 2 == 0 ? 255 : 0;
  assert_int_equal(pl_texture_create(&image, true, PL_WRAP_REPEAT, PL_WRAP_CLAMP, &texture), PL_OK);
  return texture;
}

/* A sphere of radius 1 as bodies are mapped: u from 0 to 1 eastwards, v downwards. */
static pl_model *sphere_create(void) {
  pl_model *model = model_create((AROUND + 1) * (ACROSS + 1), 2 * AROUND * ACROSS);
  model->uvs[0] = pl_alloc(2 * (AROUND + 1) * (ACROSS + 1), sizeof(float));
  assert_non_null(model->uvs[0]);
  for (size_t y = 0; y <= ACROSS; y++)
    for (size_t x = 0; x <= AROUND; x++) {
      const double lon = 2 * PL_PI * ((double)x / AROUND - 0.5);
      const double lat = PL_PI * (0.5 - (double)y / ACROSS);
      const pl_vec3 p = {cos(lat) * cos(lon), cos(lat) * sin(lon), sin(lat)};
      const size_t v = y * (AROUND + 1) + x;
      model_set_vertex(model, v, p, p);
      model->uvs[0][2 * v] = (float)x / AROUND;
      model->uvs[0][2 * v + 1] = (float)y / ACROSS;
    }
  for (uint32_t y = 0; y < ACROSS; y++)
    for (uint32_t x = 0; x < AROUND; x++) {
      const uint32_t a = y * (AROUND + 1) + x, b = a + AROUND + 1;
      const uint32_t corners[6] = {a, b, b + 1, a, b + 1, a + 1};
      memcpy(model->indices + 6 * (y * AROUND + x), corners, sizeof corners);
    }
  pl_model_measure(model);
  model->materials[0].lambert = true; /* Lambert */
  model->materials[0].base_color[0] = model->materials[0].base_color[1] =
      model->materials[0].base_color[2] = 1.0f;
  return model;
}

/* The sphere turned so that seam and pole are in sight, the sun 40 degrees to the side. */
static void open_stage(stage *s) {
  stage_init(s, SIDE, SIDE, FOCAL_PX);
  s->placement.sun.position_m =
      (pl_vec3){149597870700.0 * sin(0.7), 0.0, -149597870700.0 * cos(0.7)};
}
static pl_quat pose(void) {
  const pl_quat pole = pl_quat_axis_angle((pl_vec3){1, 0, 0}, -2.2);
  return pl_quat_mul(pole, pl_quat_axis_angle((pl_vec3){0, 0, 1}, 1.3));
}

/* Light of the whole image, linear, with the sphere at `octave`: a mean over seeds, more of them
 * where the sphere covers fewer pixels. */
static double flux(stage *s, pl_renderer *renderer, int samples, int octave) {
  const double distance = FOCAL_PX / NEAR_PX * exp2(octave);
  const pl_vec3 at = {0.004 * distance, -0.002 * distance, distance};
  const int seeds = octave > 1 ? 1 << (octave - 1) : 1;
  double sum = 0.0;
  film f;
  film_init(&f, s);
  pl_motion *motion = s->scene.object_count > 0 ? &s->objects[0].motion : &s->bodies[0].motion;
  *motion = still(at, pose());
  for (int seed = 0; seed < seeds; seed++) {
    pl_frame_request request = request_all(s, &f);
    request.seed = (uint64_t)seed;
    request.samples = samples;
    request.max_bounces = 0;
    request.wish = (pl_plan_wish){.tolerance_dn = 0.0};
    render(renderer, &request);
    for (size_t i = 0; i < 3 * SIDE * SIDE; i++)
      sum += (double)f.radiance[i] / seeds;
  }
  film_clear(&f);
  return sum;
}

typedef struct fluxes {
  double octave[OCTAVES + 1];
} fluxes;

static fluxes recede(stage *s, int samples) {
  pl_renderer *renderer;
  fluxes out;
  assert_int_equal(pl_renderer_create(&s->scene, &renderer), PL_OK);
  for (int i = 0; i <= OCTAVES; i++)
    out.octave[i] = flux(s, renderer, samples, i);
  pl_renderer_destroy(renderer);
  return out;
}

/* Largest change of the pattern's light over the plain sphere's. */
static double check(const char *name, const fluxes *pattern, const fluxes *plain) {
  double worst = 0.0;
  print_message("%-16s", name);
  for (int i = 0; i <= OCTAVES; i++) {
    const double ratio =
        pattern->octave[i] / plain->octave[i] / (pattern->octave[0] / plain->octave[0]);
    print_message(" %.4f", ratio);
    worst = fmax(worst, fabs(ratio - 1.0));
  }
  print_message("  worst %.2f %%\n", 100 * worst);
  return worst;
}

static fluxes recede_body(const pl_texture *map) {
  stage s;
  open_stage(&s);
  const size_t body = stage_add_body(&s, (pl_vec3){0, 0, 20}, (pl_vec3){1, 1, 1}, 1.0f);
  s.scene.bodies[body].map = map;
  const fluxes out = recede(&s, PL_DRAWS(64, 16));
  stage_clear(&s);
  return out;
}

static fluxes recede_mesh(const pl_model *model, const pl_graph *graph, int samples) {
  static int32_t everywhere[2 * AROUND * ACROSS] = {0};
  stage s;
  open_stage(&s);
  const size_t object = stage_add_object(&s, model, (pl_vec3){0, 0, 20}, pose(), 1.0);
  if (graph != NULL)
    assert_int_equal(pl_scene_set_materials(&s.scene, object, &graph, 1, everywhere), PL_OK);
  const fluxes out = recede(&s, samples);
  stage_clear(&s);
  return out;
}

static void test_maps_on_bodies(void **state) {
  (void)state;
  const fluxes plain = recede_body(NULL);
  double worst = 0.0;
  static const int sizes[][3] = {
      {1024, 512, 128}, {1000, 501, 100}, {256, 128, 256}, {512, 256, 64}};
  for (int i = 0; i < 4; i += PL_DRAWS(1, 2)) {
    char name[32];
    pl_texture *map = checker(sizes[i][0], sizes[i][1], sizes[i][2]);
    const fluxes mapped = recede_body(map);
    snprintf(name, sizeof name, "body %dx%d/%d", sizes[i][0], sizes[i][1], sizes[i][2]);
    worst = fmax(worst, check(name, &mapped, &plain));
    pl_texture_destroy(map);
  }
  assert_true(worst < TOLERANCE);
}

static void test_maps_on_meshes(void **state) {
  (void)state;
  pl_model *model = sphere_create();
  const fluxes plain = recede_mesh(model, NULL, PL_DRAWS(64, 16));
  model->textures = pl_alloc(1, sizeof(pl_texture *));
  assert_non_null(model->textures);
  model->textures[0] = checker(1024, 512, 128);
  model->texture_count = 1;
  model->materials[0].base_color_map.texture = 0;
  const fluxes mapped = recede_mesh(model, NULL, PL_DRAWS(64, 16));
  assert_true(check("mesh map", &mapped, &plain) < TOLERANCE);
  pl_model_destroy(model);
}

typedef struct row {
  const char *kind;
  size_t output;
  const char *choice, *chosen; /* or NULL */
} row;

static pl_graph *pattern(const row *row) {
  test_graph g = {.count = 0};
  pl_graph *graph;
  const size_t where = graph_add(&g, "coordinates");
  const size_t node = graph_add(&g, row->kind);
  graph_link(&g, node, "vector", where, 0);
  graph_set(&g, node, "scale", 150.0f, 150.0f, 150.0f);
  if (strcmp(row->kind, "panel") == 0) {
    graph_set(&g, node, "length", 1.0f, 1.0f, 1.0f);
    graph_set(&g, node, "height", 1.0f, 1.0f, 1.0f);
    graph_set(&g, node, "gap", 0.2f, 0.2f, 0.2f);
  }
  if (row->choice != NULL)
    graph_choose(&g, node, row->choice, row->chosen);
  const size_t skin = graph_add(&g, "lambert");
  const size_t dim = graph_add(&g, "math"); /* nothing is cut off at 1 */
  graph_choose(&g, dim, "function", "multiply");
  graph_link(&g, dim, "a", node, row->output);
  graph_set(&g, dim, "b", 0.05f, 0.05f, 0.05f);
  graph_link(&g, skin, "base_color", dim, 0);
  assert_int_equal(graph_make(&g, &graph), PL_OK);
  return graph;
}

static void test_patterns(void **state) {
  (void)state;
  static const row rows[] = {
      {"checker", 1, NULL, NULL},
      {"noise", 0, NULL, NULL},
      {"white_noise", 0, NULL, NULL},
      {"musgrave", 0, "fractal", "ridged"},
      {"musgrave", 0, "fractal", "hybrid"},
      {"voronoi", 0, "feature", "first"},
      {"voronoi", 0, "feature", "edge"},
      {"voronoi", 1, NULL, NULL},
      {"brick", 0, NULL, NULL},
      {"brick", 1, NULL, NULL},
      {"panel", 0, NULL, NULL},
      {"panel", 1, NULL, NULL},
      {"wave", 0, "profile", "sine"},
      {"wave", 0, "path", "rings_z"},
  };
  pl_model *model = sphere_create();
  const fluxes plain = recede_mesh(model, NULL, PL_DRAWS(16, 4));
  double worst = 0.0;
  for (size_t i = 0; i < sizeof rows / sizeof rows[0]; i += PL_DRAWS(1, 3)) {
    pl_graph *graph = pattern(&rows[i]);
    const fluxes mapped = recede_mesh(model, graph, PL_DRAWS(16, 4));
    worst =
        fmax(worst, check(rows[i].chosen != NULL ? rows[i].chosen : rows[i].kind, &mapped, &plain));
    pl_graph_destroy(graph);
  }
  pl_model_destroy(model);
  assert_true(worst < TOLERANCE);
}

int main(void) {
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(test_maps_on_bodies),
      cmocka_unit_test(test_maps_on_meshes),
      cmocka_unit_test(test_patterns),
  };
  return cmocka_run_group_tests(tests, NULL, NULL);
}
