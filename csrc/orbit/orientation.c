/* Evaluates the IAU rotation models.
 *
 * Archinal et al. 2018: the rotation from ICRF to body is Rz(W) Rx(90 deg - dec) Rz(90 deg + ra)
 * with coordinate rotations. The quaternions here are its inverse, hence the reversed order. */
#include "orbit/orientation.h"

#define DAYS_PER_CENTURY 36525.0
#define RADIANS(degrees) ((degrees) * (PL_PI / 180.0))

/* rate * days modulo 360 deg. The product is exact (high part and rounding error), so that over 30
 * years of a fast rotator the error is only that of `rate` itself. */
static double turn_part(double rate_deg, double days) {
  const double product = rate_deg * days;
  return remainder(product, 360.0) + fma(rate_deg, days, -product);
}

pl_pole pl_celestial_pole(const pl_celestial *body, double tdb_day, double tdb_fraction) {
  const pl_rotation_model *m = &body->rotation;
  const double whole = tdb_day - PL_J2000_JD; /* exact for whole and half days */
  const double days = whole + tdb_fraction;
  const double centuries = days / DAYS_PER_CENTURY;
  double ra = m->ra_deg[0] + m->ra_deg[1] * centuries;
  double dec = m->dec_deg[0] + m->dec_deg[1] * centuries;
  double w = m->w_deg[0] + turn_part(m->w_deg[1], whole) + turn_part(m->w_deg[1], tdb_fraction) +
             m->w_deg[2] * days * days;
  for (size_t i = 0; i < m->term_count; i++) {
    const pl_rotation_term *t = &m->terms[i];
    const double angle = RADIANS(t->phase_deg + remainder(t->rate_deg_century * centuries, 360.0) +
                                 t->quadratic_deg_century2 * centuries * centuries);
    ra += t->ra_deg * sin(angle);
    dec += t->dec_deg * cos(angle);
    w += t->w_deg * sin(angle);
  }
  return (pl_pole){RADIANS(ra), RADIANS(dec), RADIANS(remainder(w, 360.0))};
}

static pl_quat about_z(double angle) {
  return pl_quat_axis_angle(pl_vec3_make(0.0, 0.0, 1.0), angle);
}

static pl_quat equator_of(pl_pole pole) {
  const pl_quat tilt = pl_quat_axis_angle(pl_vec3_make(1.0, 0.0, 0.0), 0.5 * PL_PI - pole.dec_rad);
  return pl_quat_mul(about_z(0.5 * PL_PI + pole.ra_rad), tilt);
}

pl_quat pl_celestial_orientation(const pl_celestial *body, double tdb_day, double tdb_fraction) {
  const pl_pole pole = pl_celestial_pole(body, tdb_day, tdb_fraction);
  return pl_quat_unit(pl_quat_mul(equator_of(pole), about_z(pole.w_rad)));
}

pl_quat pl_celestial_equator(const pl_celestial *body, double tdb_day, double tdb_fraction) {
  return pl_quat_unit(equator_of(pl_celestial_pole(body, tdb_day, tdb_fraction)));
}
