/* Culls a snapshot by its view: what cannot change the image is left out. */
#include "scene/snapshot.h"

#include "plan/view_tree.h"

/* Arguments of culling tests, which are applied to entities or to spheres around several entities.
 */
typedef struct query {
  const pl_view *view;
  const pl_view_entity *entity, *source;
  double brightest, tolerance_dn, hidden;
} query;

/* Returns whether the light that `entity` sends to entities in the frame, or blocks from them,
 * exceeds the tolerance. Blocked light is at most as bright as the brightest entity. */
static bool reflects(const pl_view_entity *seen, bool several, void *context) {
  const query *q = context;
  (void)several;
  if (seen == q->entity || !seen->in_frame)
    return false;
  const double light =
      pl_view_light_at(q->view, seen, q->entity) * pl_view_series(q->view, q->view->max_bounces);
  const double part = pl_view_transfer(seen, q->entity);
  return pl_view_dn(q->view, part * fmax(light, q->brightest)) > q->tolerance_dn;
}

/* Returns whether the shadow of `entity` on `source` removes more than the tolerance from the light
 * that `source` sends to entities in the frame. The bound of that: the light of a source
 * of the shadow's size anywhere on `source`. */
static bool dims(const pl_view_entity *seen, bool several, void *context) {
  const query *q = context;
  (void)several;
  if (!seen->in_frame || seen == q->source)
    return false;
  pl_view_entity near = *seen, shadow = *q->source;
  near.radius_m += q->source->radius_m;
  shadow.radius_m = fmin(q->entity->radius_m, q->source->radius_m);
  const double part = fmin(pl_view_transfer(seen, q->source), pl_view_transfer(&near, &shadow));
  return pl_view_dn(q->view, part * pl_view_light(q->source)) > q->tolerance_dn;
}

/* Returns whether its shadow on a receiver changes the image, directly or through light that the
 * receiver sends on. */
static bool shades(const pl_view_entity *receiver, bool several, void *context) {
  const query *q = context;
  query inner = *q;
  if (receiver == q->entity || !pl_view_shadow_reaches(q->view, q->entity, receiver))
    return false;
  inner.source = receiver;
  return several || receiver->in_frame ||
         (q->view->max_bounces > 0 && pl_view_any(q->view, dims, &inner));
}

/* Returns whether leaving `entity` out can change any pixel by more than the tolerance. */
static bool matters(const pl_view *view, const pl_view_entity *entity, double brightest,
                    double tolerance_dn) {
  query q = {.view = view, .entity = entity, .brightest = brightest, .tolerance_dn = tolerance_dn};
  return pl_view_any(view, shades, &q) ||
         (view->max_bounces > 0 && pl_view_any(view, reflects, &q));
}

static double of_mesh(const pl_view_entity *source, const void *context) {
  const pl_view_entity *const *bodies = context; /* bodies follow after all meshes */
  return source < *bodies ? 1.0 : 0.0;
}

/* Sums the fraction of the sun that casters hide. */
static bool hide(const pl_view_entity *caster, bool several, void *context) {
  query *q = context;
  if (several)
    return pl_view_shadow_reaches(q->view, caster, q->entity);
  if (caster != q->entity)
    q->hidden += pl_view_hidden_sun(q->view, caster, q->entity);
  return false;
}

static bool is_shadowed(const pl_view *view, const pl_view_entity *receiver, double tolerance_dn) {
  query q = {.view = view, .entity = receiver};
  pl_view_any(view, hide, &q);
  return pl_view_dn_dimming(q.hidden) > tolerance_dn;
}

static bool eclipses(const pl_view_entity *caster, bool several, void *context) {
  const query *q = context;
  if (several)
    return caster->is_body && pl_view_shadow_reaches(q->view, caster, q->entity);
  return caster->is_body && pl_view_hidden_sun(q->view, caster, q->entity) > 0.0;
}

static bool is_eclipsed(const pl_view *view, const pl_view_entity *receiver) {
  query q = {.view = view, .entity = receiver};
  return pl_view_any(view, eclipses, &q);
}

/* Returns whether a sphere lies entirely in a body's umbra. Test: seen from the sphere's centre, a
 * ball smaller than the body by the sphere's radius hides a sun enlarged by that radius; moving
 * from the centre to any point of the sphere shifts each by no more than the radius. MARGIN_RAD
 * allows for rays in single precision. */
