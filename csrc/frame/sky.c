/* Visibility of stars, their light in pixels, and the scale of the background. */
#include "frame/sky.h"

#include "frame/effects.h"
#include "light/sun.h"
#include "plan/effects.h"
#include "sensor/stage.h"

static pl_status check(const pl_sky *sky) {
  const double beta = pl_vec3_norm(sky->beta);
  if (!(beta < 1.0))
    return pl_fail(PL_E_RANGE, "sky: the camera must be slower than light");
  for (int band = 0; sky->backdrop.texture != NULL && band < 3; band++)
    if (!(sky->backdrop.white[band] >= 0.0f && isfinite(sky->backdrop.white[band])))
      return pl_fail(PL_E_RANGE, "sky: the background's white must be finite and not negative");
  return PL_OK;
}

/* Here a star's light is shared by the four nearest pixels; a point-spread function may concentrate
 * it in one. No pixel then gets more than this factor times the brightest of the four. */
static const double GATHERED = 4.0;

static double white_of(const pl_view *view) {
  if (view->sensor == NULL)
    return view->white_radiance;
  return fmin(view->white_radiance, pl_sensor_white_radiance(view) / GATHERED);
}

/* Returns the total radiance that a cell's faint stars may have: at most an eighth of the
 * tolerance. */
static double faint_radiance(const pl_view *view, const pl_plan_wish *wish) {
  const bool all = pl_effect_set_has(&wish->force_on, PL_EFFECT_INDEX_stars);
  double radiance = all || !(wish->tolerance_dn > 0.0) ? 0.0 : view->sky.white_radiance;
  while (radiance > 1e-30 && pl_view_sky_dn(view, radiance) > 0.125 * wish->tolerance_dn)
    radiance *= 0.5;
  return radiance > 1e-30 ? radiance : 0.0;
}

pl_status pl_frame_sky_view(const pl_sky *sky, const pl_snapshot *shot, const pl_plan_wish *wish,
                            pl_arena *arena, pl_view *view, pl_frame_sky *out) {
  *out = (pl_frame_sky){.width = shot->rays.camera.width};
  view->sky = (pl_view_sky){.white_radiance = white_of(view)};
  if (sky == NULL)
    return PL_OK;
  PL_TRY(check(sky));
  out->backdrop = sky->backdrop;
  if (sky->backdrop.texture != NULL) {
    for (int band = 0; band < 3; band++)
      out->backdrop.white[band] *= sky->by_display ? (float)view->display_white : 1.0f;
    view->sky.has_background = true;
    view->sky.background_max = pl_backdrop_max(&out->backdrop);
  }
  if (sky->stars == NULL)
    return PL_OK;
  return pl_star_field_gather(sky->stars, shot, sky->beta, faint_radiance(view, wish), arena,
                              &out->field, &view->sky);
}

/* --- after the plan --------------------------------------------------------------------------- */

/* Keeps the stars of the plan that nothing hides. A star is a point source: it is either visible or
 * not. */
static pl_status find_seen(const pl_snapshot *shot, const pl_tracer *tracer,
                           const pl_render_settings *settings, size_t count, pl_arena *arena,
                           pl_frame_sky *sky) {
  pl_ray *rays = pl_arena_alloc(arena, count, sizeof *rays);
  pl_hit *hits = pl_arena_alloc(arena, count, sizeof *hits);
  sky->seen = pl_arena_alloc(arena, count, sizeof *sky->seen);
  if (rays == NULL || hits == NULL || sky->seen == NULL)
    return pl_fail(PL_E_MEMORY, "out of memory for %zu stars", count);
  for (size_t i = 0; i < count; i++)
    rays[i] = (pl_ray){
        .t_max = INFINITY, .direction = sky->field.stars[i].direction, .skip_body = PL_NO_BODY};
  pl_tracer_closest(tracer, rays, hits, count, false, true); /* with the camera's visibility */
  const pl_sun_view sun = pl_sun_view_at(&shot->sun, (pl_vec3){0.0, 0.0, 0.0});
  for (size_t i = 0; i < count; i++) {
    const pl_field_star *star = &sky->field.stars[i];
    double pixel[2];
    /* Projected again, since the plan may have dropped the lens distortion. */
    const pl_vec3 view = pl_mat3_mul_vec_t(shot->camera_to_root, star->direction);
    if (!pl_surface_is_none(hits[i].surface_id) ||
        pl_sun_covers(&sun, pl_vec3_to_float(star->direction)) ||
        !pl_camera_project(&shot->rays.camera, view, pixel))
      continue;
    const pl_beam beam = {.direction = star->direction};
    const pl_vec3f transmittance =
        pl_media_passed(settings->media, settings->air, shot, &beam, INFINITY);
    sky->seen[sky->seen_count++] = (pl_seen_star){star->star, pixel[0], pixel[1], transmittance};
  }
  return PL_OK;
}

