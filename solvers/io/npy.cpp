#include "solvers/io/npy.h"

#include <algorithm>
#include <bit>
#include <cstdint>
#include <cstring>
#include <fstream>
#include <limits>
#include <sstream>

#include "solvers/io/input_error.h"
#include "solvers/io/text_file.h"

namespace springstab {
namespace {

constexpr std::string_view npy_magic = "\x93NUMPY";

// The value of a key of the header, a Python dictionary like
// {'descr': '<f8', 'fortran_order': False, 'shape': (3, 4), }.
std::string_view npy_value(const Location& at, std::string_view header, const std::string& key) {
  const std::size_t found = header.find("'" + key + "':");
  if (found == std::string_view::npos) at.fail("the header has no '" + key + "', expected it");
  const std::string_view rest = header.substr(found + key.size() + 3);
  return rest.substr(std::min(rest.find_first_not_of(' '), rest.size()));
}

std::vector<long long> npy_shape(const Location& at, std::string_view value) {
  const std::size_t end = value.find(')');
  if (!value.starts_with('(') || end == std::string_view::npos)
    at.fail("the shape " + quoted(value) + " is no tuple, expected one like (10, 3)");
  std::string list(value.substr(1, end - 1));
  std::ranges::replace(list, ',', ' ');
  std::vector<std::string_view> words;
  append_words(list, words);
  std::vector<long long> shape;
  long long count = 1;
  for (const std::string_view word : words) {
    shape.push_back(at.integer(word));
    if (shape.back() < 1 || count > std::numeric_limits<int>::max() / shape.back())
      at.fail("the shape (" + list + ") has " + quoted(word) + ", expected 1 to 2^31 - 1 numbers in all");
    count *= shape.back();
  }
  return shape;
}

template <class Float, class Bits>
double npy_number(const char* from, bool swapped) {
  Bits bits;
  std::memcpy(&bits, from, sizeof bits);
  if (swapped) {
    auto* bytes = reinterpret_cast<unsigned char*>(&bits);
    std::reverse(bytes, bytes + sizeof bits);
  }
  return std::bit_cast<Float>(bits);
}

// Where the array begins; `header` is set to what stands before.
std::size_t npy_data(const Location& at, std::string_view bytes, std::string_view& header) {
  if (!bytes.starts_with(npy_magic) || bytes.size() < 12)
    at.fail("does not begin as a .npy file does, expected \\x93NUMPY");
  const auto byte = [&](std::size_t i) { return std::size_t(static_cast<unsigned char>(bytes[i])); };
  const std::size_t version = byte(6);
  if (version < 1 || version > 3) at.fail("is of version " + std::to_string(version) + ", expected 1 to 3");
  const std::size_t begin = version == 1 ? 10 : 12;
  std::size_t length = byte(8) + (byte(9) << 8);
  if (version > 1) length += (byte(10) << 16) + (byte(11) << 24);
  if (bytes.size() - begin < length) at.fail("ends within its header, expected all of it");
  header = bytes.substr(begin, length);
  return begin + length;
}

}  // namespace

NpyArray parse_npy(const std::string& source, std::string_view bytes) {
  const Location at{source, 0};
  std::string_view header;
  const std::string_view data = bytes.substr(npy_data(at, bytes, header));
  const std::string_view type = npy_value(at, header, "descr").substr(0, 5);
  const bool wide = type.substr(2) == "f8'", known = wide || type.substr(2) == "f4'";
  if (type.size() < 5 || !known || (type[1] != '<' && type[1] != '>' && type[1] != '='))
    at.fail("has numbers of the type " + quoted(type) + ", expected '<f8', '<f4', '>f8' or '>f4'");
  if (!npy_value(at, header, "fortran_order").starts_with("False"))
    at.fail("is in Fortran's order, expected C's: np.ascontiguousarray(a)");
  NpyArray array{npy_shape(at, npy_value(at, header, "shape")), {}};
  std::size_t count = 1;
  for (const long long length : array.shape) count *= static_cast<std::size_t>(length);
  const std::size_t size = wide ? 8 : 4;
  if (data.size() != count * size)
    at.fail("has " + std::to_string(data.size()) + " bytes of numbers, expected " +
            std::to_string(count * size));
  const bool swapped = type[1] == (std::endian::native == std::endian::little ? '>' : '<');
  array.values.resize(count);
  for (std::size_t i = 0; i < count; ++i)
    array.values[i] = wide ? npy_number<double, std::uint64_t>(data.data() + i * size, swapped)
                           : npy_number<float, std::uint32_t>(data.data() + i * size, swapped);
  return array;
}

NpyArray read_npy(const std::string& path) {
  std::ifstream file(path, std::ios::binary);
  std::ostringstream bytes;
  if (!file || !(bytes << file.rdbuf())) throw InputError(path, 0, "cannot be read, expected a .npy file");
  return parse_npy(path, bytes.view());
}

}  // namespace springstab
