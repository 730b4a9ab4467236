/* Output arrays: channels by name, and their description for Python. */
#include "pyext/py_request.h"
#include "pyext/py_types.h"

#include <string.h>

/* Number of components: equal to the camera's number of bands; -1, -3 and -4 are of label channels.
 */
#define PL_PY_BANDS (-2)

/* Radiometric channels; all others are in the table of label channels. */
static const struct {
  const char *name, *dtype;
  int components;
  const char *unit, *doc;
} colour_channels[] = {
    {"rgb", "uint8", 3, "DN", "clean, display-encoded (sRGB)"},
    {"radiance", "float32", 3, "W m-2 sr-1",
     "before the sensor; each colour as if all of the sun's spectrum were reflected like it"},
    {"bands", "float32", PL_PY_BANDS, "W m-2 sr-1", "clean, in each band of the camera"},
    {"raw", "uint16", 0, "DN", "the sensor's digital numbers, under its mosaic of filters"},
    {"sensor_rgb", "uint8", 3, "DN", "the sensor's picture, display-encoded (sRGB)"},
    {"glare", "float32", 0, "1",
     "light that the lens brought to a pixel of the sensor from elsewhere (ghosts, point-spread "
     "function), over the light that fills a pixel"},
};
enum { COLOUR_CHANNELS = sizeof colour_channels / sizeof colour_channels[0] };

static int type_number(const char *dtype) {
  static const struct {
    const char *name;
    int number;
  } types[] = {{"uint8", NPY_UINT8}, {"uint16", NPY_UINT16},   {"int32", NPY_INT32},
               {"int64", NPY_INT64}, {"float32", NPY_FLOAT32}, {"float64", NPY_FLOAT64}};
  for (size_t i = 0; i < sizeof types / sizeof types[0]; i++)
    if (strcmp(types[i].name, dtype) == 0)
      return types[i].number;
  return NPY_NOTYPE;
}

/* Returns the array's data if it is writable, C-contiguous and of exactly this type and shape. */
static void *checked_data(PyObject *object, const char *name, int type, int nd,
                          const npy_intp *shape) {
  if (!PyArray_Check(object)) {
    PyErr_Format(PyExc_TypeError, "out['%s'] must be a NumPy array", name);
    return NULL;
  }
  PyArrayObject *array = (PyArrayObject *)object;
  int fits = PyArray_TYPE(array) == type && PyArray_NDIM(array) == nd && PyArray_ISCARRAY(array);
  for (int i = 0; fits && i < nd; i++)
    fits = PyArray_DIM(array, i) == shape[i];
  if (!fits) {
    PyErr_Format(
        PyExc_ValueError,
        "out['%s'] must be writable, C-contiguous and of the type and shape of the channel", name);
    return NULL;
  }
  return PyArray_DATA(array);
}

/* `many` is the number of components (levels or bands) where the table has none. */
static void *channel_data(PyObject *object, const char *name, const char *dtype, int components,
                          int many, const pl_camera *camera) {
  const npy_intp shape[3] = {camera->height, camera->width, components < 0 ? many : components};
  return checked_data(object, name, type_number(dtype), components == 0 ? 2 : 3, shape);
}

/* Rows of `size` bytes; `type`: their name in perilune._core. */
static void *row_data(PyObject *object, const char *name, size_t count, size_t size,
                      const char *type) {
  if (!PyArray_Check(object)) {
    PyErr_Format(PyExc_TypeError, "out['%s'] must be a NumPy array", name);
    return NULL;
  }
  PyArrayObject *array = (PyArrayObject *)object;
  /* Any dtype of this size is accepted, except those with references to Python objects. */
  if (PyArray_TYPE(array) != NPY_VOID || PyDataType_REFCHK(PyArray_DESCR(array)) ||
      PyArray_NDIM(array) != 1 || PyArray_DIM(array, 0) != (npy_intp)count ||
      !PyArray_ISCARRAY(array) || PyArray_NBYTES(array) != (npy_intp)(count * size)) {
    PyErr_Format(PyExc_ValueError, "out['%s'] must be (%zu,) of %s", name, count, type);
    return NULL;
  }
  return PyArray_DATA(array);
}

static void *mask_data(PyObject *object, size_t count, const pl_camera *camera) {
  const npy_intp shape[3] = {(npy_intp)count, camera->height, camera->width};
  return checked_data(object, "masks", NPY_UINT8, 3, shape);
}

/* In the order of colour_channels. */
static int set_colour(size_t channel, void *data, pl_frame_request *request) {
  switch (channel) {
  case 0:
    request->rgb = data;
    break;
  case 1:
    request->radiance = data;
    break;
  case 2:
    request->bands = data;
    break;
  case 3:
    request->raw = data;
    break;
  case 4:
    request->sensor_rgb = data;
    break;
  default:
    request->glare = data;
  }
  return data != NULL ? 0 : -1;
}

/* Returns the number of components of a radiometric channel; `raw` of a sensor with planes has one
 * per plane. */
static int components_of(size_t channel, const pl_frame_request *request) {
  const bool planes = strcmp(colour_channels[channel].name, "raw") == 0 && request->sensor != NULL;
  if (planes && request->sensor->plane_count > 0)
    return (int)request->sensor->plane_count;
  return colour_channels[channel].components;
}

