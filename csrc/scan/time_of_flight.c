/* Continuous-wave time of flight with four taps a modulation (Lange and Seitz, "Solid-state
 * time-of-flight range camera", IEEE J. Quantum Electronics 37, 2001). The taps of a pixel add up
 * the light of all that it sees, so that pixels at edges measure something between or, by
 * wrap-around, beyond: flying pixels. */
#include "scan/time_of_flight.h"

#include <math.h>
#include <stdbool.h>

#include "math/vec.h"
#include "sensor/draws.h"

#define LIGHT_M_S 299792458.0
enum { TAPS = 4, WRAPS_MAX = 65536 };

static pl_status check_number(const char *name, double value, double least, double most) {
  if (value >= least && value <= most)
    return PL_OK;
  return pl_fail(PL_E_RANGE, "time_of_flight: %s must be in %g..%g, not %g", name, least, most,
                 value);
}

static double divisor(double a, double b) {
  while (b > 0.5) {
    const double rest = fmod(a, b);
    a = b;
    b = rest;
  }
  return a;
}

/* Largest distance that is told apart: that of the modulations' common period. */
static double ambiguity_m(const pl_time_of_flight *camera) {
  double common = camera->modulation_hz[0];
  for (int i = 1; i < camera->modulations; i++)
    common = divisor(common, camera->modulation_hz[i]);
  return 0.5 * LIGHT_M_S / common;
}

/* Index of the highest modulation. */
static int finest(const pl_time_of_flight *camera) {
  int best = 0;
  for (int i = 1; i < camera->modulations; i++)
    if (camera->modulation_hz[i] > camera->modulation_hz[best])
      best = i;
  return best;
}

static double period_m(const pl_time_of_flight *camera, int i) {
  return 0.5 * LIGHT_M_S / camera->modulation_hz[i];
}

pl_status pl_time_of_flight_check(const pl_time_of_flight *camera) {
  if (camera->modulations < 1 || camera->modulations > PL_MODULATIONS_MAX)
    return pl_fail(PL_E_RANGE, "time_of_flight: modulations must be 1..%d, not %d",
                   PL_MODULATIONS_MAX, camera->modulations);
  for (int i = 0; i < camera->modulations; i++) {
    const double hz = camera->modulation_hz[i];
    PL_TRY(check_number("modulation_hz", hz, 1.0, 1e12));
    if (hz != floor(hz))
      return pl_fail(PL_E_RANGE, "time_of_flight: modulation_hz must be whole numbers, not %g", hz);
  }
  PL_TRY(check_number("signal_e", camera->signal_e, 0.0, 1e30));
  PL_TRY(check_number("ambient_e", camera->ambient_e, 0.0, 1e30));
  PL_TRY(check_number("read_e", camera->read_e, 0.0, 1e30));
  PL_TRY(check_number("contrast", camera->contrast, 0.0, 1.0));
  PL_TRY(check_number("full_well_e", camera->full_well_e, 0.0, 1e30));
  PL_TRY(check_number("least_e", camera->least_e, 0.0, 1e30));
  const double wraps = ambiguity_m(camera) / period_m(camera, finest(camera));
  if (wraps > WRAPS_MAX)
    return pl_fail(PL_E_RANGE,
                   "time_of_flight: the modulations repeat together only after %.0f periods of the "
                   "finest, more than %d",
                   wraps, WRAPS_MAX);
  return PL_OK;
}

/* A difference of phases, in -pi..pi. */
static double wrapped(double phase) { return remainder(phase, 2.0 * PL_PI); }

