/* The table of forces that act on an object in addition to the point mass of its centre.
 *
 * A kind of force is a row: its named parameters, the function `create` that makes a force from
 * them, and its acceleration. To add a kind, write its file, declare its row below and add it to
 * force.c. */
#ifndef PL_ORBIT_FORCE_H
#define PL_ORBIT_FORCE_H

#include <stdbool.h>
#include <stddef.h>

#include "base/status.h"
#include "orbit/celestial.h"
#include "orbit/propagator.h"

/* Time, position and velocity; relative to the centre, ICRF axes. */
typedef struct pl_force_point {
  double t_s; /* after the epoch */
  pl_vec3 r_m, v_m_s;
} pl_force_point;

typedef struct pl_force pl_force;

/* Settings that all forces of one object share. */
typedef struct pl_force_setting {
  double tdb_day, tdb_fraction; /* JD(TDB) of the epoch, t = 0 */
  double gm_m3_s2;              /* of the centre */
} pl_force_setting;

typedef enum pl_force_type { PL_FORCE_NUMBERS, PL_FORCE_BODY, PL_FORCE_MOTION } pl_force_type;

typedef struct pl_force_parameter {
  const char *key;
  pl_force_type type;
  size_t count; /* numbers: their count; 0: one or more, one-dimensional */
  bool optional;
  const char *doc; /* includes the unit */
} pl_force_parameter;

/* The value of a parameter. Only the member for its type is set; all zero: not given. */
typedef struct pl_force_value {
  size_t count;
  const double *numbers;       /* borrowed for the call */
  const pl_celestial *body;    /* static */
  const pl_propagator *motion; /* borrowed, must outlive the force; relative to the same centre */
} pl_force_value;

#define PL_FORCE_PARAMETERS 8 /* maximum of a row */

typedef struct pl_force_kind {
  const char *name; /* "zonal" */
  const char *doc;  /* what it models, and what it neglects */
  size_t parameter_count;
  const pl_force_parameter *parameters;
  /* Minimum number of steps per revolution (of a circle through the current position), for forces
   * with regimes so short that a longer step could miss one. 0: only the tolerance determines the
   * step. */
  double steps_per_turn;
  /* values[i] belongs to parameters[i]. Required values are present and numbers are finite. The
   * force is one block of memory, freed with pl_free. */
  pl_status (*create)(const pl_force_setting *setting, const pl_force_value *values,
                      pl_force **out);
  /* Acceleration in m/s^2, ICRF axes. Must be a pure function. */
  pl_status (*acceleration)(const pl_force *self, const pl_force_point *at, pl_vec3 *out);
  /* Number of the regime (shadow, sunlight, a layer of the atmosphere) within which the
   * acceleration is smooth. Steps end where it changes: the error at a transition is small, but
   * always has the same sign and would accumulate. NULL: a single regime. */
  pl_status (*regime)(const pl_force *self, const pl_force_point *at, int *out);
} pl_force_kind;

struct pl_force {
  const pl_force_kind *kind; /* first member of each kind's struct */
};

/* All kinds, in a fixed order; static. */
const pl_force_kind *const *pl_force_kinds(size_t *count);
/* Fails with PL_E_ARGUMENT and a message that lists the valid names. */
pl_status pl_force_require(const char *name, const pl_force_kind **out);

/* Creates a force after checking `values` (one for each parameter of `kind`) against the
 * parameters. Fails with PL_E_ARGUMENT or PL_E_RANGE and names the parameter. Destroy with pl_free.
 */
pl_status pl_force_create(const pl_force_kind *kind, const pl_force_setting *setting,
                          const pl_force_value *values, pl_force **out);

extern const pl_force_kind pl_force_point_mass, pl_force_zonal, pl_force_harmonics,
    pl_force_third_body, pl_force_drag, pl_force_radiation_pressure;

#endif
