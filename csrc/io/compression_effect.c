/* The effect `compression`: changes of the sensor's image by JPEG. */
#include <math.h>

#include "plan/effects.h"
#include "sensor/stage.h"

/* ITU-T T.81, tables K.1 and K.2, row-major by frequency. */
static const int luma[64] = {16, 11, 10, 16, 24,  40,  51,  61,  12, 12, 14, 19, 26,  58,  60,  55,
                             14, 13, 16, 24, 40,  57,  69,  56,  14, 17, 22, 29, 51,  87,  80,  62,
                             18, 22, 37, 56, 68,  109, 103, 77,  24, 35, 55, 64, 81,  104, 113, 92,
                             49, 64, 78, 87, 103, 121, 120, 101, 72, 92, 95, 98, 112, 100, 103, 99};
static const int chroma[64] = {17, 18, 24, 47, 99, 99, 99, 99, 18, 21, 26, 66, 99, 99, 99, 99,
                               24, 26, 56, 99, 99, 99, 99, 99, 47, 66, 99, 99, 99, 99, 99, 99,
                               99, 99, 99, 99, 99, 99, 99, 99, 99, 99, 99, 99, 99, 99, 99, 99,
                               99, 99, 99, 99, 99, 99, 99, 99, 99, 99, 99, 99, 99, 99, 99, 99};

/* Returns a quantisation step of a table at a quality, scaled as in libjpeg. */
static int step(const int table[64], int quality, int i) {
  const int scale = quality < 50 ? 5000 / quality : 200 - 2 * quality;
  const int value = (table[i] * scale + 50) / 100;
  return value < 1 ? 1 : value > 255 ? 255 : value;
}

/* Upper bound of the error of a sample: each coefficient is off by at most half a step and
 * contributes to the sample with C(u) C(v) / 4 (T.81, A.3.3); roundings before and after add one
 * half each. */
static double sample_error(const int table[64], int quality) {
  double sum = 1.0;
  for (int i = 0; i < 64; i++) {
    const double weight = (i % 8 == 0 ? sqrt(0.5) : 1.0) * (i / 8 == 0 ? sqrt(0.5) : 1.0) / 4.0;
    sum += weight * (0.5 * step(table, quality, i) + 0.125); /* integer transforms add an eighth */
  }
  return sum;
}

static const char *absent(const pl_view *view) {
  const char *none = pl_sensor_absent(view);
  if (none != NULL)
    return none;
  return view->sensor->compression.quality > 0 ? NULL : "the image is not compressed";
}

/* Grey stays grey. Subsampled chroma is averaged over several pixels, so there is no bound below
 * 255. Otherwise blue has the largest error: that of the luminance and 1.772 times that of the
 * chroma (ITU-T T.871, 7). */
static double bound_dn(const pl_view *view, int value) {
  const pl_compression *c = &view->sensor->compression;
  if (value > 0)
    return 0.0;
  double error = sample_error(luma, c->quality) + 1.0;
  if (view->sensor->mosaic != PL_MOSAIC_MONO)
    error = c->chroma == PL_CHROMA_444 ? error + 1.772 * sample_error(chroma, c->quality) : 255.0;
  return fmin(255.0, error);
}

static double cost_ms(const pl_view *view, int value) {
  return pl_sensor_cost_ms(view, 20.0 * value);
}

const pl_effect pl_effect_compression = {
    .name = "compression",
    .doc = "Sensor: compression artefacts of JPEG",
    .absent = absent,
    .ceiling = pl_effect_ceiling_one,
    .bound_dn = bound_dn,
    .cost_ms = cost_ms,
};
