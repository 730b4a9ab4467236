/* The type Grid: a grid of numbers over a whole body. */
#include "pyext/py_types.h"

#include "geom/grid.h"

typedef struct grid_object {
  PyObject_HEAD pl_grid *grid; /* owned */
} grid_object;

static void grid_dealloc(PyObject *self) {
  PyTypeObject *type = Py_TYPE(self);
  pl_grid_destroy(((grid_object *)self)->grid);
  ((freefunc)PyType_GetSlot(type, Py_tp_free))(self);
  Py_DECREF(type);
}

const pl_grid *pl_py_grid_of(PyObject *object) {
  if (!pl_py_is(object, (void *)grid_dealloc)) {
    PyErr_SetString(PyExc_TypeError, "regolith_map must be a perilune._core.Grid");
    return NULL;
  }
  return ((grid_object *)object)->grid;
}

static PyObject *grid_new(PyTypeObject *type, PyObject *args, PyObject *kwargs) {
  static char *names[] = {"values", "west_rad", "north_rad", "south_rad", NULL};
  const npy_intp any[3] = {-1, -1, -1};
  PyObject *values;
  pl_grid_frame frame;
  if (!PyArg_ParseTupleAndKeywords(args, kwargs, "Oddd:Grid", names, &values, &frame.west_rad,
                                   &frame.north_rad, &frame.south_rad))
    return NULL;
  PyArrayObject *array = pl_py_array(values, "values", NPY_FLOAT, 3, any);
  if (array == NULL)
    return NULL;
  for (int k = 0; k < 3; k++)
    if (PyArray_DIM(array, k) > INT_MAX) {
      Py_DECREF((PyObject *)array);
      return pl_py_raise(pl_fail(PL_E_RANGE, "a grid with a side above %d", INT_MAX));
    }
  frame.height = (int)PyArray_DIM(array, 0);
  frame.width = (int)PyArray_DIM(array, 1);
  frame.channels = (int)PyArray_DIM(array, 2);
  grid_object *self = (grid_object *)((allocfunc)PyType_GetSlot(type, Py_tp_alloc))(type, 0);
  const pl_status status =
      self != NULL ? pl_grid_create(&frame, PyArray_DATA(array), &self->grid) : PL_OK;
  Py_DECREF((PyObject *)array);
  if (self != NULL && status != PL_OK) {
    Py_DECREF(self);
    return pl_py_raise(status);
  }
  return (PyObject *)self;
}

static PyObject *get_mean(PyObject *self, void *closure) {
  (void)closure;
  const pl_grid *grid = ((grid_object *)self)->grid;
  npy_intp shape[1] = {pl_grid_frame_of(grid)->channels};
  PyObject *array = PyArray_SimpleNew(1, shape, NPY_DOUBLE);
  for (npy_intp k = 0; array != NULL && k < shape[0]; k++)
    ((double *)PyArray_DATA((PyArrayObject *)array))[k] = (double)pl_grid_mean(grid)[k];
  return array;
}

static PyGetSetDef grid_getset[] = {
    {"mean", get_mean, NULL, "(channels,) mean of all cells.", NULL},
    {NULL, NULL, NULL, NULL, NULL},
};

static PyType_Slot grid_slots[] = {
    {Py_tp_doc, "Grid(values, west_rad, north_rad, south_rad)\n--\n\nNumbers over a whole body."},
    {Py_tp_new, (void *)grid_new},
    {Py_tp_dealloc, (void *)grid_dealloc},
    {Py_tp_getset, grid_getset},
    {0, NULL},
};

PyType_Spec pl_py_grid_spec = {"perilune._core.Grid", sizeof(grid_object), 0, Py_TPFLAGS_DEFAULT,
                               grid_slots};
