/* Hapke's model. Formulae: Hapke 2012; macroscopic roughness: Hapke, Icarus 59, 41, 1984; H and the
 * coherent surge: Hapke, Icarus 157, 523, 2002, and 195, 918, 2008. */
#include "shade/hapke.h"

static double length2(double x, double y, double z) { return x * x + y * y + z * z; }

/* Of components of unit vectors: nothing overflows, as hypot would guard against. */
static double length(double x, double y) { return sqrt(x * x + y * y); }

/* Sets the azimuth psi from the unit vectors of both directions projected onto the surface. */
static void set_azimuth(pl_hapke_angles *a, double lx, double ly, double vx, double vy) {
  const double apart = length(lx - vx, ly - vy), together = length(lx + vx, ly + vy);
  a->psi = 2.0 * atan2(apart, together);
  a->psi_tangent = apart / together;
  a->psi_sine2 = 0.25 * apart * apart;
}

pl_hapke_angles pl_hapke_angles_of(pl_vec3 l, pl_vec3 v) {
  const double apart2 = length2(l.x - v.x, l.y - v.y, l.z - v.z);
  const double together2 = length2(l.x + v.x, l.y + v.y, l.z + v.z);
  pl_hapke_angles a = {
      .mu0 = l.z,
      .mu = v.z,
      .sin_i = length(l.x, l.y),
      .sin_e = length(v.x, v.y),
      .half_sine2 = 0.25 * apart2,
      .half_cosine2 = 0.25 * together2,
      .half_tangent = sqrt(apart2 / together2),
  };
  a.cot_i = a.mu0 / a.sin_i;
  a.cot_e = a.mu / a.sin_e;
  if (a.sin_i > 0.0 && a.sin_e > 0.0)
    set_azimuth(&a, l.x / a.sin_i, l.y / a.sin_i, v.x / a.sin_e, v.y / a.sin_e);
  return a;
}

pl_hapke_relief pl_hapke_plane(const pl_hapke_angles *angles) {
  return (pl_hapke_relief){angles->mu0, angles->mu, 1.0};
}

/* Terms of the roughness correction that depend on one of the two directions. */
typedef struct slant {
  double cosine, sine, e1, e2;
} slant;

static slant slant_of(double cosine, double sine, double cotangent, double cot_theta) {
  const double y = cot_theta * cotangent;
  return (slant){cosine, sine, exp(-2.0 / PL_PI * y), exp(-y * y / PL_PI)};
}

static double eta(slant s, double chi, double t) {
  return chi * (s.cosine + s.sine * t * s.e2 / (2.0 - s.e1));
}

/* `high` is the direction nearer to the normal: high and low stand for i and e in Hapke's branch
 * i <= e, and for e and i in the branch i >= e. */
pl_hapke_relief pl_hapke_relief_of(const pl_hapke_angles *a, double roughness_rad) {
  const double t = tan(roughness_rad), chi = 1.0 / sqrt(1.0 + PL_PI * t * t);
  const slant sun = slant_of(a->mu0, a->sin_i, a->cot_i, 1.0 / t);
  const slant view = slant_of(a->mu, a->sin_e, a->cot_e, 1.0 / t);
  const bool sun_high = a->mu0 >= a->mu;
  const slant high = sun_high ? sun : view, low = sun_high ? view : sun;
  const double d = 2.0 - low.e1 - a->psi / PL_PI * high.e1;
  const double cos_psi = 1.0 - 2.0 * a->psi_sine2, hidden = a->psi_sine2 * high.e2;
  const double high_e = chi * (high.cosine + high.sine * t * (cos_psi * low.e2 + hidden) / d);
  const double low_e = chi * (low.cosine + low.sine * t * (low.e2 - hidden) / d);
  const double f = exp(-2.0 * a->psi_tangent);
  const double sun_eta = eta(sun, chi, t), view_eta = eta(view, chi, t);
  const double high_part = high.cosine / (sun_high ? sun_eta : view_eta);
  pl_hapke_relief out = {
      .mu0e = fmax(sun_high ? high_e : low_e, 0.0),
      .mue = fmax(sun_high ? low_e : high_e, 0.0),
  };
  out.shadowing = out.mue / view_eta * (a->mu0 / sun_eta) * chi / (1.0 - f + f * chi * high_part);
  return out;
}

/* Henyey-Greenstein lobe (1 - b^2)/((1-b)^2 + 4 b s)^(3/2); s: squared sine of half the angle from
 * the lobe's axis. */
static double lobe(double b, double s) {
  const double gap = 1.0 - b, d = gap * gap + 4.0 * b * s;
  return (1.0 - b * b) / (d * sqrt(d));
}

double pl_hapke_phase(const pl_hapke *hapke, const pl_hapke_angles *a) {
  const double back = 0.5 * (1.0 + hapke->c) * lobe(hapke->b, a->half_sine2);
  const double forward = 0.5 * (1.0 - hapke->c) * lobe(hapke->b, a->half_cosine2);
  return fmax(back + forward, 0.0);
}

