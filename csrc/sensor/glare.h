/* The light in a pixel that the lens brought there from elsewhere, for labels. */
#ifndef PL_SENSOR_GLARE_H
#define PL_SENSOR_GLARE_H

#include "sensor/stage.h"

/* Follows the light of each pixel through the lens: call it after every stage, with the stage's
 * number. At the last stage of the lens `frame->glare` is max(all - own, 0), over the light that
 * fills the most sensitive pixels (pl_sensor_full_radiance). `own` is the light that entered the
 * lens in the pixel's direction, dimmed by the lens; `all` is what arrives. An even area has 0,
 * although light is exchanged there. The mean of the three bands counts. */
void pl_glare_follow(pl_sensor_frame *frame, const pl_sensor_stage *stage);

#endif
