/* Channels of the ground: heights, slopes and roughness on bodies. */
#ifndef PL_ANNOTATE_GROUND_CHANNELS_H
#define PL_ANNOTATE_GROUND_CHANNELS_H

#include "annotate/ground_map.h"

/* Returns the body whose surface an id is of; NULL for objects and for none. */
const pl_shot_body *pl_ground_body(const pl_snapshot *shot, pl_surface_id id);
/* Distance of the body's ellipsoid from its centre in the direction of a point (from the centre,
 * root axes), m. */
double pl_ground_datum_m(const pl_shot_body *body, pl_vec3 point);

void pl_write_elevation(const pl_label_run *run, void *pixels);
void pl_write_altitude(const pl_label_run *run, void *pixels);
void pl_write_slope(const pl_label_run *run, void *pixels);
/* Ids of rocks are those of pl_rock: the same in any frame. */
void pl_write_rock_id(const pl_label_run *run, void *pixels);
/* Sets the craters of a run. */
void pl_find_craters(pl_label_run *run);
void pl_write_crater_id(const pl_label_run *run, void *pixels);
/* Numbers of the terrain's masks, on rocks, too. */
void pl_write_ground_mask(const pl_label_run *run, void *pixels);

/* Rows y0 to y1 - 1 of images of the map. From the elevations of neighbouring pixels: */
void pl_write_slope_sobel(const pl_ground_map *map, int y0, int y1);
void pl_write_roughness_laplacian(const pl_ground_map *map, int y0, int y1);
/* Pixels of a group. From heights around the points: slope_baseline and rms_height. */
pl_status pl_write_planes(const pl_ground_group *group);
/* From the same, and rocks. */
pl_status pl_write_hazard(const pl_ground_group *group);

#endif
