/* Image files: PNG and OpenEXR. */
#include "pyext/py_image.h"

#include <string.h>

#include "base/memory.h"
#include "io/deflate.h"
#include "io/exr.h"
#include "io/exr_read.h"
#include "io/image_file.h"
#include "io/png_write.h"
#include "pyext/py_types.h"

/* Returns the number of channels of an image array: 1 for (H, W); 0 for shapes that cannot be
 * written. */
static int image_channels(PyArrayObject *array) {
  if (PyArray_NDIM(array) == 2)
    return 1;
  if (PyArray_NDIM(array) == 3 && PyArray_DIM(array, 2) >= 1 && PyArray_DIM(array, 2) <= 4)
    return (int)PyArray_DIM(array, 2);
  return 0;
}

/* Decodes a grey PNG (bytes, name for errors) to a uint16 array of (height, width). */
PyObject *pl_py_png_grey(PyObject *module, PyObject *args) {
  const char *bytes, *name;
  Py_ssize_t size;
  pl_image image;
  (void)module;
  if (!PyArg_ParseTuple(args, "y#s:png_grey", &bytes, &size, &name))
    return NULL;
  const pl_status status = pl_png_decode_grey((const uint8_t *)bytes, (size_t)size, name, &image);
  if (status != PL_OK)
    return pl_py_raise(status);
  const npy_intp shape[2] = {image.height, image.width};
  PyObject *result = PyArray_SimpleNew(2, shape, NPY_UINT16);
  uint16_t *out = result != NULL ? PyArray_DATA((PyArrayObject *)result) : NULL;
  for (npy_intp i = 0; result != NULL && i < shape[0] * shape[1]; i++)
    out[i] = (uint16_t)(image.texels[2 * i] << 8 | image.texels[2 * i + 1]);
  pl_image_clear(&image);
  return result;
}

/* The GIL is released while an image is written, so the array is copied, as in pl_py_own_array. */
#define PL_IMAGE_FLAGS (NPY_ARRAY_IN_ARRAY | NPY_ARRAY_ENSUREARRAY | NPY_ARRAY_ENSURECOPY)

/* Returns a new reference to a copy of an image array, with its layout; NULL with an exception. */
static PyArrayObject *image_array(PyObject *object, const char *function, int *channels,
                                  int *bits) {
  PyArrayObject *array = (PyArrayObject *)PyArray_FROM_OF(object, PL_IMAGE_FLAGS);
  if (array == NULL)
    return NULL;
  const int type = PyArray_TYPE(array);
  *channels = image_channels(array);
  *bits = type == NPY_UINT8 ? 8 : 16;
  if ((type == NPY_UINT8 || type == NPY_UINT16) && *channels > 0)
    return array;
  PyErr_Format(PyExc_ValueError, "%s takes uint8 or uint16 arrays of shape (H, W) or (H, W, 1..4)",
               function);
  Py_DECREF((PyObject *)array);
  return NULL;
}

PyObject *pl_py_png_write(PyObject *module, PyObject *args, PyObject *kwargs) {
  static char *names[] = {"path", "array", "level", NULL};
  (void)module;
  PyObject *path = NULL, *object;
  int level = 6, channels, bits;
  if (!PyArg_ParseTupleAndKeywords(args, kwargs, "O&O|i:png_write", names, PyUnicode_FSConverter,
                                   &path, &object, &level))
    return NULL;
  PyArrayObject *array = image_array(object, "png_write", &channels, &bits);
  if (array == NULL) {
    Py_DECREF(path);
    return NULL;
  }
  const char *name = PyBytes_AsString(path);
  const int height = (int)PyArray_DIM(array, 0), width = (int)PyArray_DIM(array, 1);
  pl_status status;
  Py_BEGIN_ALLOW_THREADS status =
      pl_png_write(name, PyArray_DATA(array), width, height, channels, bits, level);
  Py_END_ALLOW_THREADS Py_DECREF((PyObject *)array);
  Py_DECREF(path);
  if (status != PL_OK)
    return pl_py_raise(status);
  Py_RETURN_NONE;
}

/* The file as a bytes object, and frees it; NULL with an exception. */
static PyObject *taken(pl_bytes *file, pl_status status) {
  PyObject *result =
      status == PL_OK ? PyBytes_FromStringAndSize((const char *)file->data, (Py_ssize_t)file->size)
                      : pl_py_raise(status);
  pl_bytes_clear(file);
  return result;
}

PyObject *pl_py_png_encode(PyObject *module, PyObject *args, PyObject *kwargs) {
  static char *names[] = {"array", "level", "palette", NULL};
  (void)module;
  PyObject *object, *colors = Py_None;
  int level = 6, channels, bits;
  if (!PyArg_ParseTupleAndKeywords(args, kwargs, "O|iO:png_encode", names, &object, &level,
                                   &colors))
    return NULL;
  PyArrayObject *array = image_array(object, "png_encode", &channels, &bits), *palette = NULL;
  const npy_intp rows[2] = {-1, 3};
  if (array != NULL && colors != Py_None)
    palette = pl_py_array(colors, "palette", NPY_UINT8, 2, rows);
  if (array == NULL || (colors != Py_None && palette == NULL)) {
    Py_XDECREF((PyObject *)array);
    return NULL;
  }
  const int height = (int)PyArray_DIM(array, 0), width = (int)PyArray_DIM(array, 1);
  const npy_intp count = palette != NULL ? PyArray_DIM(palette, 0) : 0;
  pl_bytes file = {0};
  pl_status status;
  Py_BEGIN_ALLOW_THREADS status = pl_png_encode(
      "png_encode", PyArray_DATA(array), width, height, channels, bits, level,
      palette != NULL ? PyArray_DATA(palette) : NULL, count > 256 ? 257 : (int)count, &file);
  Py_END_ALLOW_THREADS Py_DECREF((PyObject *)array);
  Py_XDECREF((PyObject *)palette);
  return taken(&file, status);
}

