/* Orders of bytes in which arrays compress better, as files have them. */
#ifndef PL_IO_SHUFFLE_H
#define PL_IO_SHUFFLE_H

#include <stddef.h>
#include <stdint.h>

/* OpenEXR's for ZIP: all even bytes, then the odd ones; of all but the first the difference to the
 * one before, plus 128. `spare` has `size` bytes, too. */
void pl_shuffle_exr(const uint8_t *data, size_t size, uint8_t *spare, uint8_t *out);

#endif
