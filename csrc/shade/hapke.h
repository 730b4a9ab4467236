/* Hapke's photometric model of particulate surfaces, complete and in double precision. */
#ifndef PL_SHADE_HAPKE_H
#define PL_SHADE_HAPKE_H

#include <stdbool.h>

#include "math/vec.h"

/* Upper limit of filling factors: K has a pole where 1.209 phi^(2/3) = 1. */
#define PL_HAPKE_FILLING_MAX 0.752

/* Parameters as in Hapke, Theory of Reflectance and Emittance Spectroscopy, 2nd ed. 2012. All zero:
 * isotropic scatterers without opposition surges, smooth and loosely packed, with the H function of
 * 2002. */
typedef struct pl_hapke {
  double w; /* single-scattering albedo, 0..1 */
  /* Two-term Henyey-Greenstein function: 0 <= b < 1; c > 0 is backscattering. Fitted values of c
   * may be outside -1..1; where p(g) would be negative, it is 0. */
  double b, c;
  double b_s0, h_s;     /* shadow-hiding opposition surge: amplitude, half width (0: no surge) */
  double b_c0, h_c;     /* coherent-backscatter surge: amplitude, half width (0: no surge) */
  double roughness_rad; /* mean slope angle of the macroscopic roughness, 0..60 degrees */
  double filling;       /* filling factor, 0 <= phi < PL_HAPKE_FILLING_MAX */
  bool simple_h;        /* H function of 1981 instead of that of 2002 */
  bool narrow_surge;    /* shape of the coherent surge of 2012 instead of that of 2002 */
} pl_hapke;

/* Angles of the directions to the sun and to the viewer, relative to the normal z. */
typedef struct pl_hapke_angles {
  double mu0, mu;      /* cosines of incidence and emission */
  double cot_i, cot_e; /* infinite along the normal */
  double sin_i, sin_e;
  double half_sine2;   /* sin^2 of half the phase angle g */
  double half_cosine2; /* cos^2 of half the phase angle */
  double half_tangent; /* tan of half the phase angle; infinite at 180 degrees */
  double psi;          /* azimuth between sun and viewer, 0..pi */
  double psi_tangent;  /* tan(psi/2); infinite at pi */
  double psi_sine2;    /* sin^2(psi/2) */
} pl_hapke_angles;

/* `l` to the sun and `v` to the viewer, unit, in a frame whose z is the normal. Half angles are
 * computed from the sum and difference of the vectors, which keeps small phase angles exact down to
 * rounding; arc cosines would not. If l or v is along the normal, psi is 0; the model does not
 * depend on it there. */
pl_hapke_angles pl_hapke_angles_of(pl_vec3 l, pl_vec3 v);

/* Macroscopic roughness (Hapke 1984): effective cosines and the shadowing function S. */
typedef struct pl_hapke_relief {
  double mu0e, mue, shadowing;
} pl_hapke_relief;
/* mu0 and mu must be positive. Exact at roughness 0, where S is 1. */
pl_hapke_relief pl_hapke_relief_of(const pl_hapke_angles *angles, double roughness_rad);
/* Smooth surface: the cosines themselves, S = 1. */
pl_hapke_relief pl_hapke_plane(const pl_hapke_angles *angles);

/* Phase function p(g); its mean over the sphere is 1. */
double pl_hapke_phase(const pl_hapke *hapke, const pl_hapke_angles *angles);
/* Shadow-hiding surge B_S(g) and coherent surge B_C(g): 1 at g = 0 (0 if the width is 0). */
double pl_hapke_shadow_surge(const pl_hapke *hapke, const pl_hapke_angles *angles);
double pl_hapke_coherent_surge(const pl_hapke *hapke, const pl_hapke_angles *angles);
/* Porosity factor K of the filling factor; 1 at 0. */
double pl_hapke_porosity(double filling);

/* What depends on the phase angle alone: facets of all slopes share it. */
typedef struct pl_hapke_at_phase {
  double k;        /* porosity factor */
  double single;   /* single scattering with its surge */
  double coherent; /* factor of the coherent surge */
} pl_hapke_at_phase;
pl_hapke_at_phase pl_hapke_at_phase_of(const pl_hapke *hapke, const pl_hapke_angles *angles);

/* What does not depend on the albedo: bands that differ in it alone share these terms. */
typedef struct pl_hapke_terms {
  bool dark; /* the reflectance is 0 */
  pl_hapke_at_phase phase;
  double lommel_seeliger; /* mu0e / (mu0e + mue) */
  double shadowing;       /* S */
  double x[2];            /* arguments of H: those of mu0e and mue */
  double logarithm[2];    /* log1p(1/x), as H of 2002 needs it */
} pl_hapke_terms;
pl_hapke_terms pl_hapke_terms_of(const pl_hapke *hapke, const pl_hapke_angles *angles,
                                 const pl_hapke_relief *relief, const pl_hapke_at_phase *phase);
/* pl_hapke_reflect from its terms. */
double pl_hapke_of_terms(const pl_hapke *hapke, const pl_hapke_terms *terms);

/* Bidirectional reflectance r, 1/sr: radiance over the sun's irradiance on a plane perpendicular to
 * its light. 0 where i or e is 90 degrees or more. The BRDF is r/cos(i). */
double pl_hapke_reflect(const pl_hapke *hapke, const pl_hapke_angles *angles,
                        const pl_hapke_relief *relief);
/* The complete model: angles, roughness and reflectance. */
double pl_hapke_reflectance(const pl_hapke *hapke, pl_vec3 l, pl_vec3 v);

#endif
