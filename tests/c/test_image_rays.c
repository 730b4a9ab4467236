/* The renderer takes rays from a source, not from a grid behind a pinhole: a panorama made up here,
 * all around the camera, shows in each pixel what a pinhole aimed there shows. */
#include "harness.h"

#include "instants.h"
#include "render/vertex.h"

enum { WIDTH = 90, HEIGHT = 45, PIXELS = WIDTH * HEIGHT, EVERY = 3 };

/* Equirectangular: azimuth to the right, elevation upwards, both in equal steps. */
static pl_vec3 panorama_at(const pl_ray_source *source, double u, double v) {
  const double azimuth = ((u + 0.5) / source->camera.width - 0.5) * 2.0 * PL_PI;
  const double elevation = (0.5 - (v + 0.5) / source->camera.height) * PL_PI;
  return pl_ray_angles(azimuth, elevation);
}
static const pl_ray_source_kind panorama = {.name = "panorama", .camera = true, .at = panorama_at};

typedef struct seen {
  pl_surface_id surface_id;
  double t;
  float light;
} seen;

typedef struct picture {
  int width;
  seen pixels[PIXELS];
} picture;

static pl_status take_tile(void *context, const pl_tile_result *result, int worker) {
  picture *out = context;
  (void)worker;
  for (int y = 0; y < result->tile.height; y++)
    for (int x = 0; x < result->tile.width; x++) {
      const int from = y * PL_TILE_SIDE + x;
      const pl_point *point = &result->points[from];
      out->pixels[(result->tile.y0 + y) * out->width + result->tile.x0 + x] =
          (seen){point->surface_id, pl_surface_is_none(point->surface_id) ? 0.0 : point->t,
                 result->radiance[from].y};
    }
  return PL_OK;
}

/* Boxes and balls on all sides, some in the shadow of others. */
static void surround(stage *s, const pl_model *cube) {
  const pl_vec3 places[] = {{0, 0, 9},   {9, 1, 0},   {-9, -2, 1}, {0.4, 1, -9},
                            {1, 9, 0.5}, {-7, -8, 7}, {2, 3, 14},  {-6, 1, 6}};
  for (size_t i = 0; i < sizeof places / sizeof places[0]; i++)
    stage_add_object(s, cube, places[i], pl_quat_axis_angle((pl_vec3){1, 2, 3}, 0.4 * (double)i),
                     1.5);
  stage_add_body(s, (pl_vec3){0, 0, 30}, (pl_vec3){8, 8, 8}, 0.5f);
  stage_add_body(s, (pl_vec3){0, -30, 5}, (pl_vec3){9, 8, 7}, 0.5f);
  stage_add_body(s, (pl_vec3){-20, 4, -20}, (pl_vec3){6, 6, 6}, 0.5f);
}

static void shoot(const pl_instant *instant, const pl_snapshot *shot, pl_render_scratch *scratch,
                  picture *out) {
  pl_render_settings settings = instant->settings;
  out->width = shot->rays.camera.width;
  settings.samples = 1;
  settings.noise_dn = 0.0f;
  settings.exact = true;
  settings.bounces = 0;
  settings.effects.soft_sun = settings.effects.bounces = settings.effects.body_bounces = 0;
  assert_int_equal(pl_render(shot, instant->tracer, &settings, scratch, take_tile, out, NULL),
                   PL_OK);
}

/* A pinhole of one pixel along a direction. */
static pl_snapshot aim(const pl_snapshot *shot, const pl_ray_source_kind *kind, pl_vec3 forward) {
  const pl_vec3 seed = fabs(forward.x) < 0.7 ? (pl_vec3){1, 0, 0} : (pl_vec3){0, 1, 0};
  const pl_vec3 right = pl_vec3_unit(pl_vec3_cross(seed, forward));
  pl_snapshot out = *shot;
  out.camera_to_root =
      pl_mat3_transpose((pl_mat3){{right, pl_vec3_cross(forward, right), forward}});
  out.rays.kind = kind;
  out.rays.camera.width = out.rays.camera.height = 1;
  out.rays.camera.cx = out.rays.camera.cy = 0.0;
  return out;
}

static void compare(const pl_instant *instant, pl_render_scratch *scratch) {
  static picture all, one;
  int meshes = 0, bodies = 0, dark = 0, wrong = 0;
  pl_snapshot shot = instant->shot;
  /* culling marked what the frame's own camera sees, and these look elsewhere */
  pl_ray_source_kind pinhole = pl_ray_source_pixels;
  pinhole.projects = false;
  shot.rays.kind = &panorama;
  shot.rays.camera.width = WIDTH;
  shot.rays.camera.height = HEIGHT;
  shot.rays.camera.fx = shot.rays.camera.fy = WIDTH / (2.0 * PL_PI);
  shoot(instant, &shot, scratch, &all);
  for (int i = 0; i < PIXELS; i += EVERY) {
    const seen *a = &all.pixels[i], *b = &one.pixels[0];
    const pl_snapshot narrow = aim(&shot, &pinhole, pl_snapshot_ray(&shot, i % WIDTH, i / WIDTH));
    shoot(instant, &narrow, scratch, &one);
    const bool none = pl_surface_is_none(a->surface_id);
    meshes += !none && pl_surface_is_mesh(a->surface_id);
    bodies += !none && pl_surface_is_ellipsoid(a->surface_id);
    dark += !none && !(a->light > 0.0f);
    wrong += !pl_surface_same(a->surface_id, b->surface_id) || fabs(a->t - b->t) > 1e-5 * b->t ||
             fabsf(a->light - b->light) > 1e-4f * (1.0f + b->light);
  }
  print_message("%d of meshes, %d of bodies, %d dark; %d of %d differ\n", meshes, bodies, dark,
                wrong, PIXELS / EVERY);
  assert_true(meshes > 100 && bodies > 100 && dark > 50);
  assert_true(wrong <= 2); /* on edges, by rounding */
}

static void test_a_panorama_shows_what_pinholes_show(void **state) {
  (void)state;
  studio s;
  studio_init(&s, 32, 30.0, 1.0);
  surround(&s.stage, s.cube);
  const pl_frame_request request = {.samples = 1, .placement = s.stage.placement};
  pl_survey survey = studio_survey(&s, &request);
  pl_choice choice = studio_choice(&s, &request, &survey, 1);
  choice.culls = false; /* what the frame's own camera does not see is seen here */
  compare(studio_realise(&s, &survey, &choice), s.scratch);
  studio_clear(&s);
}

int main(void) {
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(test_a_panorama_shows_what_pinholes_show),
  };
  return cmocka_run_group_tests(tests, NULL, NULL);
}
