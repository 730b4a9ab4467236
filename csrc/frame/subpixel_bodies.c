/* Renders each sub-pixel body in an image of SIDE x SIDE pixels and adds its light to the frame's
 * pixels. */
#include "frame/subpixel_bodies.h"

#include "render/geometry.h"

/* Bodies of a smaller diameter are sub-pixel bodies. Above it, sixteen samples per pixel integrate
 * the light of a disc to within a few hundredths, and better for larger discs. */
static const double DIAMETER_PX = 5.0;
/* Side of the image, and the fraction that the body's bounding sphere fills. Counting its pixels
 * gives the area of a disc to 2e-3. */
enum { SIDE = 2 * PL_TILE_SIDE };
static const double FILLED = 0.97;

/* Returns the distance in pixels between opposite points of a limb of angular radius `angle` about
 * the unit direction `center`, camera axes; infinite if a point has no image. */
static double across_px(const pl_camera *camera, pl_vec3 center, pl_vec3 side, double angle) {
  const pl_vec3 middle = pl_vec3_scale(center, cos(angle));
  double a[2], b[2];
  if (!pl_camera_project(camera, pl_vec3_madd(middle, sin(angle), side), a) ||
      !pl_camera_project(camera, pl_vec3_madd(middle, -sin(angle), side), b))
    return INFINITY;
  return hypot(a[0] - b[0], a[1] - b[1]);
}

/* Returns the surface of a body, or of its shape if it has one. */
static pl_surface_id surface_of(const pl_snapshot *shot, size_t index) {
  const pl_shot_body *body = &shot->bodies[index];
  return body->shape != NULL ? body->shape->id : pl_shot_surface_of(body, index);
}

/* Returns the larger one of the radial and the tangential diameter: off the axis they differ. */
static double diameter_px(const pl_snapshot *shot, const pl_geometry_bounds *ball) {
  const double distance = pl_vec3_norm(ball->center);
  if (!(distance > ball->radius_m))
    return INFINITY;
  const double angle = asin(ball->radius_m / distance);
  const pl_vec3 center =
      pl_vec3_scale(pl_mat3_mul_vec_t(shot->camera_to_root, ball->center), 1.0 / distance);
  const double off = hypot(center.x, center.y);
  const pl_vec3 turn =
      off > 0.0 ? (pl_vec3){-center.y / off, center.x / off, 0.0} : (pl_vec3){0.0, 1.0, 0.0};
  return fmax(across_px(&shot->rays.camera, center, turn, angle),
              across_px(&shot->rays.camera, center, pl_vec3_cross(turn, center), angle));
}

/* Clouds above this altitude, relative to the body's radius, do not fit into its image; nor do
 * rings. */
static const double HIGH = 0.02;

/* False with depth of field, since these images are sharp. */
static bool is_subpixel(const pl_snapshot *shot, const pl_view *view, double tolerance_dn,
                        size_t i) {
  const pl_shot_body *body = &shot->bodies[i];
  const pl_surface_id id = surface_of(shot, i);
  const pl_geometry_bounds ball = pl_geometry_of(id)->bounds(shot, id);
  const pl_view_entity *entity = &view->entities[pl_shot_slot(shot, id)];
  const double size = ball.in_frame ? diameter_px(shot, &ball) : INFINITY;
  const double covered = fmin(1.0, size * size);
  return shot->rays.camera.aperture_m == 0.0 && body->body->rings == NULL &&
         body->state->clouds.altitude_m < HIGH * body->radius_m && size < DIAMETER_PX &&
         pl_view_sky_dn(view, 4.0 * covered * pl_view_light(entity)) > 0.125 * tolerance_dn;
}

pl_status pl_subpixel_find(const pl_snapshot *shot, const pl_view *view, double tolerance_dn,
                           pl_arena *arena, const bool **out) {
  bool *subpixel = pl_arena_alloc(arena, shot->body_count, sizeof *subpixel);
  if (subpixel == NULL)
    return pl_fail(PL_E_MEMORY, "out of memory for small bodies");
  for (size_t i = 0; i < shot->body_count; i++)
    subpixel[i] = is_subpixel(shot, view, tolerance_dn, i);
  *out = subpixel;
  return PL_OK;
}

