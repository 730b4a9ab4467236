/* Writes OpenEXR files through its C library, OpenEXRCore. */
#include "io/exr.h"

#include <stdbool.h>
#include <string.h>

#include "base/memory.h"
#include "io/deflate.h"
#include "io/exr_settings.h"
#include "io/shuffle.h"

enum { MAX_SIDE = PL_EXR_MAX_SIDE, MAX_NAME = 255, PART = 0 };

static const exr_pixel_type_t pixel_types[] = {EXR_PIXEL_UINT, EXR_PIXEL_HALF, EXR_PIXEL_FLOAT};

static int64_t on_write(exr_const_context_t context, void *user, const void *from, uint64_t count,
                        uint64_t offset, exr_stream_error_func_ptr_t fail) {
  (void)context;
  (void)fail;
  return pl_bytes_put(user, (size_t)offset, from, (size_t)count) == PL_OK ? (int64_t)count : -1;
}

static pl_status told(exr_result_t code) {
  if (code == EXR_ERR_SUCCESS)
    return PL_OK;
  const bool memory = code == EXR_ERR_OUT_OF_MEMORY || code == EXR_ERR_WRITE_IO;
  return pl_fail(memory ? PL_E_MEMORY : PL_E_RANGE, "EXR: cannot be encoded: %s",
                 exr_get_default_error_message(code));
}

static pl_status check(int width, int height, const pl_exr_channel *channels, size_t count) {
  if (width < 1 || height < 1 || width > MAX_SIDE || height > MAX_SIDE)
    return pl_fail(PL_E_RANGE, "EXR: %d x %d pixels; sides must be in 1..%d", width, height,
                   MAX_SIDE);
  if (count < 1)
    return pl_fail(PL_E_RANGE, "EXR: there is no channel");
  for (size_t i = 0; i < count; i++) {
    const size_t length = strlen(channels[i].name);
    if (length < 1 || length > MAX_NAME)
      return pl_fail(PL_E_RANGE, "EXR: a channel's name has %zu bytes; must be 1..%d", length,
                     MAX_NAME);
    for (size_t k = 0; k < i; k++)
      if (strcmp(channels[i].name, channels[k].name) == 0)
        return pl_fail(PL_E_RANGE, "EXR: there are two channels '%s'", channels[i].name);
  }
  return PL_OK;
}

static exr_result_t write_header(exr_context_t context, int width, int height,
                                 const pl_exr_channel *channels, size_t count,
                                 const pl_exr_text *texts, size_t text_count) {
  int part;
  exr_result_t code = exr_add_part(context, "labels", EXR_STORAGE_SCANLINE, &part);
  if (code == EXR_ERR_SUCCESS)
    code = exr_initialize_required_attr_simple(context, PART, width, height, EXR_COMPRESSION_ZIP);
  for (size_t i = 0; i < count && code == EXR_ERR_SUCCESS; i++)
    code = exr_add_channel(context, PART, channels[i].name, pixel_types[channels[i].type],
                           EXR_PERCEPTUALLY_LOGARITHMIC, 1, 1);
  for (size_t i = 0; i < text_count && code == EXR_ERR_SUCCESS; i++)
    code = exr_attr_set_string(context, PART, texts[i].name, texts[i].value);
  return code == EXR_ERR_SUCCESS ? exr_write_header(context) : code;
}

/* The library sorts channels by name. */
static const pl_exr_channel *named(const pl_exr_channel *channels, size_t count, const char *name) {
  for (size_t i = 0; i < count; i++)
    if (strcmp(channels[i].name, name) == 0)
      return &channels[i];
  return NULL;
}

static void point_at(exr_encode_pipeline_t *pipe, int width, int y, const pl_exr_channel *channels,
                     size_t count) {
  for (int16_t c = 0; c < pipe->channel_count; c++) {
    exr_coding_channel_info_t *to = &pipe->channels[c];
    const pl_exr_channel *from = named(channels, count, to->channel_name);
    const int16_t size = from->type == PL_EXR_HALF ? 2 : 4;
    to->user_bytes_per_element = size;
    to->user_data_type = (uint16_t)pixel_types[from->type];
    to->user_pixel_stride = size;
    to->user_line_stride = size * width;
    to->encode_from_ptr = (const uint8_t *)from->samples + (size_t)y * (size_t)width * (size_t)size;
  }
}

