/* Status codes and the per-thread text of the last error. */
#ifndef PL_BASE_STATUS_H
#define PL_BASE_STATUS_H

#include <stddef.h>

#ifdef __cplusplus
extern "C" {
#endif

/* Every fallible function returns one of these; results go through the last pointer. */
typedef enum pl_status {
  PL_OK = 0,
  PL_E_MEMORY,      /* an allocation failed */
  PL_E_ARGUMENT,    /* the caller broke the contract of a function */
  PL_E_RANGE,       /* a value is non-finite or outside what is physically meaningful */
  PL_E_IO,          /* a file cannot be opened, read or written */
  PL_E_FORMAT,      /* a file's content is broken */
  PL_E_UNSUPPORTED, /* valid, but beyond what this build does */
  PL_E_CANCELLED,   /* the caller's cancel token was set */
  PL_E_DEVICE,      /* the ray-tracing device reported an error */
  PL_STATUS_COUNT
} pl_status;

/* Name of a status, e.g. "format error"; never NULL. */
const char *pl_status_name(pl_status status);

/* Records printf-style text as this thread's error text and returns `status`. */
#if defined(__GNUC__)
__attribute__((format(printf, 2, 3)))
#endif
pl_status
pl_fail(pl_status status, const char *format, ...);

/* Text of this thread's last error; valid until the next pl_fail of this thread; never NULL. */
const char *pl_error_text(void);

/* Appends a name to the list "a, b" in `text` of `size` bytes, for errors that tell what is
 * allowed; cut where the room ends. */
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
