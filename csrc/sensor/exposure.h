/* Exposure: which radiance is shown as white. */
#ifndef PL_SENSOR_EXPOSURE_H
#define PL_SENSOR_EXPOSURE_H

#include <stdbool.h>
#include <stddef.h>

#include "math/vec.h"

typedef struct pl_exposure {
  bool automatic;
  double white_radiance; /* fixed: W m-2 sr-1 encoded as 255 */
  double percentile;     /* automatic: this percentile of the lit pixels, 0..100 ... */
  double key;            /* ... is shown at this fraction of white, linear */
  double least_white;    /* automatic: white is no darker, unless a sunlit white surface is */
} pl_exposure;

/* The white radiance that an automatic exposure chooses for metered luminances (sorted in place).
 * `fallback` is that of a sunlit white surface, and the answer when nothing is lit. Pixels darker
 * than a thousandth of it count as unlit, or of the brightest pixel where all is darker: so neither
 * the sun's disc nor a glint makes the rest of the frame count as dark. */
double pl_exposure_meter(const pl_exposure *exposure, float *luminances, size_t count,
                         double fallback);

#endif
