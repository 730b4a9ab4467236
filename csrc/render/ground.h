/* Relief, open water and city lights at a point of a body. */
#ifndef PL_RENDER_GROUND_H
#define PL_RENDER_GROUND_H

#include "render/vertex.h"
#include "shade/body_map.h"

/* Tilts the normal of the shading frame by the relief. */
void pl_ground_bend(const pl_shot_body *body, const pl_body_place *place, pl_detail detail,
                    pl_surface *surface);
/* Whether water changes the colour: it has one of its own. */
bool pl_ground_tints(const pl_shot_body *body);
/* Blends a coloured Lambert surface with water where the map has water. */
void pl_ground_flood(const pl_shot_body *body, const pl_body_place *place, pl_detail detail,
                     pl_surface *surface);
/* Adds the city lights of a body to the emission where the sun is down: all of them from 6 deg
 * below the horizon on (the end of civil twilight), none while the sun's centre is above. */
void pl_ground_light(const pl_shot_body *body, const pl_shot_sun *sun, const pl_body_place *place,
                     pl_detail detail, pl_vertex *vertex);

#endif
