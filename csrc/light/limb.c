/* The polynomial and its mean. */
#include "light/limb.h"

#include "math/sampling.h"

/* A_k = a + b / lambda + c / lambda^5, lambda in um. */
static const double neckel[PL_LIMB_TERMS][3] = {
    {0.75267, -0.265577, 0.0}, {0.93874, 0.265577, -0.004095}, {-1.89287, 0.0, 0.012582},
    {2.42234, 0.0, -0.017117}, {-1.71150, 0.0, 0.011977},      {0.49062, 0.0, -0.003347},
};
static const double SHORTEST_UM = 0.4226, LONGEST_UM = 1.1;

pl_limb pl_limb_make(const double wavelengths_um[3]) {
  pl_limb limb;
  for (int band = 0; band < 3; band++) {
    const double l = fmin(fmax(wavelengths_um[band], SHORTEST_UM), LONGEST_UM);
    double a[PL_LIMB_TERMS], mean = 0.0;
    for (int k = 0; k < PL_LIMB_TERMS; k++) {
      a[k] = neckel[k][0] + neckel[k][1] / l + neckel[k][2] / (l * l * l * l * l);
      mean += 2.0 * a[k] / (k + 2.0); /* of mu^k over the disc */
    }
    for (int k = 0; k < PL_LIMB_TERMS; k++)
      limb.c[band][k] = (float)(a[k] / mean);
  }
  return limb;
}

static float polynomial(const float *c, float mu) {
  return c[0] + mu * (c[1] + mu * (c[2] + mu * (c[3] + mu * (c[4] + mu * c[5]))));
}

pl_vec3f pl_limb_ratio(const pl_limb *limb, const pl_sun_view *view, pl_vec3f direction) {
  const pl_vec3f across = pl_vec3f_cross(view->direction, direction);
  const float sine = view->sin_radius;
  const float mu = sqrtf(pl_maxf(1.0f - pl_vec3f_dot(across, across) / (sine * sine), 0.0f));
  return (pl_vec3f){polynomial(limb->c[0], mu), polynomial(limb->c[1], mu),
                    polynomial(limb->c[2], mu)};
}

/* The part of the light inside the ring at mu is 1 - sum 2 c_k mu^(k+2) / (k+2): where it is u. */
static float ring_of(const float *c, float u) {
  enum { ITERATIONS = 4 }; /* to the last digits of a float, from anywhere in 0..1 */
  const float d[PL_LIMB_TERMS] = {c[0],        c[1] / 1.5f, c[2] / 2.0f,
                                  c[3] / 2.5f, c[4] / 3.0f, c[5] / 3.5f};
  const float rest = 1.0f - u;
  float mu = sqrtf(rest);
  for (int i = 0; i < ITERATIONS && mu > 0.0f; i++) {
    mu -= (mu * mu * polynomial(d, mu) - rest) / (2.0f * mu * polynomial(c, mu));
    mu = pl_minf(pl_maxf(mu, 0.0f), 1.0f);
  }
  return mu;
}

pl_vec3f pl_limb_sample(const pl_limb *limb, const pl_sun_view *view, const float u[2]) {
  const pl_vec3f even = pl_sample_disc(u[0], u[1]);
  const float square = even.x * even.x + even.y * even.y;
  const float mu = ring_of(limb->c[1], pl_minf(square, 1.0f));
  const float out = square > 0.0f ? sqrtf((1.0f - mu * mu) / square) : 0.0f;
  const pl_basis basis = pl_basis_make(view->direction);
  return pl_basis_to_world(&basis, pl_disc_to_cone(pl_vec3f_scale(even, out), view->one_minus_cos));
}
