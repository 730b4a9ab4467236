/* The effect rows `bump_detail` and `relief`: normals changed by normal maps and bumps. */
#include "plan/changed_surfaces.h"
#include "plan/effects.h"

static bool is_bumped(const pl_view_entity *entity, int value) {
  return value == 0 && entity->bumped;
}
static bool has_relief(const pl_view_entity *entity, int value) {
  return value == 0 && entity->relief;
}

static double cost_ms(const pl_view *view, int value) {
  (void)value;
  return 1e-4 * view->width * view->height * view->samples;
}

static const char *bump_absent(const pl_view *view) {
  return pl_view_has(view, is_bumped) ? NULL : "nothing in the scene has a normal map or bump";
}

static double bump_bound_dn(const pl_view *view, int value) {
  return pl_view_changed_dn(view, is_bumped, value);
}

const pl_effect pl_effect_bump_detail = {
    .name = "bump_detail",
    .doc = "Normal maps and bumps; off: the normals of the mesh",
    .absent = bump_absent,
    .ceiling = pl_effect_ceiling_one,
    .bound_dn = bump_bound_dn,
    .cost_ms = cost_ms,
};

static const char *relief_absent(const pl_view *view) {
  return pl_view_has(view, has_relief) ? NULL : "no body in the scene has relief";
}

static double relief_bound_dn(const pl_view *view, int value) {
  return pl_view_changed_dn(view, has_relief, value);
}

const pl_effect pl_effect_relief = {
    .name = "relief",
    .doc = "Height and normal maps of bodies; off: a smooth surface",
    .absent = relief_absent,
    .ceiling = pl_effect_ceiling_one,
    .bound_dn = relief_bound_dn,
    .cost_ms = cost_ms,
};
