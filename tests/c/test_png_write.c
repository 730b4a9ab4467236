/* Writing PNG: content, identical bytes, and nothing half written. */
#define _GNU_SOURCE
#include "io/png_write.h"

#include <errno.h>
#include <png.h>
#include <signal.h>
#include <sys/resource.h>
#include <sys/stat.h>

#include "files.h"
#include "io/image_file.h"
#include "random.h"

static void fill(unsigned char *bytes, size_t count) {
  test_random random = {.seed = 21};
  for (size_t i = 0; i < count; i++)
    bytes[i] = (unsigned char)random_range(&random, 0, 255.999);
}

enum { W8 = 37, H8 = 11 };

static void come_back(const unsigned char *samples) {
  for (int channels = 1; channels <= 4; channels++) {
    for (int level = 0; level <= 9; level += 3) {
      const char *path = in_folder("a.png");
      assert_int_equal(pl_png_write(path, samples, W8, H8, channels, 8, level), PL_OK);
      pl_image image;
      assert_int_equal(pl_image_load(path, &image), PL_OK);
      assert_int_equal(image.width, W8);
      assert_int_equal(image.height, H8);
      assert_int_equal(image.channels, channels);
      assert_memory_equal(image.texels, samples, (size_t)(W8 * H8 * channels));
      pl_image_clear(&image);
    }
  }
}

static void eight_bits_come_back(void **state) {
  (void)state;
  unsigned char noise[W8 * H8 * 4], runs[W8 * H8 * 4];
  fill(noise, sizeof noise);
  for (size_t i = 0; i < sizeof runs; i++)
    runs[i] = (unsigned char)(i / 120);
  come_back(noise);
  come_back(runs);
  assert_int_equal(folder_count(test_folder, 0), 1); /* no temporary file is left */
}

/* Short runs of many values: by repetitions of strings deflate takes more bytes for them. */
static void runs_are_found(void **state) {
  (void)state;
  enum { SIDE = 128, LIMIT = 2700 };
  static unsigned char samples[SIDE * SIDE];
  test_random random = {.seed = 22};
  unsigned char value = 0;
  for (size_t i = 0, left = 0; i < sizeof samples; i++, left--) {
    if (left == 0) {
      left = (size_t)random_range(&random, 8.0, 24.0);
      value = (unsigned char)random_range(&random, 0, 255.999);
    }
    samples[i] = value;
  }
  pl_bytes out = {0};
  assert_int_equal(pl_png_encode("a", samples, SIDE, SIDE, 1, 8, 1, NULL, 0, &out), PL_OK);
  print_message("%zu bytes\n", out.size);
  assert_in_range(out.size, 1, LIMIT);
  pl_bytes_clear(&out);
}

/* Through libpng itself, since our reader reduces to 8 bits. */
static void sixteen_bits_come_back(void **state) {
  (void)state;
  enum { W = 5, H = 3 };
  uint16_t samples[W * H], back[W * H];
  for (int i = 0; i < W * H; i++)
    samples[i] = (uint16_t)(i * 4321 + 7);
  const char *path = in_folder("b.png");
  assert_int_equal(pl_png_write(path, samples, W, H, 1, 16, 6), PL_OK);
  FILE *file = fopen(path, "rb");
  assert_non_null(file);
  png_structp png = png_create_read_struct(PNG_LIBPNG_VER_STRING, NULL, NULL, NULL);
  png_infop info = png_create_info_struct(png);
  png_init_io(png, file);
  png_read_info(png, info);
  assert_int_equal(png_get_bit_depth(png, info), 16);
  assert_int_equal(png_get_color_type(png, info), PNG_COLOR_TYPE_GRAY);
  for (int y = 0; y < H; y++) {
    unsigned char row[2 * W];
    png_read_row(png, row, NULL);
    for (int x = 0; x < W; x++) /* PNG is big-endian */
      back[y * W + x] = (uint16_t)(row[2 * x] << 8 | row[2 * x + 1]);
  }
  png_destroy_read_struct(&png, &info, NULL);
  fclose(file);
  assert_memory_equal(back, samples, sizeof samples);
}

static void bytes_are_reproducible(void **state) {
  (void)state;
  unsigned char samples[64 * 64 * 3];
  fill(samples, sizeof samples);
  size_t size[2];
  unsigned char *bytes[2];
  for (int k = 0; k < 2; k++) {
    const char *path = in_folder(k == 0 ? "one.png" : "two.png");
    assert_int_equal(pl_png_write(path, samples, 64, 64, 3, 8, 6), PL_OK);
    bytes[k] = read_file(path, &size[k]);
  }
  assert_int_equal(size[0], size[1]);
  assert_memory_equal(bytes[0], bytes[1], size[0]);
  free(bytes[0]);
  free(bytes[1]);
}

