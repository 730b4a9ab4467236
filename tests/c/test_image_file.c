/* Reading PNG and JPEG: every kind of each, refusals by name, and broken files. */
#include "io/image_file.h"

#include <sys/stat.h>

#include <png.h>

#include <jpeglib.h>

#include "files.h"
#include "random.h"

enum { W = 13, H = 9, MOST = 1 << 16 };

/* Bytes of a file made in memory. */
typedef struct blob {
  unsigned char bytes[MOST];
  size_t size;
} blob;

static void append(png_structp png, png_bytep bytes, png_size_t count) {
  blob *out = png_get_io_ptr(png);
  assert_true(out->size + count <= MOST);
  memcpy(out->bytes + out->size, bytes, count);
  out->size += count;
}

static void ignore(png_structp png) { (void)png; }

/* The value of a picture in 0..255 or, for `bits` 16, in its two bytes. */
static unsigned sample(int x, int y, int c) { return (unsigned)(x * 17 + y * 29 + c * 71) % 256; }

/* A PNG of a colour type and depth; for palettes entry i is (i, 255 - i, 7). */
static void make_png(int color, int bits, int interlace, bool transparent, blob *out) {
  out->size = 0;
  png_structp png = png_create_write_struct(PNG_LIBPNG_VER_STRING, NULL, NULL, NULL);
  png_infop info = png_create_info_struct(png);
  png_set_write_fn(png, out, append, ignore);
  png_set_IHDR(png, info, W, H, bits, color, interlace, 0, 0);
  png_color palette[256];
  png_byte alpha[256];
  for (int i = 0; i < 256; i++) {
    palette[i] = (png_color){(png_byte)i, (png_byte)(255 - i), 7};
    alpha[i] = (png_byte)(255 - i);
  }
  if (color == PNG_COLOR_TYPE_PALETTE)
    png_set_PLTE(png, info, palette, 1 << bits);
  const png_color_16 key = {.gray = 0};
  if (transparent)
    png_set_tRNS(png, info, alpha, color == PNG_COLOR_TYPE_PALETTE ? 1 << bits : 0,
                 color == PNG_COLOR_TYPE_PALETTE ? NULL : &key);
  png_write_info(png, info);
  const int channels = png_get_channels(png, info);
  const int passes = png_set_interlace_handling(png);
  for (int pass = 0; pass < passes; pass++) {
    for (int y = 0; y < H; y++) {
      unsigned char row[W * 8] = {0};
      for (int x = 0; x < W; x++)
        for (int c = 0; c < channels; c++) {
          const unsigned v = sample(x, y, c);
          if (bits == 16)
            row[2 * (x * channels + c)] = row[2 * (x * channels + c) + 1] = (unsigned char)v;
          else if (bits == 8)
            row[x * channels + c] = (unsigned char)v;
          else
            row[x * bits / 8] |=
                (unsigned char)((v & ((1u << bits) - 1)) << (8 - bits - x * bits % 8));
        }
      png_write_row(png, row);
    }
  }
  png_write_end(png, info);
  png_destroy_write_struct(&png, &info);
}

static pl_image decode(const blob *in) {
  pl_image image;
  if (pl_image_decode(in->bytes, in->size, "test", &image) != PL_OK)
    fail_msg("%s", pl_error_text());
  assert_int_equal(image.width, W);
  assert_int_equal(image.height, H);
  return image;
}

