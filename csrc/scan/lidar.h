/* A LiDAR's receiver: from the echoes of a beam's rays to returns. */
#ifndef PL_SCAN_LIDAR_H
#define PL_SCAN_LIDAR_H

#include <stddef.h>
#include <stdint.h>

#include "base/status.h"

enum { PL_LIDAR_RETURNS_MAX = 8 };

typedef enum pl_lidar_keep {
  PL_LIDAR_ALL,
  PL_LIDAR_FIRST,
  PL_LIDAR_STRONGEST,
  PL_LIDAR_LAST,
  PL_LIDAR_KEEPS
} pl_lidar_keep;

typedef struct pl_lidar {
  uint64_t seed, frame, stream; /* key of the random numbers; stream: which LiDAR */
  int most;                     /* returns of a beam, 1..PL_LIDAR_RETURNS_MAX: the strongest */
  pl_lidar_keep keep;
  /* Surfaces farther apart along the beam than this give returns of their own, m: half the length
   * of the pulse. */
  double resolution_m;
  double min_m, max_m; /* ranges that are reported */
  double reference_m;  /* range at which a white target that fills the beam has the intensity 1 */
  double least_intensity; /* what is detected */
  double dropout;         /* probability that a return is lost */
  double noise_m;         /* standard deviation of the range */
  double shot_noise_m;    /* and at an intensity of 1 that which falls with its root */
  double gain_noise;      /* relative standard deviation of the intensity */
  double ambiguity_m;     /* ranges are modulo this; 0: not */
} pl_lidar;
/* Returns PL_E_RANGE, naming the value. */
pl_status pl_lidar_check(const pl_lidar *lidar);

/* An echo of one of a beam's rays. */
typedef struct pl_lidar_echo {
  double range_m;
  double reflectance; /* over the number of the beam's rays; see pl_echo */
  uint32_t index;     /* the caller's */
} pl_lidar_echo;

typedef struct pl_lidar_return {
  double range_m; /* as measured */
  double true_m;  /* without noise: the mean over its echoes, weighted by their power */
  double intensity, reflectance;
  uint32_t strongest; /* index of its strongest echo */
  int number, count;  /* 1.. by range, of the beam's returns */
} pl_lidar_return;

/* Writes the returns of a beam, nearest first, and returns their number. Sorts the echoes. */
int pl_lidar_receive(const pl_lidar *lidar, uint64_t beam, pl_lidar_echo *echoes, size_t count,
                     pl_lidar_return out[PL_LIDAR_RETURNS_MAX]);

#endif
