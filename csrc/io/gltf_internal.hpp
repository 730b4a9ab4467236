/* What the parts of the glTF reader share: faults, warnings, the file's bytes. Internal to io.
 *
 * Inside the reader errors are exceptions (Fault); pl_gltf_load turns every exception into a
 * status. Working memory is the C++ library's, the model's own memory is base/memory.h's. */
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

/* Text from a file made fit for a message: control characters replaced, cut to 100 bytes. */
std::string printable(const std::string &text);

/* Lines for the user, each once. */
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

/* The file, its container and every file it refers to. The only code here that opens files. */
class Source {
public:
  explicit Source(const std::string &path);

  Bytes json() const { return json_; }
  bool binary() const { return binary_; }
  Bytes binary_chunk() const { return chunk_; }
  /* Bytes of everything read so far; what the model may cost is measured by it. */
  size_t total_bytes() const { return total_; }
  /* The content behind a URI: a data URI, or a file in the model's folder. `what` names the user.
   */
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
  std::map<std::string, Bytes> files_; /* by real path, so that a file is read once */
  std::vector<std::string> remarks_;
};

/* Decodes base64 (RFC 4648, padding optional); throws a Fault that names `what`. */
std::vector<uint8_t> decode_base64(const char *text, size_t size, const std::string &what);

} // namespace pl_gltf

#endif
