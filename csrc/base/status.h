/* Status codes, and the per-thread text of the last error. */
#ifndef PL_BASE_STATUS_H
#define PL_BASE_STATUS_H

#include <stddef.h>

#ifdef __cplusplus
extern "C" {
#endif

/* Every function that can fail returns one of these; results are written through the last
 * pointer. */
typedef enum pl_status {
  PL_OK = 0,
  PL_E_MEMORY,      /* an allocation failed */
  PL_E_ARGUMENT,    /* the caller violated a precondition of a function */
  PL_E_RANGE,       /* a value is not finite or not physically meaningful */
  PL_E_IO,          /* a file cannot be opened, read or written */
  PL_E_FORMAT,      /* the content of a file is invalid */
  PL_E_UNSUPPORTED, /* valid, but not supported by this build */
  PL_E_CANCELLED,   /* the caller's cancel token was set */
  PL_E_DEVICE,      /* the ray-tracing device reported an error */
  PL_STATUS_COUNT
} pl_status;

/* Returns the name of a status, e.g. "format error"; never NULL. */
const char *pl_status_name(pl_status status);

/* Records printf-style text as this thread's error text and returns `status`. */
#if defined(__GNUC__)
__attribute__((format(printf, 2, 3)))
#endif
pl_status
pl_fail(pl_status status, const char *format, ...);

/* Returns the text of this thread's last error; valid until the next pl_fail of this thread; never
 * NULL. */
const char *pl_error_text(void);

/* Appends a name to the list "a, b" in `text` of `size` bytes, for errors that list the allowed
 * names. The list is truncated where the buffer ends. */
void pl_names_append(char *text, size_t size, const char *name);

/* Returns from the calling function when `expression` is not PL_OK. */
#define PL_TRY(expression)                                                                         \
  do {                                                                                             \
    const pl_status pl_try_status_ = (expression);                                                 \
    if (pl_try_status_ != PL_OK)                                                                   \
      return pl_try_status_;                                                                       \
  } while (0)

#ifdef __cplusplus
}
#endif
#endif
