/* Reading WebP: lossless, lossy and with alpha, and files that are broken or claim too much. */
#include "io/image_file.h"

#include <webp/encode.h>

#include "files.h"
#include "random.h"

enum { W = 13, H = 9, MOST = 1 << 16 };

typedef struct blob {
  unsigned char bytes[MOST];
  size_t size;
} blob;

static unsigned char sample(int x, int y, int c) {
  return (unsigned char)(1 + (x * 17 + y * 29 + c * 71) % 255);
}

/* A picture of values that `sample` gives, as WebP. libwebp's lossless encoder clears the colour of
 * transparent texels unless told otherwise, so alpha stays above 0. */
static void make_webp(int channels, bool lossless, blob *out) {
  unsigned char texels[W * H * 4];
  for (int i = 0; i < W * H; i++)
    for (int c = 0; c < channels; c++)
      texels[i * channels + c] = sample(i % W, i / W, c);
  uint8_t *made;
  size_t size;
  if (lossless)
    size = channels == 4 ? WebPEncodeLosslessRGBA(texels, W, H, W * 4, &made)
                         : WebPEncodeLosslessRGB(texels, W, H, W * 3, &made);
  else
    size = channels == 4 ? WebPEncodeRGBA(texels, W, H, W * 4, 90, &made)
                         : WebPEncodeRGB(texels, W, H, W * 3, 90, &made);
  assert_in_range(size, 1, MOST);
  memcpy(out->bytes, made, size);
  out->size = size;
  WebPFree(made);
}

static void lossless_texels_are_exact(void **state) {
  (void)state;
  static blob file;
  for (int channels = 3; channels <= 4; channels++) {
    make_webp(channels, true, &file);
    pl_image image;
    assert_int_equal(pl_image_decode(file.bytes, file.size, "test", &image), PL_OK);
    assert_int_equal(image.width, W);
    assert_int_equal(image.height, H);
    assert_int_equal(image.channels, channels);
    for (int i = 0; i < W * H; i++)
      for (int c = 0; c < channels; c++)
        assert_int_equal(image.texels[i * channels + c], sample(i % W, i / W, c));
    pl_image_clear(&image);
  }
}

/* One colour survives lossy coding but for the rounding of its colour space (RFC 6386, 9.2), and
 * alpha is lossless beside it. */
