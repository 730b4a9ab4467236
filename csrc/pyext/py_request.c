/* Parses the request dictionary. */
#include "pyext/py_request.h"

#include <string.h>

#include "base/memory.h"
#include "frame/effects.h"
#include "pyext/py_camera.h"
#include "pyext/py_ground.h"
#include "pyext/py_read.h"
#include "pyext/py_sky.h"
#include "pyext/py_types.h"

/* Returns a new reference to the value of a key; NULL, without an exception, when it is absent. A
 * borrowed reference would be unsafe: reading a value may run code that removes it from its
 * dictionary. */
static PyObject *maybe(PyObject *dict, const char *key) {
  return Py_XNewRef(PyDict_GetItemString(dict, key));
}

/* As maybe, but a missing key is a KeyError that names it. */
static PyObject *item(PyObject *dict, const char *key) {
  PyObject *value = maybe(dict, key);
  if (value == NULL && !PyErr_Occurred())
    PyErr_Format(PyExc_KeyError, "the request lacks '%s'", key);
  return value;
}

static int get_double(PyObject *dict, const char *key, double *out) {
  PyObject *value = item(dict, key);
  if (value == NULL)
    return -1;
  *out = PyFloat_AsDouble(value);
  Py_DECREF(value);
  return *out == -1.0 && PyErr_Occurred() ? -1 : 0;
}

static int get_int(PyObject *dict, const char *key, int *out) {
  PyObject *value = item(dict, key);
  if (value == NULL)
    return -1;
  const long number = PyLong_AsLong(value);
  Py_DECREF(value);
  if (number == -1 && PyErr_Occurred())
    return -1;
  if (number < INT_MIN || number > INT_MAX) {
    PyErr_Format(PyExc_ValueError, "%s: %ld does not fit", key, number);
    return -1;
  }
  *out = (int)number;
  return 0;
}

static int get_u64(PyObject *dict, const char *key, uint64_t *out) {
  PyObject *value = item(dict, key);
  if (value == NULL)
    return -1;
  PyObject *number = PyNumber_Index(value);
  Py_DECREF(value);
  if (number == NULL)
    return -1;
  *out = PyLong_AsUnsignedLongLong(number);
  Py_DECREF(number);
  return PyErr_Occurred() ? -1 : 0;
}

static PyArrayObject *get_array(PyObject *dict, const char *key, int nd, const npy_intp *shape) {
  PyObject *value = item(dict, key);
  PyArrayObject *array = value != NULL ? pl_py_array(value, key, NPY_DOUBLE, nd, shape) : NULL;
  Py_XDECREF(value);
  return array;
}

static pl_pose pose_from(const double *p) {
  return (pl_pose){{p[0], p[1], p[2]}, {p[3], p[4], p[5], p[6]}};
}

static pl_motion motion_from(const double *p) {
  return (pl_motion){.open = pose_from(p), .close = pose_from(p + 7)};
}

static int parse_camera(PyObject *dict, pl_camera *camera) {
  const npy_intp shape[2] = {2, 7};
  if (get_int(dict, "width", &camera->width) < 0 || get_int(dict, "height", &camera->height) < 0)
    return -1;
  PyObject *k = item(dict, "K"), *lens = maybe(dict, "lens"), *focus = maybe(dict, "focus");
  const int failed = k == NULL || pl_py_camera_optics(k, lens, camera) < 0 ||
                     pl_py_camera_focus(focus, camera) < 0;
  Py_XDECREF(k);
  Py_XDECREF(lens);
  Py_XDECREF(focus);
  if (failed)
    return -1;
  PyArrayObject *pose = get_array(dict, "camera_pose", 2, shape);
  if (pose == NULL)
    return -1;
  camera->motion = motion_from(PyArray_DATA(pose));
  Py_DECREF((PyObject *)pose);
  return 0;
}

static int parse_objects(PyObject *dict, size_t count, pl_object_state *out) {
  const npy_intp shape[3] = {(npy_intp)count, 2, 7};
  PyArrayObject *poses = get_array(dict, "object_poses", 3, shape);
  PyArrayObject *scale = poses != NULL ? get_array(dict, "object_scale", 1, shape) : NULL;
  for (size_t i = 0; scale != NULL && i < count; i++)
    out[i] = (pl_object_state){.motion = motion_from((const double *)PyArray_DATA(poses) + 14 * i),
                               .scale = ((const double *)PyArray_DATA(scale))[i]};
  Py_XDECREF((PyObject *)poses);
  Py_XDECREF((PyObject *)scale);
  return scale != NULL ? 0 : -1;
}

