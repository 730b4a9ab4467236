/* Trees of circles about rectangles, and of spheres about bodies. */
#include "annotate/hiders.h"

/* Added to circles for rounding, px. */
static const double ROUNDING_PX = 1e-6;

static pl_sphere circle_of(const pl_rect *r) {
  return (pl_sphere){.center = {0.5 * ((double)r->x0 + r->x1), 0.5 * ((double)r->y0 + r->y1), 0.0},
                     .radius_m =
                         0.5 * hypot((double)r->x1 - r->x0, (double)r->y1 - r->y0) + ROUNDING_PX};
}

pl_status pl_hiders_build(const pl_snapshot *shot, const pl_outline *outlines, pl_arena *arena,
                          pl_hiders *out) {
  const size_t most = shot->object_count > shot->body_count ? shot->object_count : shot->body_count;
  pl_sphere *leaves = pl_arena_alloc(arena, most, sizeof *leaves);
  if (leaves == NULL)
    return pl_fail(PL_E_MEMORY, "out of memory for %zu outlines", most);
  *out = (pl_hiders){.shot = shot, .outlines = outlines};
  for (size_t i = 0; i < shot->object_count; i++)
    leaves[i] = circle_of(&outlines[i].rect);
  PL_TRY(pl_sphere_tree_build(arena, leaves, shot->object_count, &out->objects));
  for (size_t i = 0; i < shot->body_count; i++)
    leaves[i] = (pl_sphere){.center = shot->bodies[i].center, .radius_m = shot->bodies[i].outer_m};
  return pl_sphere_tree_build(arena, leaves, shot->body_count, &out->bodies);
}

/* In front of the camera a ray that meets both first meets the one with the smaller depth. */
static bool object_hides(const pl_camera *camera, const pl_outline *other,
                         const pl_outline *outline) {
  const pl_rect a = other->rect, b = outline->rect;
  const bool nearer = other->z0_m <= outline->z1_m || camera->lens.limit_rad > 0.5 * PL_PI;
  return nearer && a.x0 <= b.x1 && a.x1 >= b.x0 && a.y0 <= b.y1 && a.y1 >= b.y0;
}

static bool any_object(pl_hiders *h, size_t index) {
  const pl_outline *outline = &h->outlines[index];
  const pl_sphere own = circle_of(&outline->rect);
  for (size_t k = 0; k < h->objects.count;) {
    const pl_sphere *node = &h->objects.nodes[k];
    const pl_vec3 apart = pl_vec3_sub(node->center, own.center);
    const bool near = pl_vec3_norm(apart) <= node->radius_m + own.radius_m;
    h->steps++;
    if (near && node->item != PL_INNER_NODE && node->item != index &&
        object_hides(&h->shot->rays.camera, &h->outlines[node->item], outline))
      return true;
    k = pl_sphere_next(&h->objects, k, near);
  }
  return false;
}

/* Whether a sphere begins nearer than the outline ends, and touches the cone of its object. */
static bool sphere_hides(const pl_sphere *sphere, const pl_shot_object *object,
                         const pl_outline *outline) {
  const double distance = pl_vec3_norm(object->center);
  if (pl_vec3_norm(sphere->center) - sphere->radius_m > outline->far_m)
    return false;
  return distance <= object->radius_m ||
         pl_sphere_in_cone(sphere->center, sphere->radius_m, pl_vec3_unit(object->center),
                           asin(object->radius_m / distance) + 1e-6);
}

static bool any_body(pl_hiders *h, size_t index) {
  const pl_shot_object *object = &h->shot->objects[index];
  for (size_t k = 0; k < h->bodies.count;) {
    const pl_sphere *node = &h->bodies.nodes[k];
    const bool hides = sphere_hides(node, object, &h->outlines[index]);
    h->steps++;
    if (hides && node->item != PL_INNER_NODE && h->shot->bodies[node->item].in_frame)
      return true;
    k = pl_sphere_next(&h->bodies, k, hides);
  }
  return false;
}

bool pl_hiders_any(pl_hiders *hiders, size_t index) {
  return any_object(hiders, index) || any_body(hiders, index);
}
