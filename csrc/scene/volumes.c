/* Volumes in the snapshot and in the plan's view. */
#include "scene/volumes.h"

#include <math.h>

#include "shade/graph_medium.h"

pl_status pl_volumes_place(const pl_placement *placement, pl_arena *arena, pl_vec3 axis,
                           double half_angle, pl_snapshot *out) {
  out->volume_count = placement->volume_count;
  if (out->volume_count == 0)
    return PL_OK;
  pl_shot_volume *volumes = pl_arena_alloc(arena, out->volume_count, sizeof *volumes);
  if (volumes == NULL)
    return pl_fail(PL_E_MEMORY, "out of memory for volumes");
  for (size_t i = 0; i < out->volume_count; i++) {
    const pl_volume *volume = &placement->volumes[i];
    const bool on_object = volume->parent < out->craft_count;
    const pl_shot_object *object = on_object ? &out->objects[volume->parent] : NULL;
    const pl_shot_body *body = on_object ? NULL : &out->bodies[volume->parent - out->craft_count];
    const pl_mat3 axes = on_object ? object->rotation : body->rotation;
    pl_shot_volume *shot = &volumes[i];
    *shot = (pl_shot_volume){.volume = volume};
    shot->rotation = pl_mat3_mul(axes, pl_mat3_from_quat(volume->local.q));
    shot->origin = pl_vec3_add(on_object ? object->position : body->center,
                               pl_mat3_mul_vec(axes, volume->local.t));
    shot->ball = pl_bound_sphere(volume->bound, volume->size);
    shot->radius_m = shot->ball.radius_m;
    shot->center = pl_vec3_add(shot->origin, pl_mat3_mul_vec(shot->rotation, shot->ball.center));
    shot->in_frame = pl_snapshot_sees(out, shot->center, shot->radius_m, axis, half_angle);
  }
  out->volumes = volumes;
  return PL_OK;
}

/* Returns upper bounds over the bands. No chord is longer than the diameter of the bounding sphere.
 * The radiance from sunlight is at most what a chord scatters of light with the sun's irradiance.
 */
static pl_view_volume volume_of(const pl_snapshot *shot, const pl_shot_volume *from) {
  const pl_volume *volume = from->volume;
  const double way = 2.0 * from->radius_m;
  const double sun = pl_shot_irradiance_max(shot, from->center, from->radius_m);
  const double of_graph = volume->graph != NULL ? pl_graph_medium_emission_max(volume->graph) : 0.0;
  pl_view_volume out = {
      .in_frame = from->in_frame,
      .center_m = {from->center.x, from->center.y, from->center.z},
      .distance_m = pl_vec3_norm(from->center),
      .radius_m = from->radius_m,
  };
  for (int k = 0; k < 3; k++) {
    const double depth = (double)volume->extinction[k] * way;
    const double met = -expm1(-depth) * (double)volume->albedo[k];
    out.depth = fmax(out.depth, depth);
    out.scattered = fmax(out.scattered, met * sun * pl_volume_phase_max(volume));
    out.emitted = fmax(out.emitted, ((double)volume->emission[k] + of_graph) * way);
  }
  return out;
}

pl_status pl_volumes_view(const pl_snapshot *shot, pl_arena *arena, pl_view *out) {
  if (shot->volume_count == 0)
    return PL_OK;
  pl_view_volume *volumes = pl_arena_alloc(arena, shot->volume_count, sizeof *volumes);
  if (volumes == NULL)
    return pl_fail(PL_E_MEMORY, "out of memory for the view");
  for (size_t i = 0; i < shot->volume_count; i++)
    volumes[i] = volume_of(shot, &shot->volumes[i]);
  out->volumes = volumes;
  out->volume_count = shot->volume_count;
  return PL_OK;
}
