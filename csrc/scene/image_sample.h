/* Samples of pixels: the one place that says which ray belongs to a pixel, a sample and a time. The
 * direction through a position of the image is that of the snapshot's ray source. */
#ifndef PL_SCENE_IMAGE_SAMPLE_H
#define PL_SCENE_IMAGE_SAMPLE_H

#include "scene/snapshot.h"

/* Position of colour sample `index` in its pixel, relative to the centre; `samples`: the usual
 * number of samples. It is the Sobol (0,2)-sequence, shifted digitally so that its first point is
 * the centre, where the labels' ray serves as a colour sample. Every aligned run of 2^k samples has
 * one in each cell of every division into 2^k cells. The samples below `samples` are evenly
 * distributed about the centre; later ones fill the gaps. */
void pl_image_sample_offset(uint32_t index, int samples, double offset[2]);

/* Sets the ray of sample `index` of pixel (x, y), root axes; `offset` is that of the sample, `seed`
 * the pixel's random word. With an aperture the ray starts at a point of the lens: uniform on its
 * disc, and stratified over the samples of the pixel. The direction is zero where the lens has no
 * ray. */
void pl_image_sample_ray(const pl_snapshot *shot, uint32_t index, const double offset[2], int x,
                         int y, uint32_t seed, pl_vec3 *origin, pl_vec3 *direction);

/* Diameter of the circle of confusion at distance t along a camera ray, m there. */
double pl_image_confusion_m(const pl_snapshot *shot, pl_vec3 direction, double t);

/* One instant of an exposure that is the mean over several. Sample j of `samples` of a pixel in row
 * y has the time offset_s + y row_s + spread_s (j + r) / samples, with r random in 0..1. It is
 * rendered at the nearest of `count` instants, which are evenly spaced over span_s from start_s. */
typedef struct pl_slice {
  int instant, count;
  double start_s, span_s;
  double offset_s, row_s, spread_s;
} pl_slice;

/* Whether a sample of a pixel in row y is of this instant. */
bool pl_slice_has(const pl_slice *slice, int y, uint32_t seed, int sample, int samples);
/* Sets the first sample of a row that may be of this instant, and the end of the range. */
void pl_slice_range(const pl_slice *slice, int y, int samples, int range[2]);

#endif
