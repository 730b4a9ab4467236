/* Writes PNG files atomically: a file is either complete or absent. Encodes them in memory, too. */
#define _POSIX_C_SOURCE 200809L
#include "io/png_write.h"

#include <errno.h>
#include <fcntl.h>
#include <png.h>
#include <setjmp.h>
#include <stdbool.h>
#include <stdio.h>
#include <string.h>
#include <sys/stat.h>
#include <unistd.h>
#include <zlib.h>

#include "base/memory.h"

/* Largest number of names tried for the temporary file: other threads of this process, or files
 * left by a killed process with the same id, may use some. */
enum { MAX_NAMES = 1000 };
/* Above this level a small file matters more than speed: libpng then tries all filters. */
enum { LAST_FAST_LEVEL = 6 };

/* All state is stored here, outside the stack frame that longjmp returns to. */
typedef struct writer {
  const char *path;
  char *temporary; /* owned */
  int descriptor;
  pl_bytes *out; /* where the bytes go instead; NULL for a file */
  const uint8_t *palette;
  int palette_count;
  int error;     /* errno of the first failed write */
  char text[96]; /* libpng's error message */
  const unsigned char *samples;
  int width, height, channels, bits, level;
  png_structp png;
  png_infop info;
} writer;

static void on_error(png_structp png, png_const_charp text) {
  writer *w = png_get_error_ptr(png);
  snprintf(w->text, sizeof w->text, "%s", text);
  png_longjmp(png, 1);
}

static void on_warning(png_structp png, png_const_charp text) {
  (void)png;
  (void)text;
}

static void on_write(png_structp png, png_bytep bytes, png_size_t count) {
  writer *w = png_get_io_ptr(png);
  if (w->out != NULL) {
    if (pl_bytes_put(w->out, w->out->size, bytes, count) != PL_OK)
      png_error(png, "out of memory");
    return;
  }
  while (count > 0) {
    const ssize_t put = write(w->descriptor, bytes, count);
    if (put < 0 && errno == EINTR)
      continue;
    if (put <= 0) {
      w->error = put < 0 ? errno : ENOSPC;
      png_error(png, "write");
    }
    bytes += put;
    count -= (size_t)put;
  }
}

static void on_flush(png_structp png) { (void)png; }

static png_voidp on_allocate(png_structp png, png_alloc_size_t size) {
  (void)png;
  return pl_alloc(size, 1);
}

static void on_free(png_structp png, png_voidp memory) {
  (void)png;
  pl_free(memory);
}

/* At most this part of the bytes of a picture of runs, as masks and ids, differ from those of the
 * pixel to their left. */
static const double RUNS = 0.125;

/* Whether a picture consists of runs of one value. Lengths of runs then say nearly all that deflate
 * finds, in a third of its time and often in fewer bytes. */
static bool has_runs(const writer *w) {
  const size_t pixel = (size_t)w->channels * (size_t)(w->bits / 8), row = (size_t)w->width * pixel;
  size_t differing = 0;
  for (size_t y = 0; y < (size_t)w->height; y++) {
    const unsigned char *bytes = w->samples + y * row;
    for (size_t i = pixel; i < row; i++)
      differing += bytes[i] != bytes[i - pixel];
  }
  return (double)differing <= RUNS * (double)row * (double)w->height;
}

/* Writes nothing that varies between runs (time, text), and fixes the filters. */
static void write_all(writer *w) {
  static const int color_types[] = {PNG_COLOR_TYPE_GRAY, PNG_COLOR_TYPE_GRAY_ALPHA,
                                    PNG_COLOR_TYPE_RGB, PNG_COLOR_TYPE_RGB_ALPHA};
  png_structp png = w->png;
  png_set_write_fn(png, w, on_write, on_flush);
  png_set_compression_level(png, w->level);
  if (w->level > 0 && w->level <= LAST_FAST_LEVEL && has_runs(w))
    png_set_compression_strategy(png, Z_RLE);
  const bool flat = w->level == 0 || (w->channels == 1 && w->bits == 8); /* mostly masks */
  png_set_filter(png, PNG_FILTER_TYPE_BASE,
                 flat ? PNG_FILTER_NONE
                      : (w->level > LAST_FAST_LEVEL ? PNG_ALL_FILTERS : PNG_FILTER_SUB));
  png_set_IHDR(png, w->info, (png_uint_32)w->width, (png_uint_32)w->height, w->bits,
               w->palette != NULL ? PNG_COLOR_TYPE_PALETTE : color_types[w->channels - 1],
               PNG_INTERLACE_NONE, PNG_COMPRESSION_TYPE_DEFAULT, PNG_FILTER_TYPE_DEFAULT);
  if (w->palette != NULL) {
    png_color colors[PNG_MAX_PALETTE_LENGTH];
    for (int k = 0; k < w->palette_count; k++)
      colors[k] = (png_color){w->palette[3 * k], w->palette[3 * k + 1], w->palette[3 * k + 2]};
    png_set_PLTE(png, w->info, colors, w->palette_count);
  }
  png_write_info(png, w->info);
  const int one = 1;
  if (w->bits == 16 && *(const char *)&one == 1)
    png_set_swap(png);
  const size_t row = (size_t)w->width * (size_t)w->channels * (size_t)(w->bits / 8);
  for (int y = 0; y < w->height; y++)
    png_write_row(png, w->samples + (size_t)y * row);
  png_write_end(png, NULL);
}

