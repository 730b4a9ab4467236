/* Keyframes. Expected values: appendix C of glTF 2.0, worked by hand. */
#include "geom/animation.h"

#include <math.h>

#include "harness.h"

#define near(a, b) assert_true(fabs((a) - (b)) < 1e-7) /* values are floats */

static pl_trs sample(const pl_track *track, double t) {
  pl_trs out = {{7, 7, 7}, PL_QUAT_IDENTITY, {7, 7, 7}};
  pl_track_sample(track, t, &out);
  return out;
}

static void steps_hold_their_value(void **state) {
  (void)state;
  float times[] = {1, 2, 4}, values[] = {1, 0, 0, 2, 0, 0, 3, 0, 0};
  const pl_track track = {0, PL_TRACK_TRANSLATION, PL_STEP, 3, times, values};
  const double at[][2] = {{-1, 1}, {1, 1}, {1.999, 1}, {2, 2}, {3.999, 2}, {4, 3}, {9, 3}};
  for (size_t i = 0; i < sizeof at / sizeof at[0]; i++) {
    near(sample(&track, at[i][0]).t.x, at[i][1]);
    near(sample(&track, at[i][0]).s.x, 7); /* others stay */
  }
}

static void lines_join_values(void **state) {
  (void)state;
  float times[] = {1, 2, 4}, values[] = {1, 0, 0, 2, 8, 0, 3, 0, -4};
  const pl_track track = {0, PL_TRACK_SCALE, PL_LINEAR, 3, times, values};
  near(sample(&track, 0).s.x, 1);
  near(sample(&track, 1.25).s.x, 1.25);
  near(sample(&track, 1.25).s.y, 2);
  near(sample(&track, 3).s.x, 2.5);
  near(sample(&track, 3).s.z, -2);
  near(sample(&track, 4).s.x, 3);
  near(sample(&track, 5).s.z, -4);
}

/* 90 degrees about z, given as its negative: the short arc is taken; a third of it is 30 degrees.
 */
static void rotations_take_the_short_arc(void **state) {
  (void)state;
  const float h = (float)sqrt(0.5);
  float times[] = {0, 3}, values[] = {1, 0, 0, 0, -h, 0, 0, -h};
  const pl_track track = {0, PL_TRACK_ROTATION, PL_LINEAR, 2, times, values};
  const double angle = 2.0 * atan2(sample(&track, 1).q.z, sample(&track, 1).q.w);
  near(angle, PL_PI / 6.0);
  near(2.0 * atan2(fabs(sample(&track, 9).q.z), fabs(sample(&track, 9).q.w)), PL_PI / 2.0);
}

/* From 0 leaving with slope 1 to 0 arriving with slope 0 in 2 s: t (u^3 - 2 u^2 + u) at u = 1/2 is
 * 2/8. Then to 10 with slopes 0: half way after half the time. */
static void splines_follow_their_tangents(void **state) {
  (void)state;
  float times[] = {0, 2, 3};
  float values[] = {9, 9, 9, 0, 0, 0, 1, 1,  1,  0,  0, 0, 0, 0,
                    0, 0, 0, 0, 0, 0, 0, 10, 20, 30, 9, 9, 9};
  const pl_track track = {0, PL_TRACK_TRANSLATION, PL_CUBIC, 3, times, values};
  near(sample(&track, 1).t.x, 0.25);
  near(sample(&track, 2.5).t.z, 15);
  near(sample(&track, 3).t.y, 20);
  near(sample(&track, 4).t.y, 20);
  near(sample(&track, -1).t.y, 0);
}

/* The spline of a rotation is taken by component and made a rotation again. */
static void splined_rotations_are_unit(void **state) {
  (void)state;
  const float h = (float)sqrt(0.5);
  float times[] = {0, 1};
  float values[] = {0, 0, 0, 0, 1, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, h, 0, 0, h, 0, 0, 0, 0};
  const pl_track track = {0, PL_TRACK_ROTATION, PL_CUBIC, 2, times, values};
  const pl_quat q = sample(&track, 0.5).q;
  near(q.w * q.w + q.x * q.x + q.y * q.y + q.z * q.z, 1);
  near(2.0 * atan2(q.z, q.w), PL_PI / 4.0); /* by symmetry */
}

static void time_runs_as_the_loop_says(void **state) {
  (void)state;
  const pl_animation a = {.start_s = 1, .stop_s = 4}, still = {.start_s = 2, .stop_s = 2};
  const double at[][4] = {/* t, repeat, clamp, pingpong */
                          {0, 1, 1, 1}, {2, 3, 3, 3},       {3, 1, 4, 4},
                          {4, 2, 4, 3}, {6.5, 1.5, 4, 1.5}, {-1, 3, 1, 2}};
  for (size_t i = 0; i < sizeof at / sizeof at[0]; i++)
    for (int loop = 0; loop < 3; loop++)
      near(pl_animation_time(&a, (pl_loop)loop, at[i][0]), at[i][1 + loop]);
  near(pl_animation_time(&still, PL_LOOP_REPEAT, 17), 2);
}

int main(void) {
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(steps_hold_their_value),
      cmocka_unit_test(lines_join_values),
      cmocka_unit_test(rotations_take_the_short_arc),
      cmocka_unit_test(splines_follow_their_tangents),
      cmocka_unit_test(splined_rotations_are_unit),
      cmocka_unit_test(time_runs_as_the_loop_says),
  };
  return cmocka_run_group_tests(tests, NULL, NULL);
}
