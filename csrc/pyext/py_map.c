/* The type Map: a filtered image texture. */
#include "pyext/py_types.h"

#include <math.h>
#include <string.h>

#include "geom/image_levels.h"
#include "geom/texture.h"
#include "io/image_file.h"

typedef struct map_object {
  PyObject_HEAD pl_texture *texture; /* owned */
} map_object;

static void map_dealloc(PyObject *self) {
  PyTypeObject *type = Py_TYPE(self);
  pl_texture_destroy(((map_object *)self)->texture);
  ((freefunc)PyType_GetSlot(type, Py_tp_free))(self);
  Py_DECREF(type);
}

const pl_texture *pl_py_map_of(PyObject *object) {
  if (!pl_py_is(object, (void *)map_dealloc)) {
    PyErr_SetString(PyExc_TypeError, "map must be a perilune._core.Map");
    return NULL;
  }
  return ((map_object *)object)->texture;
}

/* How the texels of a map are interpreted, and how they are changed before filtering. */
typedef struct map_options {
  int srgb, water;
  float black; /* NAN: the black level found by pl_image_find_black */
  pl_wrap wrap_u, wrap_v;
} map_options;

/* Takes ownership of the image. */
static pl_status filter(pl_image *image, const map_options *options, pl_texture **out) {
  float black[3] = {options->black, options->black, options->black};
  if (isnan(options->black))
    pl_image_find_black(image, black);
  if (options->black != 0.0f)
    pl_image_raise_black(image, black);
  const pl_status status = options->water ? pl_image_to_water(image) : PL_OK;
  if (status != PL_OK) {
    pl_image_clear(image);
    return status;
  }
  return pl_texture_create(image, options->srgb && !options->water, options->wrap_u,
                           options->wrap_v, out);
}

static pl_status load(const char *path, const map_options *options, pl_texture **out) {
  pl_image image;
  PL_TRY(pl_image_load(path, &image));
  return filter(&image, options, out);
}

static pl_status of_texels(PyArrayObject *array, const map_options *options, pl_texture **out) {
  const npy_intp *shape = PyArray_DIMS(array);
  pl_image image;
  PL_TRY(pl_image_init((int)shape[1], (int)shape[0], (int)shape[2], &image));
  memcpy(image.texels, PyArray_DATA(array), (size_t)(shape[0] * shape[1] * shape[2]));
  return filter(&image, options, out);
}

static pl_status of_numbers(PyArrayObject *array, const map_options *options, pl_texture **out) {
  const npy_intp *shape = PyArray_DIMS(array);
  const float *numbers = PyArray_DATA(array);
  if (options->black != 0.0f || options->water)
    return pl_fail(PL_E_ARGUMENT, "black and water are of maps of 8 bits");
  for (npy_intp i = 0; i < shape[0] * shape[1]; i++)
    if (!isfinite(numbers[i]))
      return pl_fail(PL_E_RANGE, "the numbers of a map must be finite");
  return pl_texture_of_numbers(numbers, (int)shape[1], (int)shape[0], options->wrap_u,
                               options->wrap_v, out);
}

/* Largest side of an array, texels; beyond it the size would overflow. */
enum { MAX_SIDE = 65536 };

/* Creates a texture from an array of uint8 texels or float32 numbers; returns -1 with an
 * exception. */
static int from_array(PyObject *object, const map_options *options, pl_texture **out) {
  const bool texels = PyArray_TYPE((PyArrayObject *)object) == NPY_UINT8;
  const npy_intp any[3] = {-1, -1, -1};
  PyArrayObject *array = texels ? pl_py_array(object, "texels", NPY_UINT8, 3, any)
                                : pl_py_array(object, "numbers", NPY_FLOAT, 2, any);
  if (array == NULL)
    return -1;
  pl_status status = PL_OK;
  for (int k = 0; k < PyArray_NDIM(array) && status == PL_OK; k++)
    if (PyArray_DIM(array, k) < 1 || PyArray_DIM(array, k) > MAX_SIDE)
      status = pl_fail(PL_E_RANGE, "the sides of a map must be in 1..%d", MAX_SIDE);
  if (status == PL_OK) {
    Py_BEGIN_ALLOW_THREADS status =
        texels ? of_texels(array, options, out) : of_numbers(array, options, out);
    Py_END_ALLOW_THREADS
  }
  Py_DECREF((PyObject *)array);
  if (status == PL_OK)
    return 0;
  pl_py_raise(status);
  return -1;
}

static int from_file(PyObject *object, const map_options *options, pl_texture **out) {
  PyObject *bytes = NULL;
  if (!PyUnicode_FSConverter(object, &bytes))
    return -1;
  pl_status status;
  const char *path = PyBytes_AsString(bytes);
  Py_BEGIN_ALLOW_THREADS status = load(path, options, out);
  Py_END_ALLOW_THREADS Py_DECREF(bytes);
  if (status == PL_OK)
    return 0;
  pl_py_raise(status);
  return -1;
}

/* Converter for PyArg_Parse: a wrap mode by name. */
static int convert_wrap(PyObject *object, void *out) {
  static const char *const names[] = {"repeat", "clamp", "mirror"};
  const pl_wrap modes[] = {PL_WRAP_REPEAT, PL_WRAP_CLAMP, PL_WRAP_MIRROR};
  for (size_t i = 0; PyUnicode_Check(object) && i < 3; i++)
    if (PyUnicode_CompareWithASCIIString(object, names[i]) == 0) {
      *(pl_wrap *)out = modes[i];
      return 1;
    }
  PyErr_SetString(PyExc_ValueError, "a wrap mode is 'repeat', 'clamp' or 'mirror'");
  return 0;
}

