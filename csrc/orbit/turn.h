/* Rotation of a node: the axes that it follows, a fixed rotation relative to them, and a spin. */
#ifndef PL_ORBIT_TURN_H
#define PL_ORBIT_TURN_H

#include <stdbool.h>
#include <stddef.h>

#include "base/status.h"
#include "math/rotation.h"
#include "orbit/attitude_table.h"
#include "orbit/celestial.h"
#include "orbit/kepler.h"
#include "orbit/tumble.h"

typedef struct pl_turn pl_turn;

/* Inputs of the axes at one time; ICRF axes. */
typedef struct pl_turn_view {
  double tdb_day, tdb_fraction; /* of the time */
  double t_s;                   /* after the tree's epoch */
  pl_state relative;            /* relative to the parent's centre */
  pl_vec3 aim_m;                /* from the node to its target, or the given direction */
  pl_quat parent;               /* axes of the parent */
  pl_quat given;                /* provided by the caller, unit */
} pl_turn_view;

/* Inputs that a kind needs. */
enum {
  PL_TURN_PARENT = 1, /* a parent */
  PL_TURN_BODY = 2,   /* `body` */
  PL_TURN_AIM = 4,    /* `towards`, or -1 and `direction` */
  PL_TURN_GIVEN = 8,  /* a slot */
  PL_TURN_TUMBLE = 16,
  PL_TURN_TABLE = 32
};

typedef struct pl_turn_kind {
  const char *name; /* "lvlh" */
  const char *doc;
  unsigned needs;
  /* Rotation from the axes to ICRF, unit. */
  pl_status (*axes)(const pl_turn *turn, const pl_turn_view *view, pl_quat *out);
} pl_turn_kind;

/* The rotation from a node to ICRF is axes(t) * q * rotation(axis, rate t), with t from the tree's
 * epoch: q is relative to the axes, and the spin is in the node's own frame. For a spin about an
 * axis given in the fixed axes, use q^-1 axis. */
struct pl_turn {
  const pl_turn_kind *kind; /* NULL: inertial */
  pl_quat q;                /* need not be unit */
  pl_vec3 axis;             /* need not be unit; unused at rate 0 */
  double rate_rad_s;
  const pl_celestial *body; /* body */
  ptrdiff_t towards;        /* sun, target: index of a node; -1: along `direction` */
  pl_vec3 direction;        /* sun, target: ICRF, need not be unit */
  pl_vec3 up;               /* sun, target: ICRF, need not be unit; zero: the orbit normal */
  size_t slot;              /* given: index among the caller's quaternions */
  pl_tumble tumble;         /* tumble: from pl_tumble_init, t = 0 at the tree's epoch */
  pl_attitude_table table;  /* table: borrowed, must outlive the tree; to ICRF */
};

/* Axes of ICRF, without rotation. */
#define PL_TURN_NONE ((pl_turn){.q = PL_QUAT_IDENTITY, .axis = {0.0, 0.0, 1.0}, .towards = -1})

/* All kinds, in a fixed order; static. */
const pl_turn_kind *pl_turn_kinds(size_t *count);

/* Fails with PL_E_ARGUMENT and a message that lists the valid kinds. */
pl_status pl_turn_require(const char *name, const pl_turn_kind **out);

/* Normalizes q and the axis, and checks everything that does not require the tree. */
pl_status pl_turn_prepare(pl_turn *turn);

/* Rotation to ICRF of a prepared turn. */
pl_status pl_turn_at(const pl_turn *turn, const pl_turn_view *view, pl_quat *out);

#endif
