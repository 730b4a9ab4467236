/* The function draws: standard random numbers for all drivers of a step, equal to those of NumPy's
 * Generator. NumPy's own samplers are linked statically, so that frames do not depend on the
 * installed version of NumPy. */
#include <stdbool.h>

#include <numpy/random/distributions.h>

#include "math/philox.h"
#include "pyext/py_read.h"
#include "pyext/py_types.h"

/* numpy.random.Philox: blocks of four words, the counter incremented before each. */
typedef struct philox_stream {
  uint64_t key[2];
  uint64_t counter[4];
  uint64_t words[4];
  int used;
  uint32_t half; /* remaining half of a word */
  bool has_half;
} philox_stream;

static uint64_t next_word(void *state) {
  philox_stream *stream = (philox_stream *)state;
  if (stream->used == 4) {
    for (int i = 0; i < 4 && ++stream->counter[i] == 0; i++) {
    }
    pl_philox(stream->key, stream->counter, stream->words);
    stream->used = 0;
  }
  return stream->words[stream->used++];
}

static uint32_t next_half(void *state) {
  philox_stream *stream = (philox_stream *)state;
  if (stream->has_half) {
    stream->has_half = false;
    return stream->half;
  }
  const uint64_t word = next_word(state);
  stream->has_half = true;
  stream->half = (uint32_t)(word >> 32);
  return (uint32_t)word;
}

static double next_number(void *state) { return pl_philox_double(next_word(state)); }

/* Fills the draws of all rows of the four arrays; `out` has room for the sum of the counts. */
static void fill(uint64_t seed, npy_intp rows, const uint64_t *keys, const uint64_t *frames,
                 const npy_bool *normal, const int64_t *counts, double *out) {
  for (npy_intp i = 0; i < rows; i++) {
    philox_stream stream = {.key = {seed, keys[i]}, .counter = {0, 0, 0, frames[i]}, .used = 4};
    bitgen_t generator = {&stream, next_word, next_half, next_number, next_word};
    if (normal[i])
      random_standard_normal_fill(&generator, (npy_intp)counts[i], out);
    else
      random_standard_uniform_fill(&generator, (npy_intp)counts[i], out);
    out += counts[i];
  }
}

enum { KEYS, FRAMES, NORMAL, COUNTS, COLUMNS };
enum { TOTAL_MAX = 1 << 24 };

static PyObject *draw(uint64_t seed, PyArrayObject *const columns[COLUMNS]) {
  const npy_intp rows = PyArray_DIM(columns[KEYS], 0);
  const int64_t *counts = (const int64_t *)PyArray_DATA(columns[COUNTS]);
  npy_intp total = 0;
  for (npy_intp i = 0; i < rows; i++) {
    if (counts[i] < 0 || counts[i] > TOTAL_MAX - total)
      return PyErr_Format(PyExc_ValueError, "counts: between 0 and %d in all", (int)TOTAL_MAX);
    total += (npy_intp)counts[i];
  }
  PyObject *out = PyArray_SimpleNew(1, &total, NPY_DOUBLE);
  if (out != NULL)
    fill(seed, rows, (const uint64_t *)PyArray_DATA(columns[KEYS]),
         (const uint64_t *)PyArray_DATA(columns[FRAMES]),
         (const npy_bool *)PyArray_DATA(columns[NORMAL]), counts,
         (double *)PyArray_DATA((PyArrayObject *)out));
  return out;
}

PyObject *pl_py_draws(PyObject *module, PyObject *args) {
  static const struct {
    const char *name;
    int type;
  } kinds[COLUMNS] = {
      {"keys", NPY_UINT64}, {"frames", NPY_UINT64}, {"normal", NPY_BOOL}, {"counts", NPY_INT64}};
  unsigned long long seed;
  PyObject *given[COLUMNS], *result = NULL;
  PyArrayObject *columns[COLUMNS] = {NULL};
  npy_intp shape[1] = {-1};
  (void)module;
  if (!PyArg_ParseTuple(args, "KOOOO:draws", &seed, &given[KEYS], &given[FRAMES], &given[NORMAL],
                        &given[COUNTS]))
    return NULL;
  int read = 0;
  for (; read < COLUMNS; read++) {
    columns[read] = pl_py_array(given[read], kinds[read].name, kinds[read].type, 1, shape);
    if (columns[read] == NULL)
      break;
    shape[0] = PyArray_DIM(columns[read], 0);
  }
  if (read == COLUMNS)
    result = draw((uint64_t)seed, columns);
  for (int i = 0; i < read; i++)
    Py_DECREF((PyObject *)columns[i]);
  return result;
}