static void bad_arguments_are_refused(void **state) {
  (void)state;
  const unsigned char samples[16] = {0};
  const char *path = in_folder("c.png");
  assert_int_equal(pl_png_write(path, samples, 0, 1, 1, 8, 6), PL_E_RANGE);
  assert_int_equal(pl_png_write(path, samples, 1, 65537, 1, 8, 6), PL_E_RANGE);
  assert_int_equal(pl_png_write(path, samples, 1, 1, 0, 8, 6), PL_E_RANGE);
  assert_int_equal(pl_png_write(path, samples, 1, 1, 5, 8, 6), PL_E_RANGE);
  assert_int_equal(pl_png_write(path, samples, 1, 1, 1, 12, 6), PL_E_RANGE);
  assert_int_equal(pl_png_write(path, samples, 1, 1, 1, 8, 10), PL_E_RANGE);
  assert_int_equal(folder_count(test_folder, 0), 0);
}

static void a_missing_folder_is_named(void **state) {
  (void)state;
  const unsigned char sample = 0;
  const char *path = in_folder("nowhere/c.png");
  assert_int_equal(pl_png_write(path, &sample, 1, 1, 1, 8, 6), PL_E_IO);
  assert_non_null(strstr(pl_error_text(), path));
  assert_non_null(strstr(pl_error_text(), strerror(ENOENT)));
}

/* The size limit of the process stands for a full disk: writing stops in the middle. The file that
 * was there before must survive, and no temporary file stay. */
static void a_failed_write_leaves_the_old_file(void **state) {
  (void)state;
  const char *path = in_folder("d.png");
  enum { SIDE = 300 };
  unsigned char *samples = malloc(SIDE * SIDE);
  assert_non_null(samples);
  fill(samples, SIDE * SIDE);
  assert_int_equal(pl_png_write(path, samples, 2, 2, 1, 8, 6), PL_OK);
  struct rlimit before, small;
  getrlimit(RLIMIT_FSIZE, &before);
  small = before;
  small.rlim_cur = 20000;
  signal(SIGXFSZ, SIG_IGN);
  setrlimit(RLIMIT_FSIZE, &small);
  const pl_status status = pl_png_write(path, samples, SIDE, SIDE, 1, 8, 6);
  setrlimit(RLIMIT_FSIZE, &before);
  assert_int_equal(status, PL_E_IO);
  assert_non_null(strstr(pl_error_text(), strerror(EFBIG)));
  assert_int_equal(folder_count(test_folder, 0), 1);
  pl_image image;
  assert_int_equal(pl_image_load(path, &image), PL_OK);
  assert_int_equal(image.width, 2);
  pl_image_clear(&image);
  free(samples);
}

/* A folder in the place of the target: the rename fails, the temporary file goes. */
static void a_failed_rename_leaves_nothing(void **state) {
  (void)state;
  const unsigned char sample = 9;
  const char *path = in_folder("folder");
  assert_int_equal(mkdir(path, 0777), 0);
  assert_int_equal(pl_png_write(path, &sample, 1, 1, 1, 8, 6), PL_E_IO);
  assert_int_equal(folder_count(test_folder, 0), 1);
}

/* A name left by a killed process with our id is stepped over, not clobbered. */
static void a_stale_temporary_is_no_obstacle(void **state) {
  (void)state;
  char stale[64];
  snprintf(stale, sizeof stale, "e.png.%ld.0.tmp", (long)getpid());
  write_file(stale, "old", 3);
  const unsigned char sample = 9;
  assert_int_equal(pl_png_write(in_folder("e.png"), &sample, 1, 1, 1, 8, 6), PL_OK);
  size_t size;
  unsigned char *left = read_file(in_folder(stale), &size);
  assert_int_equal(size, 3);
  free(left);
  assert_int_equal(folder_count(test_folder, 0), 2);
}

static void failed_allocations_leave_nothing(void **state) {
  (void)state;
  const unsigned char samples[12] = {0};
  for (int allowed = 0;; allowed++) {
    allowance budget = {allowed};
    pl_memory_hook(allocate_allowed, &budget);
    const pl_status status = pl_png_write(in_folder("f.png"), samples, 2, 2, 3, 8, 6);
    pl_memory_hook(NULL, NULL);
    if (status == PL_OK)
      break;
    assert_int_equal(status, PL_E_MEMORY);
    assert_int_equal(folder_count(test_folder, 0), 0);
    assert_true(allowed < 100);
  }
  assert_int_equal(folder_count(test_folder, 0), 1);
}

#define in_own_folder(test) cmocka_unit_test_setup_teardown(test, folder_create, folder_remove)

int main(void) {
  const struct CMUnitTest tests[] = {
      in_own_folder(eight_bits_come_back),
      in_own_folder(runs_are_found),
      in_own_folder(sixteen_bits_come_back),
      in_own_folder(bytes_are_reproducible),
      in_own_folder(bad_arguments_are_refused),
      in_own_folder(a_missing_folder_is_named),
      in_own_folder(a_failed_write_leaves_the_old_file),
      in_own_folder(a_failed_rename_leaves_nothing),
      in_own_folder(a_stale_temporary_is_no_obstacle),
      in_own_folder(failed_allocations_leave_nothing),
  };
  return cmocka_run_group_tests(tests, NULL, NULL);
}
