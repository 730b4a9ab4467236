/* Rings: flat layers of particles in the plane of a body's equator, and the light that they scatter
 * once and let through. */
#ifndef PL_RINGS_RINGS_H
#define PL_RINGS_RINGS_H

#include <stddef.h>

#include "base/status.h"
#include "math/vec.h"

enum { PL_RINGS_COUNT_MAX = 16384 };

/* Between neighbouring radii the rings are even. Particles are far larger than the wavelength:
 * their optical depth is the same in all colour bands. Arrays are borrowed. */
typedef struct pl_rings_settings {
  size_t count;          /* of intervals: 1..PL_RINGS_COUNT_MAX */
  const double *edges_m; /* [count + 1], rising, > 0 */
  const double *depth;   /* [count]: optical depth along the normal, 0..1000 */
  const double *albedo;  /* [count * 3]: of single scattering, 0..1 */
  double exponent;       /* of the particles' phase function, 0..20; 0: the same to all sides */
  double dust_share;     /* part of the light that is scattered as by dust, 0..1 */
  double dust_g;         /* mean cosine of its angles, -0.98..0.98 */
} pl_rings_settings;

/* Immutable once built; shared by all threads. About 1.4 kB an interval. */
typedef struct pl_rings pl_rings;

/* PL_E_RANGE naming what is wrong. */
pl_status pl_rings_create(const pl_rings_settings *settings, pl_rings **out);
void pl_rings_destroy(pl_rings *rings);

double pl_rings_inner_m(const pl_rings *rings);
double pl_rings_outer_m(const pl_rings *rings);
/* Bounds of all intervals. */
typedef struct pl_rings_reach {
  double depth;     /* along the normal */
  double scattered; /* albedo times the largest value of the phase function, 1/sr */
} pl_rings_reach;
pl_rings_reach pl_rings_reach_of(const pl_rings *rings);

/* Phase function, 1/sr, of the cosine of the angle by which light is turned; its mean over the
 * sphere is 1/(4 pi). Of the particles: (turn)^exponent, fitted to Saturn's A ring by Dones, Cuzzi
 * and Showalter (1993), Icarus 105, 184 (exponent 3.09). Of dust: Henyey and Greenstein (1941). */
double pl_rings_phase(const pl_rings *rings, double cosine);

/* Means over radii low_m..high_m (what is beyond the rings is empty) of 1 - exp(-depth c), and of
 * that times the albedo in each band; c >= 1. A span of few intervals is summed up; of more, the
 * mean is read from tables, off by less than 2e-4. low_m = high_m: the value there. */
typedef struct pl_rings_mean {
  double opacity, lit[3];
} pl_rings_mean;
pl_rings_mean pl_rings_average(const pl_rings *rings, double low_m, double high_m, double c);

/* A ray that stands for a cone: from `origin`, in axes of the body (z along the rings' normal, m
 * from its centre), to end_m, width_m across at its origin and growing by `spread` a metre. */
typedef struct pl_rings_ray {
  pl_vec3 origin, direction; /* the direction is unit */
  double width_m, spread, end_m;
} pl_rings_ray;

/* Where a part of the cone passes the rings. */
typedef struct pl_rings_piece {
  double share;         /* of the cone's width, 0..1 */
  double t;             /* m from the ray's origin, of the middle */
  pl_vec3 point;        /* of the middle, the body's axes */
  double low_m, high_m; /* radii that the part covers */
  double sine;          /* of the angle between the part's middle and the plane, > 0 */
  double side;          /* from which the origin looks at the rings: 1 north, -1 south */
} pl_rings_piece;

/* Parts of a ray's cone that pass the rings, in the order of where they do; their shares sum up to
 * 1 at most. The cone is cut along the plane through the ray and the normal, whose lines the plane
 * of the rings meets one after the other: near to edge-on that may be all along the rings. From
 * within the plane nothing is seen of them: they have no thickness. */
enum { PL_RINGS_PIECES = 16 };
size_t pl_rings_cut(const pl_rings *rings, const pl_rings_ray *ray,
                    pl_rings_piece out[PL_RINGS_PIECES]);

/* What is seen of a part. */
typedef struct pl_rings_light {
  double passed;       /* part of the light from behind that comes through */
  double scattered[3]; /* radiance for a sun of irradiance 1, 1/sr */
} pl_rings_light;

/* The sun as the rings see it. */
typedef struct pl_rings_sun {
  pl_vec3 direction; /* to it, unit, in the body's axes */
  double sin_radius; /* of the angle of its disc */
} pl_rings_sun;

/* Light of the sun that a part scatters once towards the ray's origin, on the lit and on the unlit
 * side (Chandrasekhar 1960, Radiative Transfer, section 47); a sun that is cut by the plane lights
 * both. Light that is scattered more than once, and the body's, is left out. */
pl_rings_light pl_rings_scatter(const pl_rings *rings, const pl_rings_piece *piece,
                                pl_vec3 direction, const pl_rings_sun *sun);

/* The same of a whole cone, where nothing stands between the rings and the sun. */
pl_rings_light pl_rings_seen(const pl_rings *rings, const pl_rings_ray *ray,
                             const pl_rings_sun *sun);

/* Part of the light that comes through the rings along a cone. */
double pl_rings_passed(const pl_rings *rings, const pl_rings_ray *ray);

#endif
