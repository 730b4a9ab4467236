/* Samples keyframe animations (glTF 2.0, appendix C). */
#include "geom/animation.h"

#include "base/memory.h"

void pl_animation_clear(pl_animation *animation) {
  for (size_t i = 0; animation->tracks != NULL && i < animation->count; i++) {
    pl_free(animation->tracks[i].times);
    pl_free(animation->tracks[i].values);
  }
  pl_free(animation->tracks);
  pl_free(animation->name);
  *animation = (pl_animation){0};
}

double pl_animation_time(const pl_animation *animation, pl_loop loop, double t_s) {
  const double length = animation->stop_s - animation->start_s;
  if (!(length > 0.0))
    return animation->start_s;
  if (loop == PL_LOOP_CLAMP)
    return animation->start_s + fmin(fmax(t_s, 0.0), length);
  const double period = loop == PL_LOOP_PINGPONG ? 2.0 * length : length;
  double phase = fmod(t_s, period);
  if (phase < 0.0)
    phase += period;
  return animation->start_s + (phase > length ? period - phase : phase);
}

static size_t components_of(const pl_track *track) {
  return track->path == PL_TRACK_ROTATION ? 4 : 3;
}

/* Returns the index of the last key at or before t, or 0 when there is none. */
static size_t key_before(const pl_track *track, double t) {
  size_t low = 0, high = track->count;
  while (high - low > 1) {
    const size_t middle = low + (high - low) / 2;
    if ((double)track->times[middle] <= t)
      low = middle;
    else
      high = middle;
  }
  return low;
}

/* Returns row `which` of key `k`: one of the three rows of a cubic key, or the only one. */
static const float *row_of(const pl_track *track, size_t k, size_t which) {
  const size_t rows = track->interpolation == PL_CUBIC ? 3 : 1;
  return track->values + components_of(track) * (rows * k + (rows == 3 ? which : 0));
}

static pl_quat quat_of(const double v[4]) {
  return pl_quat_unit((pl_quat){v[0], v[1], v[2], v[3]});
}

static void store(const pl_track *track, const double v[4], pl_trs *trs) {
  switch (track->path) {
  case PL_TRACK_TRANSLATION:
    trs->t = (pl_vec3){v[0], v[1], v[2]};
    return;
  case PL_TRACK_ROTATION:
    trs->q = quat_of(v);
    return;
  case PL_TRACK_SCALE:
    trs->s = (pl_vec3){v[0], v[1], v[2]};
    return;
  }
}

static void hermite(const pl_track *track, size_t k, double u, double step, double out[4]) {
  const double u2 = u * u, u3 = u2 * u;
  const float *v0 = row_of(track, k, 1), *b0 = row_of(track, k, 2);
  const float *v1 = row_of(track, k + 1, 1), *a1 = row_of(track, k + 1, 0);
  for (size_t c = 0; c < components_of(track); c++)
    out[c] = (2.0 * u3 - 3.0 * u2 + 1.0) * (double)v0[c] +
             step * (u3 - 2.0 * u2 + u) * (double)b0[c] + (3.0 * u2 - 2.0 * u3) * (double)v1[c] +
             step * (u3 - u2) * (double)a1[c];
}

static void linear(const pl_track *track, size_t k, double u, double out[4]) {
  const float *a = row_of(track, k, 1), *b = row_of(track, k + 1, 1);
  if (track->path == PL_TRACK_ROTATION) {
    const double from[4] = {a[0], a[1], a[2], a[3]}, to[4] = {b[0], b[1], b[2], b[3]};
    const pl_quat q = pl_quat_slerp(quat_of(from), quat_of(to), u);
    out[0] = q.w;
    out[1] = q.x;
    out[2] = q.y;
    out[3] = q.z;
    return;
  }
  for (size_t c = 0; c < 3; c++)
    out[c] = (1.0 - u) * (double)a[c] + u * (double)b[c];
}

void pl_track_sample(const pl_track *track, double t_s, pl_trs *trs) {
  const size_t k = key_before(track, t_s);
  const float *key = row_of(track, k, 1);
  double v[4] = {0.0, 0.0, 0.0, 0.0};
  const bool between = k + 1 < track->count && t_s > (double)track->times[k];
  if (!between || track->interpolation == PL_STEP) {
    for (size_t c = 0; c < components_of(track); c++)
      v[c] = (double)key[c];
  } else {
    const double step = (double)track->times[k + 1] - (double)track->times[k];
    const double u = (t_s - (double)track->times[k]) / step;
    if (track->interpolation == PL_CUBIC)
      hermite(track, k, u, step, v);
    else
      linear(track, k, u, v);
  }
  store(track, v, trs);
}