/* "object_movers" (nodes, 3, 4): optional when no object is articulated. */
static int parse_movers(PyObject *dict, const pl_scene *scene, pl_py_states *states) {
  const npy_intp shape[3] = {(npy_intp)states->mover_count, 3, 4};
  if (states->mover_count == 0)
    return 0;
  PyArrayObject *array = get_array(dict, "object_movers", 3, shape);
  if (array == NULL)
    return -1;
  const double *m = PyArray_DATA(array);
  for (size_t i = 0; i < states->mover_count; i++, m += 12)
    states->movers[i] = (pl_affine){{{{m[0], m[1], m[2]}, {m[4], m[5], m[6]}, {m[8], m[9], m[10]}}},
                                    {m[3], m[7], m[11]}};
  Py_DECREF((PyObject *)array);
  const pl_affine *next = states->movers;
  for (size_t i = 0; i < scene->craft_count; i++) {
    states->objects[i].movers = next;
    next += pl_object_mover_count(&scene->objects[i]);
  }
  return 0;
}

static size_t parameter_count(const pl_scene *scene) {
  size_t count = 0;
  for (size_t i = 0; i < scene->craft_count; i++)
    count += pl_object_parameter_count(&scene->objects[i]);
  for (size_t i = 0; i < scene->body_count; i++)
    count += pl_body_parameter_count(&scene->bodies[i]);
  return count;
}

/* "graph_parameters" (values, 3): optional when no material has parameters. */
static int parse_parameters(PyObject *dict, const pl_scene *scene, pl_py_states *states) {
  const size_t count = parameter_count(scene);
  const npy_intp shape[2] = {(npy_intp)count, 3};
  if (count == 0)
    return 0;
  if (count > states->parameter_room) {
    pl_value *grown = pl_realloc(states->parameters, count, sizeof *grown);
    if (grown == NULL)
      return PyErr_NoMemory(), -1;
    states->parameters = grown;
    states->parameter_room = count;
  }
  PyArrayObject *array = get_array(dict, "graph_parameters", 2, shape);
  if (array == NULL)
    return -1;
  const double *from = PyArray_DATA(array);
  for (size_t i = 0; i < count; i++)
    for (size_t k = 0; k < 4; k++)
      states->parameters[i][k] = k < 3 ? (float)from[3 * i + k] : 0.0f;
  Py_DECREF((PyObject *)array);
  const pl_value *next = (const pl_value *)states->parameters;
  for (size_t i = 0; i < scene->craft_count; i++) {
    states->objects[i].parameters = next;
    next += pl_object_parameter_count(&scene->objects[i]);
  }
  for (size_t i = 0; i < scene->body_count; i++) {
    states->bodies[i].parameters = next;
    next += pl_body_parameter_count(&scene->bodies[i]);
  }
  return 0;
}

static int parse_bodies(PyObject *dict, size_t count, pl_body_state *out) {
  const npy_intp poses[3] = {(npy_intp)count, 2, 7}, three[2] = {(npy_intp)count, 3};
  PyArrayObject *a[4] = {NULL, NULL, NULL, NULL};
  const int ok = (a[0] = get_array(dict, "body_poses", 3, poses)) != NULL &&
                 (a[1] = get_array(dict, "body_radii", 2, three)) != NULL &&
                 (a[2] = get_array(dict, "body_albedo", 2, three)) != NULL &&
                 (a[3] = get_array(dict, "body_emission", 2, three)) != NULL;
  for (size_t i = 0; ok && i < count; i++) {
    const double *radii = (const double *)PyArray_DATA(a[1]) + 3 * i;
    out[i].motion = motion_from((const double *)PyArray_DATA(a[0]) + 14 * i);
    out[i].radii_m = (pl_vec3){radii[0], radii[1], radii[2]};
    for (size_t k = 0; k < 3; k++) {
      out[i].albedo[k] = (float)((const double *)PyArray_DATA(a[2]))[3 * i + k];
      out[i].emission[k] = (float)((const double *)PyArray_DATA(a[3]))[3 * i + k];
    }
  }
  for (int i = 0; i < 4; i++)
    Py_XDECREF((PyObject *)a[i]);
  return ok ? 0 : -1;
}

