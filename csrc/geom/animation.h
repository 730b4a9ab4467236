/* Animations of a model file: keyframes of the translation, rotation and scale of nodes. */
#ifndef PL_GEOM_ANIMATION_H
#define PL_GEOM_ANIMATION_H

#include "geom/node.h"

#ifdef __cplusplus
extern "C" {
#endif

typedef enum pl_track_path {
  PL_TRACK_TRANSLATION,
  PL_TRACK_ROTATION,
  PL_TRACK_SCALE
} pl_track_path;
typedef enum pl_interpolation { PL_STEP, PL_LINEAR, PL_CUBIC } pl_interpolation;

/* One property of one node over time, in model axes. A value is (x, y, z), or the quaternion (w, x,
 * y, z) of a rotation. With PL_CUBIC each key holds in-tangent, value and out-tangent
 * (glTF 2.0, 3.11). */
typedef struct pl_track {
  int node;
  pl_track_path path;
  pl_interpolation interpolation;
  size_t count;  /* number of keys, at least one */
  float *times;  /* owned; s, strictly increasing */
  float *values; /* owned */
} pl_track;

typedef struct pl_animation {
  char *name;             /* owned, never NULL; "animation N" when the file gives none */
  double start_s, stop_s; /* time range of all keys, s */
  pl_track *tracks;       /* owned */
  size_t count;
} pl_animation;

typedef enum pl_loop { PL_LOOP_REPEAT, PL_LOOP_CLAMP, PL_LOOP_PINGPONG } pl_loop;

void pl_animation_clear(pl_animation *animation);

/* Returns the animation's local time after `t_s` seconds of playback. It repeats [start_s, stop_s],
 * plays it once, or plays it alternately forwards and backwards. An animation without duration
 * stays at its start. Precondition: t_s is finite. */
double pl_animation_time(const pl_animation *animation, pl_loop loop, double t_s);

/* Samples a track at the animation's local time `t_s` and writes the property into *trs (glTF 2.0,
 * appendix C). Before the first key the value is that of the first key, after the last key that of
 * the last. Rotations are interpolated along the shorter arc (linear) or normalised (cubic
 * spline). */
void pl_track_sample(const pl_track *track, double t_s, pl_trs *trs);

#ifdef __cplusplus
}
#endif
#endif
