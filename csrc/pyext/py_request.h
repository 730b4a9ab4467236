/* Converts the request dictionary of Python to the request struct of the core. */
#ifndef PL_PYEXT_PY_REQUEST_H
#define PL_PYEXT_PY_REQUEST_H

#include "pyext/py_common.h"

#include "frame/frame.h"

/* Buffer for the motion keys of a frame. */
typedef struct pl_py_keys {
  double *numbers; /* owned; grows with the number of keys */
  size_t room;
} pl_py_keys;

/* Memory for the placement of a frame; one per renderer, sized by its scene. */
typedef struct pl_py_states {
  pl_object_state *objects; /* owned */
  pl_body_state *bodies;    /* owned */
  pl_affine *movers;        /* owned: motions of all moving nodes, object by object */
  size_t mover_count;
  pl_value *parameters;  /* owned: parameters of all graphs, object by object, then body by body */
  size_t parameter_room; /* grows with the graphs of a scene, which may change between frames */
  pl_py_keys keys;
  pl_sensor sensor;
  float bands[PL_BANDS_MAX][3];
  pl_sensor_plane planes[PL_BANDS_MAX];
  pl_sky sky;
  pl_volume volumes[PL_VOLUMES_MAX];
  pl_value *volume_parameters; /* owned: parameters of the graphs of all volumes */
  size_t volume_room;
  pl_keypoint *keypoints; /* owned; grows with their number */
  size_t keypoint_room;
  pl_part_group *groups; /* owned; grows with their number */
  size_t group_room;
  PyObject *kept; /* list of all objects that the current request borrows; NULL between frames */
} pl_py_states;

/* Memory for another frame of the same scene, see pl_other_frame. */
typedef struct pl_py_other {
  pl_py_states states; /* of a placement */
  bool *changed;       /* owned, one per body */
  pl_other_frame frame;
} pl_py_other;

/* Parses "next" and "previous" of the request dictionary, which may be absent or None: placements.
 * others: PL_FLOW_FRAMES of them, borrowed by the request. */
int pl_py_others_parse(PyObject *request, const pl_scene *scene, pl_py_other others[],
                       pl_frame_request *out);
/* Fills everything except other frames, outputs, threads and cancel; returns -1 with an exception
 * that names the key. */
int pl_py_request_parse(PyObject *request, const pl_scene *scene, pl_py_states *states,
                        pl_frame_request *out);
/* Parses "motion" of the request dictionary; when absent or None, nothing moves. Call after the
 * placement has been parsed. */
int pl_py_motion_parse(PyObject *request, const pl_scene *scene, pl_py_states *states,
                       pl_placement *placement);
/* Parses "sensor" of the request dictionary, which may be absent or None. */
int pl_py_sensor_parse(PyObject *request, pl_py_states *states, pl_frame_request *out);
/* Parses "volumes" of the request dictionary, which may be absent or None. */
int pl_py_volumes_parse(PyObject *request, pl_py_states *states, pl_frame_request *out);
/* Parses the spectral response of the sensor's filters; see perilune.camera.filters. */
int pl_py_filters_parse(PyObject *sensor, pl_py_states *states, pl_sensor *out);
/* Parses "body_clouds", one per body, which may be absent. */
int pl_py_clouds_parse(PyObject *request, size_t count, pl_body_state *out);
/* Parses "bands" (bands, 3), which may be absent. */
int pl_py_bands_parse(PyObject *request, pl_py_states *states, pl_frame_request *out);
/* Parses "ground_labels", which may be absent or None. */
int pl_py_ground_labels_parse(PyObject *request, pl_frame_request *out);
/* Likewise of "coverage_labels". */
int pl_py_coverage_parse(PyObject *request, pl_frame_request *out);
/* Parses "keypoints" of the request dictionary, which may be absent or None. */
int pl_py_keypoints_parse(PyObject *request, pl_py_states *states, pl_frame_request *out);
/* Parses "part_groups" of the request dictionary, which may be absent or None. */
int pl_py_part_groups_parse(PyObject *request, const pl_scene *scene, pl_py_states *states,
                            pl_frame_request *out);
/* Sets the request's output pointers to the arrays of `out` (a mapping name -> ndarray), and checks
 * type, shape and contiguity. References are appended to `kept`. */
int pl_py_request_outputs(PyObject *out, const pl_scene *scene, PyObject *kept,
                          pl_frame_request *request);

/* Return CHANNELS and OBJECT_LABEL, as documented in the stub; new references. */
PyObject *pl_py_channels(void);
PyObject *pl_py_object_label(void);
/* Returns KEYPOINT_LABEL, likewise. */
PyObject *pl_py_keypoint_label(void);

#endif
