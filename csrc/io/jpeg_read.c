/* JPEG decoder with libjpeg-turbo, safe for malicious input. (libjpeg's own memory, a few rows or,
 * for progressive files, the coefficients, is not allocated through the allocation hook.) */
#include <setjmp.h>
#include <stdbool.h>
#include <stddef.h>
#include <stdio.h>

#include <jpeglib.h> /* first: the numbers in jerror.h depend on its version */

#include <jerror.h>

#include "io/image_codec.h"

/* A block of 64 samples takes at least one bit in each of two Huffman codes, or with progressive
 * runs one bit in total (ITU-T T.81, F.1.2 and G.1.2): 512 samples per byte. Colour adds two
 * components that may be subsampled 4 x 4; they take some of the bits but count as full samples. */
enum { JPEG_EXPANSION = 512 * 3 };
/* Largest number of scans of a progressive file. Real files have about ten; each costs a pass over
 * the image. */
enum { MAX_SCANS = 200 };

/* All state is stored here, outside the stack frame that longjmp returns to. */
typedef struct reader {
  struct jpeg_error_mgr errors;
  struct jpeg_progress_mgr progress;
  jmp_buf jump;
  struct jpeg_decompress_struct jpeg;
  const char *name;
  pl_image image;
  pl_status status; /* set before leaving when the error text is already recorded */
} reader;

static void leave(reader *r, pl_status status) {
  r->status = status;
  longjmp(r->jump, 1);
}

static void on_error(j_common_ptr jpeg) {
  reader *r = jpeg->client_data;
  char text[JMSG_LENGTH_MAX];
  r->errors.format_message(jpeg, text);
  const bool memory = r->errors.msg_code == JERR_OUT_OF_MEMORY;
  leave(r, pl_fail(memory ? PL_E_MEMORY : PL_E_FORMAT, "%s: broken JPEG: %s", r->name, text));
}

/* libjpeg warns and continues where data is corrupt, so warnings are errors here; only informative
 * messages (level >= 0) pass. */
static void on_message(j_common_ptr jpeg, int level) {
  if (level >= 0)
    return;
  const reader *r = jpeg->client_data;
  switch (r->errors.msg_code) {
  case JWRN_ADOBE_XFORM:
  case JWRN_EXTRANEOUS_DATA:
  case JWRN_JFIF_MAJOR:
  case JWRN_TOO_MUCH_DATA:
    return;
  default:
    on_error(jpeg);
  }
}

static void on_progress(j_common_ptr jpeg) {
  reader *r = jpeg->client_data;
  if (r->jpeg.input_scan_number > MAX_SCANS)
    leave(r, pl_fail(PL_E_FORMAT, "%s: JPEG with more than %d scans", r->name, MAX_SCANS));
}

static void read_header(reader *r, const uint8_t *bytes, size_t size) {
  struct jpeg_decompress_struct *jpeg = &r->jpeg;
  jpeg_create_decompress(jpeg);
  jpeg->client_data = r;
  jpeg->progress = &r->progress;
  jpeg_mem_src(jpeg, bytes, (unsigned long)size);
  jpeg_read_header(jpeg, TRUE);
  if (jpeg->num_components == 4)
    leave(r, pl_fail(PL_E_UNSUPPORTED, "%s: CMYK JPEG is not supported; use RGB or grey", r->name));
  if (jpeg->arith_code)
    leave(r, pl_fail(PL_E_UNSUPPORTED, "%s: arithmetic-coded JPEG is not supported", r->name));
  const uint64_t samples =
      (uint64_t)jpeg->image_width * jpeg->image_height * (uint64_t)jpeg->num_components;
  const pl_status status = pl_image_check_size(r->name, jpeg->image_width, jpeg->image_height,
                                               samples, size, JPEG_EXPANSION);
  if (status != PL_OK)
    leave(r, status);
  jpeg->out_color_space = jpeg->num_components == 1 ? JCS_GRAYSCALE : JCS_RGB;
}

static void read_texels(reader *r) {
  struct jpeg_decompress_struct *jpeg = &r->jpeg;
  jpeg_start_decompress(jpeg);
  const pl_status status = pl_image_init((int)jpeg->output_width, (int)jpeg->output_height,
                                         jpeg->output_components, &r->image);
  if (status != PL_OK)
    leave(r, status);
  const size_t row = (size_t)r->image.width * (size_t)r->image.channels;
  while (jpeg->output_scanline < jpeg->output_height) {
    JSAMPROW line = r->image.texels + (size_t)jpeg->output_scanline * row;
    jpeg_read_scanlines(jpeg, &line, 1);
  }
  jpeg_finish_decompress(jpeg); /* fails for a truncated file */
}

static pl_status guarded_read(reader *r, const uint8_t *bytes, size_t size) {
  if (setjmp(r->jump) != 0) {
    pl_image_clear(&r->image);
    return r->status;
  }
  read_header(r, bytes, size);
  read_texels(r);
  return PL_OK;
}

pl_status pl_jpeg_decode(const uint8_t *bytes, size_t size, const char *name, pl_image *out) {
  *out = (pl_image){0};
  reader r = {.name = name};
  r.jpeg.err = jpeg_std_error(&r.errors);
  r.jpeg.client_data = &r;
  r.errors.error_exit = on_error;
  r.errors.emit_message = on_message;
  r.progress.progress_monitor = on_progress;
  const pl_status status = guarded_read(&r, bytes, size);
  jpeg_destroy_decompress(&r.jpeg);
  if (status == PL_OK)
    *out = r.image;
  return status;
}
