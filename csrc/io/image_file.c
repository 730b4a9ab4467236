/* Detects image formats; limits common to all of them. */
#include "io/image_file.h"

#include <stdbool.h>
#include <string.h>

#include "base/memory.h"
#include "io/file.h"
#include "io/image_codec.h"

static const uint64_t MAX_TEXELS = 1u << 28;
static const uint64_t MAX_SIDE = 65536; /* limit of pl_image */
static const size_t MAX_FILE = (size_t)1 << 30;
/* Allowance for headers, tables and checksums of any image, so that small files pass. */
static const uint64_t EXPANSION_SLACK = 1u << 16;

typedef struct magic {
  const char *format;
  size_t offset, length;
  const char *bytes;
} magic;

/* Formats that are recognised but not read. Each has its longest known signature, so that random
 * data is not recognised as one of them. */
static const magic refused[] = {
    {"TIFF", 0, 4, "II*\0"},
    {"TIFF", 0, 4, "MM\0*"},
    {"BigTIFF", 0, 4, "II+\0"},
    {"BigTIFF", 0, 4, "MM\0+"},
    {"GIF", 0, 6, "GIF87a"},
    {"GIF", 0, 6, "GIF89a"},
    {"BMP", 0, 2, "BM"},
    {"KTX 2", 0, 12, "\xABKTX 20\xBB\r\n\x1A\n"},
    {"KTX", 0, 12, "\xABKTX 11\xBB\r\n\x1A\n"},
    {"Basis Universal", 0, 2, "sB"},
    {"DDS", 0, 4, "DDS "},
    {"AVIF", 4, 8, "ftypavif"},
    {"HEIF", 4, 8, "ftypheic"},
    {"JPEG 2000", 0, 12, "\0\0\0\x0CjP  \r\n\x87\n"},
    {"JPEG XL", 0, 12, "\0\0\0\x0CJXL \r\n\x87\n"},
    {"OpenEXR", 0, 4, "\x76\x2F\x31\x01"},
    {"Radiance HDR", 0, 10, "#?RADIANCE"},
    {"Photoshop", 0, 4, "8BPS"},
};

static bool has_magic(const uint8_t *bytes, size_t size, size_t offset, const char *expected,
                      size_t length) {
  return size >= offset + length && memcmp(bytes + offset, expected, length) == 0;
}

pl_status pl_image_check_size(const char *name, uint64_t width, uint64_t height,
                              uint64_t sample_bytes, uint64_t size, uint64_t expansion) {
  if (width < 1 || height < 1)
    return pl_fail(PL_E_FORMAT, "%s: image without texels", name);
  if (width > MAX_SIDE || height > MAX_SIDE || width * height > MAX_TEXELS)
    return pl_fail(
        PL_E_RANGE, "%s: image of %llu x %llu texels; at most %llu a side and 2^28 in all are read",
        name, (unsigned long long)width, (unsigned long long)height, (unsigned long long)MAX_SIDE);
  if (sample_bytes > EXPANSION_SLACK && sample_bytes / expansion > size)
    return pl_fail(
        PL_E_FORMAT, "%s: truncated: %llu bytes cannot hold the %llu x %llu texels of its header",
        name, (unsigned long long)size, (unsigned long long)width, (unsigned long long)height);
  return PL_OK;
}

pl_status pl_image_decode(const uint8_t *bytes, size_t size, const char *name, pl_image *out) {
  *out = (pl_image){0};
  if (size == 0)
    return pl_fail(PL_E_FORMAT, "%s: empty image", name);
  if (has_magic(bytes, size, 0, "\x89PNG\r\n\x1A\n", 8))
    return pl_png_decode(bytes, size, name, out);
  if (has_magic(bytes, size, 0, "\xFF\xD8\xFF", 3))
    return pl_jpeg_decode(bytes, size, name, out);
  if (has_magic(bytes, size, 0, "RIFF", 4) && has_magic(bytes, size, 8, "WEBP", 4))
    return pl_webp_decode(bytes, size, name, out);
  for (size_t i = 0; i < sizeof refused / sizeof refused[0]; i++)
    if (has_magic(bytes, size, refused[i].offset, refused[i].bytes, refused[i].length))
      return pl_fail(PL_E_UNSUPPORTED, "%s: %s images are not supported; use PNG, JPEG or WebP",
                     name, refused[i].format);
  return pl_fail(PL_E_FORMAT, "%s: not a PNG, JPEG or WebP image", name);
}

pl_status pl_image_load(const char *path, pl_image *out) {
  *out = (pl_image){0};
  uint8_t *bytes;
  size_t size;
  PL_TRY(pl_file_read(path, MAX_FILE, &bytes, &size));
  const pl_status status = pl_image_decode(bytes, size, path, out);
  pl_free(bytes);
  return status;
}
