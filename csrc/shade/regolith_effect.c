/* The effect row `regolith`: Hapke's model, or cheaper ones that look the same in the frame. */
#include <math.h>
#include <stddef.h>

#include "plan/effects.h"

static const char *absent(const pl_view *view) {
  for (size_t i = 0; i < view->entity_count; i++)
    if (view->entities[i].lods != NULL)
      return NULL;
  return "no body with Hapke's reflectance covers much of the frame";
}

static int ceiling(const pl_view *view) {
  (void)view;
  return PL_VIEW_LODS - 1;
}

/* Largest change of a pixel by one model, over all sampled geometries. */
static double change_dn(const pl_view *view, const pl_view_lods *lods, size_t law) {
  double largest = 0.0;
  for (size_t i = 0; i < lods->count; i++) {
    const double exact = (double)lods->exact[i], off = (double)lods->off[law][i];
    const double dn = pl_view_dn(view, exact);
    largest =
        fmax(largest, fmax(pl_view_dn(view, exact + off) - dn, dn - pl_view_dn(view, exact - off)));
  }
  return largest;
}

/* Maximum over this model and all more expensive ones, so that the bound decreases with the value.
 */
static double bound_dn(const pl_view *view, int value) {
  double largest = 0.0;
  for (size_t i = 0; i < view->entity_count; i++)
    for (int law = value; view->entities[i].lods != NULL && law < PL_VIEW_LODS - 1; law++)
      largest = fmax(largest, change_dn(view, view->entities[i].lods, (size_t)law));
  return largest;
}

/* Cost per shading relative to Lambert; measured by benchmarks/reflectance.py. */
static double cost_ms(const pl_view *view, int value) {
  static const double ns[PL_VIEW_LODS] = {0.0, 100.0, 100.0, 70.0, 100.0, 190.0};
  return 1e-6 * ns[value] * view->width * view->height * view->samples;
}

const pl_effect pl_effect_regolith = {
    .name = "regolith",
    .doc = "Reflectance of bodies with Hapke's model: 5 as configured, 4 without roughness, 3 "
           "Lommel-Seeliger, 2 lunar-Lambert, 1 Minnaert, 0 Lambert; each is fitted to the mean "
           "brightness of the visible surface",
    .absent = absent,
    .ceiling = ceiling,
    .bound_dn = bound_dn,
    .cost_ms = cost_ms,
};