static void every_png_is_read(void **state) {
  (void)state;
  static blob file;
  const struct {
    int color, bits, channels;
  } kinds[] = {{PNG_COLOR_TYPE_GRAY, 8, 1},  {PNG_COLOR_TYPE_GRAY_ALPHA, 8, 2},
               {PNG_COLOR_TYPE_RGB, 8, 3},   {PNG_COLOR_TYPE_RGB_ALPHA, 8, 4},
               {PNG_COLOR_TYPE_GRAY, 16, 1}, {PNG_COLOR_TYPE_GRAY_ALPHA, 16, 2},
               {PNG_COLOR_TYPE_RGB, 16, 3},  {PNG_COLOR_TYPE_RGB_ALPHA, 16, 4}};
  for (size_t k = 0; k < sizeof kinds / sizeof kinds[0]; k++) {
    for (int interlace = 0; interlace < 2; interlace++) {
      make_png(kinds[k].color, kinds[k].bits, interlace, false, &file);
      pl_image image = decode(&file);
      assert_int_equal(image.channels, kinds[k].channels);
      for (int i = 0; i < W * H; i++)
        for (int c = 0; c < image.channels; c++) /* v * 257 in 16 bits is v in 8 */
          assert_int_equal(image.texels[i * image.channels + c], sample(i % W, i / W, c));
      pl_image_clear(&image);
    }
  }
}

static void small_depths_and_palettes_are_expanded(void **state) {
  (void)state;
  static blob file;
  for (int bits = 1; bits <= 8; bits *= 2) {
    const unsigned mask = (1u << bits) - 1;
    make_png(PNG_COLOR_TYPE_GRAY, bits, 0, false, &file);
    pl_image grey = decode(&file);
    assert_int_equal(grey.channels, 1);
    make_png(PNG_COLOR_TYPE_PALETTE, bits, 0, false, &file);
    pl_image palette = decode(&file);
    assert_int_equal(palette.channels, 3);
    make_png(PNG_COLOR_TYPE_PALETTE, bits, 1, true, &file);
    pl_image clear = decode(&file);
    assert_int_equal(clear.channels, 4);
    for (int i = 0; i < W * H; i++) {
      const unsigned v = sample(i % W, i / W, 0) & mask;
      assert_int_equal(grey.texels[i], v * 255 / mask);
      assert_int_equal(palette.texels[3 * i], v);
      assert_int_equal(palette.texels[3 * i + 1], 255 - v);
      assert_int_equal(clear.texels[4 * i + 2], 7);
      assert_int_equal(clear.texels[4 * i + 3], 255 - v);
    }
    pl_image_clear(&grey);
    pl_image_clear(&palette);
    pl_image_clear(&clear);
  }
}

static void a_transparent_grey_becomes_alpha(void **state) {
  (void)state;
  static blob file;
  make_png(PNG_COLOR_TYPE_GRAY, 8, 0, true, &file);
  pl_image image = decode(&file);
  assert_int_equal(image.channels, 2);
  for (int i = 0; i < W * H; i++)
    assert_int_equal(image.texels[2 * i + 1], image.texels[2 * i] == 0 ? 0 : 255);
  pl_image_clear(&image);
}

/* A flat JPEG: quantisation then loses nothing but rounding. */
static void make_jpeg(J_COLOR_SPACE space, int channels, bool progressive, blob *out) {
  struct jpeg_compress_struct jpeg;
  struct jpeg_error_mgr errors;
  jpeg.err = jpeg_std_error(&errors);
  jpeg_create_compress(&jpeg);
  unsigned char *memory = NULL;
  unsigned long size = 0;
  jpeg_mem_dest(&jpeg, &memory, &size);
  jpeg.image_width = W;
  jpeg.image_height = H;
  jpeg.input_components = channels;
  jpeg.in_color_space = space;
  jpeg_set_defaults(&jpeg);
  jpeg_set_quality(&jpeg, 95, TRUE);
  if (progressive)
    jpeg_simple_progression(&jpeg);
  jpeg_start_compress(&jpeg, TRUE);
  unsigned char row[W * 4];
  for (int i = 0; i < W * channels; i++)
    row[i] = (unsigned char)(60 + 50 * (i % channels));
  for (int y = 0; y < H; y++) {
    JSAMPROW line = row;
    jpeg_write_scanlines(&jpeg, &line, 1);
  }
  jpeg_finish_compress(&jpeg);
  assert_true(size <= MOST);
  memcpy(out->bytes, memory, size);
  out->size = size;
  jpeg_destroy_compress(&jpeg);
  free(memory);
}

