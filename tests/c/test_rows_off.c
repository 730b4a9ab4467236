/* One small frame with every row on, and one for each of some rows with that row off: the plan
 * obeys, and the image changes. tests/c/rows_off.py runs this program under callgrind and looks up
 * which functions each frame executes after its plan: none of a row that is off. */
#include "harness.h"

#include <stdio.h>

#include "clouds.h"
#include "frames.h"
#include "graphs.h"
#include "terrain/terrain.h"

enum { WIDTH = 24, HEIGHT = 18 };

static const double AU = 149597870700.0;

/* Rows whose code has files or functions of its own, as listed in rows_off.py, and what else must
 * be off for that: light between surfaces keeps Hapke's law, for which cheaper ones are not fit. */
typedef struct row_off {
  const char *name, *with[2];
  enum { STILL, MOVING, GROUND } frame; /* MOVING: and not sharp; GROUND: of terrain alone */
} row_off;
/* clang-format off: a line each */
static const row_off rows[] = {
    {.name = "soft_sun"},
    {.name = "limb_darkening"},
    {.name = "emitters"},
    {.name = "planetshine"},
    {.name = "caustics"},
    {.name = "regolith", .with = {"emitters", "body_bounces"}},
    {.name = "volumes"},
    {.name = "rings"},
    {.name = "clouds", .with = {"volumes", "rings"}}, /* media, too */
    {.name = "relief"},
    {.name = "glint"},
    {.name = "night_lights"},
    {.name = "distortion"},
    {.name = "vignetting"},
    {.name = "lens_flare"},
    {.name = "point_spread"},
    {.name = "filters"},
    {.name = "fixed_pattern"},
    {.name = "smear"},
    {.name = "dark_current"},
    {.name = "defects"},
    {.name = "shot_noise"},
    {.name = "cosmic_rays"},
    {.name = "blooming"},
    {.name = "black_sun"},
    {.name = "read_noise"},
    {.name = "compression"},
    {.name = "depth_of_field", .frame = MOVING},
    {.name = "motion_blur", .with = {"rolling_shutter"}, .frame = MOVING},
    {.name = "rolling_shutter", .with = {"motion_blur"}, .frame = MOVING},
    {.name = "sub_cell_normals", .frame = GROUND},
    {.name = "crater_rays", .frame = GROUND},
};
/* clang-format on */
enum { ROWS = sizeof rows / sizeof *rows };

static pl_sensor flight_sensor(void) {
  return (pl_sensor){.f_number = 4.0,
                     .transmission = 0.9,
                     .shading = {.power = 4.0},
                     .psf = {PL_PSF_GAUSS, 0.7, 0.02, 2.0, 1.4},
                     .flare = {1, {{0.5, 0.1, {0.1, 0.1, 0.1}}}, {0.1, 1.5}},
                     .pixel_m = 5e-6,
                     .mosaic = PL_MOSAIC_RGGB,
                     .quantum_efficiency = {0.5, 0.5, 0.5},
                     .band_share = {0.12, 0.13, 0.14},
                     .wavelength_m = {650e-9, 550e-9, 450e-9},
                     .mixed = true,
                     .mix = {{0.9, 0.1, 0.0}, {0.1, 0.8, 0.1}, {0.0, 0.1, 0.9}},
                     .exposure_s = 1e-3,
                     .prnu = 0.02,
                     .dark_current = 1e6,
                     .dark_nonuniform = 0.3,
                     .hot_pixels = 0.02,
                     .hot_current = 1e8,
                     .dead_pixels = 0.02,
                     .shift_s = 1e-6,
                     .full_well = 40000.0,
                     .drain = 0.5,
                     .reset_s = 1e-5,
                     .ray_flux = 1e12,
                     .ray_electrons_per_m = 8e7,
                     .ray_depth_m = 1e-5,
                     .read_noise = 30.0,
                     .column_noise = 10.0,
                     .gain = 10.0,
                     .black_level = 100.0,
                     .bits = 12,
                     .compression = {50, PL_CHROMA_420}};
}

/* As dense everywhere, which the core does not know. */
static pl_graph *fog_create(void) {
  test_graph g = {0};
  pl_graph *graph;
  const size_t medium = graph_add(&g, "lambert");
  graph_set(&g, medium, "alpha", 0.5f, 0.5f, 0.5f);
  assert_int_equal(graph_make(&g, &graph), PL_OK);
  return graph;
}

/* A ball of fog beside the lamp. */
static pl_volume fog_of(const pl_graph *graph) {
  return (pl_volume){.name = "fog",
                     .bound = &pl_bound_ellipsoid,
                     .size = {1.0, 1.0, 1.0},
                     .local = {{2.5, 0.0, 0.0}, PL_QUAT_IDENTITY},
                     .extinction = {0.5f, 0.5f, 0.5f},
                     .albedo = {1.0f, 1.0f, 1.0f},
                     .graph = graph};
}

