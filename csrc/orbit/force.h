/* The table of forces: what pulls and pushes an object besides the point mass of its centre.
 *
 * A kind of force is a row: its parameters by name, from which `create` makes one, and its
 * acceleration. To add a kind: write its file, declare its row below, add it to force.c. */
#ifndef PL_ORBIT_FORCE_H
#define PL_ORBIT_FORCE_H

#include <stdbool.h>
#include <stddef.h>

#include "base/status.h"
#include "orbit/celestial.h"
#include "orbit/propagator.h"

/* Where and when; relative to the centre, ICRF axes. */
typedef struct pl_force_point {
  double t_s; /* after the epoch */
  pl_vec3 r_m, v_m_s;
} pl_force_point;

typedef struct pl_force pl_force;

/* What all forces of one object share. */
typedef struct pl_force_setting {
  double tdb_day, tdb_fraction; /* JD(TDB) of the epoch, t = 0 */
  double gm_m3_s2;              /* of the centre */
} pl_force_setting;

typedef enum pl_force_type { PL_FORCE_NUMBERS, PL_FORCE_BODY, PL_FORCE_MOTION } pl_force_type;

typedef struct pl_force_parameter {
  const char *key;
  pl_force_type type;
  size_t count; /* numbers: how many; 0 for any, in one dimension, at least one */
  bool optional;
  const char *doc; /* with the unit */
} pl_force_parameter;

/* The value of a parameter; only the member of its type is set. All zero: not given. */
typedef struct pl_force_value {
  size_t count;
  const double *numbers;       /* borrowed for the call */
  const pl_celestial *body;    /* static */
  const pl_propagator *motion; /* borrowed, must outlive the force: relative to the same centre */
} pl_force_value;

#define PL_FORCE_PARAMETERS 8 /* most of a row */

typedef struct pl_force_kind {
  const char *name; /* "zonal" */
  const char *doc;  /* what it models, and what it leaves out */
  size_t parameter_count;
  const pl_force_parameter *parameters;
  /* Steps at least so many per revolution (of a circle through the present place), for forces
   * whose regimes last so briefly that a longer step could miss one; 0: the tolerance alone
   * decides. */
  double steps_per_turn;
  /* values[i] belongs to parameters[i]; those that are not optional are given, numbers are finite.
   * One block of memory, freed with pl_free. */
  pl_status (*create)(const pl_force_setting *setting, const pl_force_value *values,
                      pl_force **out);
  /* m/s^2, ICRF axes. A pure function. */
  pl_status (*acceleration)(const pl_force *self, const pl_force_point *at, pl_vec3 *out);
  /* Within a regime (shadow, light, a layer of air) the acceleration is smooth. Steps end where it
   * changes: errors at an edge are small but always to one side, and add up. NULL: one for all. */
  pl_status (*regime)(const pl_force *self, const pl_force_point *at, int *out);
} pl_force_kind;

struct pl_force {
  const pl_force_kind *kind; /* each kind's struct begins with it */
};

/* All kinds, in a fixed order; static. */
const pl_force_kind *const *pl_force_kinds(size_t *count);
/* PL_E_ARGUMENT with a text that lists the names there are. */
pl_status pl_force_require(const char *name, const pl_force_kind **out);

/* Creates a force after checking `values` (one for each parameter of `kind`) as the row says.
 * PL_E_ARGUMENT or PL_E_RANGE with a text that names the parameter. Destroy with pl_free. */
pl_status pl_force_create(const pl_force_kind *kind, const pl_force_setting *setting,
                          const pl_force_value *values, pl_force **out);

extern const pl_force_kind pl_force_point_mass, pl_force_zonal, pl_force_harmonics,
    pl_force_third_body, pl_force_drag, pl_force_radiation_pressure;

#endif
