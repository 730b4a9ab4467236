/* Reads OpenEXR files through its C library, OpenEXRCore. */
#include "io/exr_read.h"

#include <stdbool.h>
#include <stdint.h>
#include <string.h>

#include "base/memory.h"
#include "io/exr_settings.h"

enum { PART = 0 };
/* ZIP packs at most 1032 bytes into one (zlib's manual), and RLE 64: beyond, a file lies. */
static const size_t most_ratio = 1100;

typedef struct source {
  const uint8_t *data;
  size_t size;
} source;

static int64_t on_read(exr_const_context_t context, void *user, void *to, uint64_t count,
                       uint64_t offset, exr_stream_error_func_ptr_t fail) {
  (void)context;
  (void)fail;
  const source *from = user;
  if (offset > from->size)
    return -1;
  const uint64_t rest = from->size - offset;
  const size_t taken = (size_t)(count < rest ? count : rest);
  memcpy(to, from->data + offset, taken);
  return (int64_t)taken;
}

static int64_t on_size(exr_const_context_t context, void *user) {
  (void)context;
  return (int64_t)((const source *)user)->size;
}

static pl_status told(exr_result_t code, const char *name) {
  if (code == EXR_ERR_SUCCESS)
    return PL_OK;
  return pl_fail(code == EXR_ERR_OUT_OF_MEMORY ? PL_E_MEMORY : PL_E_FORMAT,
                 "%s: EXR cannot be decoded: %s", name, exr_get_default_error_message(code));
}

static int bytes_of(pl_exr_type type) { return type == PL_EXR_HALF ? 2 : 4; }

static pl_exr_type type_of(exr_pixel_type_t type) {
  return type == EXR_PIXEL_UINT ? PL_EXR_UINT : type == EXR_PIXEL_HALF ? PL_EXR_HALF : PL_EXR_FLOAT;
}

static pl_status take_planes(const exr_attr_chlist_t *list, const char *name, size_t file_size,
                             pl_exr_image *out) {
  size_t all = 0;
  const size_t pixels = (size_t)out->width * (size_t)out->height;
  for (int c = 0; c < list->num_channels; c++)
    all += pixels * (size_t)bytes_of(type_of(list->entries[c].pixel_type));
  if (all / most_ratio > file_size)
    return pl_fail(PL_E_FORMAT, "%s: EXR claims %zu bytes of pixels", name, all);
  out->planes = pl_alloc((size_t)list->num_channels, sizeof *out->planes);
  if (out->planes == NULL)
    return pl_fail(PL_E_MEMORY, "%s: no memory for %d channels", name, list->num_channels);
  for (int c = 0; c < list->num_channels; c++) {
    const exr_attr_chlist_entry_t *entry = &list->entries[c];
    pl_exr_plane *plane = &out->planes[c];
    if (entry->x_sampling != 1 || entry->y_sampling != 1 ||
        strlen(entry->name.str) >= sizeof plane->name)
      return pl_fail(PL_E_FORMAT, "%s: EXR channel '%s' is subsampled, or its name is too long",
                     name, entry->name.str);
    strcpy(plane->name, entry->name.str);
    plane->type = type_of(entry->pixel_type);
    plane->samples = pl_alloc(pixels, (size_t)bytes_of(plane->type));
    out->count++;
    if (plane->samples == NULL)
      return pl_fail(PL_E_MEMORY, "%s: no memory for %zu pixels", name, pixels);
  }
  return PL_OK;
}

static pl_status read_header(exr_context_t context, const char *name, size_t file_size,
                             pl_exr_image *out) {
  exr_attr_box2i_t window;
  exr_storage_t storage;
  const exr_attr_chlist_t *list;
  PL_TRY(told(exr_get_data_window(context, PART, &window), name));
  PL_TRY(told(exr_get_storage(context, PART, &storage), name));
  PL_TRY(told(exr_get_channels(context, PART, &list), name));
  const bool flat = storage == EXR_STORAGE_SCANLINE && window.min.x == 0 && window.min.y == 0;
  if (!flat || window.max.x < 0 || window.max.y < 0 || window.max.x >= PL_EXR_MAX_SIDE ||
      window.max.y >= PL_EXR_MAX_SIDE || list->num_channels < 1)
    return pl_fail(PL_E_FORMAT, "%s: EXR must have one part of scan lines from 0, 0 on", name);
  out->width = window.max.x + 1;
  out->height = window.max.y + 1;
  return take_planes(list, name, file_size, out);
}

static const pl_exr_plane *named(const pl_exr_image *image, const char *name) {
  for (size_t i = 0; i < image->count; i++)
    if (strcmp(image->planes[i].name, name) == 0)
      return &image->planes[i];
  return NULL;
}

static void point_at(exr_decode_pipeline_t *pipe, const pl_exr_image *image, int y) {
  for (int16_t c = 0; c < pipe->channel_count; c++) {
    exr_coding_channel_info_t *from = &pipe->channels[c];
    const pl_exr_plane *to = named(image, from->channel_name);
    const int16_t size = (int16_t)bytes_of(to->type);
    from->user_bytes_per_element = size;
    from->user_data_type = from->data_type;
    from->user_pixel_stride = size;
    from->user_line_stride = size * image->width;
    from->decode_to_ptr = (uint8_t *)to->samples + (size_t)y * (size_t)from->user_line_stride;
  }
}

static exr_result_t read_lines(exr_context_t context, const pl_exr_image *image) {
  exr_decode_pipeline_t pipe = EXR_DECODE_PIPELINE_INITIALIZER;
  int32_t step = 1;
  exr_result_t code = exr_get_scanlines_per_chunk(context, PART, &step);
  for (int y = 0; y < image->height && code == EXR_ERR_SUCCESS; y += step) {
    exr_chunk_info_t chunk;
    code = exr_read_scanline_chunk_info(context, PART, y, &chunk);
    if (code == EXR_ERR_SUCCESS)
      code = y == 0 ? exr_decoding_initialize(context, PART, &chunk, &pipe)
                    : exr_decoding_update(context, PART, &chunk, &pipe);
    if (code != EXR_ERR_SUCCESS)
      break;
    point_at(&pipe, image, y);
    if (y == 0)
      code = exr_decoding_choose_default_routines(context, PART, &pipe);
    if (code == EXR_ERR_SUCCESS)
      code = exr_decoding_run(context, PART, &pipe);
  }
  exr_decoding_destroy(context, &pipe);
  return code;
}

pl_status pl_exr_decode(const void *data, size_t size, const char *name, pl_exr_image *out) {
  *out = (pl_exr_image){0};
  source from = {data, size};
  exr_context_initializer_t settings = pl_exr_settings(&from);
  settings.read_fn = on_read;
  settings.size_fn = on_size;
  exr_context_t context;
  PL_TRY(told(exr_start_read(&context, "memory.exr", &settings), name));
  pl_status status = read_header(context, name, size, out);
  if (status == PL_OK)
    status = told(read_lines(context, out), name);
  exr_finish(&context);
  if (status != PL_OK)
    pl_exr_image_clear(out);
  return status;
}

void pl_exr_image_clear(pl_exr_image *image) {
  for (size_t i = 0; i < image->count; i++)
    pl_free(image->planes[i].samples);
  pl_free(image->planes);
  *image = (pl_exr_image){0};
}
