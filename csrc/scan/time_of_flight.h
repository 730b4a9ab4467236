/* A time-of-flight camera: distance from the phase of modulated light. */
#ifndef PL_SCAN_TIME_OF_FLIGHT_H
#define PL_SCAN_TIME_OF_FLIGHT_H

#include <stddef.h>
#include <stdint.h>

#include "base/status.h"

enum { PL_MODULATIONS_MAX = 4 };

typedef struct pl_time_of_flight {
  uint64_t seed, frame;
  double modulation_hz[PL_MODULATIONS_MAX];
  int modulations;
  /* Electrons, over the four taps of a modulation, from a white Lambert target that fills the pixel
   * and faces the camera at 1 m; they fall with the square of the distance. */
  double signal_e;
  double ambient_e;   /* electrons per tap of other light */
  double read_e;      /* standard deviation of a tap, electrons */
  double contrast;    /* of the modulation, 0..1 */
  double full_well_e; /* of a tap; 0: none */
  double least_e;     /* amplitude below which a pixel has no depth, electrons */
} pl_time_of_flight;
/* Returns PL_E_RANGE, naming the value. */
pl_status pl_time_of_flight_check(const pl_time_of_flight *camera);

typedef struct pl_time_of_flight_pixel {
  double range_m;      /* NAN below least_e, and where a tap is full */
  double true_range_m; /* mean over the pixel's echoes by power; NAN without any */
  float amplitude_e;   /* of the modulation with the least */
  float offset_e;      /* mean of the taps of the first modulation */
  uint8_t echoes;      /* 0: none, 1: of one surface, 2: of several */
  uint8_t full, unused[6];
} pl_time_of_flight_pixel;

/* Light that comes back to a pixel. */
typedef struct pl_time_of_flight_echo {
  double range_m, power; /* power: reflectance over the number of rays */
  uint64_t surface;
} pl_time_of_flight_echo;

void pl_time_of_flight_measure(const pl_time_of_flight *camera, uint64_t pixel,
                               const pl_time_of_flight_echo *echoes, size_t count,
                               pl_time_of_flight_pixel *out);

#endif
