/* Hapke's model of the light that a particulate surface reflects, complete and in double. */
#ifndef PL_SHADE_HAPKE_H
#define PL_SHADE_HAPKE_H

#include <stdbool.h>

#include "math/vec.h"

/* Filling factors stay below this: K has a pole where 1.209 phi^(2/3) = 1. */
#define PL_HAPKE_FILLING_MAX 0.752

/* Parameters as in Hapke, Theory of Reflectance and Emittance Spectroscopy, 2nd ed. 2012. All zero:
 * isotropic scatterers without surges, smooth and loosely packed; the improved H function. */
typedef struct pl_hapke {
  double w;         /* single-scattering albedo, 0..1 */
  double b, c;      /* two-term Henyey-Greenstein function: 0 <= b < 1; c > 0 scatters back. Fits
                     * may give c beyond 1: what would be negative is 0 */
  double b_s0, h_s; /* opposition surge by hidden shadows: height, half width (0: no surge) */
  double b_c0, h_c; /* by coherent backscatter: height, half width (0: no surge) */
  double roughness_rad; /* mean slope of the unresolved relief, 0..60 degrees */
  double filling;       /* part of the volume that grains fill, 0 <= phi < PL_HAPKE_FILLING_MAX */
  bool simple_h;        /* H of 1981 instead of that of 2002 */
  bool narrow_surge;    /* the coherent surge's shape of 2012 instead of that of 2002 */
} pl_hapke;

/* Directions to the sun and to the viewer, about the normal z. */
typedef struct pl_hapke_angles {
  double mu0, mu;      /* cosines of incidence and emission */
  double cot_i, cot_e; /* infinite along the normal */
  double sin_i, sin_e;
  double half_sine2;   /* sin^2 of half the phase angle g */
  double half_cosine2; /* cos^2 of it */
  double half_tangent; /* tan of it; infinite at 180 degrees */
  double psi;          /* azimuth between sun and viewer, 0..pi */
  double psi_tangent;  /* tan(psi/2); infinite at pi */
  double psi_sine2;    /* sin^2(psi/2) */
} pl_hapke_angles;

/* `l` to the sun and `v` to the viewer, unit, in a frame whose z is the normal. Differences of the
 * vectors keep phase angles exact down to the rounding of the vectors, which arc cosines do not.
 * Where l or v is the normal psi is 0; nothing depends on it there. */
pl_hapke_angles pl_hapke_angles_of(pl_vec3 l, pl_vec3 v);

/* The relief's work (Hapke 1984): effective cosines and the shadowing function S. */
typedef struct pl_hapke_relief {
  double mu0e, mue, shadowing;
} pl_hapke_relief;
/* mu0 and mu must be above 0. Exact at roughness 0, where S is 1. */
pl_hapke_relief pl_hapke_relief_of(const pl_hapke_angles *angles, double roughness_rad);
/* A plane: the cosines themselves, S = 1. */
pl_hapke_relief pl_hapke_plane(const pl_hapke_angles *angles);

/* Phase function p(g); its mean over the sphere is 1. */
double pl_hapke_phase(const pl_hapke *hapke, const pl_hapke_angles *angles);
/* Shadow-hiding surge B_S(g) and coherent surge B_C(g): 1 at g = 0 (0 if the width is 0). */
double pl_hapke_shadow_surge(const pl_hapke *hapke, const pl_hapke_angles *angles);
double pl_hapke_coherent_surge(const pl_hapke *hapke, const pl_hapke_angles *angles);
/* K of the filling factor, 1 at 0. */
double pl_hapke_porosity(double filling);
/* H at a cosine (over K) x >= 0. */
double pl_hapke_h(const pl_hapke *hapke, double x);

/* Bidirectional reflectance r, 1/sr: radiance over the sun's irradiance on a plane across its
 * light. 0 where i or e is 90 degrees or more. The BRDF is r/cos(i). */
double pl_hapke_reflect(const pl_hapke *hapke, const pl_hapke_angles *angles,
                        const pl_hapke_relief *relief);
/* All at once. */
double pl_hapke_reflectance(const pl_hapke *hapke, pl_vec3 l, pl_vec3 v);

#endif
