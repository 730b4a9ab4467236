/* What alpha leaves of triangles: against opacity at many points of them. */
#include "shade/presence.h"

#include "models.h"
#include "shade/material_surface.h"

enum { SIDE = 16, TRIALS = 400, STEPS = 60 };

/* A texture of blocks of full, no and half opacity, as the images of real masks are. */
static pl_texture *blocks(test_random *random, pl_wrap wrap) {
  pl_image image;
  assert_int_equal(pl_image_init(SIDE, SIDE, 4, &image), PL_OK);
  for (size_t i = 0; i < (size_t)SIDE * SIDE * 4; i++)
    image.texels[i] = 255;
  for (int k = 0; k < 6; k++) {
    const int x0 = (int)random_range(random, 0, SIDE - 0.001);
    const int y0 = (int)random_range(random, 0, SIDE - 0.001);
    const uint8_t alpha = (uint8_t)(random_range(random, 0, 2.999)) * 120;
    for (int y = y0; y < SIDE && y < y0 + 8; y++)
      for (int x = x0; x < SIDE && x < x0 + 8; x++)
        image.texels[4 * (y * SIDE + x) + 3] = alpha;
  }
  pl_texture *texture;
  assert_int_equal(pl_texture_create(&image, true, wrap, wrap, &texture), PL_OK);
  return texture;
}

static pl_model *random_triangle(test_random *random, bool textured, bool colored) {
  pl_model *model = model_create(3, 1);
  pl_material *material = &model->materials[0];
  material->alpha_mode = random_range(random, 0, 1) < 0.5 ? PL_ALPHA_MASK : PL_ALPHA_BLEND;
  material->alpha_cutoff = (float)random_range(random, 0.05, 0.95);
  material->base_color[3] = random_range(random, 0, 1) < 0.5 ? 1.0f : 0.7f;
  model->uvs[0] = pl_alloc(6, sizeof(float));
  model->colors = colored ? pl_alloc(12, sizeof(float)) : NULL;
  assert_non_null(model->uvs[0]);
  const double u = random_range(random, -2, 2), v = random_range(random, -2, 2);
  const double size = random_range(random, 0.02, 0.8);
  for (uint32_t k = 0; k < 3; k++) {
    model->indices[k] = k;
    model_set_vertex(model, k, (pl_vec3){k == 1, k == 2, 0}, (pl_vec3){0, 0, 1});
    model->uvs[0][2 * k] = (float)(u + random_range(random, 0, size));
    model->uvs[0][2 * k + 1] = (float)(v + random_range(random, 0, size));
    for (uint32_t c = 0; colored && c < 4; c++)
      model->colors[4 * k + c] = (float)random_range(random, 0, 1);
  }
  if (textured) {
    model->textures = pl_alloc(1, sizeof *model->textures);
    assert_non_null(model->textures);
    model->texture_count = 1;
    model->textures[0] = blocks(random, (pl_wrap)random_range(random, 0, 2.999));
    material->base_color_map.texture = 0;
  }
  return model;
}

/* Which of the two are met at points all over the triangle: bit 0 none, bit 1 a surface. */
static unsigned sampled(const pl_model *model) {
  unsigned found = 0;
  for (int i = 0; i <= STEPS; i++)
    for (int j = 0; j <= STEPS - i; j++) {
      const float a = (float)i / STEPS, b = (float)j / STEPS;
      const pl_triangle_point point = {.w = {1.0f - a - b, a, b}};
      found |= pl_material_opacity(model, &point) >= 0.5f ? 2u : 1u;
    }
  return found;
}

static void certain_answers_hold_at_every_point(void **state) {
  (void)state;
  test_random random = {.seed = 5};
  int count[3] = {0}, decided = 0;
  for (int trial = 0; trial < TRIALS; trial++) {
    pl_model *model = random_triangle(&random, trial % 4 != 0, trial % 3 == 0);
    uint8_t presence;
    pl_presence_find(model, &presence);
    const unsigned found = sampled(model);
    if (presence == PL_PRESENCE_NONE)
      assert_int_equal(found, 1);
    if (presence == PL_PRESENCE_WHOLE)
      assert_int_equal(found, 2);
    decided += found == 3 || presence != PL_PRESENCE_PART;
    count[presence]++;
    pl_model_destroy(model);
  }
  for (int k = 0; k < 3; k++)
    assert_true(count[k] > TRIALS / 20);
  assert_true(decided > TRIALS * 9 / 10); /* it does not say "a part" of all */
}

static void opaque_materials_and_no_alpha_are_whole(void **state) {
  (void)state;
  test_random random = {.seed = 5};
  uint8_t presence;
  pl_model *model = random_triangle(&random, true, true);
  model->materials[0].alpha_mode = PL_ALPHA_OPAQUE;
  pl_presence_find(model, &presence);
  assert_int_equal(presence, PL_PRESENCE_WHOLE);
  model->materials[0].alpha_mode = PL_ALPHA_BLEND;
  model->uvs[0][0] = NAN;
  pl_presence_find(model, &presence);
  assert_int_equal(presence, PL_PRESENCE_PART);
  pl_model_destroy(model);
}

int main(void) {
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(certain_answers_hold_at_every_point),
      cmocka_unit_test(opaque_materials_and_no_alpha_are_whole),
  };
  return cmocka_run_group_tests(tests, NULL, NULL);
}