static void every_jpeg_is_read(void **state) {
  (void)state;
  static blob file;
  for (int progressive = 0; progressive < 2; progressive++) {
    for (int channels = 1; channels <= 3; channels += 2) {
      make_jpeg(channels == 1 ? JCS_GRAYSCALE : JCS_RGB, channels, progressive, &file);
      pl_image image = decode(&file);
      assert_int_equal(image.channels, channels);
      for (int i = 0; i < W * H * channels; i++)
        assert_in_range(image.texels[i], 57 + 50 * (i % channels), 63 + 50 * (i % channels));
      pl_image_clear(&image);
    }
  }
}

static void refuse(const void *bytes, size_t size, pl_status expected, const char *text) {
  pl_image image;
  const pl_status status = pl_image_decode(bytes, size, "my-image", &image);
  if (status != expected || strstr(pl_error_text(), text) == NULL ||
      strstr(pl_error_text(), "my-image") == NULL)
    fail_msg("%s: %s (expected %s, \"%s\")", pl_status_name(status), pl_error_text(),
             pl_status_name(expected), text);
  assert_null(image.texels);
}

static void other_formats_are_refused_by_name(void **state) {
  (void)state;
  static blob file;
  make_jpeg(JCS_CMYK, 4, false, &file);
  refuse(file.bytes, file.size, PL_E_UNSUPPORTED, "CMYK");
  refuse("II*\0abcdefgh", 12, PL_E_UNSUPPORTED, "TIFF");
  refuse("MM\0*abcdefgh", 12, PL_E_UNSUPPORTED, "TIFF");
  refuse("GIF89a......", 12, PL_E_UNSUPPORTED, "GIF");
  refuse("BM..........", 12, PL_E_UNSUPPORTED, "BMP");
  refuse("\xABKTX 20\xBB\r\n\x1A\n", 12, PL_E_UNSUPPORTED, "KTX 2");
  refuse("hello", 5, PL_E_FORMAT, "not a PNG, JPEG or WebP");
  refuse("", 0, PL_E_FORMAT, "empty");
  refuse("\x89PNG", 4, PL_E_FORMAT, "not a PNG");
}

/* Cut anywhere, a file is an error: never a picture with a grey rest. */
static void truncated_files_are_refused(void **state) {
  (void)state;
  static blob file;
  for (int kind = 0; kind < 4; kind++) {
    if (kind < 2)
      make_png(PNG_COLOR_TYPE_RGB, 8, kind, false, &file);
    else
      make_jpeg(JCS_RGB, 3, kind == 3, &file);
    for (size_t size = 0; size < file.size; size++) {
      /* A block of its own, so that the sanitizer sees a read past the end. */
      unsigned char *cut = malloc(size > 0 ? size : 1);
      assert_non_null(cut);
      memcpy(cut, file.bytes, size);
      refuse(cut, size, PL_E_FORMAT, "");
      free(cut);
    }
  }
}

static void noise_never_crashes(void **state) {
  (void)state;
  static blob file, broken;
  test_random random = {.seed = 99};
  for (int kind = 0; kind < 4; kind++) {
    if (kind < 2)
      make_png(PNG_COLOR_TYPE_PALETTE, 8, kind, true, &file);
    else
      make_jpeg(JCS_RGB, 3, kind == 3, &file);
    for (int i = 0; i < 2000; i++) {
      broken = file;
      const int flips = 1 + (int)random_range(&random, 0, 6);
      for (int k = 0; k < flips; k++)
        broken.bytes[(size_t)random_range(&random, 8, (double)file.size - 0.001)] =
            (unsigned char)random_range(&random, 0, 255.999);
      pl_image image;
      if (pl_image_decode(broken.bytes, broken.size, "noise", &image) == PL_OK)
        pl_image_clear(&image);
      else
        assert_null(image.texels);
    }
  }
}

static void put_u32(unsigned char *at, uint32_t value) {
  for (int i = 0; i < 4; i++)
    at[i] = (unsigned char)(value >> (24 - 8 * i));
}

