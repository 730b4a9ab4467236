/* Typed ids of the surfaces of a snapshot: the kind of geometry, and an index among those that the
 * snapshot keeps in one array. */
#ifndef PL_SCENE_SURFACE_ID_H
#define PL_SCENE_SURFACE_ID_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

/* Kinds of geometry: those with a mesh, whose index is that of an object, come first; the index of
 * others is that of a body. To add a kind, add the file that defines its row, `pl_geometry_NAME`
 * (render/geometry.h), and one line here: its names, and when it replaces the ellipsoid of a `body`
 * (a pl_shot_body); of several the last does. */
/* clang-format off */
#define PL_SURFACE_KIND_LIST(X) \
  X(MESH, mesh, false) \
  X(SHAPE, shape, false)                           /* mesh of a body's shape */ \
  X(ELLIPSOID, ellipsoid, true) \
  X(HEIGHT_FIELD, height_field, body->has_terrain) /* terrain of a body */ \
  X(ROCKS, rocks, false)                           /* rocks on the terrain of a body */
/* clang-format on */

typedef enum pl_surface_kind {
#define PL_KIND(NAME, name, replaces) PL_SURFACE_##NAME,
  PL_SURFACE_KIND_LIST(PL_KIND)
#undef PL_KIND
      PL_SURFACE_KINDS
} pl_surface_kind;

/* The kind is in the upper 4 bits, the index in the other 28. Zero is the first object. */
typedef struct pl_surface_id {
  uint32_t value;
} pl_surface_id;

enum { PL_SURFACE_INDEX_BITS = 28 };
#define PL_SURFACE_INDEX_MAX ((UINT32_C(1) << PL_SURFACE_INDEX_BITS) - 1)

/* Id of no surface: a ray hits nothing. */
#define PL_NO_SURFACE ((pl_surface_id){UINT32_MAX})
/* Body index of no body. */
#define PL_NO_BODY UINT32_MAX

static inline pl_surface_id pl_surface_make(pl_surface_kind kind, size_t index) {
  return (pl_surface_id){(uint32_t)kind << PL_SURFACE_INDEX_BITS | (uint32_t)index};
}

static inline bool pl_surface_same(pl_surface_id a, pl_surface_id b) { return a.value == b.value; }

static inline bool pl_surface_is_none(pl_surface_id id) { return id.value == UINT32_MAX; }

/* PL_SURFACE_KINDS or above for no surface. */
static inline pl_surface_kind pl_surface_kind_of(pl_surface_id id) {
  return (pl_surface_kind)(id.value >> PL_SURFACE_INDEX_BITS);
}

static inline uint32_t pl_surface_index(pl_surface_id id) {
  return id.value & PL_SURFACE_INDEX_MAX;
}

/* Whether it has triangles: the index is that of an object. False for no surface. */
static inline bool pl_surface_is_mesh(pl_surface_id id) {
  return id.value < (uint32_t)PL_SURFACE_ELLIPSOID << PL_SURFACE_INDEX_BITS;
}

/* Whether it is convex and has a closed form: the index is that of a body. */
static inline bool pl_surface_is_ellipsoid(pl_surface_id id) {
  return pl_surface_kind_of(id) == PL_SURFACE_ELLIPSOID;
}

static inline pl_surface_id pl_surface_of_body(size_t body) {
  return pl_surface_make(PL_SURFACE_ELLIPSOID, body);
}

#endif