/* Contrast of the maps of bodies; when absent, as in the maps. */
static int parse_contrast(PyObject *dict, size_t count, pl_body_state *out) {
  const npy_intp shape[1] = {(npy_intp)count};
  PyObject *given = Py_XNewRef(PyDict_GetItemString(dict, "body_contrast"));
  for (size_t i = 0; i < count; i++)
    out[i].contrast = 0.0f;
  if (given == NULL)
    return PyErr_Occurred() ? -1 : 0;
  PyArrayObject *array = pl_py_array(given, "body_contrast", NPY_DOUBLE, 1, shape);
  Py_DECREF(given);
  for (size_t i = 0; array != NULL && i < count; i++)
    out[i].contrast = (float)(((const double *)PyArray_DATA(array))[i] - 1.0);
  Py_XDECREF((PyObject *)array);
  return array != NULL ? 0 : -1;
}

/* Regolith parameters of bodies; when absent, all values are those of the map, or 0. */
static int parse_regolith(PyObject *dict, size_t count, pl_body_state *out) {
  enum { BANDS = 3 * PL_REGOLITH_VALUES, ROW = BANDS + 3 };
  const npy_intp shape[2] = {(npy_intp)count, ROW};
  for (size_t i = 0; i < count; i++)
    for (size_t k = 0; k < BANDS; k++)
      ((float *)out[i].regolith.band)[k] = NAN;
  /* only tests for presence; the reference is not used */
  if (PyDict_GetItemString(dict, "body_regolith") == NULL)
    return PyErr_Occurred() ? -1 : 0;
  PyArrayObject *array = get_array(dict, "body_regolith", 2, shape);
  if (array == NULL)
    return -1;
  for (size_t i = 0; i < count; i++) {
    const double *row = (const double *)PyArray_DATA(array) + ROW * i;
    for (size_t k = 0; k < BANDS; k++)
      ((float *)out[i].regolith.band)[k] = (float)row[k];
    out[i].regolith.limb = (float)(row[BANDS] - 1.0);
    out[i].regolith.simple_h = row[BANDS + 1] != 0.0;
    out[i].regolith.narrow_surge = row[BANDS + 2] != 0.0;
  }
  Py_DECREF((PyObject *)array);
  return 0;
}

/* Dominant wavelengths of the sRGB primaries, um. */
static const double srgb_um[3] = {0.612, 0.549, 0.465};

/* "sun_wavelengths" is optional. */
static int parse_wavelengths(PyObject *dict, pl_sun *sun) {
  const npy_intp three[1] = {3};
  memcpy(sun->wavelengths_um, srgb_um, sizeof srgb_um);
  if (PyDict_GetItemString(dict, "sun_wavelengths") == NULL)
    return 0;
  PyArrayObject *array = get_array(dict, "sun_wavelengths", 1, three);
  if (array == NULL)
    return -1;
  memcpy(sun->wavelengths_um, PyArray_DATA(array), sizeof srgb_um);
  Py_DECREF((PyObject *)array);
  return 0;
}

static int parse_sun(PyObject *dict, pl_sun *sun) {
  const npy_intp three[1] = {3};
  if (get_double(dict, "sun_radius", &sun->radius_m) < 0 ||
      get_double(dict, "sun_irradiance", &sun->irradiance_au) < 0)
    return -1;
  PyArrayObject *position = get_array(dict, "sun_position", 1, three);
  if (position == NULL)
    return -1;
  const double *p = PyArray_DATA(position);
  sun->position_m = (pl_vec3){p[0], p[1], p[2]};
  Py_DECREF((PyObject *)position);
  return parse_wavelengths(dict, sun);
}

