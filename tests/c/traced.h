/* A stage with a tracer for its snapshot. */
#ifndef PL_TEST_TRACED_H
#define PL_TEST_TRACED_H

#include "scenes.h"
#include "render/geometry.h"
#include "trace/tracer.h"

typedef struct world {
  stage stage;
  pl_arena arena;
  pl_snapshot shot;
  pl_accelerators *kept;
  const pl_tracer *tracer;
} world;

static inline void world_init(world *w) {
  stage_init(&w->stage, 64, 64, 64.0);
  pl_arena_init(&w->arena);
  assert_int_equal(pl_accelerators_create(&w->kept), PL_OK);
}
static inline void world_set(world *w) {
  pl_arena_reset(&w->arena);
  assert_int_equal(pl_snapshot_build(&w->stage.scene, &w->stage.placement, &w->arena, &w->shot),
                   PL_OK);
  assert_int_equal(pl_geometry_tracer(w->kept, &w->shot, &w->arena, &w->tracer), PL_OK);
}
static inline void world_clear(world *w) {
  pl_accelerators_destroy(w->kept);
  pl_arena_clear(&w->arena);
  stage_clear(&w->stage);
}

#endif
