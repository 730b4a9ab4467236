/* Bound of the change of a pixel when normals, heights or shadows of some surfaces change. */
#ifndef PL_PLAN_CHANGED_SURFACES_H
#define PL_PLAN_CHANGED_SURFACES_H

#include "plan/view.h"

/* Whether a surface changes if a row has a value. */
typedef bool (*pl_view_picks)(const pl_view_entity *entity, int value);

/* Whether any would change without the row. */
bool pl_view_has(const pl_view *view, pl_view_picks picks);
/* Upper bound of the change of a pixel, digital numbers: by the picked entities themselves, and by
 * the light that they send onto others. */
double pl_view_changed_dn(const pl_view *view, pl_view_picks picks, int value);

#endif
