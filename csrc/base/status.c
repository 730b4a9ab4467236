/* Per-thread error text. */
#include "base/status.h"

#include <stdarg.h>
#include <stdio.h>
#include <string.h>

static _Thread_local char error_text[1024];

static const char *const names[PL_STATUS_COUNT] = {
    [PL_OK] = "ok",
    [PL_E_MEMORY] = "out of memory",
    [PL_E_ARGUMENT] = "bad argument",
    [PL_E_RANGE] = "value out of range",
    [PL_E_IO] = "input/output error",
    [PL_E_FORMAT] = "format error",
    [PL_E_UNSUPPORTED] = "not supported",
    [PL_E_CANCELLED] = "cancelled",
    [PL_E_DEVICE] = "ray-tracing device error",
};

const char *pl_status_name(pl_status status) {
  return (unsigned)status < PL_STATUS_COUNT ? names[status] : "unknown status";
}

pl_status pl_fail(pl_status status, const char *format, ...) {
  /* Formatted into a separate buffer, because an argument may be the text of the error that is
   * being wrapped. */
  char text[sizeof error_text];
  va_list arguments;
  va_start(arguments, format);
  vsnprintf(text, sizeof text, format, arguments);
  va_end(arguments);
  snprintf(error_text, sizeof error_text, "%s", text);
  return status;
}

const char *pl_error_text(void) { return error_text; }

void pl_names_append(char *text, size_t size, const char *name) {
  const size_t used = strlen(text);
  snprintf(text + used, size - used, "%s%s", used > 0 ? ", " : "", name);
}