static bool is_dark(const pl_snapshot *shot, pl_vec3 center, double radius_m) {
  static const double MARGIN_RAD = 1e-6;
  const pl_vec3 to_sun = pl_vec3_sub(shot->sun.position, center);
  const double sun_m = pl_vec3_norm(to_sun), wide = shot->sun.radius_m + radius_m;
  for (size_t i = 0; i < shot->body_count; i++) {
    if (!pl_shot_is_smooth(&shot->bodies[i]))
      continue;
    const pl_vec3 radii = shot->bodies[i].state->radii_m;
    const double ball = fmin(radii.x, fmin(radii.y, radii.z)) - radius_m;
    const pl_vec3 to_body = pl_vec3_sub(shot->bodies[i].center, center);
    const double far = pl_vec3_norm(to_body);
    if (!(ball > 0.0 && far > ball && far + radius_m < sun_m - wide))
      continue;
    const double apart =
        atan2(pl_vec3_norm(pl_vec3_cross(to_sun, to_body)), pl_vec3_dot(to_sun, to_body));
    if (apart + asin(wide / sun_m) + MARGIN_RAD < asin(ball / far))
      return true;
  }
  return false;
}

/* Returns an upper bound of the radiance of any entity, including interreflection, W m-2 sr-1. */
static double brightest_of(const pl_view *view) {
  double brightest = 0.0;
  for (size_t i = 0; i < view->entity_count; i++)
    brightest = fmax(brightest, pl_view_light(&view->entities[i]));
  for (size_t i = 0; i < view->volume_count; i++)
    brightest += view->volumes[i].scattered + view->volumes[i].emitted;
  return brightest * pl_view_series(view, view->max_bounces);
}

static void cull_objects(const pl_snapshot *placed, const pl_culling *culling, double brightest,
                         pl_shot_object *out) {
  const pl_view *view = culling->view;
  for (size_t i = 0; i < placed->object_count; i++) {
    pl_shot_object *object = &out[i];
    *object = placed->objects[i];
    object->eclipsed = is_eclipsed(view, &view->entities[i]);
    object->dark = object->eclipsed && is_dark(placed, object->center, object->radius_m);
    object->kept =
        object->in_frame || matters(view, &view->entities[i], brightest, culling->tolerance_dn);
  }
}

/* Where on an ellipsoid the light of others may matter. */
static pl_status make_senders(const pl_snapshot *placed, const pl_culling *culling, size_t entity,
                              pl_arena *arena, pl_shot_body *body) {
  pl_senders *made = NULL;
  if (body->bounced && body->shape == NULL)
    PL_TRY(pl_senders_make(culling->view, placed->object_count, entity, culling->tolerance_dn,
                           arena, &made));
  body->senders = made;
  return PL_OK;
}

/* `objects`: the culled objects, which include the shapes of bodies. */
static pl_status cull_bodies(const pl_snapshot *placed, const pl_culling *culling, double brightest,
                             pl_arena *arena, pl_shot_object *objects, pl_shot_body *out) {
  const pl_view *view = culling->view;
  const double series = pl_view_series(view, view->max_bounces);
  double mirrored = 0.0;
  for (size_t i = 0; i < placed->object_count; i++)
    mirrored = fmax(mirrored, series * pl_view_light_most(view, &view->entities[i]));
  const pl_view_entity *meshes_end = view->entities + placed->object_count;
  pl_view_weigh(view, of_mesh, &meshes_end);
  for (size_t i = 0; i < placed->body_count; i++) {
    const size_t entity = placed->object_count + i;
    pl_shot_body *body = &out[i];
    *body = placed->bodies[i];
    body->shadowed = is_shadowed(view, &view->entities[entity], culling->tolerance_dn);
    body->bounced =
        pl_view_dn(view, pl_view_received(view, entity) * series) > culling->tolerance_dn;
    PL_TRY(make_senders(placed, culling, entity, arena, body));
    /* objects block or send at most the light of the part of its sky that they cover, at the
     * highest radiance */
    const double part = pl_view_sum(view, &view->entities[entity], of_mesh, &meshes_end);
    body->near_meshes = pl_view_dn(view, part * fmax(brightest, mirrored)) > culling->tolerance_dn;
    body->lods = view->entities[entity].lods;
    body->subpixel = culling->subpixel != NULL && culling->subpixel[i];
    if (body->shape == NULL)
      continue;
    pl_shot_object *shape = objects + (body->shape - placed->objects);
    shape->subpixel = body->subpixel;
    body->shape = shape;
  }
  return PL_OK;
}

pl_status pl_snapshot_cull(const pl_snapshot *placed, const pl_culling *culling, pl_arena *arena,
                           pl_snapshot *out) {
  const double brightest = brightest_of(culling->view);
  pl_shot_object *objects = pl_arena_alloc(arena, placed->object_count, sizeof *objects);
  pl_shot_body *bodies = pl_arena_alloc(arena, placed->body_count, sizeof *bodies);
  if (objects == NULL || bodies == NULL)
    return pl_fail(PL_E_MEMORY, "out of memory for the snapshot");
  cull_objects(placed, culling, brightest, objects);
  PL_TRY(cull_bodies(placed, culling, brightest, arena, objects, bodies));
  *out = *placed;
  out->objects = objects;
  out->bodies = bodies;
  return PL_OK;
}