static int set_of(PyObject *names, const char *key, pl_effect_set *set) {
  const Py_ssize_t count = PySequence_Size(names);
  *set = (pl_effect_set){0};
  for (Py_ssize_t i = 0; i < count; i++) {
    PyObject *name = PySequence_GetItem(names, i);
    const char *text = name != NULL ? PyUnicode_AsUTF8AndSize(name, NULL) : NULL;
    const int index = text != NULL ? pl_effect_find(text) : -1;
    if (text != NULL && index < 0)
      PyErr_Format(PyExc_ValueError, "%s: unknown effect '%s'; see perilune._core.EFFECTS", key,
                   text);
    Py_XDECREF(name);
    if (index < 0)
      return -1;
    pl_effect_set_add(set, (size_t)index);
  }
  return count < 0 ? -1 : 0;
}

/* Converts names of effects to a set. */
static int parse_set(PyObject *dict, const char *key, pl_effect_set *set) {
  PyObject *names = item(dict, key);
  const int failed = names != NULL ? set_of(names, key, set) : -1;
  Py_XDECREF(names);
  return failed;
}

/* Returns a new reference to a member that must be a dictionary. */
static PyObject *section(PyObject *dict, const char *key) {
  PyObject *value = item(dict, key);
  if (value == NULL || PyDict_Check(value))
    return value;
  PyErr_Format(PyExc_TypeError, "%s must be a dict", key);
  Py_DECREF(value);
  return NULL;
}

static int quality_of(PyObject *quality, pl_frame_request *out) {
  if (get_int(quality, "samples", &out->samples) < 0 ||
      get_int(quality, "max_bounces", &out->max_bounces) < 0 ||
      get_int(quality, "texture_filter", &out->texture_filter) < 0 ||
      get_double(quality, "tolerance_dn", &out->wish.tolerance_dn) < 0)
    return -1;
  if (PyDict_GetItemString(quality, "target_dn") != NULL &&
      (get_double(quality, "target_dn", &out->target_dn) < 0 ||
       get_double(quality, "target_sigmas", &out->target_sigmas) < 0))
    return -1;
  if (parse_set(quality, "force_on", &out->wish.force_on) < 0)
    return -1;
  return parse_set(quality, "force_off", &out->wish.force_off);
}

static int parse_quality(PyObject *dict, pl_frame_request *out) {
  PyObject *quality = section(dict, "quality");
  const int failed = quality != NULL ? quality_of(quality, out) : -1;
  Py_XDECREF(quality);
  return failed;
}

static int parse_mode(PyObject *exposure, pl_exposure *out) {
  PyObject *mode = item(exposure, "mode");
  if (mode == NULL)
    return -1;
  const bool text = PyUnicode_Check(mode);
  out->automatic = text && PyUnicode_CompareWithASCIIString(mode, "auto") == 0;
  const bool known =
      out->automatic || (text && PyUnicode_CompareWithASCIIString(mode, "fixed") == 0);
  if (!known)
    PyErr_Format(PyExc_ValueError, "exposure.mode must be 'auto' or 'fixed', not %R", mode);
  Py_DECREF(mode);
  return known ? 0 : -1;
}

/* "min_white_radiance" is optional; default 0. */
static int parse_least_white(PyObject *exposure, pl_exposure *out) {
  PyObject *value = PyMapping_GetItemString(exposure, "min_white_radiance");
  out->least_white = 0.0;
  if (value == NULL && !PyErr_ExceptionMatches(PyExc_KeyError))
    return -1;
  PyErr_Clear();
  if (value == NULL)
    return 0;
  Py_DECREF(value);
  return get_double(exposure, "min_white_radiance", &out->least_white);
}

static int parse_exposure(PyObject *dict, pl_exposure *out) {
  PyObject *exposure = section(dict, "exposure");
  if (exposure == NULL)
    return -1;
  const int failed = parse_mode(exposure, out) < 0 ||
                     get_double(exposure, "white_radiance", &out->white_radiance) < 0 ||
                     get_double(exposure, "percentile", &out->percentile) < 0 ||
                     get_double(exposure, "key", &out->key) < 0 ||
                     parse_least_white(exposure, out) < 0;
  Py_DECREF(exposure);
  return failed ? -1 : 0;
}