static pl_texture *speckle(void) {
  pl_image image;
  pl_texture *texture;
  assert_int_equal(pl_image_init(16, 8, 1, &image), PL_OK);
  for (int i = 0; i < 16 * 8; i++)
    image.texels[i] = (uint8_t)(97 * i % 256);
  assert_int_equal(pl_texture_create(&image, false, PL_WRAP_REPEAT, PL_WRAP_CLAMP, &texture),
                   PL_OK);
  return texture;
}

/* A lamp and its ground before a moon with Hapke's soil; a planet beside that shines on them, and a
 * world with water and lights. */
static void set_scene(stage *s, const pl_model *ground, const pl_model *lamp,
                      const pl_model *mirror, const pl_texture *map) {
  static const double bent[8] = {0.1, 0.02};
  stage_init(s, WIDTH, HEIGHT, 30.0);
  s->placement.sun = (pl_sun){.position_m = {0.05 * AU, 0.02 * AU, -0.08 * AU},
                              .radius_m = 695700e3,
                              .irradiance_au = 13.6,
                              .wavelengths_um = {0.65, 0.55, 0.45}};
  assert_int_equal(pl_lens_init(&pl_lens_models[0], bent, &s->placement.camera.lens), PL_OK);
  stage_add_object(s, ground, (pl_vec3){-4.0, 0, 12.0}, PL_QUAT_IDENTITY, 1.0);
  stage_add_object(s, lamp, (pl_vec3){-4.0, 0.5, 10.0}, PL_QUAT_IDENTITY, 1.0);
  /* Throws sunlight onto the ground: its normal is between the sun and that. */
  const pl_vec3 tilt = pl_vec3_unit((pl_vec3){-0.66, 0.52, 0});
  stage_add_object(s, mirror, (pl_vec3){-4.0, -2.0, 8.0}, pl_quat_axis_angle(tilt, 1.5), 1.0);
  stage_add_body(s, (pl_vec3){-40.0, 0, 0.0}, (pl_vec3){15.0, 15.0, 15.0}, 0.9f);
  const size_t moon = stage_add_body(s, (pl_vec3){6.0, 0, 40.0}, (pl_vec3){15.0, 15.0, 15.0}, 0.3f);
  s->scene.bodies[moon].reflectance = &pl_reflectance_hapke;
  const pl_regolith_band soil = {0.25f, 0.3f, 0.0f, 0.0f, 1.5f, 0.06f, 0.4f, 0.0f};
  for (int band = 0; band < 3; band++)
    s->bodies[moon].regolith.band[band] = soil;
  s->bodies[moon].clouds = overcast(0.5, 2.0f);
  s->bodies[moon].clouds.opacity = 0.2f;
  const size_t sea = stage_add_body(s, (pl_vec3){0, 20.0, 60.0}, (pl_vec3){15.0, 15.0, 15.0}, 0.3f);
  s->scene.bodies[sea].ground =
      (pl_ground){.heights = map, .ocean = true, .water = map, .lights = map};
  s->bodies[sea].ground = (pl_ground_state){
      .height_m = 1.0f, .wind_m_s = 7.0f, .lights = {200.0f, 100.0f, 50.0f}, .towns_m = 10.0f};
}

/* Thin ones about the moon. */
static pl_rings *put_rings(stage *s) {
  const double edges[2] = {17.0, 22.0}, depth = 0.2, albedo[3] = {0.5, 0.5, 0.5};
  pl_rings *rings;
  const pl_rings_settings settings = {
      .count = 1, .edges_m = edges, .depth = &depth, .albedo = albedo};
  assert_int_equal(pl_rings_create(&settings, &rings), PL_OK);
  s->scene.bodies[1].rings = rings;
  return rings;
}

/* The camera turns while rows are read, and focuses behind the lamp. */
static void set_moving(stage *s) {
  pl_camera *camera = &s->placement.camera;
  const pl_quat turned = pl_quat_axis_angle((pl_vec3){0, 1, 0}, 0.05);
  camera->motion.close.q = pl_quat_mul(turned, camera->motion.open.q);
  camera->aperture_m = 0.2;
  camera->focus_per_m = 0.05;
  s->placement.shutter = (pl_shutter){.exposure_s = 0.01, .line_s = 0.001};
}

static pl_effect_set set_of(const row_off *row) {
  pl_effect_set set = row == NULL ? no_effects() : one_effect(row->name);
  for (int i = 0; row != NULL && i < 2 && row->with[i] != NULL; i++)
    add_effect(&set, row->with[i]);
  return set;
}

/* rows_off.py has callgrind dump at the end of this function: it must stay one. */
__attribute__((noinline)) static void rows_off_frame(const stage *s, pl_renderer *renderer,
                                                     const pl_sensor *sensor, const row_off *row,
                                                     int kind, uint16_t *raw, uint8_t *rgb) {
  pl_frame_request request = {
      .seed = 1,
      .placement = s->placement,
      .samples = 1,
      .max_bounces = 1,
      .volume_steps = 4,
      .texture_filter = PL_FILTER_FINEST,
      .wish = {.tolerance_dn = kind == MOVING ? 1.0 : 0.0, .force_off = set_of(row)},
      .exposure = {.white_radiance = 1361.0 / PL_PI},
      .threads = 1,
      .sensor = sensor,
      .raw = raw,
      .sensor_rgb = rgb};
  if (kind != MOVING) /* there the number of instants is the plan's */
    request.wish.force_on = effects_without(all_effects(), request.wish.force_off);
  const pl_frame_result result = render(renderer, &request);
  if (row != NULL)
    assert_int_equal(pl_plan_value(&result.plan, pl_effects[pl_effect_find(row->name)]), 0);
}

