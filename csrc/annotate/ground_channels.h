/* Channels of the ground: heights and slopes on bodies. */
#ifndef PL_ANNOTATE_GROUND_CHANNELS_H
#define PL_ANNOTATE_GROUND_CHANNELS_H

#include "annotate/channel.h"

void pl_write_elevation(const pl_label_run *run, void *pixels);
void pl_write_altitude(const pl_label_run *run, void *pixels);
void pl_write_slope(const pl_label_run *run, void *pixels);

#endif
