/* Random numbers of the stages: pure functions of what is drawn. */
#ifndef PL_SENSOR_DRAWS_H
#define PL_SENSOR_DRAWS_H

#include <stdint.h>

/* What is drawn; a number is never used again for something else. */
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
} pl_draw;

/* The stream of one quantity: key (seed, quantity), counter (pixel or item, frame, n, 0). */
typedef struct pl_stream {
  uint64_t key[2];
  uint64_t counter[4];
} pl_stream;

/* `frame` is 0 for what is the same in all frames. */
pl_stream pl_stream_of(uint64_t seed, pl_draw what, uint64_t item, uint64_t frame);

/* The next number in [0, 1) of 53 bits; never 0 where `open`, so that its logarithm is finite. */
double pl_stream_uniform(pl_stream *stream);
double pl_stream_open(pl_stream *stream);
/* Of the standard normal distribution (Box and Muller 1958). */
double pl_stream_normal(pl_stream *stream);
/* Of the Poisson distribution. Exact below a mean of 1e4: inversion below 10, from there
 * transformed rejection (PTRS of Hoermann, "The transformed rejection method for generating Poisson
 * random variables", 1993). Above, the rounded normal, whose skewness is wrong by 1/sqrt(mean) < 1
 * % and whose quantiles by less than 1/6 of a count (Cornish and Fisher's first term at 1 sigma of
 * 0). 0 for a mean of 0, NaN and below. */
double pl_stream_poisson(pl_stream *stream, double mean);
/* A number of counts that a Poisson draw of this mean reaches once in 1e9 at most, by Chernoff's
 * bound: P(N >= k) <= exp(-mean) (e mean / k)^k. 0 for a mean of 0. */
double pl_poisson_most(double mean);

#endif