/* Renders a frame with all rows, called `name`, and one without each of its rows. */
static void compare_rows(const stage *s, pl_renderer *renderer, const pl_sensor *sensor, int kind,
                         const char *name) {
  static uint16_t raw[2][WIDTH * HEIGHT];
  static uint8_t rgb[2][3 * WIDTH * HEIGHT];
  for (int i = -1; i < ROWS; i++) { /* the first frame has all */
    if (i >= 0 && (int)rows[i].frame != kind)
      continue;
    const int k = i < 0 ? 0 : 1;
    rows_off_frame(s, renderer, sensor, i < 0 ? NULL : &rows[i], kind, raw[k], rgb[k]);
    if (i >= 0 && memcmp(raw[0], raw[1], sizeof raw[0]) == 0 &&
        memcmp(rgb[0], rgb[1], sizeof rgb[0]) == 0)
      fail_msg("%s changes nothing", rows[i].name);
    printf("frame %s\n", i >= 0 ? rows[i].name : name);
  }
}

static void test_rows_that_are_off(void **state) {
  (void)state;
  stage s;
  pl_renderer *renderer;
  pl_model *ground = square_create(3.0), *lamp = square_create(0.5), *mirror = square_create(1.0);
  for (int k = 0; k < 3; k++)
    lamp->materials[0].emissive[k] = 200.0f;
  mirror->materials[0].metallic = 1.0f;
  mirror->materials[0].roughness = 0.1f;
  mirror->materials[0].double_sided = true;
  pl_texture *map = speckle();
  set_scene(&s, ground, lamp, mirror, map);
  pl_graph *graph = fog_create();
  const pl_volume fog = fog_of(graph);
  s.placement.volumes = &fog;
  s.placement.volume_count = 1;
  pl_rings *rings = put_rings(&s);
  const pl_sensor sensor = flight_sensor();
  assert_int_equal(pl_renderer_create(&s.scene, &renderer), PL_OK);
  compare_rows(&s, renderer, &sensor, STILL, "all");
  set_moving(&s);
  compare_rows(&s, renderer, &sensor, MOVING, "moving");
  pl_renderer_destroy(renderer);
  stage_clear(&s);
  pl_graph_destroy(graph);
  pl_model_destroy(ground);
  pl_model_destroy(lamp);
  pl_model_destroy(mirror);
  pl_texture_destroy(map);
  pl_rings_destroy(rings);
}

/* Large craters with rays, and fine detail. */
static pl_terrain *make_ground(double radius_m, pl_crater_field **craters) {
  pl_crater_frame given = pl_crater_frame_default(radius_m);
  given.min_m = 2e3;
  given.max_m = 2e4;
  given.rays = (pl_crater_rays){.brightness = 0.6, .fade_ga = 3.0, .reach = 8.0};
  assert_int_equal(pl_crater_field_create(&given, craters), PL_OK);
  const pl_terrain_frame frame = {.radii_m = {radius_m, radius_m, radius_m},
                                  .detail = pl_terrain_detail_default(radius_m),
                                  .craters = *craters};
  pl_terrain *terrain;
  assert_int_equal(pl_terrain_create(&frame, &terrain), PL_OK);
  return terrain;
}

static void test_rows_of_ground_that_are_off(void **state) {
  (void)state;
  static const double radius_m = 1737400.0;
  stage s;
  pl_renderer *renderer;
  pl_crater_field *craters;
  stage_init(&s, WIDTH, HEIGHT, 40.0);
  s.placement.sun = (pl_sun){.position_m = {0.6 * AU, 0, -0.8 * AU},
                             .radius_m = 695700e3,
                             .irradiance_au = 13.6,
                             .wavelengths_um = {0.65, 0.55, 0.45}};
  const size_t moon = stage_add_body(&s, (pl_vec3){0, 0, radius_m + 5e4},
                                     (pl_vec3){radius_m, radius_m, radius_m}, 0.3f);
  pl_terrain *terrain = make_ground(radius_m, &craters);
  s.scene.bodies[moon].terrain = terrain;
  s.scene.bodies[moon].cells_per_pixel = 0.25;
  s.scene.bodies[moon].finest_cell_m = 100.0;
  const pl_sensor sensor = flight_sensor();
  assert_int_equal(pl_renderer_create(&s.scene, &renderer), PL_OK);
  compare_rows(&s, renderer, &sensor, GROUND, "ground");
  pl_renderer_destroy(renderer);
  stage_clear(&s);
  pl_terrain_destroy(terrain);
  pl_crater_field_destroy(craters);
}

int main(void) {
  const struct CMUnitTest tests[] = {
      serial_unit_test(test_rows_that_are_off),
      serial_unit_test(test_rows_of_ground_that_are_off),
  };
  return cmocka_run_group_tests(tests, NULL, NULL);
}
