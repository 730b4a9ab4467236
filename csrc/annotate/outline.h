/* Where the silhouette of an object can lie, and whether what is seen of it is all of it: known
 * before any ray is cast. */
#ifndef PL_ANNOTATE_OUTLINE_H
#define PL_ANNOTATE_OUTLINE_H

#include <stdbool.h>

#include "scene/snapshot.h"

typedef struct pl_outline {
  pl_vec3 corners[8]; /* of the model's bounding box, camera axes, m */
  int x0, y0, x1, y1; /* pixels of the canvas it may cover, inclusive; x0 > x1 when none */
  double z0_m, z1_m;  /* of the corners, along the optical axis */
  double far_m;       /* of the farthest corner from the camera */
  bool whole;         /* its seen pixels are its silhouette */
} pl_outline;

/* The canvas is the image with one image size of margin on each side (BOP). An object is whole when
 * its projected bounding box lies inside the image, and no other object whose box begins nearer
 * than this one's ends projects on the same pixels, and no body whose bounding sphere does stands
 * in the cone of its own: then neither the image's border nor another thing can take a pixel. */
void pl_outline_build(const pl_snapshot *shot, pl_outline *outlines);

/* Whether rays through canvas pixels x0..x1, y0..y1 may meet the object: false only when a side of
 * their pyramid parts it from the bounding box. Holds for boxes around and behind the camera. */
bool pl_outline_meets(const pl_outline *outline, const pl_camera *camera, int x0, int y0, int x1,
                      int y1);

#endif
