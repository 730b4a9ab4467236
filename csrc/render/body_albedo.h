/* The albedo of a body's surface: its colour map or the albedo of its photometric maps, rasters on
 * its terrain above them, and their contrast. */
#ifndef PL_RENDER_BODY_ALBEDO_H
#define PL_RENDER_BODY_ALBEDO_H

#include "render/vertex.h"

/* Writes the mean of the body's maps over all of it; 1 without any. */
void pl_body_albedo_mean(const pl_shot_body *body, float out[4]);

/* Lays rasters of the terrain over `map`, the value of the other maps at a vertex, and applies the
 * contrast and the rays of craters. */
void pl_body_albedo_finish(const pl_shot_body *body, const pl_beam *beam, pl_detail detail,
                           const pl_vertex *vertex, float map[4]);

/* Returns the terrain's rasters of roughness (rad) at a vertex, which lie over that of the body. */
pl_raster_mix pl_body_roughness(const pl_shot_body *body, const pl_beam *beam, bool maps,
                                const pl_vertex *vertex);

#endif
