/* A model's own animations: keyframes of nodes' translation, rotation and scale. */
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

/* One property of one node over time, in the model's axes. A value is (x, y, z), or (w, x, y, z) of
 * a rotation. With PL_CUBIC each key holds in-tangent, value, out-tangent (glTF 2.0, 3.11). */
typedef struct pl_track {
  int node;
  pl_track_path path;
  pl_interpolation interpolation;
  size_t count;  /* keys, at least one */
  float *times;  /* owned; s, strictly increasing */
  float *values; /* owned */
} pl_track;

typedef struct pl_animation {
  char *name;             /* owned, never NULL; "animation N" when the file gives none */
  double start_s, stop_s; /* of all keys */
  pl_track *tracks;       /* owned */
  size_t count;
} pl_animation;

typedef enum pl_loop { PL_LOOP_REPEAT, PL_LOOP_CLAMP, PL_LOOP_PINGPONG } pl_loop;

void pl_animation_clear(pl_animation *animation);

/* The animation's own time at `t_s` seconds of play: [start_s, stop_s] again and again, once, or to
 * and fro. An animation without duration stays at its start. t_s must be finite. */
double pl_animation_time(const pl_animation *animation, pl_loop loop, double t_s);

/* The value of a track at the animation's own time `t_s`: before the first key its value, after the
 * last its; rotations are interpolated on the short arc (linear) or normalised (cubic spline).
 * Appendix C of glTF 2.0. Writes the property into *trs. */
void pl_track_sample(const pl_track *track, double t_s, pl_trs *trs);

#ifdef __cplusplus
}
#endif
#endif