/* Converter for PyArg_Parse: None becomes NAN. */
static int convert_black(PyObject *object, void *out) {
  const double black = object == Py_None ? NAN : PyFloat_AsDouble(object);
  if (PyErr_Occurred())
    return 0;
  if (object != Py_None && !(black >= 0.0 && black < 1.0)) {
    PyErr_SetString(PyExc_ValueError, "black must be at least 0 and below 1, or None");
    return 0;
  }
  *(float *)out = (float)black;
  return 1;
}

static PyObject *map_new(PyTypeObject *type, PyObject *args, PyObject *kwargs) {
  static char *names[] = {"source", "srgb", "wrap_u", "wrap_v", "black", "water", NULL};
  PyObject *source;
  map_options options = {.srgb = 1, .wrap_u = PL_WRAP_REPEAT, .wrap_v = PL_WRAP_CLAMP};
  if (!PyArg_ParseTupleAndKeywords(args, kwargs, "O|pO&O&O&p:Map", names, &source, &options.srgb,
                                   convert_wrap, &options.wrap_u, convert_wrap, &options.wrap_v,
                                   convert_black, &options.black, &options.water))
    return NULL;
  map_object *self = (map_object *)((allocfunc)PyType_GetSlot(type, Py_tp_alloc))(type, 0);
  if (self == NULL)
    return NULL;
  if ((PyArray_Check(source) ? from_array : from_file)(source, &options, &self->texture) != 0) {
    Py_DECREF(self);
    return NULL;
  }
  return (PyObject *)self;
}

static PyObject *get_size(PyObject *self, void *closure) {
  (void)closure;
  int width, height, channels;
  pl_texture_size(((map_object *)self)->texture, &width, &height, &channels);
  return Py_BuildValue("(ii)", width, height);
}

static PyObject *get_nbytes(PyObject *self, void *closure) {
  (void)closure;
  return PyLong_FromSize_t(pl_texture_bytes(((map_object *)self)->texture));
}

static PyObject *get_mean(PyObject *self, void *closure) {
  (void)closure;
  npy_intp shape[1] = {4};
  float mean[4];
  PyObject *array = PyArray_SimpleNew(1, shape, NPY_DOUBLE);
  if (array == NULL)
    return NULL;
  pl_texture_mean(((map_object *)self)->texture, mean);
  for (int k = 0; k < 4; k++)
    ((double *)PyArray_DATA((PyArrayObject *)array))[k] = mean[k];
  return array;
}

/* Largest number of rows that the mean of a column samples. */
enum { COLUMN_ROWS = 64 };

static void column_mean(const pl_texture *texture, int column, double out[4]) {
  const float none[2] = {0.0f, 0.0f};
  int width, height, channels;
  pl_texture_size(texture, &width, &height, &channels);
  const int rows = height < COLUMN_ROWS ? height : COLUMN_ROWS;
  for (int k = 0; k < 4; k++)
    out[k] = 0.0;
  for (int i = 0; i < rows; i++) {
    float texel[4];
    const int row = (int)((int64_t)height * (2 * i + 1) / (2 * rows));
    pl_texture_sample(texture, ((float)column + 0.5f) / (float)width,
                      ((float)row + 0.5f) / (float)height, none, none, PL_FILTER_NONE, texel);
    for (int k = 0; k < 4; k++)
      out[k] += (double)texel[k] / rows;
  }
}

static PyObject *map_columns(PyObject *self, PyObject *none) {
  (void)none;
  const pl_texture *texture = ((map_object *)self)->texture;
  int width, height, channels;
  pl_texture_size(texture, &width, &height, &channels);
  npy_intp shape[2] = {width, 4};
  PyObject *array = PyArray_SimpleNew(2, shape, NPY_DOUBLE);
  for (int i = 0; array != NULL && i < width; i++)
    column_mean(texture, i, (double *)PyArray_DATA((PyArrayObject *)array) + 4 * i);
  return array;
}

static PyMethodDef map_methods[] = {
    {"columns", map_columns, METH_NOARGS, "(width, 4) mean linear RGBA of each column."},
    {NULL, NULL, 0, NULL},
};

static PyGetSetDef map_getset[] = {
    {"size", get_size, NULL, "(width, height), texels.", NULL},
    {"mean", get_mean, NULL, "(4,) mean linear RGBA.", NULL},
    {"nbytes", get_nbytes, NULL, "Memory of its texels at all levels.", NULL},
    {NULL, NULL, NULL, NULL, NULL},
};

static PyType_Slot map_slots[] = {
    {Py_tp_doc, "Map(source, srgb=True, wrap_u='repeat', wrap_v='clamp', black=0.0, "
                "water=False)\n--\n\nA filtered image "
                "texture: a PNG, JPEG or WebP file, uint8 texels or float32 numbers."},
    {Py_tp_new, (void *)map_new},
    {Py_tp_dealloc, (void *)map_dealloc},
    {Py_tp_getset, map_getset},
    {Py_tp_methods, map_methods},
    {0, NULL},
};

PyType_Spec pl_py_map_spec = {"perilune._core.Map", sizeof(map_object), 0, Py_TPFLAGS_DEFAULT,
                              map_slots};
