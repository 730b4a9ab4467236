/* Planetary rings: plane layers of particles in the equatorial plane of a body, with the light that
 * they scatter once and transmit. */
#ifndef PL_RINGS_RINGS_H
#define PL_RINGS_RINGS_H

#include <stddef.h>

#include "base/status.h"
#include "math/vec.h"

enum { PL_RINGS_COUNT_MAX = 16384 };

/* The rings are uniform between adjacent radii. The particles are much larger than the wavelength,
 * so the optical depth is the same in all bands. Arrays are borrowed. */
typedef struct pl_rings_settings {
  size_t count;          /* number of intervals: 1..PL_RINGS_COUNT_MAX */
  const double *edges_m; /* [count + 1]: radii of the interval edges, m, increasing, > 0 */
  const double *depth;   /* [count]: optical depth along the normal, 0..1000 */
  const double *albedo;  /* [count * 3]: single-scattering albedo by band, 0..1 */
  double exponent;       /* of the particles' phase function, 0..20; 0: isotropic */
  double dust_share;     /* fraction of the light that dust scatters, 0..1 */
  double dust_g;         /* asymmetry parameter (mean cosine) of the dust, -0.98..0.98 */
} pl_rings_settings;

/* Immutable after construction and shared by all threads. Takes about 1.4 kB per interval. */
typedef struct pl_rings pl_rings;

/* Fails with PL_E_RANGE and names the invalid setting. */
pl_status pl_rings_create(const pl_rings_settings *settings, pl_rings **out);
void pl_rings_destroy(pl_rings *rings);

double pl_rings_inner_m(const pl_rings *rings);
double pl_rings_outer_m(const pl_rings *rings);
/* Upper bounds over all intervals. */
typedef struct pl_rings_light_bounds {
  double depth;     /* optical depth along the normal */
  double scattered; /* albedo times the largest value of the phase function, 1/sr */
} pl_rings_light_bounds;
pl_rings_light_bounds pl_rings_light_bounds_of(const pl_rings *rings);

/* Phase function, 1/sr, as a function of the cosine of the scattering angle; its mean over the
 * sphere is 1/(4 pi). Particles: (turn)^exponent, where turn is the scattering angle, fitted to
 * Saturn's A ring by Dones, Cuzzi and Showalter (1993), Icarus 105, 184 (exponent 3.09). Dust:
 * Henyey and Greenstein (1941). */
double pl_rings_phase(const pl_rings *rings, double cosine);

/* Means over radii low_m..high_m of 1 - exp(-depth c), and of that times the albedo in each band,
 * for c >= 1. Radii outside the rings count as empty. A range of a few intervals is summed
 * directly. For longer ranges the mean is interpolated in tables with an error below 2e-4. If low_m
 * = high_m, returns the value at that radius. */
typedef struct pl_rings_mean {
  double opacity, lit[3];
} pl_rings_mean;
pl_rings_mean pl_rings_average(const pl_rings *rings, double low_m, double high_m, double c);

/* A ray that represents a cone: from `origin`, in body axes (z along the ring normal, m from the
 * body's centre), to end_m. The cone is width_m wide at the origin and widens by `spread` per
 * metre. */
typedef struct pl_rings_ray {
  pl_vec3 origin, direction; /* the direction is a unit vector */
  double width_m, spread, end_m;
} pl_rings_ray;

/* Intersection of one part of the cone with the rings. */
typedef struct pl_rings_piece {
  double fraction;      /* fraction of the cone's width, 0..1 */
  double t;             /* distance of the middle from the ray's origin, m */
  pl_vec3 point;        /* middle of the part, body axes */
  double low_m, high_m; /* range of radii that the part covers */
  double sine; /* sine of the angle between the line to the middle and the ring plane, > 0 */
  double side; /* side of the rings on which the origin lies: 1 north, -1 south */
} pl_rings_piece;

/* Divides a ray's cone into the parts that intersect the rings, in order along the rings. Their
 * fractions sum to 1 at most. The cone is cut by the plane through the ray and the ring normal; the
 * lines of the cone in this plane meet the ring plane one after another. In nearly edge-on views
 * this intersection can extend across all of the rings. From within their plane the rings are
 * invisible, since they have no thickness. Returns the number of parts. */
enum { PL_RINGS_PIECES = 16 };
size_t pl_rings_cut(const pl_rings *rings, const pl_rings_ray *ray,
                    pl_rings_piece out[PL_RINGS_PIECES]);

/* Transmitted and scattered light of a part. */
typedef struct pl_rings_light {
  double transmittance; /* of the light from behind */
  double scattered[3];  /* radiance for a solar irradiance of 1, 1/sr */
} pl_rings_light;

/* Direction and size of the sun as seen from the rings. */
typedef struct pl_rings_sun {
  pl_vec3 direction; /* to the sun, unit, body axes */
  double sin_radius; /* sine of the angular radius of its disc */
} pl_rings_sun;

/* Sunlight that a part scatters once towards the ray's origin, on the lit or on the unlit side
 * (Chandrasekhar 1960, Radiative Transfer, section 47). If the ring plane cuts the sun's disc, the
 * sun illuminates both sides. Multiple scattering and light from the body are neglected. */
pl_rings_light pl_rings_scatter(const pl_rings *rings, const pl_rings_piece *piece,
                                pl_vec3 direction, const pl_rings_sun *sun);

/* The same for a whole cone, if nothing blocks the sun from the rings. */
pl_rings_light pl_rings_seen(const pl_rings *rings, const pl_rings_ray *ray,
                             const pl_rings_sun *sun);

/* Transmittance of the rings along a cone. */
double pl_rings_passed(const pl_rings *rings, const pl_rings_ray *ray);

#endif
