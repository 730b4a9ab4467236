/* Colours from image files. */
#include <math.h>

#include "shade/body_map.h"
#include "shade/node_rows.h"

enum { IMAGE_FILE, COLOR_SPACE, WRAP, WRAP_V, UV_SET };

/* Side of the square with the area of the footprint's circle. */
static float side_of(float radius) { return radius * sqrtf(PL_PI_F); }

static void read(const pl_node_call *call, const pl_texture *texture, size_t lane, float out[4]) {
  const pl_graph_point *p = &call->points[lane];
  const bool given = (call->given & 1u) != 0;
  const float(*in)[PL_LANES] = *call->in[0];
  const pl_value at = {in[0][lane], in[1][lane], in[2][lane], in[3][lane]};
  float uv[2] = {at[0], at[1]}, a[2] = {side_of(at[3]), 0.0f}, b[2] = {0.0f, side_of(at[3])};
  if (isinf(given ? at[3] : p->radius)) {
    pl_texture_mean(texture, out);
    return;
  }
  if (!given && p->body != NULL) {
    const pl_body_place place = {p->place, p->across, p->along, p->map_center_lon_rad,
                                 p->map_oblate};
    pl_body_map_sample(texture, &place, p->filter, out);
    return;
  }
  if (!given)
    pl_graph_point_uv(p, (int)call->constants[UV_SET].number, uv, a, b);
  pl_texture_sample(texture, uv[0], uv[1], a, b, p->filter, out);
}

static void image(const pl_node_call *call) {
  const pl_texture *texture = call->constants[IMAGE_FILE].texture;
  for (size_t i = 0; i < call->count; i++) {
    float rgba[4] = {1.0f, 1.0f, 1.0f, 1.0f};
    if (texture != NULL)
      read(call, texture, i, rgba);
    pl_lane_vector(call->out[0], i, pl_value_vec(rgba), 0.0f);
    pl_lane_scalar(call->out[1], i, rgba[3]);
  }
  pl_lanes_fill(call->out[0], call->count);
  pl_lanes_fill(call->out[1], call->count);
}

static const char *const spaces[] = {"srgb", "linear", NULL};
static const char *const wraps[] = {"repeat", "clamp", "mirror", NULL};
static const char *const wraps_v[] = {"repeat", "clamp", "mirror", "same", NULL};
static const char *const sets[] = {"uv", "uv1", NULL};

/* The three choices after the file determine how the texture is loaded. */
static const pl_constant_row constants[] = {
    [IMAGE_FILE] = {"file", PL_IMAGE, NAN, 0, 0, NULL, 0, "PNG, JPEG, WebP or TIFF"},
    [COLOR_SPACE] = {"color_space", PL_CHOICE, 0, 0, 0, spaces, 0,
                     "srgb: a picture. linear: data, as roughness, heights and normals; alpha "
                     "always is"},
    [WRAP] = {"wrap", PL_CHOICE, PL_WRAP_REPEAT, 0, 0, wraps, 0,
              "Beyond the image: it again, its edge, or its mirror image"},
    [WRAP_V] = {"wrap_v", PL_CHOICE, 3, 0, 0, wraps_v, 0, "The same upwards and downwards"},
    [UV_SET] = {"uv", PL_CHOICE, 0, 0, 0, sets, 0,
                "Texture coordinates of the model, where no vector is given"},
};
static const pl_socket inputs[] = {
    {"vector",
     PL_VECTOR,
     {0.0f, 0.0f, 0.0f},
     "x to the right, y downwards from the upper left corner, the image's width and height being "
     "1; "
     "where not given the model's texture coordinates or a body's map, whose footprints are known "
     "better; on a map wrap_v: clamp keeps the poles apart"}};
static const pl_socket outputs[] = {
    {"color", PL_COLOR, {0.0f, 0.0f, 0.0f}, "Linear RGB; grey spreads"},
    {"alpha", PL_SCALAR, {0.0f, 0.0f, 0.0f}, "1 where the image has none"},
};

const pl_node_kind pl_node_image = {
    .name = "image",
    .doc = "An image, filtered by the footprint",
    .inputs = inputs,
    .input_count = 1,
    .outputs = outputs,
    .output_count = 2,
    .constants = constants,
    .constant_count = sizeof constants / sizeof constants[0],
    .reads_point = true,
    .evaluate = image,
};
