/* PNG decoder with libpng, safe for malicious input. */
#include <png.h>
#include <setjmp.h>
#include <stdio.h>
#include <string.h>

#include "base/memory.h"
#include "io/image_codec.h"

/* Largest expansion by deflate (zlib's "Technical details"). */
enum { PNG_EXPANSION = 1032 };
/* Largest ancillary chunk (profile, text) that is decompressed, bytes, and largest number of chunks
 * that are kept. */
enum { MAX_CHUNK = 8 << 20, MAX_CHUNKS = 1000 };

/* All state is stored here, outside the stack frame that longjmp returns to. */
typedef struct reader {
  const uint8_t *bytes;
  size_t size, position;
  const char *name;
  bool deep; /* decode to 16-bit grey */
  png_structp png;
  png_infop info;
  pl_image image;
  pl_status status; /* set before png_error when the error is not one of format */
  char text[160];   /* libpng's error message */
} reader;

static void on_error(png_structp png, png_const_charp text) {
  reader *r = png_get_error_ptr(png);
  snprintf(r->text, sizeof r->text, "%s", text);
  png_longjmp(png, 1);
}

static void on_warning(png_structp png, png_const_charp text) {
  (void)png;
  (void)text;
}

static void on_read(png_structp png, png_bytep out, png_size_t count) {
  reader *r = png_get_io_ptr(png);
  if (count > r->size - r->position)
    png_error(png, "truncated");
  memcpy(out, r->bytes + r->position, count);
  r->position += count;
}

static png_voidp on_allocate(png_structp png, png_alloc_size_t size) {
  (void)png;
  return pl_alloc(size, 1);
}

static void on_free(png_structp png, png_voidp memory) {
  (void)png;
  pl_free(memory);
}

/* Converts everything to 8-bit grey, grey+alpha, RGB or RGBA. */
static void set_transforms(reader *r) {
  png_structp png = r->png;
  const int color = png_get_color_type(png, r->info), depth = png_get_bit_depth(png, r->info);
  if (color == PNG_COLOR_TYPE_PALETTE)
    png_set_palette_to_rgb(png);
  if (color == PNG_COLOR_TYPE_GRAY && depth < 8)
    png_set_expand_gray_1_2_4_to_8(png);
  if (png_get_valid(png, r->info, PNG_INFO_tRNS))
    png_set_tRNS_to_alpha(png);
  if (depth == 16)
    png_set_scale_16(png);
}

/* Converts to 16-bit grey, whose two bytes are the two channels of the image. */
static void set_deep_transforms(reader *r) {
  png_structp png = r->png;
  if (png_get_color_type(png, r->info) & (PNG_COLOR_MASK_COLOR | PNG_COLOR_MASK_PALETTE)) {
    r->status = pl_fail(PL_E_UNSUPPORTED, "%s: must be a grey PNG, not one of colours", r->name);
    png_error(png, "colours");
  }
  png_set_expand_16(png);
  png_set_strip_alpha(png);
}

static void read_header(reader *r) {
  png_structp png = r->png;
  png_set_read_fn(png, r, on_read);
  png_set_user_limits(png, 65536, 65536);
  png_set_chunk_malloc_max(png, MAX_CHUNK);
  png_set_chunk_cache_max(png, MAX_CHUNKS);
  png_read_info(png, r->info);
  const uint64_t height = png_get_image_height(png, r->info);
  r->status = pl_image_check_size(r->name, png_get_image_width(png, r->info), height,
                                  (uint64_t)png_get_rowbytes(png, r->info) * height, r->size,
                                  PNG_EXPANSION);
  if (r->status != PL_OK)
    png_error(png, "size");
  if (r->deep)
    set_deep_transforms(r);
  else
    set_transforms(r);
}

static void read_texels(reader *r) {
  png_structp png = r->png;
  const int passes = png_set_interlace_handling(png);
  png_read_update_info(png, r->info);
  const size_t row = png_get_rowbytes(png, r->info);
  r->status =
      pl_image_init((int)png_get_image_width(png, r->info), (int)png_get_image_height(png, r->info),
                    r->deep ? 2 : (int)png_get_channels(png, r->info), &r->image);
  if (r->status != PL_OK)
    png_error(png, "allocation");
  if (row != (size_t)r->image.width * (size_t)r->image.channels)
    png_error(png, "unexpected row size");
  for (int pass = 0; pass < passes; pass++)
    for (int y = 0; y < r->image.height; y++)
      png_read_row(png, r->image.texels + (size_t)y * row, NULL);
  png_read_end(png, NULL); /* fails for a truncated file */
}

static pl_status guarded_read(reader *r) {
  if (setjmp(png_jmpbuf(r->png)) != 0) {
    pl_image_clear(&r->image);
    if (r->status != PL_OK)
      return r->status;
    return pl_fail(PL_E_FORMAT, "%s: broken PNG: %s", r->name, r->text);
  }
  read_header(r);
  read_texels(r);
  return PL_OK;
}

static pl_status decode(const uint8_t *bytes, size_t size, const char *name, bool deep,
                        pl_image *out) {
  *out = (pl_image){0};
  reader r = {.bytes = bytes, .size = size, .name = name, .deep = deep};
  r.png = png_create_read_struct_2(PNG_LIBPNG_VER_STRING, &r, on_error, on_warning, NULL,
                                   on_allocate, on_free);
  r.info = r.png != NULL ? png_create_info_struct(r.png) : NULL;
  const pl_status status =
      r.info != NULL ? guarded_read(&r) : pl_fail(PL_E_MEMORY, "%s: out of memory for PNG", name);
  png_destroy_read_struct(&r.png, &r.info, NULL);
  if (status == PL_OK)
    *out = r.image;
  return status;
}

pl_status pl_png_decode(const uint8_t *bytes, size_t size, const char *name, pl_image *out) {
  return decode(bytes, size, name, false, out);
}

pl_status pl_png_decode_grey(const uint8_t *bytes, size_t size, const char *name, pl_image *out) {
  if (size < 8 || png_sig_cmp(bytes, 0, 8) != 0)
    return pl_fail(PL_E_FORMAT, "%s: not a PNG file", name);
  return decode(bytes, size, name, true, out);
}
