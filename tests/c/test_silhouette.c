/* Full silhouettes against each object rendered alone on the large canvas, against casting every
 * ray, and against squares whose pixels can be counted by hand; what they cost; threads. */
#include "harness.h"

#include <stdio.h>

#include "annotate/silhouette.h"
#include "render/geometry.h"
#include "frames.h"

enum { WIDTH = 48, HEIGHT = 36, THREADS = 3 };

static const int32_t unseen_box[4] = {-1, -1, -1, -1};

/* A frame with all labels and masks. */
typedef struct shoot {
  film film;
  pl_renderer *renderer;
} shoot;

static void shoot_init(shoot *shoot, const stage *s) {
  film_init(&shoot->film, s);
  assert_int_equal(pl_renderer_create(&s->scene, &shoot->renderer), PL_OK);
}
static void shoot_clear(shoot *shoot) {
  pl_renderer_destroy(shoot->renderer);
  film_clear(&shoot->film);
}

/* Labels alone, without colour. */
static pl_frame_request labels_request(const stage *s, const film *f) {
  pl_frame_request request = request_all(s, f);
  request.rgb = NULL;
  request.radiance = NULL;
  return request;
}

static void shoot_frame(shoot *shoot, const stage *s, int threads) {
  pl_frame_request request = labels_request(s, &shoot->film);
  request.threads = threads;
  render(shoot->renderer, &request);
}

/* --- by hand ---------------------------------------------------------------------------------- */

/* A square of 20 x 20 pixels whose middle is pixel position (u, v), facing the camera. */
static size_t add_square(stage *s, const pl_model *square, double u, double v, double z) {
  const pl_camera *camera = &s->placement.camera;
  const double size = fabs(z) / camera->fx;
  const pl_vec3 middle = {(u - camera->cx) * size, (v - camera->cy) * size, z};
  return stage_add_object(s, square, middle, PL_QUAT_IDENTITY, 20.0 * size);
}

static void assert_label(const pl_object_label *label, int visible, int valid, int all) {
  assert_int_equal(label->px_count_visib, visible);
  assert_int_equal(label->px_count_valid, valid);
  assert_int_equal(label->px_count_all, all);
  assert_true(label->visib_fract == (all > 0 ? (double)visible / all : 0.0));
}

static void assert_box(const int32_t *box, int x, int y, int w, int h) {
  const int32_t expected[4] = {x, y, w, h};
  assert_memory_equal(box, expected, sizeof expected);
}

static size_t mask_sum(const film *f, size_t object) {
  size_t sum = 0;
  for (size_t i = 0; i < f->pixels; i++) {
    assert_in_range(f->masks[object * f->pixels + i], 0, 1);
    sum += f->masks[object * f->pixels + i];
  }
  return sum;
}

/* Whole, hidden in part by it, hidden wholly, cut at a corner, off the image, off the canvas,
 * behind the camera. */
