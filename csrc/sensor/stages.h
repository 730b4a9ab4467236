/* The stages of a sensor in the order in which they run, one per file. */
#ifndef PL_SENSOR_STAGES_H
#define PL_SENSOR_STAGES_H

#include "sensor/stage.h"

/* EFFECT: the plan may omit the stage, by the effect row of the same name; STEP: always runs. To
 * add a stage, write its file with the function `pl_stage_NAME` and add its line here. An effect
 * also needs a line in plan/effects.h. */
/* clang-format off */
#define PL_SENSOR_STAGES(EFFECT, STEP) \
  EFFECT(filters) \
  EFFECT(lens_flare) \
  EFFECT(vignetting) \
  EFFECT(point_spread) \
  STEP(electrons) \
  EFFECT(fixed_pattern) \
  EFFECT(smear) \
  EFFECT(dark_current) \
  EFFECT(defects) \
  EFFECT(shot_noise) \
  EFFECT(cosmic_rays) \
  EFFECT(blooming) \
  EFFECT(black_sun) \
  STEP(full_well) \
  EFFECT(read_noise) \
  STEP(digitise) \
  STEP(demosaic)
/* clang-format on */

#define PL_DECLARE(name) pl_status pl_stage_##name(pl_sensor_frame *frame, int value);
PL_SENSOR_STAGES(PL_DECLARE, PL_DECLARE)
#undef PL_DECLARE

#endif