static size_t tile_of(const pl_frame_sky *sky, uint32_t pixel) {
  const size_t x = pixel % (uint32_t)sky->width, y = pixel / (uint32_t)sky->width;
  return y / PL_TILE_SIDE * (size_t)sky->columns + x / PL_TILE_SIDE;
}

/* Counting sort by tile; stable. */
static void sort_light(const pl_star_light *light, size_t count, size_t tiles, pl_frame_sky *sky) {
  for (size_t i = 0; i <= tiles; i++)
    sky->first[i] = 0;
  for (size_t i = 0; i < count; i++)
    sky->first[tile_of(sky, light[i].pixel) + 1]++;
  for (size_t i = 0; i < tiles; i++)
    sky->first[i + 1] += sky->first[i];
  for (size_t i = 0; i < count; i++) {
    size_t *next = &sky->first[tile_of(sky, light[i].pixel)];
    sky->light[(*next)++] = light[i];
  }
  for (size_t i = tiles; i > 0; i--) /* each entry has moved to the start of the next tile */
    sky->first[i] = sky->first[i - 1];
  sky->first[0] = 0;
}

static pl_status deposit(const pl_camera *camera, pl_arena *arena, pl_frame_sky *sky) {
  const int rows = (camera->height + PL_TILE_SIDE - 1) / PL_TILE_SIDE;
  sky->columns = (camera->width + PL_TILE_SIDE - 1) / PL_TILE_SIDE;
  const size_t tiles = (size_t)sky->columns * (size_t)rows,
               most = 4 * sky->seen_count + sky->subpixel_count;
  pl_star_light *light = pl_arena_alloc(arena, most, sizeof *light);
  size_t count = 0;
  for (; count < sky->subpixel_count; count++)
    light[count] = sky->subpixel[count];
  sky->light = pl_arena_alloc(arena, most, sizeof *light);
  sky->first = pl_arena_alloc(arena, tiles + 1, sizeof *sky->first);
  if (light == NULL || sky->light == NULL || sky->first == NULL)
    return pl_fail(PL_E_MEMORY, "out of memory for %zu stars", sky->seen_count);
  for (size_t i = 0; i < sky->seen_count; i++) {
    pl_star_splat splat;
    const pl_vec3f transmittance = sky->seen[i].transmittance;
    pl_star star = *sky->seen[i].star;
    star.light[0] *= transmittance.x;
    star.light[1] *= transmittance.y;
    star.light[2] *= transmittance.z;
    pl_star_splat_at(camera, &star, sky->seen[i].u, sky->seen[i].v, &splat);
    for (int k = 0; k < splat.count; k++)
      light[count++] = (pl_star_light){splat.pixels[k], splat.light[k]};
  }
  sort_light(light, count, tiles, sky);
  return PL_OK;
}

pl_status pl_frame_sky_place(const pl_plan *plan, const pl_snapshot *shot, const pl_tracer *tracer,
                             const pl_render_settings *settings, pl_arena *arena,
                             pl_frame_sky *sky) {
  const int level = pl_plan_value(plan, &pl_effect_stars);
  size_t count = 0;
  if (pl_plan_value(plan, &pl_effect_sky_background) == 0)
    sky->backdrop.kind = PL_BACKDROP_NONE;
  while (count < sky->field.count && sky->field.stars[count].level <= level)
    count++;
  if (count == 0 && sky->subpixel_count == 0)
    return PL_OK;
  PL_TRY(find_seen(shot, tracer, settings, count, arena, sky));
  return deposit(&shot->rays.camera, arena, sky);
}

const pl_vec3f *pl_frame_sky_tile(const pl_frame_sky *sky, const pl_tile_result *result,
                                  pl_vec3f *lit) {
  const pl_tile *tile = &result->tile;
  if (sky->first == NULL)
    return result->radiance;
  const size_t index =
      (size_t)(tile->y0 / PL_TILE_SIDE) * (size_t)sky->columns + (size_t)(tile->x0 / PL_TILE_SIDE);
  if (sky->first[index] == sky->first[index + 1])
    return result->radiance;
  for (int i = 0; i < PL_TILE_PIXELS; i++)
    lit[i] = result->radiance[i];
  for (size_t i = sky->first[index]; i < sky->first[index + 1]; i++) {
    const int x = (int)(sky->light[i].pixel % (uint32_t)sky->width) - tile->x0;
    const int y = (int)(sky->light[i].pixel / (uint32_t)sky->width) - tile->y0;
    if (y < 0 || y >= tile->height) /* outside this band of rows */
      continue;
    lit[y * PL_TILE_SIDE + x] = pl_vec3f_add(lit[y * PL_TILE_SIDE + x], sky->light[i].light);
  }
  return lit;
}