static void test_counted_by_hand(void **state) {
  (void)state;
  pl_model *square = square_create(0.5);
  stage s;
  shoot shoot;
  stage_init(&s, WIDTH, HEIGHT, 40.0);
  add_square(&s, square, 19.5, 15.5, 10.0);  /* 10..29 x 6..25 */
  add_square(&s, square, 24.5, 20.5, 12.0);  /* 15..34 x 11..30; 15 x 15 of it hidden */
  add_square(&s, square, 19.5, 15.5, 11.0);  /* behind the first, pixel for pixel */
  add_square(&s, square, -2.5, 33.5, 9.0);   /* -12..7 x 24..43; 8 x 12 in the image */
  add_square(&s, square, -20.5, 15.5, 9.0);  /* -30..-11 x 6..25 */
  add_square(&s, square, -49.5, 15.5, 9.0);  /* -59..-40; the canvas begins at -48 */
  add_square(&s, square, -500.5, 15.5, 9.0); /* nowhere on the canvas */
  add_square(&s, square, 19.5, 15.5, -9.0);  /* behind the camera */
  shoot_init(&shoot, &s);
  shoot_frame(&shoot, &s, 1);
  const pl_object_label *labels = shoot.film.objects;
  assert_label(&labels[0], 400, 400, 400);
  assert_box(labels[0].bbox_obj, 10, 6, 19, 19);
  assert_label(&labels[1], 175, 400, 400);
  assert_box(labels[1].bbox_obj, 15, 11, 19, 19);
  assert_box(labels[1].bbox_visib, 15, 11, 19, 19);
  assert_label(&labels[2], 0, 400, 400);
  assert_memory_equal(labels[2].bbox_obj, unseen_box, sizeof unseen_box);
  assert_memory_equal(labels[2].bbox_visib, unseen_box, sizeof unseen_box);
  assert_label(&labels[3], 96, 96, 400);
  assert_box(labels[3].bbox_obj, -12, 24, 19, 19);
  assert_box(labels[3].bbox_visib, 0, 24, 7, 11);
  assert_label(&labels[4], 0, 0, 400);
  assert_memory_equal(labels[4].bbox_obj, unseen_box, sizeof unseen_box);
  assert_label(&labels[5], 0, 0, 9 * 20);
  assert_label(&labels[6], 0, 0, 0);
  assert_label(&labels[7], 0, 0, 0);
  for (size_t i = 0; i < s.scene.object_count; i++)
    assert_int_equal(mask_sum(&shoot.film, i), labels[i].px_count_valid);
  assert_int_equal(shoot.film.masks[2 * shoot.film.pixels + 6 * WIDTH + 10], 1);
  assert_int_equal(shoot.film.masks[2 * shoot.film.pixels + 5 * WIDTH + 10], 0);
  shoot_clear(&shoot);
  stage_clear(&s);
  pl_model_destroy(square);
}

/* Every pixel of the canvas sees the cube that the camera is in. */
static void test_around_the_camera(void **state) {
  (void)state;
  pl_model *cube = cube_create(0.5);
  stage s;
  shoot shoot;
  stage_init(&s, WIDTH, HEIGHT, 40.0);
  stage_add_object(&s, cube, (pl_vec3){0.2, 0.1, -0.3}, PL_QUAT_IDENTITY, 4.0);
  stage_add_object(&s, cube, (pl_vec3){0, 0, 20}, PL_QUAT_IDENTITY, 1.0);
  shoot_init(&shoot, &s);
  shoot_frame(&shoot, &s, 2);
  const pl_object_label *labels = shoot.film.objects;
  assert_label(&labels[0], WIDTH * HEIGHT, WIDTH * HEIGHT, 9 * WIDTH * HEIGHT);
  assert_box(labels[0].bbox_obj, -WIDTH, -HEIGHT, 3 * WIDTH - 1, 3 * HEIGHT - 1);
  assert_label(&labels[1], 0, 2 * 2, 2 * 2); /* 1 m at 19.5 m: 2.05 pixels about a pixel's corner */
  shoot_clear(&shoot);
  stage_clear(&s);
  pl_model_destroy(cube);
}

/* Without the switch the amodal fields say that they are not there; the others are the same. */
static void test_switched_off(void **state) {
  (void)state;
  pl_model *square = square_create(0.5);
  stage s;
  shoot shoot;
  stage_init(&s, WIDTH, HEIGHT, 40.0);
  add_square(&s, square, -0.5, 15.5, 10.0);
  shoot_init(&shoot, &s);
  shoot_frame(&shoot, &s, 1);
  pl_object_label expected = shoot.film.objects[0];
  assert_label(&expected, 200, 200, 400);
  pl_frame_request request = labels_request(&s, &shoot.film);
  request.amodal = false;
  render(shoot.renderer, &request); /* masks alone */
  assert_int_equal(mask_sum(&shoot.film, 0), 200);
  memset(shoot.film.masks, 0xa5, shoot.film.pixels);
  request.masks = NULL;
  render(shoot.renderer, &request);
  assert_int_equal(shoot.film.masks[0], 0xa5);
  const pl_object_label *label = &shoot.film.objects[0];
  assert_true(isnan(label->visib_fract));
  assert_int_equal(label->px_count_all, -1);
  assert_int_equal(label->px_count_valid, -1);
  assert_memory_equal(label->bbox_obj, unseen_box, sizeof unseen_box);
  expected.visib_fract = label->visib_fract;
  expected.px_count_all = expected.px_count_valid = -1;
  memcpy(expected.bbox_obj, unseen_box, sizeof unseen_box);
  assert_memory_equal(label, &expected, sizeof expected);
  shoot_clear(&shoot);
  stage_clear(&s);
  pl_model_destroy(square);
}