/* Phase and amplitude of a modulation from its taps; counts those that are full. */
static double expose(const pl_time_of_flight *camera, int modulation, pl_stream *draws,
                     const pl_time_of_flight_echo *echoes, size_t count, double *amplitude,
                     double *offset, bool *full) {
  double taps[TAPS];
  *offset = 0.0;
  for (int k = 0; k < TAPS; k++) {
    double mean = camera->ambient_e;
    for (size_t i = 0; i < count; i++) {
      const double r = echoes[i].range_m;
      const double signal = camera->signal_e * echoes[i].power / (r * r) / TAPS;
      const double phase = 2.0 * PL_PI * fmod(r / period_m(camera, modulation), 1.0);
      mean += signal * (1.0 + camera->contrast * cos(phase - 0.5 * PL_PI * k));
    }
    const double charge = pl_stream_poisson(draws, mean);
    *full = *full || (camera->full_well_e > 0.0 && charge >= camera->full_well_e);
    taps[k] = charge + camera->read_e * pl_stream_normal(draws);
    *offset += taps[k] / TAPS;
  }
  const double real = taps[0] - taps[2], imaginary = taps[1] - taps[3];
  *amplitude = 0.5 * hypot(real, imaginary);
  return atan2(imaginary, real);
}

/* Phase of modulation `i` less that of a range. */
static double off(const pl_time_of_flight *camera, const double *phases, int i, double range_m) {
  return wrapped(phases[i] - 2.0 * PL_PI * fmod(range_m / period_m(camera, i), 1.0));
}

/* The range in the common period that fits all phases best: of the ranges that fit the finest
 * modulation the one with the least squares, then their mean by squared frequency. */
static double unwrap(const pl_time_of_flight *camera, const double *phases) {
  const int fine = finest(camera);
  const double step_m = period_m(camera, fine), common_m = ambiguity_m(camera);
  const double turn = phases[fine] / (2.0 * PL_PI), first_m = step_m * (turn - floor(turn));
  const int wraps = (int)floor(common_m / step_m + 0.5);
  double best_m = first_m, least = INFINITY;
  for (int n = 0; n < wraps; n++) {
    double sum = 0.0;
    for (int i = 0; i < camera->modulations; i++) {
      const double d = off(camera, phases, i, first_m + n * step_m);
      sum += d * d;
    }
    if (sum < least) {
      least = sum;
      best_m = first_m + n * step_m;
    }
  }
  double shift = 0.0, weight = 0.0;
  for (int i = 0; i < camera->modulations; i++) {
    const double f = camera->modulation_hz[i] / camera->modulation_hz[fine];
    shift += f * f * off(camera, phases, i, best_m) / (2.0 * PL_PI) * period_m(camera, i);
    weight += f * f;
  }
  const double range_m = best_m + shift / weight;
  return range_m - common_m * floor(range_m / common_m);
}

/* Mean range of the echoes by power, and whether they are of one surface. */
static void summarise(const pl_time_of_flight_echo *echoes, size_t count,
                      pl_time_of_flight_pixel *out) {
  double weight = 0.0, sum = 0.0;
  for (size_t i = 0; i < count; i++) {
    const double part = echoes[i].power / (echoes[i].range_m * echoes[i].range_m);
    weight += part;
    sum += part * (echoes[i].range_m - echoes[0].range_m);
    if (echoes[i].surface != echoes[0].surface)
      out->echoes = 2;
  }
  if (out->echoes == 0 && count > 0)
    out->echoes = 1;
  out->true_range_m = count > 0 ? echoes[0].range_m + (weight > 0.0 ? sum / weight : 0.0) : NAN;
}

void pl_time_of_flight_measure(const pl_time_of_flight *camera, uint64_t pixel,
                               const pl_time_of_flight_echo *echoes, size_t count,
                               pl_time_of_flight_pixel *out) {
  pl_stream draws = pl_stream_of(camera->seed, PL_DRAW_TAP, pixel, camera->frame);
  double phases[PL_MODULATIONS_MAX], least = INFINITY;
  bool full = false;
  *out = (pl_time_of_flight_pixel){.range_m = NAN};
  summarise(echoes, count, out);
  for (int i = 0; i < camera->modulations; i++) {
    double amplitude, offset;
    phases[i] = expose(camera, i, &draws, echoes, count, &amplitude, &offset, &full);
    least = fmin(least, amplitude);
    if (i == 0)
      out->offset_e = (float)offset;
  }
  out->amplitude_e = (float)least;
  out->full = full;
  if (!full && least >= camera->least_e && least > 0.0)
    out->range_m = unwrap(camera, phases);
}
