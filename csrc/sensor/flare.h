/* Ghosts of a lens: light that its surfaces reflect twice, as discs about the optical axis. */
#ifndef PL_SENSOR_FLARE_H
#define PL_SENSOR_FLARE_H

#include <stdbool.h>

#include "base/status.h"

enum { PL_GHOSTS_MAX = 32 };

/* A source at p from the axis makes a disc about `scale` p. */
typedef struct pl_ghost {
  double scale;      /* -2..2 */
  double radius_rad; /* of the disc, as seen through the lens; at least half a pixel is taken */
  double part[3];    /* of a source's light that lands in the disc, in the bands; 0..1 */
} pl_ghost;

typedef struct pl_flare {
  int count; /* of ghosts; 0: none */
  pl_ghost ghosts[PL_GHOSTS_MAX];
  /* Angle to the axis up to which the sun shines into the lens, and from which on the baffle keeps
   * it out; linear between. Less than a right angle. */
  double baffle_rad[2];
} pl_flare;

/* The sun as a source: where its image would be, and its light in pixels: the sum of what a pixel
 * of this radiance would add, W m-2 sr-1. */
typedef struct pl_flare_sun {
  bool on;
  double place_px[2];
  double radius_px; /* of its disc, whose pixels are no sources besides */
  double light;     /* in each band */
} pl_flare_sun;

/* PL_E_RANGE naming what is outside of its range. */
pl_status pl_flare_check(const pl_flare *flare);
/* Part of the sun's light that the baffle lets through at an angle to the axis. */
double pl_flare_baffle(const pl_flare *flare, double angle_rad);

#endif