/* --- random scenes ---------------------------------------------------------------------------- */

/* Cubes and soups near and far, in front, beside, behind and about the camera, before and behind
 * two bodies. Some materials are single-sided. */
typedef struct crowd {
  pl_model *cube, *soup;
  stage stage;
} crowd;

static void crowd_init(crowd *c, test_random *random) {
  c->cube = cube_create(0.5);
  c->soup = soup_create(random, 40);
  c->soup->materials[0].double_sided = random_unit(random) < 0.5;
  stage_init(&c->stage, WIDTH, HEIGHT, random_range(random, 15.0, 80.0));
  c->stage.placement.camera.skew = random_range(random, -3.0, 3.0);
  c->stage.placement.camera.cx += random_range(random, -9.0, 9.0);
  c->stage.placement.camera.motion = still((pl_vec3){3e6, -2e6, 5e6}, random_rotation(random));
  const pl_pose camera = c->stage.placement.camera.motion.open;
  for (int i = 0; i < 6; i++) {
    const pl_vec3 at = {random_range(random, -8, 8), random_range(random, -6, 6),
                        random_range(random, i == 0 ? -3 : 1, 20)};
    stage_add_object(&c->stage, i % 2 == 0 ? c->cube : c->soup, pose_apply(camera, at),
                     random_rotation(random), random_scale(random, 0.1, 5.0));
  }
  const pl_vec3 near = pose_apply(camera, (pl_vec3){5, 2, 9});
  const pl_vec3 far = pose_apply(camera, (pl_vec3){0, 90, 60});
  stage_add_body(&c->stage, near, (pl_vec3){1.5, 2.0, 1.0}, 0.5f);
  stage_add_body(&c->stage, far, (pl_vec3){80, 80, 79}, 0.5f);
}
static void crowd_clear(crowd *c) {
  stage_clear(&c->stage);
  pl_model_destroy(c->cube);
  pl_model_destroy(c->soup);
}

/* The instance image of one object alone, on the canvas. */
static void render_alone(const stage *s, size_t index, int32_t *canvas) {
  const pl_object *object = &s->scene.objects[index];
  stage alone;
  pl_renderer *renderer;
  stage_init(&alone, 3 * WIDTH, 3 * HEIGHT, 1.0);
  alone.placement.camera = s->placement.camera;
  alone.placement.camera.width = 3 * WIDTH;
  alone.placement.camera.height = 3 * HEIGHT;
  alone.placement.camera.cx += WIDTH;
  alone.placement.camera.cy += HEIGHT;
  stage_add_object(&alone, object->model, (pl_vec3){0, 0, 0}, PL_QUAT_IDENTITY, 1.0);
  alone.objects[0] = s->objects[index];
  film f = {.pixels = 9 * WIDTH * HEIGHT};
  pl_frame_request request = request_all(&alone, &f);
  for (size_t i = 0; i < pl_channel_count; i++)
    request.channels[i] = strcmp(pl_channels[i].name, "instance") == 0 ? canvas : NULL;
  assert_int_equal(pl_renderer_create(&alone.scene, &renderer), PL_OK);
  render(renderer, &request);
  pl_renderer_destroy(renderer);
  stage_clear(&alone);
}

