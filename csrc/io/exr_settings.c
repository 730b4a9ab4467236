/* What writing and reading OpenEXR share. */
#include "io/exr_settings.h"

#include "base/memory.h"

static void *on_allocate(size_t size) { return pl_alloc(size, 1); }

static void on_free(void *memory) { pl_free(memory); }

/* Errors are told by the status; the default handler prints. */
static void on_error(exr_const_context_t context, exr_result_t code, const char *text) {
  (void)context;
  (void)code;
  (void)text;
}

exr_context_initializer_t pl_exr_settings(void *user) {
  exr_context_initializer_t settings = EXR_DEFAULT_CONTEXT_INITIALIZER;
  settings.error_handler_fn = on_error;
  settings.alloc_fn = on_allocate;
  settings.free_fn = on_free;
  settings.user_data = user;
  return settings;
}
