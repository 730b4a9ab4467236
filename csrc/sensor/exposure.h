/* Exposure: the radiance that is displayed as white. */
#ifndef PL_SENSOR_EXPOSURE_H
#define PL_SENSOR_EXPOSURE_H

#include <stdbool.h>
#include <stddef.h>

#include "math/vec.h"

typedef struct pl_exposure {
  bool automatic;
  double white_radiance; /* fixed: W m-2 sr-1 encoded as 255 */
  double percentile;     /* automatic: this percentile of the lit pixels, 0..100 ... */
  double key;            /* ... is displayed at this fraction of white, linear */
  double least_white;    /* automatic: lower limit of white; `fallback` if that is less */
} pl_exposure;

/* Returns the white radiance that automatic exposure chooses from metered luminances (sorted in
 * place). `fallback` is the radiance of a sunlit white surface, and is returned if nothing is lit.
 * Pixels are ignored as unlit if they are darker than a thousandth of `fallback`, or of the
 * brightest pixel if that is darker than `fallback`. The sun's disc or a glint therefore does not
 * make the rest of the frame count as unlit. */
double pl_exposure_meter(const pl_exposure *exposure, float *luminances, size_t count,
                         double fallback);

#endif