double pl_hapke_shadow_surge(const pl_hapke *hapke, const pl_hapke_angles *a) {
  return hapke->h_s > 0.0 ? 1.0 / (1.0 + a->half_tangent / hapke->h_s) : 0.0;
}

double pl_hapke_coherent_surge(const pl_hapke *hapke, const pl_hapke_angles *a) {
  if (!(hapke->h_c > 0.0))
    return 0.0;
  const double x = a->half_tangent / hapke->h_c;
  if (hapke->narrow_surge)
    return 1.0 / (1.0 + (1.3 + pl_hapke_porosity(hapke->filling)) * (x + x * x));
  const double decay = x > 0.0 ? -expm1(-x) / x : 1.0;
  return (1.0 + decay) / (2.0 * (1.0 + x) * (1.0 + x));
}

double pl_hapke_porosity(double filling) {
  const double u = 1.209 * cbrt(filling * filling);
  return u < 1e-4 ? 1.0 + u * (0.5 + u / 3.0) : -log1p(-u) / u;
}

/* H of 2002 at x, from log1p(1/x). */
static double h_of(double w, double gamma, double x, double logarithm) {
  if (!(x > 1e-30)) /* 1/x would overflow; H - 1 is below the rounding error */
    return 1.0;
  const double r0 = w / ((1.0 + gamma) * (1.0 + gamma));
  return 1.0 / (1.0 - w * x * (r0 + 0.5 * (1.0 - 2.0 * r0 * x) * logarithm));
}

static double simple_h(double gamma, double x) { return (1.0 + 2.0 * x) / (1.0 + 2.0 * x * gamma); }

static double gamma_of(const pl_hapke *hapke) { return sqrt(fmax(1.0 - hapke->w, 0.0)); }

/* log1p(1/x), where h_of needs it. */
static double logarithm_of(const pl_hapke *hapke, double x) {
  return !hapke->simple_h && x > 1e-30 ? log1p(1.0 / x) : 0.0;
}

pl_hapke_at_phase pl_hapke_at_phase_of(const pl_hapke *hapke, const pl_hapke_angles *a) {
  return (pl_hapke_at_phase){
      .k = hapke->filling > 0.0 ? pl_hapke_porosity(hapke->filling) : 1.0,
      .single = (1.0 + hapke->b_s0 * pl_hapke_shadow_surge(hapke, a)) * pl_hapke_phase(hapke, a),
      .coherent = 1.0 + hapke->b_c0 * pl_hapke_coherent_surge(hapke, a),
  };
}

pl_hapke_terms pl_hapke_terms_of(const pl_hapke *hapke, const pl_hapke_angles *a,
                                 const pl_hapke_relief *relief, const pl_hapke_at_phase *phase) {
  const double sum = relief->mu0e + relief->mue;
  pl_hapke_terms out = {.dark = !(a->mu0 > 0.0 && a->mu > 0.0 && sum > 0.0)};
  if (out.dark)
    return out;
  out.phase = *phase;
  out.lommel_seeliger = relief->mu0e / sum;
  out.shadowing = relief->shadowing;
  out.x[0] = relief->mu0e / phase->k;
  out.x[1] = relief->mue / phase->k;
  for (int k = 0; k < 2; k++)
    out.logarithm[k] = logarithm_of(hapke, out.x[k]);
  return out;
}

double pl_hapke_of_terms(const pl_hapke *hapke, const pl_hapke_terms *terms) {
  if (terms->dark)
    return 0.0;
  const double gamma = gamma_of(hapke);
  double h[2];
  for (int k = 0; k < 2; k++)
    h[k] = hapke->simple_h ? simple_h(gamma, terms->x[k])
                           : h_of(hapke->w, gamma, terms->x[k], terms->logarithm[k]);
  const double multiple = h[0] * h[1] - 1.0;
  const pl_hapke_at_phase *phase = &terms->phase;
  return phase->k * hapke->w / (4.0 * PL_PI) * terms->lommel_seeliger * (phase->single + multiple) *
         phase->coherent * terms->shadowing;
}

double pl_hapke_reflect(const pl_hapke *hapke, const pl_hapke_angles *angles,
                        const pl_hapke_relief *relief) {
  const pl_hapke_at_phase phase = pl_hapke_at_phase_of(hapke, angles);
  const pl_hapke_terms terms = pl_hapke_terms_of(hapke, angles, relief, &phase);
  return pl_hapke_of_terms(hapke, &terms);
}

double pl_hapke_reflectance(const pl_hapke *hapke, pl_vec3 l, pl_vec3 v) {
  const pl_hapke_angles angles = pl_hapke_angles_of(l, v);
  if (!(angles.mu0 > 0.0 && angles.mu > 0.0))
    return 0.0;
  const pl_hapke_relief relief = pl_hapke_relief_of(&angles, hapke->roughness_rad);
  return pl_hapke_reflect(hapke, &angles, &relief);
}