PyObject *pl_py_deflate(PyObject *module, PyObject *args) {
  PyObject *object;
  int zlib;
  const npy_intp any[1] = {-1};
  (void)module;
  if (!PyArg_ParseTuple(args, "Op:deflate", &object, &zlib))
    return NULL;
  PyArrayObject *array = pl_py_array(object, "array", NPY_UINT8, 1, any);
  if (array == NULL)
    return NULL;
  const pl_deflate_form form = zlib ? PL_DEFLATE_ZLIB : PL_DEFLATE_RAW;
  pl_bytes stream = {0};
  pl_status status;
  Py_BEGIN_ALLOW_THREADS status =
      pl_deflate(PyArray_DATA(array), (size_t)PyArray_DIM(array, 0), form, &stream);
  Py_END_ALLOW_THREADS Py_DECREF((PyObject *)array);
  return taken(&stream, status);
}

/* One channel from (name, array); a new reference to its array in *owner. -1 with an exception. */
static int exr_channel(PyObject *item, npy_intp shape[2], pl_exr_channel *out, PyObject **owner) {
  PyObject *object;
  if (!PyTuple_Check(item) || !PyArg_ParseTuple(item, "sO:exr_encode", &out->name, &object)) {
    if (!PyErr_Occurred())
      PyErr_SetString(PyExc_TypeError, "exr_encode: channels must be tuples (name, array)");
    return -1;
  }
  PyArrayObject *array = (PyArrayObject *)PyArray_FROM_OF(object, PL_IMAGE_FLAGS);
  *owner = (PyObject *)array;
  if (array == NULL)
    return -1;
  const int type = PyArray_TYPE(array);
  const int same =
      PyArray_NDIM(array) == 2 &&
      (shape[0] < 0 || (PyArray_DIM(array, 0) == shape[0] && PyArray_DIM(array, 1) == shape[1]));
  if (!same || (type != NPY_UINT32 && type != NPY_HALF && type != NPY_FLOAT)) {
    PyErr_Format(PyExc_ValueError,
                 "exr_encode: '%s' must be a uint32, float16 or float32 array of shape (H, W), the "
                 "same for all",
                 out->name);
    return -1;
  }
  shape[0] = PyArray_DIM(array, 0);
  shape[1] = PyArray_DIM(array, 1);
  out->type = type == NPY_UINT32 ? PL_EXR_UINT : type == NPY_HALF ? PL_EXR_HALF : PL_EXR_FLOAT;
  out->samples = PyArray_DATA(array);
  return 0;
}

PyObject *pl_py_exr_encode(PyObject *module, PyObject *args) {
  PyObject *list;
  pl_exr_text text = {"perilune", NULL};
  (void)module;
  if (!PyArg_ParseTuple(args, "O!s:exr_encode", &PyList_Type, &list, &text.value))
    return NULL;
  const Py_ssize_t count = PyList_Size(list);
  npy_intp shape[2] = {-1, -1};
  pl_exr_channel *channels = pl_alloc((size_t)count, sizeof *channels);
  PyObject **owners = pl_alloc((size_t)count, sizeof *owners), *result = NULL;
  int good = channels != NULL && owners != NULL;
  if (!good)
    PyErr_NoMemory();
  for (Py_ssize_t i = 0; good && i < count; i++)
    good = exr_channel(PyList_GetItem(list, i), shape, &channels[i], &owners[i]) == 0;
  if (good) {
    pl_bytes file = {0};
    pl_status status;
    Py_BEGIN_ALLOW_THREADS status =
        pl_exr_encode((int)shape[1], (int)shape[0], channels, (size_t)count, &text, 1, &file);
    Py_END_ALLOW_THREADS result = taken(&file, status);
  }
  for (Py_ssize_t i = 0; owners != NULL && i < count; i++)
    Py_XDECREF(owners[i]);
  pl_free(owners);
  pl_free(channels);
  return result;
}

/* The planes as a dict of arrays (height, width); NULL with an exception. */
static PyObject *planes_dict(const pl_exr_image *image) {
  static const int types[] = {
      [PL_EXR_UINT] = NPY_UINT32, [PL_EXR_HALF] = NPY_HALF, [PL_EXR_FLOAT] = NPY_FLOAT};
  const npy_intp shape[2] = {image->height, image->width};
  PyObject *result = PyDict_New();
  for (size_t i = 0; result != NULL && i < image->count; i++) {
    const pl_exr_plane *plane = &image->planes[i];
    PyObject *array = PyArray_SimpleNew(2, shape, types[plane->type]);
    if (array != NULL)
      memcpy(PyArray_DATA((PyArrayObject *)array), plane->samples,
             (size_t)PyArray_NBYTES((PyArrayObject *)array));
    if (array == NULL || PyDict_SetItemString(result, plane->name, array) != 0)
      Py_CLEAR(result);
    Py_XDECREF(array);
  }
  return result;
}

PyObject *pl_py_exr_decode(PyObject *module, PyObject *args) {
  const char *bytes, *name;
  Py_ssize_t size;
  pl_exr_image image;
  pl_status status;
  (void)module;
  if (!PyArg_ParseTuple(args, "y#s:exr_decode", &bytes, &size, &name))
    return NULL;
  Py_BEGIN_ALLOW_THREADS status = pl_exr_decode(bytes, (size_t)size, name, &image);
  Py_END_ALLOW_THREADS if (status != PL_OK) return pl_py_raise(status);
  PyObject *result = planes_dict(&image);
  pl_exr_image_clear(&image);
  return result;
}
