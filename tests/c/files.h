/* A folder of a test's own: made before, removed after, with helpers to fill it. */
#ifndef PL_TESTS_FILES_H
#define PL_TESTS_FILES_H

#include <dirent.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

#include "harness.h"

#include "base/memory.h"

static char test_folder[64];

static inline int folder_create(void **state) {
  (void)state;
  snprintf(test_folder, sizeof test_folder, "pl_test_XXXXXX");
  return mkdtemp(test_folder) != NULL ? 0 : -1;
}

/* Number of files; with `remove` they are removed, and folders one level below. */
static inline int folder_count(const char *path, int remove_all) {
  int count = 0;
  DIR *folder = opendir(path);
  for (struct dirent *entry; folder != NULL && (entry = readdir(folder)) != NULL;) {
    if (strcmp(entry->d_name, ".") == 0 || strcmp(entry->d_name, "..") == 0)
      continue;
    count++;
    char name[600];
    if (snprintf(name, sizeof name, "%s/%s", path, entry->d_name) >= (int)sizeof name)
      continue;
    if (remove_all && unlink(name) != 0) {
      folder_count(name, 1);
      rmdir(name);
    }
  }
  if (folder != NULL)
    closedir(folder);
  return count;
}

static inline int folder_remove(void **state) {
  (void)state;
  pl_memory_hook(NULL, NULL);
  folder_count(test_folder, 1);
  return rmdir(test_folder);
}

/* "FOLDER/name", valid until the fourth call after. */
static inline const char *in_folder(const char *name) {
  static char paths[4][400];
  static int next;
  char *path = paths[next++ % 4];
  snprintf(path, sizeof paths[0], "%s/%s", test_folder, name);
  return path;
}

static inline const char *write_file(const char *name, const void *bytes, size_t size) {
  const char *path = in_folder(name);
  FILE *file = fopen(path, "wb");
  assert_non_null(file);
  assert_int_equal(fwrite(bytes, 1, size, file), size);
  assert_int_equal(fclose(file), 0);
  return path;
}

/* Whole content, for free(). */
static inline unsigned char *read_file(const char *path, size_t *size) {
  FILE *file = fopen(path, "rb");
  assert_non_null(file);
  fseek(file, 0, SEEK_END);
  *size = (size_t)ftell(file);
  rewind(file);
  unsigned char *bytes = malloc(*size + 1);
  assert_non_null(bytes);
  assert_int_equal(fread(bytes, 1, *size, file), *size);
  fclose(file);
  return bytes;
}

/* A hook that lets `left` allocations pass and fails every further one. */
typedef struct allowance {
  int left;
} allowance;

static inline void *allocate_allowed(void *context, size_t size) {
  allowance *a = context;
  return a->left-- > 0 ? malloc(size) : NULL;
}

#endif