/* What BOP's definitions give for the canvas of one object. */
static pl_object_label expected_label(const pl_object_label *visible, const int32_t *canvas,
                                      const film *f, size_t index) {
  const float *depth = film_channel(f, "depth");
  pl_object_label out = *visible;
  pl_extent all = PL_EXTENT_NONE;
  out.px_count_valid = 0;
  for (int y = 0; y < 3 * HEIGHT; y++)
    for (int x = 0; x < 3 * WIDTH; x++) {
      const int u = x - WIDTH, v = y - HEIGHT;
      const bool inside = u >= 0 && v >= 0 && u < WIDTH && v < HEIGHT;
      const size_t pixel = (size_t)(inside ? v * WIDTH + u : 0);
      const bool there = canvas[y * 3 * WIDTH + x] != 0;
      if (inside)
        assert_int_equal(f->masks[index * f->pixels + pixel], there);
      if (!there)
        continue;
      all.count++;
      all.x0 = all.x0 < u ? all.x0 : u;
      all.y0 = all.y0 < v ? all.y0 : v;
      all.x1 = all.x1 > u ? all.x1 : u;
      all.y1 = all.y1 > v ? all.y1 : v;
      out.px_count_valid += inside && depth[pixel] != 0.0f;
    }
  out.px_count_all = all.count;
  out.visib_fract = all.count > 0 ? (double)visible->px_count_visib / all.count : 0.0;
  memcpy(out.bbox_obj, unseen_box, sizeof unseen_box);
  if (visible->px_count_visib > 0) {
    const int32_t box[4] = {all.x0, all.y0, all.x1 - all.x0, all.y1 - all.y0};
    memcpy(out.bbox_obj, box, sizeof box);
  }
  return out;
}

/* Every label and mask pixel; and what is seen is part of the mask. */
static void test_against_each_object_alone(void **state) {
  (void)state;
  test_random random = {.seed = 91};
  static int32_t canvas[9 * WIDTH * HEIGHT];
  int hidden = 0, cut = 0, off = 0, whole = 0;
  print_message("seed 91\n");
  for (int round = 0; round < 40; round++) {
    crowd c;
    shoot shoot;
    crowd_init(&c, &random);
    shoot_init(&shoot, &c.stage);
    shoot_frame(&shoot, &c.stage, 1 + round % THREADS);
    const int32_t *instance = film_channel(&shoot.film, "instance");
    for (size_t i = 0; i < c.stage.scene.object_count; i++) {
      const pl_object_label *label = &shoot.film.objects[i];
      render_alone(&c.stage, i, canvas);
      const pl_object_label expected = expected_label(label, canvas, &shoot.film, i);
      assert_memory_equal(label, &expected, sizeof expected);
      for (size_t p = 0; p < shoot.film.pixels; p++)
        assert_true(instance[p] != label->instance_id ||
                    shoot.film.masks[i * shoot.film.pixels + p] == 1);
      hidden += label->px_count_visib < label->px_count_valid;
      cut += label->px_count_valid > 0 && label->px_count_valid < label->px_count_all;
      off += label->px_count_valid == 0 && label->px_count_all > 0;
      whole += label->px_count_all > 0 && label->px_count_all == label->px_count_visib;
    }
    shoot_clear(&shoot);
    crowd_clear(&c);
  }
  print_message("%d hidden in part, %d cut, %d off the image, %d whole\n", hidden, cut, off, whole);
  assert_true(hidden > 20 && cut > 20 && off > 5 && whole > 10);
}

/* --- what is cast ----------------------------------------------------------------------------- */

/* The parts of a frame that silhouettes need, made without a renderer. */
typedef struct bench {
  pl_arena arena;
  pl_snapshot shot;
  pl_accelerators *kept;
  const pl_tracer *tracer;
  pl_solo *solo;
  pl_cluster_cache clusters;
  pl_seen seen[WIDTH * HEIGHT];
  pl_extent extents[STAGE_THINGS];
  pl_outline outlines[STAGE_THINGS];
  pl_silhouette workers[THREADS];
  pl_silhouette_job job;
} bench;

