#include "sensor/glare.h"

#include <math.h>

#include "sensor/stages.h"

static float light_of(const pl_sensor_frame *frame, size_t i) {
  const pl_vec3f bands = frame->bands[i];
  const float sum = pl_maxf(bands.x, 0.0f) + pl_maxf(bands.y, 0.0f) + pl_maxf(bands.z, 0.0f);
  return pl_minf(sum / 3.0f, 1e30f); /* the sun may be brighter than any number */
}

/* Before ghosts: the light itself. After them: the pixel's own part. After vignetting: the light
 * that is its own. After the point-spread function: glare. */
void pl_glare_follow(pl_sensor_frame *frame, const pl_sensor_stage *stage) {
  const size_t count = (size_t)frame->width * (size_t)frame->height;
  float *glare = frame->glare;
  if (stage->run == pl_stage_filters) {
    for (size_t i = 0; i < count; i++)
      glare[i] = light_of(frame, i);
  } else if (stage->run == pl_stage_lens_flare) {
    for (size_t i = 0; i < count; i++)
      glare[i] = glare[i] > 0.0f ? glare[i] / pl_maxf(light_of(frame, i), glare[i]) : 0.0f;
  } else if (stage->run == pl_stage_vignetting) {
    for (size_t i = 0; i < count; i++)
      glare[i] *= light_of(frame, i);
  } else if (stage->run == pl_stage_point_spread) {
    const float full = (float)fmin(pl_sensor_full_radiance(frame->sensor), 1e30);
    for (size_t i = 0; i < count; i++)
      glare[i] = pl_maxf(0.0f, light_of(frame, i) - glare[i]) / full;
  }
}
