/* Writing OpenEXR: content, identical bytes, refusals, and allocations that fail. What a reader of
 * others makes of it, tests/python/output/test_format_readers.py asks. */
#include "io/exr.h"

#include <stdbool.h>
#include <string.h>

#include "files.h"
#include "io/exr_read.h"
#include "io/png_write.h"

enum { W = 19, H = 40 }; /* three blocks of 16 lines, the last one short */

static float depth[W * H];
static uint16_t half[W * H];
static uint32_t ids[W * H];

static const pl_exr_channel planes[] = {
    {"depth.Z", PL_EXR_FLOAT, depth}, {"instance.ID", PL_EXR_UINT, ids}, {"R", PL_EXR_HALF, half}};
static const pl_exr_text texts[] = {{"perilune", "{}"}};

static void fill(void) {
  for (int i = 0; i < W * H; i++) {
    depth[i] = 0.25F * (float)i;
    half[i] = (uint16_t)(i % 0x7bff); /* finite */
    ids[i] = (uint32_t)i * 7919U;
  }
}

static pl_status encode(pl_bytes *out) { return pl_exr_encode(W, H, planes, 3, texts, 1, out); }

static void the_same_bytes_every_time(void **state) {
  (void)state;
  fill();
  pl_bytes one = {0}, two = {0};
  assert_int_equal(encode(&one), PL_OK);
  assert_int_equal(encode(&two), PL_OK);
  assert_int_equal(one.size, two.size);
  assert_memory_equal(one.data, two.data, one.size);
  const uint8_t magic[4] = {0x76, 0x2f, 0x31, 0x01}; /* OpenEXR File Layout, "Magic Number" */
  assert_memory_equal(one.data, magic, 4);
  assert_true(one.size < (sizeof depth + sizeof half + sizeof ids)); /* it is compressed */
  pl_bytes_clear(&one);
  pl_bytes_clear(&two);
}

static void what_cannot_be_is_refused(void **state) {
  (void)state;
  char name[300];
  memset(name, 'a', sizeof name);
  name[sizeof name - 1] = 0;
  const pl_exr_channel twice[] = {planes[0], planes[0]}, none[] = {{"", PL_EXR_FLOAT, depth}},
                       wide[] = {{name, PL_EXR_FLOAT, depth}};
  pl_bytes out = {0};
  assert_int_equal(pl_exr_encode(W, H, twice, 2, NULL, 0, &out), PL_E_RANGE);
  assert_int_equal(pl_exr_encode(W, H, none, 1, NULL, 0, &out), PL_E_RANGE);
  assert_int_equal(pl_exr_encode(W, H, wide, 1, NULL, 0, &out), PL_E_RANGE);
  assert_int_equal(pl_exr_encode(W, H, planes, 0, NULL, 0, &out), PL_E_RANGE);
  assert_int_equal(pl_exr_encode(0, H, planes, 1, NULL, 0, &out), PL_E_RANGE);
  assert_int_equal(pl_exr_encode(W, 65537, planes, 1, NULL, 0, &out), PL_E_RANGE);
  assert_int_equal(out.size, 0);
  pl_bytes_clear(&out);
}

/* With every number of allocations that succeed there is an error, and nothing leaks. */
static void failed_allocations_are_told(pl_status (*task)(pl_bytes *), bool reads) {
  for (int allowed = 0;; allowed++) {
    allowance budget = {allowed};
    pl_bytes out = {0};
    pl_memory_hook(allocate_allowed, &budget);
    const pl_status status = task(&out);
    pl_memory_hook(NULL, NULL);
    pl_bytes_clear(&out);
    if (status == PL_OK)
      break;
    /* OpenEXRCore tells of some of its own as of damage when it reads. */
    if (!reads || status != PL_E_FORMAT)
      assert_int_equal(status, PL_E_MEMORY);
    assert_true(allowed < 200);
  }
}

static void failed_allocations_of_exr(void **state) {
  (void)state;
  fill();
  failed_allocations_are_told(encode, false);
}

