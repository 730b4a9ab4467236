/* Relief, open water and lights of the night at a point of a body. */
#ifndef PL_RENDER_GROUND_H
#define PL_RENDER_GROUND_H

#include "render/vertex.h"
#include "shade/body_map.h"

/* Bends the normal of the shading frame by the relief. */
void pl_ground_bend(const pl_shot_body *body, const pl_body_place *place, pl_detail detail,
                    pl_surface *surface);
/* Makes a coloured Lambert surface the water's where there is some. */
void pl_ground_flood(const pl_shot_body *body, const pl_body_place *place, pl_detail detail,
                     pl_surface *surface);
/* Of a body with lights: adds them to the emission where the sun is down: all of them once it is 6
 * deg below the horizon, as at the end of civil twilight, and none while its centre is above. */
void pl_ground_light(const pl_shot_body *body, const pl_shot_sun *sun, const pl_body_place *place,
                     pl_detail detail, pl_vertex *vertex);

#endif
