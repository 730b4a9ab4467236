/* Lens ghosts: light that two surfaces of the lens reflect, as discs on the line through the source
 * and the optical axis. */
#ifndef PL_SENSOR_FLARE_H
#define PL_SENSOR_FLARE_H

#include <stdbool.h>

#include "base/status.h"

enum { PL_GHOSTS_MAX = 32 };

/* A source at p relative to the optical axis produces a disc centred at `scale` p. */
typedef struct pl_ghost {
  double scale;      /* -2..2 */
  double radius_rad; /* angular radius of the disc; half a pixel or more is used */
  double part[3];    /* fraction of a source's light that falls in the disc, by band; 0..1 */
} pl_ghost;

typedef struct pl_flare {
  int count; /* number of ghosts; 0: none */
  pl_ghost ghosts[PL_GHOSTS_MAX];
  /* Angles of the sun to the axis: up to the first all sunlight enters the lens, from the second on
   * the baffle blocks it; linear in between. Less than a right angle. */
  double baffle_rad[2];
} pl_flare;

/* The sun as a source of ghosts: the position of its image, and its light as radiance summed over
 * pixels, W m-2 sr-1. */
typedef struct pl_flare_sun {
  bool on;
  double place_px[2];
  double radius_px; /* of its disc, whose pixels are not counted as sources again */
  double light;     /* in each band */
} pl_flare_sun;

/* Fails with PL_E_RANGE and names the value that is out of range. */
pl_status pl_flare_check(const pl_flare *flare);
/* Fraction of sunlight that passes the baffle at an angle to the axis. */
double pl_flare_baffle(const pl_flare *flare, double angle_rad);

#endif
