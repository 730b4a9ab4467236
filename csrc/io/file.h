/* Reads whole files up to a size limit. Internal to io. */
#ifndef PL_IO_FILE_H
#define PL_IO_FILE_H

#include <stddef.h>
#include <stdint.h>

#include "base/status.h"

#ifdef __cplusplus
extern "C" {
#endif

/* Reads a regular file of at most `limit` bytes into memory that the caller frees (pl_free).
 * Returns PL_E_IO when it cannot be read or is not a regular file, PL_E_RANGE when it is larger. */
pl_status pl_file_read(const char *path, size_t limit, uint8_t **bytes, size_t *size);

#ifdef __cplusplus
}
#endif
#endif
