/* Channels of the materials of surfaces. */
#ifndef PL_ANNOTATE_SURFACE_CHANNELS_H
#define PL_ANNOTATE_SURFACE_CHANNELS_H

#include "annotate/channel.h"

/* Writes (count, 3): the colour that materials and maps state, over the footprint of each pixel. */
void pl_write_albedo(const pl_label_run *run, void *pixels);

#endif