static void lossy_texels_are_near(void **state) {
  (void)state;
  unsigned char texels[W * H * 4];
  for (int i = 0; i < W * H; i++) {
    texels[4 * i] = 60, texels[4 * i + 1] = 110, texels[4 * i + 2] = 160;
    texels[4 * i + 3] = (unsigned char)(255 - i);
  }
  uint8_t *made;
  const size_t size = WebPEncodeRGBA(texels, W, H, W * 4, 95, &made);
  pl_image image;
  assert_int_equal(pl_image_decode(made, size, "test", &image), PL_OK);
  assert_int_equal(image.channels, 4);
  for (int i = 0; i < W * H; i++) {
    for (int c = 0; c < 3; c++)
      assert_in_range(image.texels[4 * i + c], 57 + 50 * c, 63 + 50 * c);
    assert_int_equal(image.texels[4 * i + 3], 255 - i);
  }
  pl_image_clear(&image);
  WebPFree(made);
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

/* Cut anywhere, a file is an error: never a picture with a grey rest. */
static void truncated_files_are_refused(void **state) {
  (void)state;
  static blob file;
  for (int kind = 0; kind < 4; kind++) {
    make_webp(3 + kind / 2, kind % 2 == 0, &file);
    for (size_t size = 0; size < file.size; size++) {
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
  test_random random = {.seed = 7};
  int loaded = 0;
  for (int kind = 0; kind < 4; kind++) {
    make_webp(3 + kind / 2, kind % 2 == 0, &file);
    for (int i = 0; i < 1500; i++) {
      broken = file;
      const int flips = 1 + random_below(&random, 5);
      for (int k = 0; k < flips; k++)
        broken.bytes[12 + random_below(&random, (int)file.size - 12)] =
            (unsigned char)random_below(&random, 256);
      pl_image image;
      if (pl_image_decode(broken.bytes, broken.size, "noise", &image) == PL_OK) {
        loaded++;
        pl_image_clear(&image);
      } else {
        assert_null(image.texels);
      }
    }
  }
  assert_in_range(loaded, 10, 5990);
}

/* A lossless header of any size (RFC 9649, 3.4: signature, 14 bits each of width - 1 and height -
 * 1), with zeros behind it. */
static size_t huge_webp(unsigned width, unsigned height, unsigned char *out) {
  static const unsigned char head[21] = "RIFF\x38\0\0\0WEBPVP8L\x2c\0\0\0\x2f";
  memset(out, 0, 64);
  memcpy(out, head, 21);
  const uint32_t bits = (uint32_t)(width - 1) | (uint32_t)(height - 1) << 14;
  for (int i = 0; i < 4; i++)
    out[21 + i] = (unsigned char)(bits >> (8 * i));
  return 64;
}

static void headers_cannot_claim_memory(void **state) {
  (void)state;
  unsigned char webp[64];
  const uint64_t before = pl_memory_allocations();
  refuse(webp, huge_webp(16384, 16384, webp), PL_E_FORMAT, "cannot hold");
  refuse(webp, huge_webp(16384, 4096, webp), PL_E_FORMAT, "cannot hold");
  assert_int_equal(pl_memory_allocations(), before);
  memcpy(webp + 4, "\xFF\xFF\xFF\xFF", 4);
  refuse(webp, 64, PL_E_FORMAT, "truncated");
}

/* Few bytes hold a large image of one colour; that is no attack. */
static void one_colour_may_be_large(void **state) {
  (void)state;
  enum { SIDE = 2048 };
  unsigned char *texels = malloc((size_t)SIDE * SIDE * 3);
  assert_non_null(texels);
  memset(texels, 77, (size_t)SIDE * SIDE * 3);
  uint8_t *made;
  const size_t size = WebPEncodeLosslessRGB(texels, SIDE, SIDE, SIDE * 3, &made);
  assert_in_range(size, 1, 1000);
  pl_image image;
  assert_int_equal(pl_image_decode(made, size, "test", &image), PL_OK);
  assert_memory_equal(image.texels, texels, (size_t)SIDE * SIDE * 3);
  pl_image_clear(&image);
  WebPFree(made);
  free(texels);
}

/* An extended header (RFC 9649, 2.7: flags, then 24 bits each of width - 1 and height - 1) that
 * says animation, and its empty ANIM chunk. */
static void animations_are_refused(void **state) {
  (void)state;
  static const char file[] = "RIFF\x24\0\0\0WEBPVP8X\x0a\0\0\0\x02\0\0\0\x07\0\0\x07\0\0"
                             "ANIM\x06\0\0\0\0\0\0\0\0\0";
  refuse(file, sizeof file - 1, PL_E_UNSUPPORTED, "animated");
}

static void failed_allocations_are_reported(void **state) {
  (void)state;
  static blob file;
  make_webp(4, true, &file);
  allowance budget = {0};
  pl_memory_hook(allocate_allowed, &budget);
  pl_image image;
  const pl_status status = pl_image_decode(file.bytes, file.size, "test", &image);
  pl_memory_hook(NULL, NULL);
  assert_int_equal(status, PL_E_MEMORY);
  assert_null(image.texels);
}

int main(void) {
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(lossless_texels_are_exact),
      cmocka_unit_test(lossy_texels_are_near),
      cmocka_unit_test(truncated_files_are_refused),
      cmocka_unit_test(noise_never_crashes),
      cmocka_unit_test(headers_cannot_claim_memory),
      cmocka_unit_test(one_colour_may_be_large),
      cmocka_unit_test(animations_are_refused),
      cmocka_unit_test(failed_allocations_are_reported),
  };
  return cmocka_run_group_tests(tests, NULL, NULL);
}