/* Sets up a camera that frames one body. */
static void aim(const pl_snapshot *shot, const pl_geometry_bounds *ball, pl_snapshot *out) {
  const pl_vec3 forward = pl_vec3_unit(ball->center);
  const pl_vec3 seed = fabs(forward.x) < 0.7 ? (pl_vec3){1, 0, 0} : (pl_vec3){0, 1, 0};
  const pl_vec3 right = pl_vec3_unit(pl_vec3_cross(seed, forward));
  const pl_vec3 down = pl_vec3_cross(forward, right);
  const double sine = ball->radius_m / pl_vec3_norm(ball->center);
  const double focal = 0.5 * SIDE * FILLED * sqrt(1.0 - sine * sine) / sine;
  *out = *shot;
  out->camera_to_root = pl_mat3_transpose((pl_mat3){{right, down, forward}});
  out->rays.camera = (pl_camera){.width = SIDE,
                                 .height = SIDE,
                                 .fx = focal,
                                 .fy = focal,
                                 .cx = 0.5 * (SIDE - 1),
                                 .cy = 0.5 * (SIDE - 1)};
}

/* Image of one sub-pixel body. */
typedef struct gathering {
  pl_surface_id surface_id;
  pl_vec3f light[SIDE * SIDE]; /* black where another surface is hit */
} gathering;

static pl_status gather_tile(void *context, const pl_tile_result *result, int worker) {
  gathering *g = context;
  (void)worker;
  for (int y = 0; y < result->tile.height; y++)
    for (int x = 0; x < result->tile.width; x++) {
      const int from = y * PL_TILE_SIDE + x;
      const int to = (result->tile.y0 + y) * SIDE + result->tile.x0 + x;
      g->light[to] = pl_surface_same(result->points[from].surface_id, g->surface_id)
                         ? result->radiance[from]
                         : (pl_vec3f){0.0f, 0.0f, 0.0f};
    }
  return PL_OK;
}

/* Limit on the pixels that one body touches. The number is far lower, unless the lens distortion
 * varies extremely within the body. */
enum { PIXELS = 16 * 16 };

static void add(pl_frame_sky *sky, size_t first, uint32_t pixel, pl_vec3f light) {
  size_t i = first;
  while (i < sky->subpixel_count && sky->subpixel[i].pixel != pixel)
    i++;
  if (i == first + PIXELS)
    return;
  if (i == sky->subpixel_count)
    sky->subpixel[sky->subpixel_count++] = (pl_star_light){.pixel = pixel};
  sky->subpixel[i].light = pl_vec3f_add(sky->subpixel[i].light, light);
}

/* Returns the fraction of an interval of length `width` centred on `place` that lies in pixel
 * `pixel` of an axis. */
static double overlap(double place, double width, double pixel) {
  const double low = fmax(place - 0.5 * width, pixel - 0.5);
  const double high = fmin(place + 0.5 * width, pixel + 0.5);
  return fmax(0.0, high - low) / width;
}

/* Distributes a pixel of the image, `width` pixels of the frame wide, over the pixels that it
 * overlaps. */
static void spread_pixel(const pl_camera *camera, const double at[2], double width, pl_vec3f energy,
                         size_t first, pl_frame_sky *sky) {
  const double x0 = floor(at[0] - 0.5 * width + 0.5), y0 = floor(at[1] - 0.5 * width + 0.5);
  for (int i = 0; i < 4; i++) {
    const double x = x0 + i % 2, y = y0 + (double)(i / 2);
    const double part = overlap(at[0], width, x) * overlap(at[1], width, y);
    if (!(part > 0.0) || x < 0.0 || y < 0.0 || x >= camera->width || y >= camera->height)
      continue;
    const double angle = pl_pixel_solid_angle(camera, (int)x, (int)y);
    add(sky, first, (uint32_t)y * (uint32_t)camera->width + (uint32_t)x,
        pl_vec3f_scale(energy, (float)(part / angle)));
  }
}