/* A header of any size with a correct checksum. */
static size_t huge_png(uint32_t width, uint32_t height, unsigned char *out) {
  memcpy(out, "\x89PNG\r\n\x1A\n\0\0\0\rIHDR", 16);
  put_u32(out + 16, width);
  put_u32(out + 20, height);
  memcpy(out + 24, "\x08\x02\0\0\0", 5);
  uint32_t crc = 0xFFFFFFFFu; /* PNG specification, annex D */
  for (int i = 12; i < 29; i++) {
    crc ^= out[i];
    for (int bit = 0; bit < 8; bit++)
      crc = crc & 1 ? crc >> 1 ^ 0xEDB88320u : crc >> 1;
  }
  put_u32(out + 29, ~crc);
  memcpy(out + 33, "\0\0\0\0IDAT\x35\xAF\x06\x1E", 12);
  return 45;
}

static void headers_cannot_claim_memory(void **state) {
  (void)state;
  unsigned char png[64];
  const uint64_t before = pl_memory_allocations();
  refuse(png, huge_png(65536, 65536, png), PL_E_RANGE, "2^28");
  refuse(png, huge_png(65537, 1, png), PL_E_FORMAT, "");
  refuse(png, huge_png(16384, 16384, png), PL_E_FORMAT, "cannot hold");
  refuse(png, huge_png(0, 1, png), PL_E_FORMAT, "");
  assert_true(pl_memory_allocations() - before < 100); /* libpng's own, none of them the image */
}

static void files_are_read(void **state) {
  (void)state;
  static blob file;
  make_png(PNG_COLOR_TYPE_RGB, 8, 0, false, &file);
  pl_image image;
  assert_int_equal(pl_image_load(write_file("a.dat", file.bytes, file.size), &image), PL_OK);
  assert_int_equal(image.width, W);
  pl_image_clear(&image);
  const char *missing = in_folder("missing.png");
  assert_int_equal(pl_image_load(missing, &image), PL_E_IO);
  assert_non_null(strstr(pl_error_text(), missing));
  assert_int_equal(pl_image_load(test_folder, &image), PL_E_IO);
  assert_int_equal(pl_image_load("/dev/zero", &image), PL_E_IO);
  assert_int_equal(mkfifo(in_folder("pipe"), 0600), 0);
  assert_int_equal(pl_image_load(in_folder("pipe"), &image), PL_E_IO); /* and does not hang */
}

static void failed_allocations_are_reported(void **state) {
  (void)state;
  static blob file;
  for (int kind = 0; kind < 2; kind++) {
    if (kind == 0)
      make_png(PNG_COLOR_TYPE_PALETTE, 8, 1, true, &file);
    else
      make_jpeg(JCS_RGB, 3, false, &file);
    for (int allowed = 0;; allowed++) {
      allowance budget = {allowed};
      pl_memory_hook(allocate_allowed, &budget);
      pl_image image;
      const pl_status status = pl_image_decode(file.bytes, file.size, "test", &image);
      pl_memory_hook(NULL, NULL);
      if (status == PL_OK) {
        pl_image_clear(&image);
        assert_true(allowed > 0);
        break;
      }
      assert_true(status == PL_E_MEMORY || status == PL_E_FORMAT); /* libpng words it itself */
      assert_null(image.texels);
      assert_true(allowed < 100);
    }
  }
}

int main(void) {
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(every_png_is_read),
      cmocka_unit_test(small_depths_and_palettes_are_expanded),
      cmocka_unit_test(a_transparent_grey_becomes_alpha),
      cmocka_unit_test(every_jpeg_is_read),
      cmocka_unit_test(other_formats_are_refused_by_name),
      cmocka_unit_test(truncated_files_are_refused),
      cmocka_unit_test(noise_never_crashes),
      cmocka_unit_test(headers_cannot_claim_memory),
      cmocka_unit_test_setup_teardown(files_are_read, folder_create, folder_remove),
      cmocka_unit_test(failed_allocations_are_reported),
  };
  return cmocka_run_group_tests(tests, NULL, NULL);
}
