/* The type RockScan: the shape of a measured rock. */
#include "pyext/py_types.h"
#include "terrain/rock_scan.h"

typedef struct scan_object {
  PyObject_HEAD pl_rock_scan scan;
} scan_object;

static void scan_dealloc(PyObject *self) {
  PyTypeObject *type = Py_TYPE(self);
  pl_rock_scan_clear(&((scan_object *)self)->scan);
  ((freefunc)PyType_GetSlot(type, Py_tp_free))(self);
  Py_DECREF(type);
}

const pl_rock_scan *pl_py_rock_scan_of(PyObject *object) {
  if (!pl_py_is(object, (void *)scan_dealloc)) {
    PyErr_SetString(PyExc_TypeError, "models of rocks must be of perilune._core.RockScan");
    return NULL;
  }
  return &((scan_object *)object)->scan;
}

static pl_status measure(PyArrayObject *positions, PyArrayObject *triangles, pl_rock_scan *out) {
  const pl_rock_model model = {.positions = PyArray_DATA(positions),
                               .vertex_count = (size_t)PyArray_DIM(positions, 0),
                               .triangles = PyArray_DATA(triangles),
                               .triangle_count = (size_t)PyArray_DIM(triangles, 0)};
  pl_status status;
  Py_BEGIN_ALLOW_THREADS status = pl_rock_scan_create(&model, out);
  Py_END_ALLOW_THREADS return status;
}

static PyObject *scan_new(PyTypeObject *type, PyObject *args, PyObject *kwargs) {
  static char *names[] = {"positions", "triangles", NULL};
  const npy_intp shape[2] = {-1, 3};
  PyObject *given, *corners;
  if (!PyArg_ParseTupleAndKeywords(args, kwargs, "OO:RockScan", names, &given, &corners))
    return NULL;
  PyArrayObject *positions = pl_py_array(given, "positions", NPY_DOUBLE, 2, shape);
  PyArrayObject *triangles =
      positions != NULL ? pl_py_array(corners, "triangles", NPY_UINT32, 2, shape) : NULL;
  scan_object *self = NULL;
  if (triangles != NULL)
    self = (scan_object *)((allocfunc)PyType_GetSlot(type, Py_tp_alloc))(type, 0);
  const pl_status status = self != NULL ? measure(positions, triangles, &self->scan) : PL_OK;
  Py_XDECREF((PyObject *)positions);
  Py_XDECREF((PyObject *)triangles);
  if (status == PL_OK)
    return (PyObject *)self;
  Py_DECREF((PyObject *)self);
  return pl_py_raise(status);
}

static PyObject *get_folded(PyObject *self, void *closure) {
  (void)closure;
  return PyFloat_FromDouble(((scan_object *)self)->scan.folded);
}

static PyObject *radii(PyObject *self, PyObject *object) {
  const npy_intp shape[2] = {-1, 3};
  PyArrayObject *directions = pl_py_array(object, "directions", NPY_DOUBLE, 2, shape);
  if (directions == NULL)
    return NULL;
  npy_intp count = PyArray_DIM(directions, 0);
  PyObject *out = PyArray_SimpleNew(1, &count, NPY_DOUBLE);
  const pl_vec3 *d = PyArray_DATA(directions);
  for (npy_intp k = 0; out != NULL && k < count; k++)
    ((double *)PyArray_DATA((PyArrayObject *)out))[k] =
        pl_rock_scan_radius(&((scan_object *)self)->scan, pl_vec3_unit(d[k]));
  Py_DECREF((PyObject *)directions);
  return out;
}

static PyMethodDef scan_methods[] = {
    {"radii", radii, METH_O, "radii($self, directions, /)\n--\n\n(n,) distances of the surface."},
    {NULL, NULL, 0, NULL},
};

static PyGetSetDef scan_getset[] = {
    {"folded", get_folded, NULL, "Fraction of directions in which overhangs were filled.", NULL},
    {NULL, NULL, NULL, NULL, NULL},
};

static PyType_Slot scan_slots[] = {
    {Py_tp_doc, "RockScan(positions, triangles)\n--\n\nThe shape of a measured rock."},
    {Py_tp_new, (void *)scan_new},
    {Py_tp_dealloc, (void *)scan_dealloc},
    {Py_tp_methods, scan_methods},
    {Py_tp_getset, scan_getset},
    {0, NULL},
};

PyType_Spec pl_py_rock_scan_spec = {"perilune._core.RockScan", sizeof(scan_object), 0,
                                    Py_TPFLAGS_DEFAULT, scan_slots};
