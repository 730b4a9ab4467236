/* Reads whole files. */
#define _POSIX_C_SOURCE 200809L
#include "io/file.h"

#include <errno.h>
#include <fcntl.h>
#include <string.h>
#include <sys/stat.h>
#include <unistd.h>

#include "base/memory.h"

static pl_status read_all(int descriptor, const char *path, uint8_t *bytes, size_t size) {
  size_t have = 0;
  while (have < size) {
    const ssize_t got = read(descriptor, bytes + have, size - have);
    if (got < 0 && errno == EINTR)
      continue;
    if (got < 0)
      return pl_fail(PL_E_IO, "%s: cannot be read: %s", path, strerror(errno));
    if (got == 0)
      return pl_fail(PL_E_IO, "%s: became shorter while it was read", path);
    have += (size_t)got;
  }
  return PL_OK;
}

static pl_status read_open(int descriptor, const char *path, size_t limit, uint8_t **bytes,
                           size_t *size) {
  struct stat about;
  if (fstat(descriptor, &about) != 0)
    return pl_fail(PL_E_IO, "%s: cannot be read: %s", path, strerror(errno));
  if (!S_ISREG(about.st_mode))
    return pl_fail(PL_E_IO, "%s: is not a regular file", path);
  if (about.st_size < 0 || (uintmax_t)about.st_size > limit)
    return pl_fail(PL_E_RANGE, "%s: %jd bytes; at most %zu are read", path, (intmax_t)about.st_size,
                   limit);
  void *memory;
  PL_TRY(pl_alloc_or_fail((size_t)about.st_size, 1, path, &memory));
  const pl_status status = read_all(descriptor, path, memory, (size_t)about.st_size);
  if (status != PL_OK) {
    pl_free(memory);
    return status;
  }
  *bytes = memory;
  *size = (size_t)about.st_size;
  return PL_OK;
}

pl_status pl_file_read(const char *path, size_t limit, uint8_t **bytes, size_t *size) {
  *bytes = NULL;
  *size = 0;
  /* Non-blocking, so that opening a named pipe does not hang. */
  const int descriptor = open(path, O_RDONLY | O_CLOEXEC | O_NONBLOCK);
  if (descriptor < 0)
    return pl_fail(PL_E_IO, "%s: cannot be opened: %s", path, strerror(errno));
  const pl_status status = read_open(descriptor, path, limit, bytes, size);
  close(descriptor);
  return status;
}
