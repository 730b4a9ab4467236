/* Bodies of a few pixels where the image is wide. */
#include "harness.h"

#include "frames.h"

enum { SIDE = 64 };

static double energy_of(const film *f, const pl_camera *camera, int *lit) {
  double energy = 0.0;
  *lit = 0;
  for (int i = 0; i < SIDE * SIDE; i++) {
    const double radiance = (double)f->radiance[3 * i];
    assert_true(isfinite(radiance));
    if (radiance > 0.0) {
      energy += radiance * pl_pixel_solid_angle(camera, i % SIDE, i / SIDE);
      ++*lit;
    }
  }
  return energy;
}

static void render_dot(stage *s, film *f, double tolerance_dn) {
  pl_renderer *renderer;
  pl_frame_request request = request_all(s, f);
  request.wish.tolerance_dn = tolerance_dn;
  request.samples = 64;
  assert_int_equal(pl_renderer_create(&s->scene, &renderer), PL_OK);
  render(renderer, &request);
  pl_renderer_destroy(renderer);
}

/* A body in the direction (x, 0, z), of the angular radius `angle`. */
static void place(stage *s, double x, double z, double angle) {
  const double norm = hypot(x, z), far = 1e8, r = far * sin(angle);
  stage_add_body(s, (pl_vec3){far * x / norm, 0.0, far * z / norm}, (pl_vec3){r, r, r}, 0.9f);
}

/* Off the axis a pinhole's image is wider by the square of the cosine: at 76 degrees a body that
 * would be 4 pixels wide on the axis is one of 68. It has the light of the one on the axis: the sun
 * is far off to the side that both show alike. */
static void test_wide_image(void **state) {
  (void)state;
  double energy[2];
  for (int k = 0; k < 2; k++) {
    stage s;
    film f;
    int lit;
    stage_init(&s, SIDE, SIDE, 100.0);
    if (k == 1)
      s.placement.camera.cx -= 400.0; /* 4 = tan 76 degrees */
    s.placement.sun.position_m = (pl_vec3){0.0, -1.5e11, 0.0};
    place(&s, k == 1 ? 4.0 : 0.0, 1.0, 0.02);
    film_init(&f, &s);
    render_dot(&s, &f, 0.5);
    energy[k] = energy_of(&f, &s.placement.camera, &lit);
    assert_true(k == 0 ? lit < 60 : lit > 256);
    film_clear(&f);
    stage_clear(&s);
  }
  assert_true(fabs(energy[1] / energy[0] - 1.0) < 0.02);
}

int main(void) {
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(test_wide_image),
  };
  return cmocka_run_group_tests(tests, NULL, NULL);
}