/* Distributes all pixels of the image over the frame. */
static void spread(const gathering *g, const pl_snapshot *close, const pl_snapshot *shot,
                   pl_frame_sky *sky) {
  const pl_camera *camera = &shot->rays.camera;
  const double width = fmax(camera->fx, camera->fy) / close->rays.camera.fx;
  const size_t first = sky->subpixel_count;
  for (int i = 0; i < SIDE * SIDE; i++) {
    double at[2];
    const pl_vec3 ray = pl_snapshot_ray(close, i % SIDE, i / SIDE);
    if (!(pl_vec3f_max(g->light[i]) > 0.0f) ||
        !pl_camera_project(camera, pl_mat3_mul_vec_t(shot->camera_to_root, ray), at))
      continue;
    const double angle = pl_pixel_solid_angle(&close->rays.camera, i % SIDE, i / SIDE);
    spread_pixel(camera, at, width, pl_vec3f_scale(g->light[i], (float)angle), first, sky);
  }
}

static pl_status render_dot(const pl_instant *instant, size_t body, pl_render_scratch *scratch,
                            pl_cancel *cancel, gathering *g, pl_frame_sky *sky) {
  const pl_snapshot *shot = &instant->shot;
  pl_render_settings settings = instant->settings;
  pl_snapshot close;
  g->surface_id = surface_of(shot, body);
  const pl_geometry_bounds ball = pl_geometry_of(g->surface_id)->bounds(shot, g->surface_id);
  aim(shot, &ball, &close);
  const pl_air_view *air = settings.air;
  const pl_media *media = settings.media;
  pl_media own; /* media that the body carries itself are part of its image */
  settings.samples = 1;
  settings.noise_dn = 0.0f;
  settings.exact = false;
  settings.backdrop = NULL;
  settings.air = NULL;
  if (media != NULL) {
    own = *media;
    own.air = NULL;
    own.subpixel = (uint32_t)body;
    settings.media = &own;
  }
  settings.see_subpixel = true;
  settings.shadow_mask = settings.shadow_cause = false;
  settings.row0 = settings.row1 = 0;
  settings.slice = NULL;
  PL_TRY(pl_render(&close, instant->tracer, &settings, scratch, gather_tile, g, cancel));
  const size_t first = sky->subpixel_count;
  spread(g, &close, shot, sky);
  const pl_beam beam = {.direction = pl_vec3_unit(ball.center)};
  const pl_vec3f transmittance =
      pl_media_passed(media, air, shot, &beam, pl_vec3_norm(ball.center));
  for (size_t i = first; i < sky->subpixel_count; i++)
    sky->subpixel[i].light = pl_vec3f_mul(sky->subpixel[i].light, transmittance);
  return PL_OK;
}

pl_status pl_subpixel_render(const pl_instant *instant, pl_render_scratch *scratch, pl_arena *arena,
                             pl_cancel *cancel, pl_frame_sky *sky) {
  const pl_snapshot *shot = &instant->shot;
  size_t count = 0;
  for (size_t i = 0; i < shot->body_count; i++)
    count += shot->bodies[i].subpixel;
  if (count == 0)
    return PL_OK;
  gathering *g = pl_arena_alloc(arena, 1, sizeof *g);
  sky->subpixel = pl_arena_alloc(arena, PIXELS * count, sizeof *sky->subpixel);
  if (g == NULL || sky->subpixel == NULL)
    return pl_fail(PL_E_MEMORY, "out of memory for %zu small bodies", count);
  for (size_t i = 0; i < shot->body_count; i++)
    if (shot->bodies[i].subpixel)
      PL_TRY(render_dot(instant, i, scratch, cancel, g, sky));
  return PL_OK;
}