/* What compressing a block of lines needs. */
typedef struct block {
  uint8_t *spare, *shuffled;
  size_t room;
  pl_bytes stream;
} block;

/* In place of the library's, which takes zlib most of the time of a file. OpenEXR 3.2 and later use
 * libdeflate, too. */
static exr_result_t compress(exr_encode_pipeline_t *pipe) {
  block *b = pipe->encoding_user_data;
  const size_t size = (size_t)pipe->packed_bytes;
  if (size > b->room) {
    pl_free(b->spare);
    pl_free(b->shuffled);
    b->spare = pl_alloc(size, 1);
    b->shuffled = pl_alloc(size, 1);
    b->room = b->spare != NULL && b->shuffled != NULL ? size : 0;
  }
  b->stream.size = 0;
  if (b->room < size)
    return EXR_ERR_OUT_OF_MEMORY;
  pl_shuffle_exr(pipe->packed_buffer, size, b->spare, b->shuffled);
  if (pl_deflate(b->shuffled, size, PL_DEFLATE_ZLIB, &b->stream) != PL_OK)
    return EXR_ERR_OUT_OF_MEMORY;
  const bool smaller = b->stream.size < size; /* else readers take it for the values themselves */
  pipe->compressed_buffer = smaller ? b->stream.data : pipe->packed_buffer;
  pipe->compressed_bytes = smaller ? b->stream.size : size;
  return EXR_ERR_SUCCESS;
}

static void block_clear(block *b) {
  pl_free(b->spare);
  pl_free(b->shuffled);
  pl_bytes_clear(&b->stream);
}

static exr_result_t write_lines(exr_context_t context, int width, int height,
                                const pl_exr_channel *channels, size_t count) {
  exr_encode_pipeline_t pipe = EXR_ENCODE_PIPELINE_INITIALIZER;
  block block = {0};
  int32_t step = 1;
  exr_result_t code = exr_get_scanlines_per_chunk(context, PART, &step);
  for (int y = 0; y < height && code == EXR_ERR_SUCCESS; y += step) {
    exr_chunk_info_t chunk;
    code = exr_write_scanline_chunk_info(context, PART, y, &chunk);
    if (code == EXR_ERR_SUCCESS)
      code = y == 0 ? exr_encoding_initialize(context, PART, &chunk, &pipe)
                    : exr_encoding_update(context, PART, &chunk, &pipe);
    if (code != EXR_ERR_SUCCESS)
      break;
    point_at(&pipe, width, y, channels, count);
    if (y == 0)
      code = exr_encoding_choose_default_routines(context, PART, &pipe);
    pipe.encoding_user_data = &block;
    pipe.compress_fn = compress;
    if (code == EXR_ERR_SUCCESS)
      code = exr_encoding_run(context, PART, &pipe);
    pipe.compressed_buffer = NULL; /* not the pipeline's */
  }
  exr_encoding_destroy(context, &pipe);
  block_clear(&block);
  return code;
}

pl_status pl_exr_encode(int width, int height, const pl_exr_channel *channels, size_t channel_count,
                        const pl_exr_text *texts, size_t text_count, pl_bytes *out) {
  PL_TRY(check(width, height, channels, channel_count));
  exr_context_initializer_t settings = pl_exr_settings(out);
  settings.write_fn = on_write;
  exr_context_t context;
  PL_TRY(told(exr_start_write(&context, "memory.exr", EXR_WRITE_FILE_DIRECTLY, &settings)));
  exr_result_t code =
      write_header(context, width, height, channels, channel_count, texts, text_count);
  if (code == EXR_ERR_SUCCESS)
    code = write_lines(context, width, height, channels, channel_count);
  const exr_result_t finished = exr_finish(&context); /* writes the table of chunks */
  return told(code != EXR_ERR_SUCCESS ? code : finished);
}
