/* Encodes an image as JPEG with libjpeg-turbo, and decodes it again. */
#include "io/jpeg_write.h"

#include <setjmp.h>
#include <stddef.h>
#include <stdio.h>

#include <jpeglib.h>

/* All state is stored here, outside the stack frame that longjmp returns to. */
typedef struct cycle {
  struct jpeg_error_mgr errors;
  struct jpeg_destination_mgr target;
  jmp_buf jump;
  struct jpeg_compress_struct writer;
  struct jpeg_decompress_struct reader;
  const pl_compression *compression;
  int width, height;
  uint8_t *rgb, *file;
  size_t room;
  pl_status status;
} cycle;

static void on_error(j_common_ptr jpeg) {
  cycle *c = jpeg->client_data;
  char text[JMSG_LENGTH_MAX];
  c->errors.format_message(jpeg, text);
  c->status = pl_fail(PL_E_FORMAT, "sensor: compression: %s", text);
  longjmp(c->jump, 1);
}

static void on_message(j_common_ptr jpeg, int level) {
  (void)jpeg;
  (void)level;
}

static void start_file(j_compress_ptr jpeg) {
  cycle *c = jpeg->client_data;
  c->target.next_output_byte = c->file;
  c->target.free_in_buffer = c->room;
}

static boolean is_full(j_compress_ptr jpeg) {
  cycle *c = jpeg->client_data;
  c->status = pl_fail(PL_E_FORMAT, "sensor: compression: the file exceeds %zu bytes", c->room);
  longjmp(c->jump, 1);
}

static void end_file(j_compress_ptr jpeg) { (void)jpeg; }

static void encode(cycle *c) {
  struct jpeg_compress_struct *jpeg = &c->writer;
  jpeg_create_compress(jpeg);
  jpeg->client_data = c;
  c->target.init_destination = start_file;
  c->target.empty_output_buffer = is_full;
  c->target.term_destination = end_file;
  jpeg->dest = &c->target;
  jpeg->image_width = (JDIMENSION)c->width;
  jpeg->image_height = (JDIMENSION)c->height;
  jpeg->input_components = 3;
  jpeg->in_color_space = JCS_RGB;
  jpeg_set_defaults(jpeg);
  jpeg_set_quality(jpeg, c->compression->quality, TRUE);
  jpeg->dct_method = JDCT_ISLOW;
  jpeg->comp_info[0].h_samp_factor = c->compression->chroma == PL_CHROMA_444 ? 1 : 2;
  jpeg->comp_info[0].v_samp_factor = c->compression->chroma == PL_CHROMA_420 ? 2 : 1;
  jpeg_start_compress(jpeg, TRUE);
  while (jpeg->next_scanline < jpeg->image_height) {
    JSAMPROW row = c->rgb + (size_t)jpeg->next_scanline * 3 * (size_t)c->width;
    jpeg_write_scanlines(jpeg, &row, 1);
  }
  jpeg_finish_compress(jpeg);
}

static void decode(cycle *c) {
  struct jpeg_decompress_struct *jpeg = &c->reader;
  jpeg_create_decompress(jpeg);
  jpeg->client_data = c;
  jpeg_mem_src(jpeg, c->file, (unsigned long)(c->room - c->target.free_in_buffer));
  jpeg_read_header(jpeg, TRUE);
  jpeg->out_color_space = JCS_RGB;
  jpeg->dct_method = JDCT_ISLOW;
  jpeg_start_decompress(jpeg);
  while (jpeg->output_scanline < jpeg->output_height) {
    JSAMPROW row = c->rgb + (size_t)jpeg->output_scanline * 3 * (size_t)c->width;
    jpeg_read_scanlines(jpeg, &row, 1);
  }
  jpeg_finish_decompress(jpeg);
}

static pl_status guarded(cycle *c) {
  if (setjmp(c->jump) != 0)
    return c->status;
  encode(c);
  decode(c);
  return PL_OK;
}

/* Upper bound of the size of a file. Without subsampling a pixel has three coefficients. With steps
 * of 1 their root mean square is at most 128: 8 bits and a code of 10 bits each, 7 bytes a pixel.
 * Bytes of value 255 are doubled. Blocks have up to 16 x 16 pixels. A larger file is an error. */
static size_t room_for(int width, int height) {
  const size_t columns = ((size_t)width + 15) / 16 * 16, rows = ((size_t)height + 15) / 16 * 16;
  return columns * rows * 12 + 4096;
}

pl_status pl_jpeg_cycle(const pl_compression *compression, int width, int height, pl_arena *arena,
                        uint8_t *rgb) {
  cycle c = {.compression = compression,
             .width = width,
             .height = height,
             .rgb = rgb,
             .room = room_for(width, height)};
  c.file = pl_arena_alloc(arena, c.room, 1);
  if (c.file == NULL)
    return pl_fail(PL_E_MEMORY, "out of memory for compressing an image");
  c.writer.err = c.reader.err = jpeg_std_error(&c.errors);
  c.writer.client_data = c.reader.client_data = &c;
  c.errors.error_exit = on_error;
  c.errors.emit_message = on_message;
  const pl_status status = guarded(&c);
  jpeg_destroy_compress(&c.writer);
  jpeg_destroy_decompress(&c.reader);
  return status;
}
