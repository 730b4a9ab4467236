/* The light in a pixel that the lens brought there from elsewhere, for labels. */
#ifndef PL_SENSOR_GLARE_H
#define PL_SENSOR_GLARE_H

#include "sensor/stage.h"

/* Follows the light of each pixel through the lens: call it after every stage, with the stage's
 * number. At the last stage of the lens `frame->glare` is all - own, or 0 if that is negative, over
 * the light that fills the most sensitive pixels (pl_sensor_full_radiance): own is the light that
 * entered the lens in the pixel's direction, dimmed as the lens dims all light there; all is what
 * arrives. In an even area that is 0, although light is exchanged. Of the three bands the mean
 * counts. */
void pl_glare_follow(pl_sensor_frame *frame, const pl_sensor_stage *stage);

#endif
