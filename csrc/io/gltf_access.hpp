/* Safe reading of accessors: every bound is checked once, when an accessor is opened. Internal to
 * io. */
#ifndef PL_IO_GLTF_ACCESS_HPP
#define PL_IO_GLTF_ACCESS_HPP

#include <map>
#include <memory>
#include <string>
#include <vector>

#include "io/gltf_internal.hpp"
#include "io/gltf_tiny.hpp"

namespace pl_gltf {

/* An image of the file: in a buffer view, or in a file of its own. */
struct ImageRef {
  std::string name; /* for messages */
  int view = -1;    /* buffer view, or -1 */
  Bytes file;       /* otherwise */
};

/* A parsed file with the content it refers to. */
struct Asset {
  std::shared_ptr<const Source> source; /* owns all bytes below */
  tinygltf::Model model;
  std::vector<Bytes> buffers;
  std::vector<ImageRef> images;
  /* Content of buffer views that is decoded (gltf_decoded.hpp) instead of lying in a buffer. */
  std::map<int, std::vector<uint8_t>> decoded;
  size_t decoded_bytes = 0;
  int no_view = -1;      /* buffer view of accessors that have none: they are zeros */
  size_t file_bytes = 0; /* of the file, all it refers to, and what is decoded from them */
};

/* Checked content of a buffer view. */
Bytes view_bytes(const Asset &asset, int view, const std::string &what);

/* A view of an accessor's elements: dense, strided or sparse, any component type. */
class Accessor {
public:
  /* Throws a Fault naming `what` if any element would lie outside its buffer. */
  Accessor(const Asset &asset, int index, const std::string &what);

  size_t count() const { return count_; }
  int components() const { return components_; } /* 1..4, 4, 9 or 16 */
  bool is_float() const;
  bool is_unsigned_integer() const;
  bool normalized() const { return normalized_; }

  /* Element `i` < count(), at most four components; normalised integers become -1..1 or 0..1. */
  void read(size_t i, float out[4]) const;
  /* The same for indices (one unsigned component). */
  uint32_t read_index(size_t i) const;
  /* The value that means "restart" for this type of indices (255, 65535 or 2^32 - 1). */
  uint32_t restart_value() const;

private:
  void open_dense(const Asset &asset, const tinygltf::Accessor &accessor, const std::string &what);
  void open_sparse(const Asset &asset, const tinygltf::Accessor &accessor, const std::string &what);
  const uint8_t *element(size_t i) const; /* nullptr: zero */
  float component(const uint8_t *at) const;

  size_t count_ = 0;
  int components_ = 0, component_type_ = 0;
  size_t component_size_ = 0, element_size_ = 0;
  bool normalized_ = false;
  const uint8_t *base_ = nullptr; /* nullptr: zeros */
  size_t stride_ = 0;
  struct Replacement {
    uint32_t index, order; /* element replaced; by which of the sparse values */
  };
  std::vector<Replacement> sparse_; /* by index, each once */
  const uint8_t *sparse_values_ = nullptr;
};

} // namespace pl_gltf

#endif