static pl_status guarded_write(writer *w) {
  if (setjmp(png_jmpbuf(w->png)) != 0) {
    if (w->error != 0)
      return pl_fail(PL_E_IO, "%s: cannot be written: %s", w->path, strerror(w->error));
    return pl_fail(PL_E_MEMORY, "%s: cannot be encoded: %s", w->path, w->text);
  }
  write_all(w);
  return PL_OK;
}

static pl_status encode(writer *w) {
  w->png = png_create_write_struct_2(PNG_LIBPNG_VER_STRING, w, on_error, on_warning, NULL,
                                     on_allocate, on_free);
  w->info = w->png != NULL ? png_create_info_struct(w->png) : NULL;
  const pl_status status = w->info != NULL
                               ? guarded_write(w)
                               : pl_fail(PL_E_MEMORY, "%s: out of memory for PNG", w->path);
  png_destroy_write_struct(&w->png, &w->info);
  return status;
}

/* Creates the temporary file beside the target, under an unused name. */
static pl_status open_temporary(writer *w) {
  const size_t capacity = strlen(w->path) + 48;
  void *memory;
  PL_TRY(pl_alloc_or_fail(capacity, 1, "a file name", &memory));
  w->temporary = memory;
  for (int k = 0; k < MAX_NAMES; k++) {
    snprintf(w->temporary, capacity, "%s.%ld.%d.tmp", w->path, (long)getpid(), k);
    w->descriptor = open(w->temporary, O_WRONLY | O_CREAT | O_EXCL | O_CLOEXEC, 0666);
    if (w->descriptor >= 0 || errno != EEXIST)
      break;
  }
  if (w->descriptor < 0)
    return pl_fail(PL_E_IO, "%s: cannot be written: %s", w->path, strerror(errno));
  return PL_OK;
}

static pl_status write_and_rename(writer *w) {
  pl_status status = encode(w);
  if (close(w->descriptor) != 0 && status == PL_OK)
    status = pl_fail(PL_E_IO, "%s: cannot be written: %s", w->path, strerror(errno));
  if (status == PL_OK && rename(w->temporary, w->path) != 0)
    status = pl_fail(PL_E_IO, "%s: cannot be replaced: %s", w->path, strerror(errno));
  if (status != PL_OK)
    unlink(w->temporary);
  return status;
}

static pl_status check(const char *path, int width, int height, int channels, int bits, int level) {
  if (width < 1 || height < 1 || width > 65536 || height > 65536)
    return pl_fail(PL_E_RANGE, "%s: %d x %d pixels; sides must be in 1..65536", path, width,
                   height);
  if (channels < 1 || channels > 4 || (bits != 8 && bits != 16))
    return pl_fail(PL_E_RANGE, "%s: %d channels of %d bits; PNG has 1..4 of 8 or 16", path,
                   channels, bits);
  if (level < 0 || level > 9)
    return pl_fail(PL_E_RANGE, "%s: compression level %d; must be in 0..9", path, level);
  return PL_OK;
}

/* Every sample must have a colour: readers differ in what they make of others. */
static pl_status check_palette(const writer *w) {
  if (w->channels != 1 || w->bits != 8 || w->palette_count < 1 ||
      w->palette_count > PNG_MAX_PALETTE_LENGTH)
    return pl_fail(PL_E_RANGE, "%s: a palette has 1..256 colours, for one channel of 8 bits",
                   w->path);
  const size_t count = (size_t)w->width * (size_t)w->height;
  for (size_t i = 0; i < count; i++)
    if (w->samples[i] >= w->palette_count)
      return pl_fail(PL_E_RANGE, "%s: the value %d has none of the %d colours of the palette",
                     w->path, w->samples[i], w->palette_count);
  return PL_OK;
}

static writer writer_of(const char *path, const void *samples, int width, int height, int channels,
                        int bits, int level) {
  return (writer){.path = path,
                  .descriptor = -1,
                  .samples = samples,
                  .width = width,
                  .height = height,
                  .channels = channels,
                  .bits = bits,
                  .level = level};
}

pl_status pl_png_write(const char *path, const void *samples, int width, int height, int channels,
                       int bits, int level) {
  PL_TRY(check(path, width, height, channels, bits, level));
  writer w = writer_of(path, samples, width, height, channels, bits, level);
  pl_status status = open_temporary(&w);
  if (status == PL_OK)
    status = write_and_rename(&w);
  pl_free(w.temporary);
  return status;
}

pl_status pl_png_encode(const char *name, const void *samples, int width, int height, int channels,
                        int bits, int level, const uint8_t *palette, int palette_count,
                        pl_bytes *out) {
  PL_TRY(check(name, width, height, channels, bits, level));
  writer w = writer_of(name, samples, width, height, channels, bits, level);
  w.out = out;
  w.palette = palette;
  w.palette_count = palette_count;
  if (palette != NULL)
    PL_TRY(check_palette(&w));
  return encode(&w);
}