static int set_output(const char *name, PyObject *array, const pl_scene *scene,
                      pl_frame_request *request) {
  const pl_camera *camera = &request->placement.camera;
  if (strcmp(name, "objects") == 0) {
    request->objects =
        row_data(array, name, pl_scene_label_count(scene), sizeof(pl_object_label), "OBJECT_LABEL");
    return request->objects != NULL ? 0 : -1;
  }
  if (strcmp(name, "keypoints") == 0) {
    request->keypoint_labels =
        row_data(array, name, request->keypoint_count, sizeof(pl_keypoint_label), "KEYPOINT_LABEL");
    return request->keypoint_labels != NULL ? 0 : -1;
  }
  if (strcmp(name, "part_groups") == 0) {
    request->group_labels =
        row_data(array, name, request->group_count, sizeof(pl_object_label), "OBJECT_LABEL");
    return request->group_labels != NULL ? 0 : -1;
  }
  if (strcmp(name, "masks") == 0)
    return (request->masks = mask_data(array, pl_scene_label_count(scene), camera)) != NULL ? 0
                                                                                            : -1;
  for (size_t i = 0; i < COLOUR_CHANNELS; i++)
    if (strcmp(colour_channels[i].name, name) == 0)
      return set_colour(i,
                        channel_data(array, name, colour_channels[i].dtype,
                                     components_of(i, request), request->band_count, camera),
                        request);
  for (size_t i = 0; i < pl_channel_count; i++) {
    const pl_channel *channel = &pl_channels[i];
    if (strcmp(channel->name, name) != 0)
      continue;
    const int many = channel->components == PL_COMPONENTS_BASELINES ? request->ground.baseline_count
                     : channel->components == PL_COMPONENTS_LAYERS  ? request->coverage.layers
                                                                    : scene->levels;
    request->channels[i] =
        channel_data(array, name, channel->dtype, channel->components, many, camera);
    return request->channels[i] != NULL ? 0 : -1;
  }
  PyErr_Format(PyExc_ValueError, "unknown channel '%s'; see perilune._core.CHANNELS", name);
  return -1;
}

static int take_pair(PyObject *pair, const pl_scene *scene, PyObject *kept,
                     pl_frame_request *request) {
  if (!PyTuple_Check(pair) || PyTuple_Size(pair) != 2 ||
      !PyUnicode_Check(PyTuple_GetItem(pair, 0))) {
    PyErr_SetString(PyExc_TypeError, "out must map names of channels to NumPy arrays");
    return -1;
  }
  PyObject *array = PyTuple_GetItem(pair, 1);
  const char *name = PyUnicode_AsUTF8AndSize(PyTuple_GetItem(pair, 0), NULL);
  if (name == NULL || pl_py_keep_memory(kept, array) < 0)
    return -1;
  return set_output(name, array, scene, request);
}

int pl_py_request_outputs(PyObject *out, const pl_scene *scene, PyObject *kept,
                          pl_frame_request *request) {
  PyObject *items = PyMapping_Items(out);
  const Py_ssize_t count = items != NULL ? PyList_Size(items) : -1;
  int failed = count < 0;
  for (Py_ssize_t i = 0; !failed && i < count; i++)
    failed = take_pair(PyList_GetItem(items, i), scene, kept, request) < 0;
  Py_XDECREF(items);
  return failed ? -1 : 0;
}

static PyObject *channel_entry(const char *name, const char *dtype, int components,
                               const char *unit, const char *doc, bool colour) {
  return Py_BuildValue("{s:s,s:s,s:i,s:s,s:s,s:O}", "name", name, "dtype", dtype, "components",
                       components, "unit", unit, "doc", doc, "colour", colour ? Py_True : Py_False);
}

PyObject *pl_py_channels(void) {
  PyObject *tuple = PyTuple_New((Py_ssize_t)(COLOUR_CHANNELS + pl_channel_count));
  for (size_t i = 0; tuple != NULL && i < COLOUR_CHANNELS + pl_channel_count; i++) {
    PyObject *entry;
    if (i < COLOUR_CHANNELS) {
      entry = channel_entry(colour_channels[i].name, colour_channels[i].dtype,
                            colour_channels[i].components, colour_channels[i].unit,
                            colour_channels[i].doc, true);
    } else {
      const pl_channel *c = &pl_channels[i - COLOUR_CHANNELS];
      entry = channel_entry(c->name, c->dtype, c->components, c->unit, c->doc, false);
    }
    if (entry == NULL)
      Py_CLEAR(tuple);
    else
      PyTuple_SetItem(tuple, (Py_ssize_t)i, entry);
  }
  return tuple;
}

PyObject *pl_py_object_label(void) {
  /* The struct has no padding, so the compiler's layout equals NumPy's packed layout. */
  _Static_assert(sizeof(pl_object_label) == 13 * 8 + 14 * 4, "pl_object_label has padding");
  return Py_BuildValue("[(ss(ii)),(ss(i)),(ss),(ss),(ss),(ss(i)),(ss(i)),(ss),(ss),(ss),(ss)]",
                       "R_m2c", "<f8", 3, 3, "t_m2c", "<f8", 3, "visib_fract", "<f8", "instance_id",
                       "<i4", "obj_id", "<i4", "bbox_visib", "<i4", 4, "bbox_obj", "<i4", 4,
                       "px_count_visib", "<i4", "px_count_all", "<i4", "px_count_valid", "<i4",
                       "in_view", "<i4");
}
