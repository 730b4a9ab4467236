/* Slopes of a body's surface that are finer than its mesh, as facets of its law of reflectance. */
#ifndef PL_RENDER_FINE_SLOPES_H
#define PL_RENDER_FINE_SLOPES_H

#include "render/vertex.h"

/* Width of a square as large as a beam's footprint, m. */
double pl_fine_slopes_footprint_m(const pl_vertex *vertex, const pl_beam *beam);

/* Gives a shaded vertex facets. Models that know none have a bent normal instead. `roughness_less`:
 * variance of slopes along an axis that laws with a roughness of their own have no more. */
void pl_fine_slopes_set(pl_vertex *vertex, const pl_rough *rough, double roughness_less);

#endif
