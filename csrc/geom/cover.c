/* Builds the bounding box tree of a mesh by recursive bisection. */
#include "geom/cover.h"

#include <math.h>

#include "base/memory.h"

/* The tree has at most 2^13 leaves; a node with at most LEAF triangles is not split. */
enum { LEAF = 8, BOXES_MAX = (2 << PL_COVER_DEPTH) - 1 };

static const float *vertex_of(const pl_model *model, uint32_t triangle, size_t corner) {
  return model->positions + 3 * (size_t)model->indices[3 * (size_t)triangle + corner];
}

static float centroid(const pl_model *model, uint32_t triangle, int axis) {
  return (vertex_of(model, triangle, 0)[axis] + vertex_of(model, triangle, 1)[axis] +
          vertex_of(model, triangle, 2)[axis]) /
         3.0f;
}

static pl_box box_of(const pl_model *model, const uint32_t *triangles, size_t count) {
  pl_box box = {.low = {INFINITY, INFINITY, INFINITY}, .high = {-INFINITY, -INFINITY, -INFINITY}};
  for (size_t i = 0; i < count; i++)
    for (size_t corner = 0; corner < 3; corner++)
      for (int axis = 0; axis < 3; axis++) {
        const float x = vertex_of(model, triangles[i], corner)[axis];
        box.low[axis] = fminf(box.low[axis], x);
        box.high[axis] = fmaxf(box.high[axis], x);
      }
  return box;
}

/* Finds the axis of the largest extent of the centroids, and the middle of that extent. */
static int longest_axis(const pl_model *model, const uint32_t *triangles, size_t count,
                        float *middle) {
  int longest = 0;
  float length = -1.0f;
  for (int axis = 0; axis < 3; axis++) {
    float low = INFINITY, high = -INFINITY;
    for (size_t i = 0; i < count; i++) {
      const float x = centroid(model, triangles[i], axis);
      low = fminf(low, x);
      high = fmaxf(high, x);
    }
    if (high - low > length) {
      length = high - low;
      longest = axis;
      *middle = 0.5f * (low + high);
    }
  }
  return longest;
}

/* Moves the triangles below the middle to the front; returns their number. */
static size_t partition(const pl_model *model, uint32_t *triangles, size_t count) {
  float middle = 0.0f;
  const int axis = longest_axis(model, triangles, count, &middle);
  size_t front = 0;
  for (size_t i = 0; i < count; i++) {
    if (!(centroid(model, triangles[i], axis) < middle))
      continue;
    const uint32_t swap = triangles[front];
    triangles[front++] = triangles[i];
    triangles[i] = swap;
  }
  return front;
}

static void add_box(pl_box box, size_t first, size_t count, pl_cover *cover) {
  box.first = (uint32_t)first;
  box.count = (uint32_t)count;
  cover->boxes[cover->count++] = box;
}

/* Grows the box of an inner node to the union of its children's, which are built first. */
static void enclose(pl_box *box, const pl_box *half) {
  for (int axis = 0; axis < 3; axis++) {
    box->low[axis] = fminf(box->low[axis], half->low[axis]);
    box->high[axis] = fmaxf(box->high[axis], half->high[axis]);
  }
}

static void halve(const pl_model *model, size_t first, size_t count, int depth, pl_cover *cover) {
  const size_t own = cover->count;
  uint32_t *triangles = cover->triangles + first;
  const size_t front =
      depth < PL_COVER_DEPTH && count > LEAF ? partition(model, triangles, count) : 0;
  if (front == 0 || front == count) {
    add_box(box_of(model, triangles, count), first, count, cover);
  } else {
    add_box(box_of(model, triangles, 0), first, count, cover);
    halve(model, first, front, depth + 1, cover);
    const size_t second = cover->count;
    halve(model, first + front, count - front, depth + 1, cover);
    enclose(&cover->boxes[own], &cover->boxes[own + 1]);
    enclose(&cover->boxes[own], &cover->boxes[second]);
  }
  cover->boxes[own].after = (uint32_t)cover->count;
}

/* Upper bound of the number of boxes; small meshes have fewer. */
static size_t boxes_most(size_t triangles) {
  return triangles < BOXES_MAX / 2 ? 2 * triangles : BOXES_MAX;
}

pl_status pl_cover_init(const pl_model *model, pl_cover *out) {
  void *boxes, *triangles;
  const size_t count = model->triangle_count;
  *out = (pl_cover){.model = model};
  if (count == 0)
    return PL_OK;
  PL_TRY(pl_alloc_or_fail(count, sizeof(uint32_t), "a cover", &triangles));
  const pl_status status = pl_alloc_or_fail(boxes_most(count), sizeof(pl_box), "a cover", &boxes);
  if (status != PL_OK) {
    pl_free(triangles);
    return status;
  }
  *out = (pl_cover){.model = model, .boxes = boxes, .triangles = triangles};
  for (size_t i = 0; i < count; i++)
    out->triangles[i] = (uint32_t)i;
  halve(model, 0, count, 0, out);
  return PL_OK;
}

void pl_cover_clear(pl_cover *cover) {
  pl_free(cover->boxes);
  pl_free(cover->triangles);
  pl_facets_clear(&cover->facets);
  *cover = (pl_cover){0};
}
