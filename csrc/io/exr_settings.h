/* What writing and reading OpenEXR share: allocations by base/memory.h, and no printed errors. */
#ifndef PL_IO_EXR_SETTINGS_H
#define PL_IO_EXR_SETTINGS_H

#include <OpenEXR/openexr.h>

/* Largest width and height of a file. */
enum { PL_EXR_MAX_SIDE = 65536 };

/* Settings of a context whose reading and writing functions get `user`. */
exr_context_initializer_t pl_exr_settings(void *user);

#endif
