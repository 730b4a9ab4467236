/* Channels of the ground from a map of points: hazards beside a list of rocks, other channels where
 * nothing is seen, what workers keep, errors. */
#include "harness.h"

#include <string.h>

#include "annotate/ground_map.h"
#include "base/memory.h"
#include "frame/frame.h"
#include "random.h"
#include "terrain/rock_field.h"

enum { WIDTH = 21, HEIGHT = 13, PIXELS = WIDTH * HEIGHT };
static const double RADIUS_M = 1737400.0;

typedef struct world {
  pl_rock_field *rocks;
  pl_terrain *terrain;
  pl_body body;
  pl_body_state state;
  pl_shot_body shot_body;
  pl_snapshot shot;
  pl_ground_settings settings;
  pl_ground_point points[PIXELS];
  pl_rock_memo memos[PL_ROCK_MEMOS];
  float sobel[PIXELS], laplacian[PIXELS], slope[PIXELS], rms[PIXELS];
  uint8_t hazard[PIXELS];
  void *channels[PL_FRAME_CHANNELS_MAX];
  pl_ground_map map;
} world;

static void ask(world *w, const char *name, void *image) {
  for (size_t i = 0; i < pl_channel_count; i++)
    if (strcmp(pl_channels[i].name, name) == 0)
      w->channels[i] = image;
}

/* Points 0.7 m apart on the sphere about a place; the last column sees nothing. */
static void lay_points(world *w, pl_vec3 up) {
  pl_vec3 east, north;
  pl_ground_axes(up, &east, &north);
  for (int y = 0; y < HEIGHT; y++)
    for (int x = 0; x < WIDTH; x++) {
      const pl_vec3 along = pl_vec3_madd(up, 0.7 * (x - 10) / RADIUS_M, east);
      const pl_vec3 at = pl_vec3_unit(pl_vec3_madd(along, 0.7 * (y - 6) / RADIUS_M, north));
      w->points[y * WIDTH + x] = (pl_ground_point){.position = pl_vec3_scale(at, RADIUS_M),
                                                   .body = x < WIDTH - 1 ? 0 : -1};
    }
}

static void world_init(world *w, uint64_t seed) {
  test_random random = {.seed = seed};
  pl_rock_frame rocks = pl_rock_frame_default(RADIUS_M);
  pl_terrain_frame ground = {.radii_m = {RADIUS_M, RADIUS_M, RADIUS_M},
                             .detail = pl_terrain_detail_default(RADIUS_M)};
  memset(w, 0, sizeof *w);
  rocks.law.factor = 4.0;
  rocks.min_m = 0.1;
  assert_int_equal(pl_rock_field_create(&rocks, &w->rocks), PL_OK);
  ground.rocks = w->rocks;
  assert_int_equal(pl_terrain_create(&ground, &w->terrain), PL_OK);
  w->body.terrain = w->terrain;
  w->state.radii_m = ground.radii_m;
  w->shot_body = (pl_shot_body){.body = &w->body, .state = &w->state};
  w->shot = (pl_snapshot){.bodies = &w->shot_body, .body_count = 1};
  w->shot.rays.camera.width = WIDTH;
  w->shot.rays.camera.height = HEIGHT;
  w->settings = (pl_ground_settings){.baselines_m = {3.0},
                                     .baseline_count = 1,
                                     .disc_points = 16,
                                     .hazard = {2.0, 0.1, 0.02, 0.12}};
  lay_points(w, random_direction(&random));
  ask(w, "slope_sobel", w->sobel);
  ask(w, "roughness_laplacian", w->laplacian);
  ask(w, "slope_baseline", w->slope);
  ask(w, "rms_height", w->rms);
  ask(w, "hazard", w->hazard);
  assert_true(pl_ground_map_init(&w->shot, &w->settings, w->channels, &w->map));
  w->map.points = w->points;
  w->map.memos = w->memos;
}

static void world_clear(world *w) {
  pl_terrain_destroy(w->terrain);
  pl_rock_field_destroy(w->rocks);
}

static void write_all(world *w) {
  assert_int_equal(pl_ground_map_check(&w->map), PL_OK);
  for (int y = 0; y < HEIGHT; y += PL_GROUND_ROWS)
    assert_int_equal(pl_ground_map_write(
                         &w->map, y, y + PL_GROUND_ROWS < HEIGHT ? y + PL_GROUND_ROWS : HEIGHT, 0),
                     PL_OK);
}

