/* The stages' functions, one a file; see the table in stage.c. */
#ifndef PL_SENSOR_STAGES_H
#define PL_SENSOR_STAGES_H

#include "sensor/stage.h"

pl_status pl_stage_filters(pl_sensor_frame *frame, int value);
pl_status pl_stage_point_spread(pl_sensor_frame *frame, int value);
pl_status pl_stage_vignetting(pl_sensor_frame *frame, int value);
pl_status pl_stage_lens_flare(pl_sensor_frame *frame, int value);
pl_status pl_stage_smear(pl_sensor_frame *frame, int value);
pl_status pl_stage_defects(pl_sensor_frame *frame, int value);
pl_status pl_stage_cosmic_rays(pl_sensor_frame *frame, int value);
pl_status pl_stage_blooming(pl_sensor_frame *frame, int value);
pl_status pl_stage_black_sun(pl_sensor_frame *frame, int value);
pl_status pl_stage_electrons(pl_sensor_frame *frame, int value);
pl_status pl_stage_fixed_pattern(pl_sensor_frame *frame, int value);
pl_status pl_stage_dark_current(pl_sensor_frame *frame, int value);
pl_status pl_stage_shot_noise(pl_sensor_frame *frame, int value);
pl_status pl_stage_full_well(pl_sensor_frame *frame, int value);
pl_status pl_stage_read_noise(pl_sensor_frame *frame, int value);
pl_status pl_stage_digitise(pl_sensor_frame *frame, int value);
pl_status pl_stage_demosaic(pl_sensor_frame *frame, int value);

#endif