static void bench_init(bench *b, const stage *s) {
  memset(b, 0, sizeof *b);
  pl_arena_init(&b->arena);
  assert_int_equal(pl_snapshot_build(&s->scene, &s->placement, &b->arena, &b->shot), PL_OK);
  assert_int_equal(pl_accelerators_create(&b->kept), PL_OK);
  assert_int_equal(pl_geometry_tracer(b->kept, &b->shot, &b->arena, &b->tracer), PL_OK);
  assert_int_equal(pl_solo_create(b->kept, &b->solo), PL_OK);
  for (size_t i = 0; i < STAGE_THINGS; i++)
    b->extents[i] = PL_EXTENT_NONE;
  for (int y = 0; y < HEIGHT; y++)
    for (int x = 0; x < WIDTH; x++) {
      const pl_ray ray = {
          .t_max = INFINITY, .direction = pl_snapshot_ray(&b->shot, x, y), .skip_body = PL_NO_BODY};
      pl_hit hit;
      pl_point point = {0};
      const int pixel[4] = {x, y, 1, 1};
      pl_tracer_closest(b->tracer, &ray, &hit, 1, true, true);
      point.surface_id = hit.surface_id;
      point.t = hit.t;
      pl_seen_write(&point, 1, pixel, WIDTH, b->seen);
      pl_extent_add(b->extents, PL_EXTENT_NO_BODIES, &point, 1, pixel);
    }
  pl_cluster_cache_init(&b->clusters);
  assert_int_equal(pl_outline_build(&b->shot, &b->clusters, &b->arena, b->outlines), PL_OK);
  uint8_t *cells = pl_arena_alloc(&b->arena, pl_outline_cells_size(&b->shot.rays.camera), 1);
  assert_non_null(cells);
  b->job = (pl_silhouette_job){.shot = &b->shot,
                               .seen = b->seen,
                               .solo = b->solo,
                               .cells = cells,
                               .workers = b->workers,
                               .threads = 1};
}
static void bench_clear(bench *b) {
  pl_cluster_cache_clear(&b->clusters);
  pl_solo_destroy(b->solo);
  pl_accelerators_destroy(b->kept);
  pl_arena_clear(&b->arena);
}

static pl_silhouette find(bench *b, size_t index, const pl_outline *outline, uint8_t *mask) {
  pl_silhouette out;
  assert_int_equal(pl_silhouette_find(&b->job, index, outline, &b->extents[index], mask, &out),
                   PL_OK);
  return out;
}

/* One ray through every pixel of the canvas. */
static pl_silhouette cast_all(bench *b, size_t index, uint8_t *mask) {
  pl_silhouette out = {INT32_MAX, INT32_MAX, INT32_MIN, INT32_MIN, 0, 0, 0};
  assert_int_equal(pl_solo_set(b->solo, &b->shot.objects[index]), PL_OK);
  for (int y = -HEIGHT; y < 2 * HEIGHT; y++)
    for (int x = -WIDTH; x < 2 * WIDTH; x++) {
      const pl_vec3 direction = pl_snapshot_ray(&b->shot, x, y);
      bool hit;
      pl_solo_cast(b->solo, &direction, &hit, 1);
      if (!hit)
        continue;
      const bool inside = x >= 0 && y >= 0 && x < WIDTH && y < HEIGHT;
      out = (pl_silhouette){out.x0 < x ? out.x0 : x,
                            out.y0 < y ? out.y0 : y,
                            out.x1 > x ? out.x1 : x,
                            out.y1 > y ? out.y1 : y,
                            out.count + 1,
                            out.inside + inside,
                            0};
      if (inside)
        mask[y * WIDTH + x] = 1;
    }
  return out;
}

/* The criterion: objects called whole are found without a ray as they are by all rays; and the few
 * rays of the others give what all rays give. For any number of threads. */
