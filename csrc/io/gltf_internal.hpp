/* Common code of the glTF reader: faults, warnings, the bytes of the file. Internal to io.
 *
 * Errors inside the reader are exceptions (Fault); pl_gltf_load converts every exception to a
 * status. Temporary memory is allocated by the C++ library, the model's memory by base/memory.h. */
#ifndef PL_IO_GLTF_INTERNAL_HPP
#define PL_IO_GLTF_INTERNAL_HPP

#include <cstddef>
#include <cstdint>
#include <map>
#include <string>
#include <vector>

#include "base/status.h"

namespace pl_gltf {

struct Fault {
  pl_status status;
  std::string text;
};

/* Throws a Fault with printf-style text. */
[[noreturn]] void fail(pl_status status, const char *format, ...)
    __attribute__((format(printf, 2, 3)));

/* Sanitises text from a file for a message: control characters are replaced, the length is limited
 * to 100 bytes. */
std::string printable(const std::string &text);

/* Returns a copy of a name in the model's memory; throws a Fault when there is none. */
char *copy_text(const std::string &text);

/* Warning lines for the user, without duplicates. */
class Warnings {
public:
  void add(const char *format, ...) __attribute__((format(printf, 2, 3)));
  std::string text() const; /* lines separated by '\n' */

private:
  std::vector<std::string> lines_;
};

/* Bytes owned by a Source. */
struct Bytes {
  const uint8_t *data = nullptr;
  size_t size = 0;
};

/* The file, its container and every file that it refers to. No other code of the reader opens
 * files. */
class Source {
public:
  explicit Source(const std::string &path);

  Bytes json() const { return json_; }
  bool binary() const { return binary_; }
  Bytes binary_chunk() const { return chunk_; }
  /* Returns the number of bytes read so far; limits on the model's size are proportional to it. */
  size_t total_bytes() const { return total_; }
  /* Returns the content of a URI: a data URI, or a file in the model's folder. `what` names the
   * referring object. */
  Bytes resolve(const std::string &uri, const std::string &what);
  const std::vector<std::string> &remarks() const { return remarks_; }

private:
  Bytes keep(std::vector<uint8_t> bytes);
  Bytes read(const std::string &path, const char *what);
  void split_container(Bytes file);

  std::string folder_;
  bool binary_ = false;
  Bytes json_, chunk_;
  size_t total_ = 0;
  std::vector<std::vector<uint8_t>> owned_;
  std::map<std::string, Bytes> files_; /* keyed by real path, so that a file is read once */
  std::vector<std::string> remarks_;
};

/* Decodes base64 (RFC 4648, padding optional); throws a Fault that names `what`. */
std::vector<uint8_t> decode_base64(const char *text, size_t size, const std::string &what);

} // namespace pl_gltf

#endif