static void decoded_planes_are_those_encoded(void **state) {
  (void)state;
  fill();
  pl_bytes file = {0};
  pl_exr_image image;
  assert_int_equal(encode(&file), PL_OK);
  assert_int_equal(pl_exr_decode(file.data, file.size, "a.exr", &image), PL_OK);
  assert_int_equal(image.width, W);
  assert_int_equal(image.height, H);
  assert_int_equal(image.count, 3);
  for (size_t i = 0; i < image.count; i++) {
    const pl_exr_channel *from = &planes[0];
    while (strcmp(from->name, image.planes[i].name) != 0)
      from++;
    assert_int_equal(image.planes[i].type, from->type);
    const size_t size = W * H * (from->type == PL_EXR_HALF ? 2 : 4);
    assert_memory_equal(image.planes[i].samples, from->samples, size);
  }
  pl_exr_image_clear(&image);
  pl_bytes_clear(&file);
}

/* A file that is cut anywhere, or has another byte anywhere, never reads outside of itself. */
static void damaged_files_are_told(void **state) {
  (void)state;
  fill();
  pl_bytes file = {0};
  pl_exr_image image;
  assert_int_equal(encode(&file), PL_OK);
  for (size_t size = 0; size < file.size; size += 7)
    assert_int_equal(pl_exr_decode(file.data, size, "a.exr", &image), PL_E_FORMAT);
  for (size_t at = 0; at < file.size; at += 3) {
    file.data[at] ^= 0x41;
    if (pl_exr_decode(file.data, file.size, "a.exr", &image) == PL_OK)
      pl_exr_image_clear(&image);
    file.data[at] ^= 0x41;
  }
  assert_int_equal(pl_exr_decode("", 0, "a.exr", &image), PL_E_FORMAT);
  pl_bytes_clear(&file);
}

static pl_bytes whole;

static pl_status decode_whole(pl_bytes *file) {
  (void)file;
  pl_exr_image image;
  const pl_status status = pl_exr_decode(whole.data, whole.size, "a.exr", &image);
  if (status == PL_OK)
    pl_exr_image_clear(&image);
  return status;
}

static void failed_allocations_of_reading(void **state) {
  (void)state;
  fill();
  assert_int_equal(encode(&whole), PL_OK);
  failed_allocations_are_told(decode_whole, true);
  pl_bytes_clear(&whole);
}

static pl_status encode_png(pl_bytes *out) {
  static const uint8_t samples[6] = {0, 1, 2, 2, 1, 0}, palette[9] = {0};
  return pl_png_encode("a", samples, 3, 2, 1, 8, 6, palette, 3, out);
}

static void failed_allocations_of_png(void **state) {
  (void)state;
  failed_allocations_are_told(encode_png, false);
}

static void bytes_may_be_written_anywhere(void **state) {
  (void)state;
  pl_bytes bytes = {0};
  assert_int_equal(pl_bytes_put(&bytes, 10, "abc", 3), PL_OK);
  assert_int_equal(pl_bytes_put(&bytes, 0, "xy", 2), PL_OK);
  assert_int_equal(pl_bytes_put(&bytes, 9000, "z", 1), PL_OK);
  assert_int_equal(bytes.size, 9001);
  assert_memory_equal(bytes.data, "xy\0\0\0\0\0\0\0\0abc\0", 14);
  assert_int_equal(bytes.data[9000], 'z');
  assert_int_equal(pl_bytes_put(&bytes, SIZE_MAX - 1, "z", 1), PL_E_MEMORY);
  pl_bytes_clear(&bytes);
  assert_null(bytes.data);
}

int main(void) {
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(the_same_bytes_every_time),
      cmocka_unit_test(what_cannot_be_is_refused),
      cmocka_unit_test(failed_allocations_of_exr),
      cmocka_unit_test(failed_allocations_of_png),
      cmocka_unit_test(bytes_may_be_written_anywhere),
      cmocka_unit_test(damaged_files_are_told),
      cmocka_unit_test(failed_allocations_of_reading),
      cmocka_unit_test(decoded_planes_are_those_encoded),
  };
  return cmocka_run_group_tests(tests, NULL, NULL);
}
