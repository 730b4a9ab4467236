/* Random numbers of sensors: pure functions of the seed and of the quantity drawn. */
#ifndef PL_SENSOR_DRAWS_H
#define PL_SENSOR_DRAWS_H

#include <stdint.h>

/* The random quantities. A value must never be reused for another quantity. */
typedef enum pl_draw {
  PL_DRAW_PRNU = 1,
  PL_DRAW_DARK,
  PL_DRAW_SHOT,
  PL_DRAW_READ,
  PL_DRAW_COLUMN,
  PL_DRAW_DEFECT,
  PL_DRAW_RAY,
  PL_DRAW_ROW,
  PL_DRAW_FLICKER,
  PL_DRAW_LIDAR,
  PL_DRAW_TAP,
  PL_DRAW_THRESHOLD,
  PL_DRAW_EVENT,
} pl_draw;

/* Random stream of one quantity: key (seed, quantity), counter (pixel or item, frame, n, 0). */
typedef struct pl_stream {
  uint64_t key[2];
  uint64_t counter[4];
} pl_stream;

/* `frame` is 0 for quantities that are the same in all frames. */
pl_stream pl_stream_of(uint64_t seed, pl_draw what, uint64_t item, uint64_t frame);

/* The next number in [0, 1) with 53 bits. */
double pl_stream_uniform(pl_stream *stream);
/* The next number of the standard normal distribution (Box and Muller 1958). */
double pl_stream_normal(pl_stream *stream);
/* The next number of the Poisson distribution. Exact below a mean of 1e4: by inversion below 10,
 * otherwise by transformed rejection (PTRS of Hoermann, "The transformed rejection method for
 * generating Poisson random variables", 1993). At larger means it is a rounded normal number, whose
 * skewness is wrong by 1/sqrt(mean) < 1 % and whose quantiles are wrong by less than 1/6 of a count
 * (first term of the Cornish-Fisher expansion, within 1 sigma). Returns 0 if the mean is 0,
 * negative or NaN. */
double pl_stream_poisson(pl_stream *stream, double mean);
/* A count that a Poisson number with this mean reaches with a probability of 1e-9 at most, by
 * Chernoff's bound: P(N >= k) <= exp(-mean) (e mean / k)^k. 0 for a mean of 0. */
double pl_poisson_most(double mean);

#endif
