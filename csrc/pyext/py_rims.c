/* The function rim_images: where the rims of craters lie in an image. */
#include "annotate/rim_image.h"
#include "base/memory.h"
#include "pyext/py_types.h"

/* A packed pl_rim_image: all members are of 8 bytes. */
typedef struct rim_record {
  int64_t kind;
  double centre[2], semi_axes[2], angle_rad, box[4], facing;
} rim_record;

PyObject *pl_py_rim_record(void) {
  return Py_BuildValue("[(ss),(ss(i)),(ss(i)),(ss),(ss(i)),(ss)]", "kind", "<i8", "centre", "<f8",
                       2, "semi_axes", "<f8", 2, "angle_rad", "<f8", "box", "<f8", 4, "facing",
                       "<f8");
}

static rim_record record_of(const pl_rim *rim, const pl_pinhole *camera, double near_m) {
  const pl_rim_image image = pl_rim_project(rim, camera, near_m);
  return (rim_record){image.kind,
                      {image.centre[0], image.centre[1]},
                      {image.semi_axes[0], image.semi_axes[1]},
                      image.angle_rad,
                      {image.box[0], image.box[1], image.box[2], image.box[3]},
                      image.facing};
}

PyObject *pl_py_rim_images(PyObject *module, PyObject *args) {
  const npy_intp shape[3] = {-1, 3, 3};
  PyObject *object;
  pl_pinhole camera;
  double near_m;
  (void)module;
  if (!PyArg_ParseTuple(args, "O(ddddd)d:rim_images", &object, &camera.fx, &camera.fy, &camera.cx,
                        &camera.cy, &camera.skew, &near_m))
    return NULL;
  if (!(near_m > 0.0))
    return PyErr_Format(PyExc_ValueError, "near_m must be above 0");
  PyArrayObject *array = pl_py_array(object, "rims", NPY_DOUBLE, 3, shape);
  if (array == NULL)
    return NULL;
  const size_t count = (size_t)PyArray_DIM(array, 0);
  const pl_rim *rims = PyArray_DATA(array);
  rim_record *records = pl_alloc(count, sizeof *records);
  PyObject *out = records != NULL ? NULL : PyErr_NoMemory();
  if (records != NULL) {
    for (size_t k = 0; k < count; k++)
      records[k] = record_of(&rims[k], &camera, near_m);
    out = pl_py_records(pl_py_rim_record(), records, count, sizeof *records);
  }
  pl_free(records);
  Py_DECREF((PyObject *)array);
  return out;
}
