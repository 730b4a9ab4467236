/* Feeds every file of a folder to a fuzzer's entry point, without a fuzzing engine. */
#include <dirent.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size);

static int replay(const char *path) {
  FILE *file = fopen(path, "rb");
  if (file == NULL)
    return -1;
  uint8_t *data = NULL;
  long size = -1;
  if (fseek(file, 0, SEEK_END) == 0 && (size = ftell(file)) >= 0) {
    rewind(file);
    /* Exactly as large as the content, so that the sanitizer sees a read past its end. */
    data = malloc(size > 0 ? (size_t)size : 1);
  }
  int result = -1;
  if (data != NULL && fread(data, 1, (size_t)size, file) == (size_t)size) {
    LLVMFuzzerTestOneInput(data, (size_t)size);
    result = 0;
  }
  free(data);
  fclose(file);
  return result;
}

int main(int argc, char **argv) {
  if (argc != 2) {
    fprintf(stderr, "usage: %s FOLDER\n", argv[0]);
    return 2;
  }
  DIR *folder = opendir(argv[1]);
  if (folder == NULL) {
    fprintf(stderr, "cannot open %s\n", argv[1]);
    return 2;
  }
  size_t count = 0;
  for (struct dirent *entry; (entry = readdir(folder)) != NULL;) {
    if (entry->d_name[0] == '.')
      continue;
    char path[4096];
    snprintf(path, sizeof path, "%s/%s", argv[1], entry->d_name);
    if (replay(path) != 0) {
      fprintf(stderr, "cannot read %s\n", path);
      closedir(folder);
      return 1;
    }
    count++;
  }
  closedir(folder);
  printf("%zu inputs replayed\n", count);
  return count > 0 ? 0 : 1;
}
