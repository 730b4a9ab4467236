/* Limb darkening: the polynomial, its mean over the disc and the sampling table. */
#include "light/limb.h"

#include "math/sampling.h"

/* A_k = a + b / lambda + c / lambda^5, lambda in um. */
static const double neckel[PL_LIMB_TERMS][3] = {
    {0.75267, -0.265577, 0.0}, {0.93874, 0.265577, -0.004095}, {-1.89287, 0.0, 0.012582},
    {2.42234, 0.0, -0.017117}, {-1.71150, 0.0, 0.011977},      {0.49062, 0.0, -0.003347},
};
static const double SHORTEST_UM = 0.4226, LONGEST_UM = 1.1;

static double value_at(const double c[PL_LIMB_TERMS], double mu) {
  double sum = 0.0;
  for (int k = PL_LIMB_TERMS - 1; k >= 0; k--)
    sum = sum * mu + c[k];
  return sum;
}

/* Finds the mu at which the fraction of the light inside the ring is s, by Newton's method. That
 * fraction is 1 - sum 2 c_k mu^(k+2) / (k+2). */
static double ring_at(const double c[PL_LIMB_TERMS], double s) {
  enum { ITERATIONS = 12 };
  double d[PL_LIMB_TERMS], mu = sqrt(1.0 - s);
  for (int k = 0; k < PL_LIMB_TERMS; k++)
    d[k] = 2.0 * c[k] / (k + 2.0);
  for (int i = 0; i < ITERATIONS && mu > 0.0; i++) {
    mu -= (mu * mu * value_at(d, mu) - (1.0 - s)) / (2.0 * mu * value_at(c, mu));
    mu = fmin(fmax(mu, 0.0), 1.0);
  }
  return mu;
}

/* Squared radius over s. The limit at the centre is the inverse of the radiance there. */
static void tabulate(const double c[PL_LIMB_TERMS], float spread[PL_LIMB_RINGS + 1]) {
  spread[0] = (float)(1.0 / value_at(c, 1.0));
  for (int i = 1; i <= PL_LIMB_RINGS; i++) {
    const double s = (double)i / PL_LIMB_RINGS, mu = ring_at(c, s);
    spread[i] = (float)((1.0 - mu * mu) / s);
  }
}

void pl_limb_polynomial(double wavelength_um, double c[PL_LIMB_TERMS]) {
  const double l = fmin(fmax(wavelength_um, SHORTEST_UM), LONGEST_UM);
  double mean = 0.0;
  for (int k = 0; k < PL_LIMB_TERMS; k++) {
    c[k] = neckel[k][0] + neckel[k][1] / l + neckel[k][2] / (l * l * l * l * l);
    mean += 2.0 * c[k] / (k + 2.0); /* mean of mu^k over the disc */
  }
  for (int k = 0; k < PL_LIMB_TERMS; k++)
    c[k] /= mean;
}

pl_limb pl_limb_make(const double wavelengths_um[3]) {
  pl_limb limb;
  for (int band = 0; band < 3; band++) {
    double a[PL_LIMB_TERMS];
    pl_limb_polynomial(wavelengths_um[band], a);
    for (int k = 0; k < PL_LIMB_TERMS; k++)
      limb.c[band][k] = (float)a[k];
    if (band == 1)
      tabulate(a, limb.spread);
  }
  return limb;
}

static pl_vec3f ratio_at(const pl_limb *limb, float square_radius) {
  const float mu = sqrtf(pl_maxf(1.0f - square_radius, 0.0f));
  float out[3];
  for (int band = 0; band < 3; band++) {
    const float *c = limb->c[band];
    out[band] = c[0] + mu * (c[1] + mu * (c[2] + mu * (c[3] + mu * (c[4] + mu * c[5]))));
  }
  return (pl_vec3f){out[0], out[1], out[2]};
}

pl_vec3f pl_limb_ratio(const pl_limb *limb, const pl_sun_view *view, pl_vec3f direction) {
  const pl_vec3f across = pl_vec3f_cross(view->direction, direction);
  const float sine = view->sin_radius;
  return ratio_at(limb, pl_vec3f_dot(across, across) / (sine * sine));
}

pl_vec3f pl_limb_sample(const pl_limb *limb, const pl_sun_view *view, const float u[2],
                        pl_vec3f *ratio) {
  /* In polar coordinates u[0] alone is the ring, and so the colour, of which few samples have no
   * noise left. A map that keeps squares together (pl_sample_disc) has three times the variance of
   * colour at 4 samples, and of penumbrae four fifths at 4 samples, the same at 16. */
  const float s = u[0], turn = 2.0f * PL_PI_F * u[1];
  const float place = s * (float)PL_LIMB_RINGS;
  const int ring = place < (float)PL_LIMB_RINGS ? (int)place : PL_LIMB_RINGS - 1;
  const float *spread = limb->spread + ring;
  const float out = spread[0] + (place - (float)ring) * (spread[1] - spread[0]);
  const float radius = sqrtf(s * out);
  const pl_vec3f at = {radius * cosf(turn), radius * sinf(turn), 0.0f};
  const pl_basis basis = pl_basis_make(view->direction);
  *ratio = ratio_at(limb, s * out);
  return pl_basis_to_world(&basis, pl_disc_to_cone(at, view->one_minus_cos));
}
