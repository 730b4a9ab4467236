/* Eclipses for Python: the fraction of sunlight that reaches points past bodies. */
#include "light/occultation.h"
#include "pyext/py_types.h"

enum { POINTS, SUN, POSES, RADII, WAVELENGTHS, ARRAYS };

/* Converts the arguments to arrays, or returns -1 with an exception; `shapes` gets their
 * dimensions. */
static int read_arrays(PyObject *const objects[ARRAYS], PyArrayObject *arrays[ARRAYS]) {
  static const char *const names[ARRAYS] = {"points", "sun", "poses", "radii", "wavelengths_um"};
  npy_intp times = -1, bodies = -1;
  for (int i = 0; i < ARRAYS; i++) {
    const npy_intp place[2] = {times, 3}, pose[3] = {times, -1, 7}, radii[2] = {bodies, 3};
    const npy_intp any[1] = {-1};
    arrays[i] = i == POSES         ? pl_py_array(objects[i], names[i], NPY_DOUBLE, 3, pose)
                : i == RADII       ? pl_py_array(objects[i], names[i], NPY_DOUBLE, 2, radii)
                : i == WAVELENGTHS ? pl_py_array(objects[i], names[i], NPY_DOUBLE, 1, any)
                                   : pl_py_array(objects[i], names[i], NPY_DOUBLE, 2, place);
    if (arrays[i] == NULL)
      return -1;
    times = i == POINTS ? PyArray_DIM(arrays[i], 0) : times;
    bodies = i == POSES ? PyArray_DIM(arrays[i], 1) : bodies;
  }
  return 0;
}

static PyObject *solve(PyArrayObject *const arrays[ARRAYS], double sun_radius, int nodes) {
  const npy_intp times = PyArray_DIM(arrays[POINTS], 0), bodies = PyArray_DIM(arrays[POSES], 1);
  const npy_intp bands = PyArray_DIM(arrays[WAVELENGTHS], 0);
  const npy_intp light[2] = {times, bands}, hidden[2] = {times, bodies};
  PyObject *fraction = PyArray_SimpleNew(2, light, NPY_DOUBLE);
  PyObject *hides = PyArray_SimpleNew(2, hidden, NPY_BOOL);
  pl_status status = PL_OK;
  if (fraction != NULL && hides != NULL) {
    const pl_occultation request = {
        .times = (size_t)times,
        .bodies = (size_t)bodies,
        .bands = (size_t)bands,
        .sun_radius_m = sun_radius,
        .points = PyArray_DATA(arrays[POINTS]),
        .sun_m = PyArray_DATA(arrays[SUN]),
        .poses = PyArray_DATA(arrays[POSES]),
        .radii_m = PyArray_DATA(arrays[RADII]),
        .wavelength_um = PyArray_DATA(arrays[WAVELENGTHS]),
        .nodes = nodes,
    };
    const pl_occultation_result out = {PyArray_DATA((PyArrayObject *)fraction),
                                       PyArray_DATA((PyArrayObject *)hides)};
    Py_BEGIN_ALLOW_THREADS status = pl_occultation_solve(&request, &out);
    Py_END_ALLOW_THREADS if (status != PL_OK) pl_py_raise(status);
  }
  if (fraction == NULL || hides == NULL || status != PL_OK) {
    Py_XDECREF(fraction);
    Py_XDECREF(hides);
    return NULL;
  }
  return Py_BuildValue("(NN)", fraction, hides);
}

PyObject *pl_py_sunlight(PyObject *module, PyObject *args, PyObject *kwargs) {
  static char *names[] = {"points",         "sun",   "sun_radius", "poses", "radii",
                          "wavelengths_um", "nodes", NULL};
  (void)module;
  PyObject *objects[ARRAYS];
  PyArrayObject *arrays[ARRAYS] = {NULL};
  double sun_radius = 0.0;
  int nodes = 16;
  if (!PyArg_ParseTupleAndKeywords(args, kwargs, "OOdOOO|i:sunlight", names, &objects[POINTS],
                                   &objects[SUN], &sun_radius, &objects[POSES], &objects[RADII],
                                   &objects[WAVELENGTHS], &nodes))
    return NULL;
  PyObject *result = read_arrays(objects, arrays) == 0 ? solve(arrays, sun_radius, nodes) : NULL;
  for (int i = 0; i < ARRAYS; i++)
    Py_XDECREF((PyObject *)arrays[i]);
  return result;
}
