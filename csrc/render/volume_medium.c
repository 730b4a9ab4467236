/* Bounded volumes as participating media. */
#include "render/medium_kinds.h"
#include "render/volume.h"

static pl_status build(const pl_snapshot *shot, int value, pl_arena *arena, const void **own) {
  const pl_volume_view *view;
  PL_TRY(pl_volume_view_build(shot, value, arena, &view));
  *own = view;
  return PL_OK;
}

static bool in_cone(const void *own, const pl_snapshot *shot, pl_vec3 axis, double half_angle) {
  const pl_volume_view *view = own;
  for (size_t i = 0; i < view->count; i++) {
    const pl_shot_volume *volume = view->items[i].shot;
    if (pl_snapshot_sees(shot, volume->center, volume->radius_m, axis, half_angle))
      return true;
  }
  return false;
}

/* Context of sun_at. */
typedef struct place {
  const pl_media *media;
  const pl_snapshot *shot;
} place;

static pl_vec3f sun_at(const void *context, pl_vec3 point, const pl_sun_view *sun) {
  const place *p = context;
  return pl_media_sunlight(p->media, &pl_medium_volumes, p->shot, point, sun, 0.0f);
}

/* Each stretch is represented by a crossing at its middle. The image of a sub-pixel body has no
 * volumes: they are in the frame's own image. */
static void cross(const pl_media *media, const void *own, const pl_snapshot *shot,
                  const pl_medium_ray *ray, pl_medium_list *out) {
  if (ray->camera && media->subpixel != PL_NO_BODY)
    return;
  const place p = {media, shot};
  const pl_volume_ray asked = {
      .origin = ray->beam->origin,
      .direction = ray->beam->direction,
      .width_m = ray->beam->width_m,
      .spread = ray->beam->spread,
      .t_max = ray->t_max,
      .camera = ray->camera,
      .unlit = ray->camera && !media->emitted_light,
      .sun = ray->dark ? NULL : sun_at,
      .context = &p,
  };
  pl_volume_stretch stretches[PL_VOLUMES_MAX];
  const size_t count = pl_volume_cross(own, &asked, stretches);
  for (size_t i = 0; i < count; i++) {
    const pl_medium_crossing crossing = {.t = 0.5 * (stretches[i].start + stretches[i].end),
                                         .transmittance = stretches[i].transmittance,
                                         .radiance = stretches[i].radiance};
    pl_medium_list_add(out, &crossing);
  }
}

static pl_vec3f toward_sun(const pl_media *media, const void *own, const pl_snapshot *shot,
                           pl_vec3 point, const pl_sun_view *sun, float width_m) {
  (void)media, (void)shot, (void)sun, (void)width_m;
  return pl_volume_toward_sun(own, point);
}

const pl_medium_kind pl_medium_volumes = {
    .effect = &pl_effect_volumes,
    .build = build,
    .in_cone = in_cone,
    .cross = cross,
    .toward_sun = toward_sun,
};