static void test_against_casting_every_ray(void **state) {
  (void)state;
  test_random random = {.seed = 92};
  static bench b;
  int64_t rays = 0, all_rays = 0, whole = 0;
  print_message("seed 92\n");
  for (int round = 0; round < PL_DRAWS(40, 8); round++) {
    crowd c;
    crowd_init(&c, &random);
    bench_init(&b, &c.stage);
    for (size_t i = 0; i < c.stage.scene.object_count; i++) {
      static uint8_t expected_mask[WIDTH * HEIGHT], mask[WIDTH * HEIGHT];
      memset(expected_mask, 0, sizeof mask);
      pl_silhouette expected = cast_all(&b, i, expected_mask);
      for (b.job.threads = 1; b.job.threads <= THREADS; b.job.threads++) {
        memset(mask, 0, sizeof mask);
        const pl_silhouette found = find(&b, i, &b.outlines[i], mask);
        expected.rays = found.rays;
        assert_memory_equal(&found, &expected, sizeof found);
        assert_memory_equal(mask, expected_mask, sizeof mask);
        if (b.outlines[i].whole)
          assert_int_equal(found.rays, 0);
      }
      b.job.threads = 1;
      whole += b.outlines[i].whole && expected.count > 0;
      rays += find(&b, i, &b.outlines[i], NULL).rays;
      all_rays += 9 * WIDTH * HEIGHT;
    }
    bench_clear(&b);
    crowd_clear(&c);
  }
  print_message("%d objects whole; %d of %d rays cast\n", (int)whole, (int)rays, (int)all_rays);
  assert_true(PL_SEEN(whole, 10));
  assert_true(rays > 0 && rays < all_rays / 4);
}

/* An object before a planet, beside another, or before another costs no ray; one behind another
 * costs those of the pixels that see the other; one cut, those outside the image. */
static void test_rays_are_cast_only_where_needed(void **state) {
  (void)state;
  pl_model *square = square_create(0.5), *cube = cube_create(0.5);
  static bench b;
  stage s;
  stage_init(&s, WIDTH, HEIGHT, 40.0);
  stage_add_body(&s, (pl_vec3){0, 0, 8e6}, (pl_vec3){6e6, 6e6, 6e6}, 0.5f);
  add_square(&s, square, 19.5, 15.5, 10.0); /* before the next and the planet */
  add_square(&s, square, 24.5, 20.5, 20.0); /* 15 x 15 pixels of it see the first */
  stage_add_object(&s, cube, (pl_vec3){-450, -400, 1000}, PL_QUAT_IDENTITY, 10.0);
  add_square(&s, square, 47.5, 15.5, 10.0); /* 38..57: 10 columns outside */
  add_square(&s, square, 19.5, 15.5, -10.0);
  bench_init(&b, &s);
  assert_true(b.outlines[0].whole);
  assert_int_equal(find(&b, 0, &b.outlines[0], NULL).rays, 0);
  assert_false(b.outlines[1].whole);
  /* The box may be a few pixels wider than the square. */
  assert_in_range(find(&b, 1, &b.outlines[1], NULL).rays, 15 * 15, 18 * 18);
  assert_true(b.outlines[2].whole);
  assert_false(b.outlines[3].whole);
  assert_in_range(find(&b, 3, &b.outlines[3], NULL).rays, 10 * 20, 14 * 25);
  assert_true(b.outlines[4].whole);
  assert_int_equal(find(&b, 4, &b.outlines[4], NULL).count, 0);
  bench_clear(&b);
  stage_clear(&s);
  pl_model_destroy(square);
  pl_model_destroy(cube);
}

/* --- the frame -------------------------------------------------------------------------------- */

