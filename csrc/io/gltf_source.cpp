/* Bytes of a glTF asset: container, data URIs, and external files, which must lie in the model's
 * folder. */
#include "io/gltf_internal.hpp"

#include <cctype>
#include <cstdarg>
#include <cstdio>
#include <cstdlib>
#include <cstring>

#include "base/memory.h"
#include "io/file.h"

namespace pl_gltf {

namespace {

/* Largest file that is read. glTF binary has 32-bit lengths; half of that prevents overflows in
 * arithmetic. */
constexpr size_t MAX_FILE = size_t{1} << 31;
constexpr uint32_t GLB_MAGIC = 0x46546C67, GLB_JSON = 0x4E4F534A, GLB_BIN = 0x004E4942;
constexpr size_t GLB_HEADER = 12, CHUNK_HEADER = 8;
constexpr size_t MAX_WARNINGS = 100;

std::string format_text(const char *format, va_list arguments) {
  char text[900];
  vsnprintf(text, sizeof text, format, arguments);
  return text;
}

uint32_t u32_at(const Bytes &bytes, size_t offset) {
  const uint8_t *b = bytes.data + offset;
  return static_cast<uint32_t>(b[0]) | static_cast<uint32_t>(b[1]) << 8 |
         static_cast<uint32_t>(b[2]) << 16 | static_cast<uint32_t>(b[3]) << 24;
}

int hex_digit(char c) {
  if (c >= '0' && c <= '9')
    return c - '0';
  if (c >= 'a' && c <= 'f')
    return c - 'a' + 10;
  return c >= 'A' && c <= 'F' ? c - 'A' + 10 : -1;
}

/* RFC 3986, 2.1. '+' is not decoded (it means a space only in forms). */
std::string percent_decode(const std::string &uri, const std::string &what) {
  std::string out;
  for (size_t i = 0; i < uri.size(); i++) {
    if (uri[i] != '%') {
      out += uri[i];
      continue;
    }
    const int high = i + 2 < uri.size() ? hex_digit(uri[i + 1]) : -1;
    const int low = i + 2 < uri.size() ? hex_digit(uri[i + 2]) : -1;
    if (high < 0 || low < 0)
      fail(PL_E_FORMAT, "%s: URI \"%s\" has a broken %% escape", what.c_str(),
           printable(uri).c_str());
    out += static_cast<char>(high * 16 + low);
    i += 2;
  }
  return out;
}

bool has_scheme(const std::string &uri) {
  const size_t colon = uri.find(':');
  if (colon == std::string::npos || colon == 0 || !isalpha(static_cast<unsigned char>(uri[0])))
    return false;
  for (size_t i = 0; i < colon; i++)
    if (!isalnum(static_cast<unsigned char>(uri[i])) && strchr("+-.", uri[i]) == nullptr)
      return false;
  return true;
}

/* Rejects absolute paths, and paths that leave the folder at any point. */
void check_relative(const std::string &path, const std::string &what) {
  if (path.empty() || path.find('\0') != std::string::npos)
    fail(PL_E_FORMAT, "%s: the URI names no file", what.c_str());
  int depth = path[0] == '/' ? -1 : 0;
  for (size_t begin = 0; begin <= path.size() && depth >= 0;) {
    const size_t end =
        path.find('/', begin) == std::string::npos ? path.size() : path.find('/', begin);
    const std::string part = path.substr(begin, end - begin);
    if (part == "..")
      depth--;
    else if (!part.empty() && part != ".")
      depth++;
    begin = end + 1;
  }
  if (depth < 0)
    fail(PL_E_FORMAT,
         "%s: \"%s\" lies outside the model's folder; only files beside or below "
         "the model are read",
         what.c_str(), printable(path).c_str());
}

std::string folder_of(const std::string &path) {
  const size_t slash = path.rfind('/');
  return slash == std::string::npos ? "." : slash == 0 ? "/" : path.substr(0, slash);
}

/* Returns the path with symbolic links resolved; empty when there is no such file. */
std::string real_path(const std::string &path) {
  char *resolved = realpath(path.c_str(), nullptr);
  if (resolved == nullptr)
    return "";
  const std::string out = resolved;
  free(resolved);
  return out;
}

} // namespace

void fail(pl_status status, const char *format, ...) {
  va_list arguments;
  va_start(arguments, format);
  Fault fault{status, format_text(format, arguments)};
  va_end(arguments);
  throw fault;
}

std::string printable(const std::string &text) {
  constexpr size_t LONGEST = 100;
  std::string out = text.substr(0, LONGEST);
  /* Does not cut inside a UTF-8 sequence, whose continuation bytes are 10xxxxxx. */
  if (text.size() > LONGEST) {
    while (!out.empty() && (static_cast<unsigned char>(text[out.size()]) & 0xC0) == 0x80)
      out.pop_back();
    out += "...";
  }
  for (char &c : out)
    if (static_cast<unsigned char>(c) < 32 || c == 127)
      c = '?';
  return out;
}

char *copy_text(const std::string &text) {
  char *copy = pl_strdup(text.c_str());
  if (copy == nullptr)
    fail(PL_E_MEMORY, "out of memory for names");
  return copy;
}

void Warnings::add(const char *format, ...) {
  va_list arguments;
  va_start(arguments, format);
  std::string line = format_text(format, arguments);
  va_end(arguments);
  for (const std::string &known : lines_)
    if (known == line)
      return;
  if (lines_.size() == MAX_WARNINGS)
    line = "further warnings are left out";
  if (lines_.size() <= MAX_WARNINGS)
    lines_.push_back(std::move(line));
}

std::string Warnings::text() const {
  std::string out;
  for (const std::string &line : lines_)
    out += (out.empty() ? "" : "\n") + line;
  return out;
}

std::vector<uint8_t> decode_base64(const char *text, size_t size, const std::string &what) {
  while (size > 0 && text[size - 1] == '=')
    size--;
  std::vector<uint8_t> out;
  out.reserve(size / 4 * 3 + 2);
  uint32_t bits = 0;
  int count = 0;
  for (size_t i = 0; i < size; i++) {
    const char c = text[i];
    int value = -1;
    if (c >= 'A' && c <= 'Z')
      value = c - 'A';
    else if (c >= 'a' && c <= 'z')
      value = c - 'a' + 26;
    else if (c >= '0' && c <= '9')
      value = c - '0' + 52;
    else if (c == '+' || c == '/')
      value = c == '+' ? 62 : 63;
    if (value < 0)
      fail(PL_E_FORMAT, "%s: broken base64 in a data URI", what.c_str());
    bits = bits << 6 | static_cast<uint32_t>(value);
    count += 6;
    if (count >= 8) {
      count -= 8;
      out.push_back(static_cast<uint8_t>(bits >> count & 0xFF));
    }
  }
  if (size % 4 == 1)
    fail(PL_E_FORMAT, "%s: broken base64 in a data URI", what.c_str());
  return out;
}

Source::Source(const std::string &path) : folder_(real_path(folder_of(path))) {
  const Bytes file = read(path, nullptr);
  binary_ = file.size >= 4 && u32_at(file, 0) == GLB_MAGIC;
  if (binary_)
    split_container(file);
  else
    json_ = file;
}

Bytes Source::keep(std::vector<uint8_t> bytes) {
  total_ += bytes.size();
  owned_.push_back(std::move(bytes));
  return {owned_.back().data(), owned_.back().size()};
}

Bytes Source::read(const std::string &path, const char *what) {
  uint8_t *bytes;
  size_t size;
  const pl_status status = pl_file_read(path.c_str(), MAX_FILE, &bytes, &size);
  if (status != PL_OK) {
    /* Removes the path at the beginning of the text: callers prepend it to every text about the
     * model's own file. */
    const char *text = pl_error_text();
    if (what == nullptr && path.size() + 2 < strlen(text))
      fail(status, "%s", text + path.size() + 2);
    fail(status, "%s: %s", what != nullptr ? what : "file", text);
  }
  try {
    std::vector<uint8_t> copy(bytes, bytes + size);
    pl_free(bytes);
    bytes = nullptr;
    return keep(std::move(copy));
  } catch (...) {
    pl_free(bytes);
    throw;
  }
}

/* glTF 2.0, section 4.4. */
void Source::split_container(Bytes file) {
  if (file.size < GLB_HEADER + CHUNK_HEADER)
    fail(PL_E_FORMAT, "truncated: %zu bytes are no binary glTF", file.size);
  if (u32_at(file, 4) != 2)
    fail(PL_E_UNSUPPORTED, "binary glTF version %u; only version 2 is read", u32_at(file, 4));
  const size_t length = u32_at(file, 8);
  if (length > file.size)
    fail(PL_E_FORMAT, "truncated: the header says %zu bytes, the file has %zu", length, file.size);
  if (length < GLB_HEADER + CHUNK_HEADER)
    fail(PL_E_FORMAT, "broken binary glTF: the header says %zu bytes in all", length);
  if (length < file.size)
    remarks_.push_back("bytes after the end of the binary glTF are ignored");
  bool have_bin = false;
  int chunk = 0;
  for (size_t at = GLB_HEADER; at < length; chunk++) {
    if (length - at < CHUNK_HEADER)
      fail(PL_E_FORMAT, "truncated: chunk %d has no header", chunk);
    const size_t size = u32_at(file, at);
    const uint32_t type = u32_at(file, at + 4);
    at += CHUNK_HEADER;
    if (size > length - at)
      fail(PL_E_FORMAT, "truncated: chunk %d says %zu bytes, %zu are left", chunk, size,
           length - at);
    const Bytes content{file.data + at, size};
    at += size;
    if ((chunk == 0) != (type == GLB_JSON))
      fail(PL_E_FORMAT, chunk == 0 ? "broken binary glTF: the first chunk is not JSON"
                                   : "broken binary glTF: two JSON chunks");
    if (type == GLB_JSON)
      json_ = content;
    else if (type == GLB_BIN && have_bin)
      fail(PL_E_FORMAT, "broken binary glTF: two BIN chunks");
    else if (type == GLB_BIN)
      chunk_ = content, have_bin = true;
    /* Other chunk types belong to extensions and must be skipped (section 4.4.3.1). */
  }
}

Bytes Source::resolve(const std::string &uri, const std::string &what) {
  if (uri.compare(0, 5, "data:") == 0) {
    const size_t comma = uri.find(',');
    const std::string head = comma == std::string::npos ? "" : uri.substr(0, comma);
    if (head.size() < 12 || head.compare(head.size() - 7, 7, ";base64") != 0)
      fail(PL_E_FORMAT, "%s: only base64 data URIs are read", what.c_str());
    return keep(decode_base64(uri.data() + comma + 1, uri.size() - comma - 1, what));
  }
  if (has_scheme(uri))
    fail(PL_E_FORMAT, "%s: \"%s\" is not a file beside the model; URLs are never followed",
         what.c_str(), printable(uri).c_str());
  const std::string relative = percent_decode(uri, what);
  check_relative(relative, what);
  const std::string real = real_path(folder_ + "/" + relative);
  if (real.empty())
    fail(PL_E_IO, "%s: missing file \"%s\"", what.c_str(), printable(relative).c_str());
  const std::string inside = folder_ == "/" ? "/" : folder_ + "/";
  if (real.compare(0, inside.size(), inside) != 0)
    fail(PL_E_FORMAT, "%s: \"%s\" is a link out of the model's folder", what.c_str(),
         printable(relative).c_str());
  const auto known = files_.find(real);
  if (known != files_.end())
    return known->second;
  return files_[real] = read(real, what.c_str());
}

} // namespace pl_gltf