/* Whether a rock above the limit touches the footprint about a point. */
static bool touched(const world *w, const pl_rock *rocks, size_t count, pl_vec3 at) {
  const pl_hazard_limits *limits = &w->settings.hazard;
  for (size_t k = 0; k < count; k++)
    if (rocks[k].height_m > limits->rock_m &&
        RADIUS_M * pl_vec3_norm(pl_vec3_sub(rocks[k].direction, at)) <
            0.5 * (limits->footprint_m + rocks[k].diameter_m))
      return true;
  return false;
}

static void test_hazards_beside_a_list(void **state) {
  (void)state;
  static world w;
  size_t rocky = 0;
  for (uint64_t seed = 31; seed < 34; seed++) {
    pl_plane_fit fit;
    pl_rock *rocks;
    size_t count;
    world_init(&w, seed);
    write_all(&w);
    const pl_vec3 middle = pl_vec3_unit(w.points[PIXELS / 2].position);
    assert_int_equal(pl_rock_list(w.rocks, w.terrain, middle, 40.0, 0.0, 1e9, &rocks, &count),
                     PL_OK);
    for (size_t i = 0; i < PIXELS; i++) {
      const pl_vec3 at = pl_vec3_unit(w.points[i].position);
      pl_plane_fits(w.terrain, &w.map.disc, &at, 1, w.settings.hazard.footprint_m, &fit);
      const int expected = (fit.slope_rad > 0.1 ? PL_HAZARD_SLOPE : 0) |
                           (fit.rms_m > 0.02 ? PL_HAZARD_ROUGH : 0) |
                           (touched(&w, rocks, count, at) ? PL_HAZARD_ROCK : 0);
      assert_int_equal(w.hazard[i], w.points[i].body < 0 ? PL_HAZARD_UNKNOWN : expected);
      rocky += w.points[i].body == 0 && (expected & PL_HAZARD_ROCK) != 0;
    }
    pl_free(rocks);
    world_clear(&w);
  }
  print_message("%zu points touch rocks\n", rocky);
  assert_true(rocky > 20);
}

/* With what the worker kept from before, and without. */
static void test_memory_of_workers_does_not_matter(void **state) {
  (void)state;
  static world w;
  uint8_t before[PIXELS];
  world_init(&w, 31);
  write_all(&w);
  memcpy(before, w.hazard, sizeof before);
  write_all(&w);
  assert_memory_equal(before, w.hazard, sizeof before);
  memset(w.memos, 0, sizeof w.memos);
  write_all(&w);
  assert_memory_equal(before, w.hazard, sizeof before);
  world_clear(&w);
}

static void test_what_is_not_seen(void **state) {
  (void)state;
  static world w;
  world_init(&w, 35);
  write_all(&w);
  for (int y = 0; y < HEIGHT; y++)
    for (int x = 0; x < WIDTH; x++) {
      const int i = y * WIDTH + x;
      const bool inner = x > 0 && x < WIDTH - 2 && y > 0 && y < HEIGHT - 1;
      assert_true(isnan(w.slope[i]) == (x == WIDTH - 1) && isnan(w.rms[i]) == (x == WIDTH - 1));
      assert_true(isnan(w.sobel[i]) == !inner && isnan(w.laplacian[i]) == !inner);
    }
  world_clear(&w);
}

static void refuse(world *w, const char *word) {
  const pl_status status = pl_ground_map_check(&w->map);
  assert_true(status == PL_E_RANGE || status == PL_E_ARGUMENT);
  assert_non_null(strstr(pl_error_text(), word));
}

static void test_errors(void **state) {
  (void)state;
  static world w;
  world_init(&w, 36);
  const pl_ground_settings good = w.settings;
  w.settings.baseline_count = 0;
  refuse(&w, "baseline");
  w.settings = good;
  w.settings.baselines_m[0] = -1.0;
  refuse(&w, "baseline of -1");
  w.settings = good;
  w.settings.disc_points = 3;
  refuse(&w, "3 points");
  w.settings = good;
  w.settings.hazard.footprint_m = 0.0;
  refuse(&w, "footprint");
  w.settings = good;
  w.settings.hazard.rms_m = -0.5;
  refuse(&w, "-0.5");
  world_clear(&w);
}

int main(void) {
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(test_hazards_beside_a_list),
      cmocka_unit_test(test_memory_of_workers_does_not_matter),
      cmocka_unit_test(test_what_is_not_seen),
      cmocka_unit_test(test_errors),
  };
  return cmocka_run_group_tests(tests, NULL, NULL);
}