/* The same bits for any number of threads and after any other frame. */
static void test_frames_repeat(void **state) {
  (void)state;
  test_random random = {.seed = 93};
  print_message("seed 93\n");
  for (int round = 0; round < 5; round++) {
    crowd c;
    shoot one, other;
    crowd_init(&c, &random);
    shoot_init(&one, &c.stage);
    shoot_init(&other, &c.stage);
    shoot_frame(&one, &c.stage, 1);
    const pl_object_state first = c.stage.objects[0];
    c.stage.objects[0] = c.stage.objects[1];
    shoot_frame(&other, &c.stage, 1);
    c.stage.objects[0] = first;
    for (int threads = 1; threads <= 5; threads++) {
      memset(other.film.memory, 0, other.film.bytes);
      shoot_frame(&other, &c.stage, threads);
      assert_memory_equal(one.film.objects, other.film.objects, 6 * sizeof(pl_object_label));
      assert_memory_equal(one.film.masks, other.film.masks, 6 * one.film.pixels);
    }
    shoot_clear(&one);
    shoot_clear(&other);
    crowd_clear(&c);
  }
}

static void *fail_at_zero(void *context, size_t size) {
  long *left = context;
  return (*left)-- == 0 ? NULL : malloc(size);
}

/* With hidden and cut objects: every allocation may fail, and the second frame makes none. */
static void test_memory(void **state) {
  (void)state;
  test_random random = {.seed = 91};
  crowd c;
  shoot shoot;
  crowd_init(&c, &random);
  film_init(&shoot.film, &c.stage);
  pl_status status = PL_E_MEMORY;
  long n = 0;
  for (; status != PL_OK; n++) {
    const pl_frame_request request = labels_request(&c.stage, &shoot.film);
    pl_frame_result result;
    long left = n;
    shoot.renderer = NULL;
    pl_memory_hook(fail_at_zero, &left);
    status = pl_renderer_create(&c.stage.scene, &shoot.renderer);
    if (status == PL_OK)
      status = pl_renderer_frame(shoot.renderer, &request, &result);
    pl_memory_hook(NULL, NULL);
    assert_true(status == PL_OK || status == PL_E_MEMORY);
    if (status != PL_OK)
      pl_renderer_destroy(shoot.renderer);
    assert_true(n < 1000);
  }
  print_message("%ld allocations failed in turn\n", n - 1);
  const uint64_t before = pl_memory_allocations();
  shoot_frame(&shoot, &c.stage, 1);
  assert_int_equal(pl_memory_allocations(), before);
  shoot_clear(&shoot);
  crowd_clear(&c);
}

static void test_no_objects(void **state) {
  (void)state;
  stage s;
  shoot shoot;
  stage_init(&s, WIDTH, HEIGHT, 40.0);
  stage_add_body(&s, (pl_vec3){0, 0, 10}, (pl_vec3){2, 2, 2}, 0.5f);
  shoot_init(&shoot, &s);
  shoot_frame(&shoot, &s, 2);
  shoot_clear(&shoot);
  stage_clear(&s);
}

static void test_cancelled(void **state) {
  (void)state;
  pl_model *square = square_create(0.5);
  static bench b;
  stage s;
  pl_cancel cancel;
  pl_silhouette out;
  memset(&cancel, 0, sizeof cancel);
  atomic_store(&cancel.requested, true);
  stage_init(&s, WIDTH, HEIGHT, 40.0);
  add_square(&s, square, 47.5, 15.5, 10.0);
  bench_init(&b, &s);
  b.job.cancel = &cancel;
  assert_int_equal(pl_silhouette_find(&b.job, 0, &b.outlines[0], &b.extents[0], NULL, &out),
                   PL_E_CANCELLED);
  bench_clear(&b);
  stage_clear(&s);
  pl_model_destroy(square);
}

int main(void) {
  const struct CMUnitTest tests[] = {
      serial_unit_test(test_counted_by_hand),
      cmocka_unit_test(test_around_the_camera),
      serial_unit_test(test_switched_off),
      cmocka_unit_test(test_against_each_object_alone),
      cmocka_unit_test(test_against_casting_every_ray),
      serial_unit_test(test_rays_are_cast_only_where_needed),
      cmocka_unit_test(test_frames_repeat),
      serial_unit_test(test_memory),
      cmocka_unit_test(test_no_objects),
      serial_unit_test(test_cancelled),
  };
  return cmocka_run_group_tests(tests, NULL, NULL);
}
