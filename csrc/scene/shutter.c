/* Makes the static world of one instant. */
#include "scene/shutter.h"

double pl_shutter_window_s(const pl_placement *placement) {
  return placement->shutter.exposure_s +
         placement->shutter.line_s * (double)(placement->camera.height - 1);
}

static double lerp(double a, double b, double u) { return a + u * (b - a); }

static pl_vec3 lerp3(pl_vec3 a, pl_vec3 b, double u) {
  return (pl_vec3){lerp(a.x, b.x, u), lerp(a.y, b.y, u), lerp(a.z, b.z, u)};
}

/* Finds the interval between two of `count` keys that contains an instant, and the fraction of it.
 */
static int key_at(int count, double u, double *part) {
  const double at = u * (count - 1);
  const int first = (int)fmin(at, count - 2);
  *part = at - first;
  return first;
}

static pl_motion stopped(const pl_motion *motion, double u) {
  const pl_pose pose = pl_motion_at(motion, u);
  return (pl_motion){.open = pose, .close = pose};
}

static pl_status stop_movers(const pl_object *object, double u, pl_arena *arena,
                             pl_object_state *state) {
  const size_t count = pl_object_mover_count(object);
  if (state->mover_keys == NULL || count == 0)
    return PL_OK;
  pl_affine *now = pl_arena_alloc(arena, count, sizeof *now);
  if (now == NULL)
    return pl_fail(PL_E_MEMORY, "out of memory for the parts of '%s'", object->name);
  double part;
  const int first = key_at(state->mover_key_count, u, &part);
  const pl_affine *a = state->mover_keys + (size_t)first * count, *b = a + count;
  for (size_t i = 0; i < count; i++) {
    for (int k = 0; k < 3; k++)
      now[i].m.row[k] = lerp3(a[i].m.row[k], b[i].m.row[k], part);
    now[i].t = lerp3(a[i].t, b[i].t, part);
  }
  state->movers = now;
  state->mover_keys = NULL;
  return PL_OK;
}

/* Returns the time of the nearest key, for keys that must not be interpolated. */
static double held(const pl_motion *camera, double u) {
  const int steps = camera->keys != NULL ? camera->key_count - 1 : 1;
  return floor(u * steps + 0.5) / steps;
}

double pl_shutter_row_share(const pl_placement *placement, double row) {
  const pl_shutter *shutter = &placement->shutter;
  const double window_s = pl_shutter_window_s(placement);
  if (!(window_s > 0.0))
    return 0.5;
  const double u = fmin(fmax(pl_shutter_row_s(shutter, row) / window_s, 0.0), 1.0);
  return shutter->held ? held(&placement->camera.motion, u) : u;
}

pl_status pl_placement_at(const pl_scene *scene, const pl_placement *from, double u,
                          pl_arena *arena, pl_placement *out) {
  pl_object_state *objects = pl_arena_alloc(arena, scene->craft_count, sizeof *objects);
  pl_body_state *bodies = pl_arena_alloc(arena, scene->body_count, sizeof *bodies);
  if (objects == NULL || bodies == NULL)
    return pl_fail(PL_E_MEMORY, "out of memory for an instant of the exposure");
  u = fmin(fmax(u, 0.0), 1.0);
  if (from->shutter.held)
    u = held(&from->camera.motion, u);
  *out = *from;
  out->shutter = (pl_shutter){0};
  out->objects = objects;
  out->bodies = bodies;
  out->camera.motion = stopped(&from->camera.motion, u);
  if (from->sun.keys != NULL) {
    double part;
    const int first = key_at(from->sun.key_count, u, &part);
    out->sun.position_m = lerp3(from->sun.keys[first], from->sun.keys[first + 1], part);
    out->sun.keys = NULL;
  }
  for (size_t i = 0; i < scene->craft_count; i++) {
    objects[i] = from->objects[i];
    objects[i].motion = stopped(&from->objects[i].motion, u);
    PL_TRY(stop_movers(&scene->objects[i], u, arena, &objects[i]));
  }
  for (size_t i = 0; i < scene->body_count; i++) {
    bodies[i] = from->bodies[i];
    bodies[i].motion = stopped(&from->bodies[i].motion, u);
  }
  return PL_OK;
}
