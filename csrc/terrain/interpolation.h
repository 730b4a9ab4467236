/* Interpolation between numbers at equal distances. Both forms are written with differences, so
 * that equal numbers give exactly that number and t = 0 keeps the bits. */
#ifndef PL_TERRAIN_INTERPOLATION_H
#define PL_TERRAIN_INTERPOLATION_H

static inline double pl_linear(double a, double b, double t) { return a + t * (b - a); }

/* Catmull-Rom, between p[1] and p[2]. */
static inline double pl_catmull_rom(const double p[4], double t) {
  const double a = p[0] - p[1], c = p[2] - p[1], d = p[3] - p[1];
  return p[1] + 0.5 * t * ((c - a) + t * ((2.0 * a + 4.0 * c - d) + t * (d - a - 3.0 * c)));
}

/* Its derivative by t. */
static inline double pl_catmull_rom_slope(const double p[4], double t) {
  const double a = p[0] - p[1], c = p[2] - p[1], d = p[3] - p[1];
  return 0.5 * ((c - a) + t * (2.0 * (2.0 * a + 4.0 * c - d) + 3.0 * t * (d - a - 3.0 * c)));
}

#endif