/* "amodal" is optional; default true. */
static int parse_amodal(PyObject *dict, bool *out) {
  PyObject *value = PyDict_GetItemString(dict, "amodal");
  if (value == NULL && PyErr_Occurred())
    return -1;
  if (value != NULL && !PyBool_Check(value)) {
    PyErr_Format(PyExc_TypeError, "amodal must be True or False, not %R", value);
    return -1;
  }
  *out = value == NULL || value == Py_True;
  return 0;
}

/* Everything that is placed, except volumes. */
static int parse_placement(PyObject *request, const pl_scene *scene, pl_py_states *states,
                           pl_placement *out) {
  out->objects = states->objects;
  out->bodies = states->bodies;
  if (parse_camera(request, &out->camera) < 0 ||
      parse_objects(request, scene->craft_count, states->objects) < 0 ||
      parse_movers(request, scene, states) < 0 ||
      parse_bodies(request, scene->body_count, states->bodies) < 0 ||
      parse_contrast(request, scene->body_count, states->bodies) < 0 ||
      parse_regolith(request, scene->body_count, states->bodies) < 0 ||
      pl_py_clouds_parse(request, scene->body_count, states->bodies) < 0 ||
      pl_py_ground_states(request, scene->body_count, states->bodies) < 0 ||
      parse_parameters(request, scene, states) < 0)
    return -1;
  if (parse_sun(request, &out->sun) < 0)
    return -1;
  return pl_py_motion_parse(request, scene, states, out);
}

int pl_py_request_parse(PyObject *request, const pl_scene *scene, pl_py_states *states,
                        pl_frame_request *out) {
  if (!PyDict_Check(request)) {
    PyErr_SetString(PyExc_TypeError, "request must be a dict");
    return -1;
  }
  if (get_u64(request, "seed", &out->seed) < 0 || get_u64(request, "index", &out->index) < 0 ||
      parse_placement(request, scene, states, &out->placement) < 0 ||
      parse_quality(request, out) < 0 || parse_amodal(request, &out->amodal) < 0 ||
      pl_py_ground_labels_parse(request, out) < 0 || pl_py_coverage_parse(request, out) < 0 ||
      pl_py_keypoints_parse(request, states, out) < 0 ||
      pl_py_part_groups_parse(request, scene, states, out) < 0 ||
      pl_py_volumes_parse(request, states, out) < 0 ||
      pl_py_sensor_parse(request, states, out) < 0 || pl_py_bands_parse(request, states, out) < 0 ||
      pl_py_sky_parse(request, states, out) < 0)
    return -1;
  return parse_exposure(request, &out->exposure);
}

/* "changed_bodies" (bodies,) of bool, optional. */
static int parse_changed(PyObject *dict, pl_py_other *other, size_t count) {
  const npy_intp shape[1] = {(npy_intp)count};
  PyObject *given = maybe(dict, "changed_bodies");
  other->frame.changed = NULL;
  if (given == NULL)
    return PyErr_Occurred() ? -1 : 0;
  PyArrayObject *array = pl_py_array(given, "changed_bodies", NPY_BOOL, 1, shape);
  Py_DECREF(given);
  if (array == NULL)
    return -1;
  for (size_t i = 0; i < count; i++)
    other->changed[i] = ((const npy_bool *)PyArray_DATA(array))[i] != 0;
  Py_DECREF((PyObject *)array);
  other->frame.changed = other->changed;
  return 0;
}

int pl_py_others_parse(PyObject *request, const pl_scene *scene, pl_py_other others[],
                       pl_frame_request *out) {
  static const char *const keys[PL_FLOW_FRAMES] = {"next", "previous"};
  for (int i = 0; i < PL_FLOW_FRAMES; i++) {
    PyObject *dict;
    if (pl_py_member(request, keys[i], 1, "request", &dict) < 0)
      return -1;
    int failed = 0;
    if (dict != Py_None && !PyDict_Check(dict)) {
      PyErr_Format(PyExc_TypeError, "%s must be None or a dict", keys[i]);
      failed = 1;
    } else if (dict != Py_None) {
      pl_py_other *other = &others[i];
      other->frame.placement = (pl_placement){0};
      failed = parse_placement(dict, scene, &other->states, &other->frame.placement) < 0 ||
               parse_changed(dict, other, scene->body_count) < 0;
      out->others[i] = &other->frame;
    }
    Py_DECREF(dict);
    if (failed)
      return -1;
  }
  return 0;
}
