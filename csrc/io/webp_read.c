/* WebP decoder (RFC 9649) with libwebp, safe for malicious input. (libwebp's own memory, a few rows
 * or, for lossless files, four bytes per texel, is not allocated through the allocation hook.) */
#include <string.h>

#include <webp/decode.h>

#include "io/image_codec.h"

/* Decoded bytes that are allowed for a file of any size: an image of one colour takes a few hundred
 * bytes at any dimensions (RFC 9649, 3.7.2: codes of one symbol take no bits). */
static const uint64_t WEBP_FREE = (uint64_t)1 << 26;
/* Decoded bytes per byte of the file that are allowed beyond that. Lossy files of one colour reach
 * 1700. */
enum { WEBP_EXPANSION = 4096 };
/* Size of the header: "RIFF", the size and "WEBP". The size counts the bytes that follow it. */
enum { RIFF_HEADER = 12, RIFF_COUNTED_FROM = 8 };

static uint64_t riff_size(const uint8_t *bytes) {
  return RIFF_COUNTED_FROM + ((uint64_t)bytes[4] | (uint64_t)bytes[5] << 8 |
                              (uint64_t)bytes[6] << 16 | (uint64_t)bytes[7] << 24);
}

static const char *fault_of(VP8StatusCode code) {
  switch (code) {
  case VP8_STATUS_NOT_ENOUGH_DATA:
    return "truncated";
  case VP8_STATUS_UNSUPPORTED_FEATURE:
    return "unsupported feature";
  default:
    return "broken bitstream";
  }
}

static pl_status fail_decoding(const char *name, VP8StatusCode code) {
  if (code == VP8_STATUS_OUT_OF_MEMORY)
    return pl_fail(PL_E_MEMORY, "%s: out of memory for the image", name);
  return pl_fail(PL_E_FORMAT, "%s: broken WebP: %s", name, fault_of(code));
}

static pl_status check_header(const uint8_t *bytes, size_t size, const char *name,
                              WebPBitstreamFeatures *features) {
  if (size < RIFF_HEADER || riff_size(bytes) > size)
    return pl_fail(PL_E_FORMAT, "%s: broken WebP: truncated", name);
  const VP8StatusCode code = WebPGetFeatures(bytes, size, features);
  if (code != VP8_STATUS_OK)
    return fail_decoding(name, code);
  if (features->has_animation)
    return pl_fail(PL_E_UNSUPPORTED, "%s: animated WebP is not supported; use a still image", name);
  const uint64_t width = features->width > 0 ? (uint64_t)features->width : 0;
  const uint64_t height = features->height > 0 ? (uint64_t)features->height : 0;
  const uint64_t samples = width * height * (features->has_alpha ? 4 : 3);
  return pl_image_check_size(name, width, height, samples <= WEBP_FREE ? 0 : samples, size,
                             WEBP_EXPANSION);
}

pl_status pl_webp_decode(const uint8_t *bytes, size_t size, const char *name, pl_image *out) {
  *out = (pl_image){0};
  WebPDecoderConfig config;
  if (!WebPInitDecoderConfig(&config))
    return pl_fail(PL_E_UNSUPPORTED, "%s: this libwebp does not fit the one built with", name);
  PL_TRY(check_header(bytes, size, name, &config.input));
  const int channels = config.input.has_alpha ? 4 : 3;
  pl_image image;
  PL_TRY(pl_image_init(config.input.width, config.input.height, channels, &image));
  config.output.colorspace = channels == 4 ? MODE_RGBA : MODE_RGB;
  config.output.is_external_memory = 1;
  config.output.u.RGBA.rgba = image.texels;
  config.output.u.RGBA.stride = image.width * channels;
  config.output.u.RGBA.size = (size_t)image.width * (size_t)image.height * (size_t)channels;
  const VP8StatusCode code = WebPDecode(bytes, size, &config);
  WebPFreeDecBuffer(&config.output);
  if (code != VP8_STATUS_OK) {
    pl_image_clear(&image);
    return fail_decoding(name, code);
  }
  *out = image;
  return PL_OK;
}
