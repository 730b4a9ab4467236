/* Returns of a pulsed LiDAR. A pulse that meets several surfaces comes back as several pulses where
 * these are farther apart than half its length; otherwise as one, whose centroid is measured. */
#include "scan/lidar.h"

#include <math.h>
#include <stdbool.h>
#include <stdlib.h>

#include "sensor/draws.h"

static pl_status check_at_least(const char *name, double value, double least) {
  if (value >= least && isfinite(value))
    return PL_OK;
  return pl_fail(PL_E_RANGE, "lidar: %s must be finite and at least %g, not %g", name, least,
                 value);
}

pl_status pl_lidar_check(const pl_lidar *lidar) {
  PL_TRY(check_at_least("min_range_m", lidar->min_m, 0.0));
  PL_TRY(check_at_least("max_range_m", lidar->max_m, lidar->min_m));
  PL_TRY(check_at_least("resolution_m", lidar->resolution_m, 0.0));
  PL_TRY(check_at_least("reference_m", lidar->reference_m, 1e-9));
  PL_TRY(check_at_least("least_intensity", lidar->least_intensity, 0.0));
  PL_TRY(check_at_least("dropout", lidar->dropout, 0.0));
  PL_TRY(check_at_least("noise_m", lidar->noise_m, 0.0));
  PL_TRY(check_at_least("shot_noise_m", lidar->shot_noise_m, 0.0));
  PL_TRY(check_at_least("gain_noise", lidar->gain_noise, 0.0));
  PL_TRY(check_at_least("ambiguity_m", lidar->ambiguity_m, 0.0));
  if (lidar->most < 1 || lidar->most > PL_LIDAR_RETURNS_MAX)
    return pl_fail(PL_E_RANGE, "lidar: returns must be in 1..%d, not %d", PL_LIDAR_RETURNS_MAX,
                   lidar->most);
  return PL_OK;
}

static int by_range(const void *a, const void *b) {
  const pl_lidar_echo *one = a, *other = b;
  if (one->range_m != other->range_m)
    return one->range_m < other->range_m ? -1 : 1;
  return one->index < other->index ? -1 : one->index > other->index;
}

/* Echoes that come back as one pulse. */
static pl_lidar_return gather(const pl_lidar *lidar, const pl_lidar_echo *echoes, size_t count) {
  pl_lidar_return out = {.strongest = echoes[0].index};
  double most = -1.0, weight = 0.0;
  /* Relative to the first: a mean of equal ranges is that range. */
  const double base_m = echoes[0].range_m;
  double beyond = 0.0;
  for (size_t i = 0; i < count; i++) {
    const double part = lidar->reference_m / echoes[i].range_m;
    const double power = echoes[i].reflectance * part * part;
    out.reflectance += echoes[i].reflectance;
    out.intensity += power;
    weight += power;
    beyond += power * (echoes[i].range_m - base_m);
    if (power > most) {
      most = power;
      out.strongest = echoes[i].index;
    }
  }
  out.true_m = base_m + (weight > 0.0 ? beyond / weight : 0.0);
  return out;
}

/* Random numbers of a return; beams have 26 bits, pulses of a beam 16. */
static pl_stream draws_of(const pl_lidar *lidar, uint64_t beam, uint64_t nth) {
  return pl_stream_of(lidar->seed, PL_DRAW_LIDAR, beam | nth << 32 | lidar->stream << 48,
                      lidar->frame);
}

/* What the receiver makes of a pulse; false if it does not report it. */
static bool measure(const pl_lidar *lidar, uint64_t beam, uint64_t nth, pl_lidar_return *pulse) {
  pl_stream draws = draws_of(lidar, beam, nth);
  const bool lost = pl_stream_uniform(&draws) < lidar->dropout;
  if (lost || !(pulse->intensity > 0.0) || pulse->intensity < lidar->least_intensity)
    return false;
  const double shot_m = lidar->shot_noise_m / sqrt(pulse->intensity);
  const double noise_m = hypot(lidar->noise_m, shot_m);
  pulse->range_m = pulse->true_m + noise_m * pl_stream_normal(&draws);
  if (lidar->ambiguity_m > 0.0)
    pulse->range_m -= lidar->ambiguity_m * floor(pulse->range_m / lidar->ambiguity_m);
  const double gain = 1.0 + lidar->gain_noise * pl_stream_normal(&draws);
  pulse->intensity = fmax(pulse->intensity * gain, 0.0);
  return pulse->range_m >= lidar->min_m && pulse->range_m <= lidar->max_m;
}

/* Adds a pulse if it is among the `most` strongest; the pulses stay in order of their range. */
static int insert(const pl_lidar *lidar, const pl_lidar_return *pulse, pl_lidar_return *out,
                  int count) {
  int weakest = 0;
  if (count < lidar->most) {
    out[count] = *pulse;
    return count + 1;
  }
  for (int i = 1; i < count; i++)
    if (out[i].intensity < out[weakest].intensity)
      weakest = i;
  if (pulse->intensity <= out[weakest].intensity)
    return count;
  for (int i = weakest; i + 1 < count; i++)
    out[i] = out[i + 1];
  out[count - 1] = *pulse;
  return count;
}

static int keep_one(const pl_lidar *lidar, pl_lidar_return *out, int count) {
  int one = lidar->keep == PL_LIDAR_LAST ? count - 1 : 0;
  if (lidar->keep == PL_LIDAR_ALL || count == 0)
    return count;
  for (int i = 1; lidar->keep == PL_LIDAR_STRONGEST && i < count; i++)
    if (out[i].intensity > out[one].intensity)
      one = i;
  out[0] = out[one];
  return 1;
}

int pl_lidar_receive(const pl_lidar *lidar, uint64_t beam, pl_lidar_echo *echoes, size_t count,
                     pl_lidar_return out[PL_LIDAR_RETURNS_MAX]) {
  int found = 0;
  uint64_t nth = 0;
  qsort(echoes, count, sizeof *echoes, by_range);
  for (size_t i = 0, end; i < count; i = end, nth++) {
    for (end = i + 1; end < count; end++)
      if (echoes[end].range_m - echoes[end - 1].range_m > lidar->resolution_m)
        break;
    pl_lidar_return pulse = gather(lidar, echoes + i, end - i);
    if (measure(lidar, beam, nth, &pulse))
      found = insert(lidar, &pulse, out, found);
  }
  for (int i = 0; i < found; i++) {
    out[i].number = i + 1;
    out[i].count = found;
  }
  return keep_one(lidar, out, found);
}
