/* Bounds-checked accessors: all bounds are checked once, when an accessor is opened. Internal to
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

/* An image of the file: in a buffer view, or in a separate file. */
struct ImageRef {
  std::string name; /* for error texts */
  int view = -1;    /* buffer view, or -1 */
  Bytes file;       /* used when view is -1 */
};

/* A parsed file and the content that it refers to. */
struct Asset {
  std::shared_ptr<const Source> source; /* owns all bytes below */
  tinygltf::Model model;
  std::vector<Bytes> buffers;
  std::vector<ImageRef> images;
  /* Decoded content of compressed buffer views (gltf_decoded.hpp), which does not lie in a
   * buffer. */
  std::map<int, std::vector<uint8_t>> decoded;
  size_t decoded_bytes = 0;
  int no_view = -1; /* placeholder buffer view of accessors without one: they are all zeros */
  /* size of the file, all files that it refers to, and their decoded content */
  size_t file_bytes = 0;
};

/* Returns the content of a buffer view, with bounds checked. */
Bytes view_bytes(const Asset &asset, int view, const std::string &what);

/* Reads an accessor's elements: dense, strided or sparse, of any component type. */
class Accessor {
public:
  /* Throws a Fault that names `what` if any element would lie outside its buffer. */
  Accessor(const Asset &asset, int index, const std::string &what);

  size_t count() const { return count_; }
  int components() const { return components_; } /* 1..4, 4, 9 or 16 */
  bool is_float() const;
  bool is_unsigned_integer() const;
  bool normalized() const { return normalized_; }

  /* Reads element `i` < count(), at most four components; normalised integers are mapped to -1..1
   * or 0..1. */
  void read(size_t i, float out[4]) const;
  /* Reads an index (one unsigned component). */
  uint32_t read_index(size_t i) const;
  /* Returns the primitive restart value of this index type (255, 65535 or 2^32 - 1). */
  uint32_t restart_value() const;

private:
  void open_dense(const Asset &asset, const tinygltf::Accessor &accessor, const std::string &what);
  void open_sparse(const Asset &asset, const tinygltf::Accessor &accessor, const std::string &what);
  const uint8_t *element(size_t i) const; /* nullptr for a zero element */
  float component(const uint8_t *at) const;

  size_t count_ = 0;
  int components_ = 0, component_type_ = 0;
  size_t component_size_ = 0, element_size_ = 0;
  bool normalized_ = false;
  const uint8_t *base_ = nullptr; /* nullptr when all elements are zero */
  size_t stride_ = 0;
  struct Replacement {
    /* element that is replaced; number of the sparse value that replaces it */
    uint32_t index, order;
  };
  std::vector<Replacement> sparse_; /* sorted by index, without duplicates */
  const uint8_t *sparse_values_ = nullptr;
};

} // namespace pl_gltf

#endif
