#include "trace/ray_log.h"

#include "trace/accelerator.h"

void pl_accelerators_log(pl_accelerators *kept, pl_ray_log *log) { kept->log = log; }

static bool grow(pl_ray_log *log, int kind, size_t count) {
  if (count <= log->room[kind])
    return true;
  const size_t room = count + log->room[kind] + 4096;
  pl_ray *rays = pl_realloc(log->rays[kind], room, sizeof *rays);
  if (rays == NULL)
    return false;
  log->rays[kind] = rays;
  log->room[kind] = room;
  return true;
}

void pl_ray_log_add(pl_ray_log *log, int kind, const pl_ray *rays, size_t count) {
  log->full = log->full || !grow(log, kind, log->count[kind] + count);
  for (size_t i = 0; i < count && !log->full; i++)
    if (!rays[i].no_meshes)
      log->rays[kind][log->count[kind]++] = rays[i];
}

void pl_ray_log_clear(pl_ray_log *log) {
  for (int kind = 0; kind < PL_LOG_KINDS; kind++)
    pl_free(log->rays[kind]);
  *log = (pl_ray_log){0};
}
