/* Longitude and latitude on bodies, with the footprint that a pixel has in them. */
#ifndef PL_SHADE_BODY_MAP_H
#define PL_SHADE_BODY_MAP_H

#include "math/vec.h"

/* Coordinates in an equirectangular map whose centre column is at longitude `center_lon_rad`: u
 * eastwards, 0..1, v from the north pole to the south pole. `across`, `along`: extent of the
 * footprint on the surface, body axes, metres; a, b: the same in the map. They come of derivatives,
 * so the date line is no seam. At the poles, where longitude has none, the point counts as a
 * millionth of the radius away, at longitude 0. Latitude is planetocentric. */
void pl_body_map_uv(pl_vec3 point, double center_lon_rad, pl_vec3 across, pl_vec3 along,
                    float uv[2], float a[2], float b[2]);

#endif
