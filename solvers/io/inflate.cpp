#include "solvers/io/inflate.h"

#include <limits>
#include <memory>

#ifdef SPRINGSTAB_ZLIB
#include <zlib.h>
#endif

namespace springstab {

#ifdef SPRINGSTAB_ZLIB
bool has_zlib() { return true; }

std::string inflated(std::string_view bytes, std::size_t size, Deflated form, const Location& at) {
  constexpr std::size_t best_ratio = 1032, most = std::numeric_limits<int>::max();
  const auto wrong = [&](const std::string& what) {
    at.fail(what + ", expected " + std::to_string(size) + " bytes, compressed by zlib");
  };
  if (size > most || size / best_ratio > bytes.size())
    wrong(std::to_string(bytes.size()) + " bytes are too few for what is announced");
  z_stream stream{};
  if (inflateInit2(&stream, form == Deflated::raw ? -MAX_WBITS : MAX_WBITS) != Z_OK) throw std::bad_alloc();
  const std::unique_ptr<z_stream, int (*)(z_stream*)> end(&stream, inflateEnd);
  std::string out(size + 1, '\0');  // one more, to see that there is not
  stream.next_in = reinterpret_cast<Bytef*>(const_cast<char*>(bytes.data()));  // zlib writes nothing there
  stream.avail_in = static_cast<uInt>(bytes.size());
  stream.next_out = reinterpret_cast<Bytef*>(out.data());
  stream.avail_out = static_cast<uInt>(out.size());
  const int status = ::inflate(&stream, Z_FINISH);
  if (status != Z_STREAM_END || stream.total_out != size)
    wrong("the data are damaged (" + std::string(stream.msg ? stream.msg : "their size differs") + ")");
  out.resize(size);
  return out;
}
#else
bool has_zlib() { return false; }

std::string inflated(std::string_view, std::size_t, Deflated, const Location& at) {
  at.fail(
      "the data are compressed, which this program was built without, expected one built with zlib (Debian: "
      "zlib1g-dev)");
}
#endif

}  // namespace springstab
