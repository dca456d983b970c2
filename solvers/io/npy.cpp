#include "solvers/io/npy.h"

#include <algorithm>
#include <bit>
#include <fstream>
#include <limits>
#include <sstream>
#include <utility>

#include "solvers/io/binary_reader.h"
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

std::vector<long long> npy_shape(const Location& at, std::string_view value, long long least) {
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
    if (shape.back() < least || count > std::numeric_limits<int>::max() / std::max(shape.back(), 1LL))
      at.fail("the shape (" + list + ") has " + quoted(word) + ", expected 1 to 2^31 - 1 numbers in all");
    count *= shape.back();
  }
  return shape;
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

struct NpyView {
  char kind;  // f, i, u, b; S and U of strings; c and others
  std::size_t size;
  std::endian order;
  std::string_view type;  // as it stands there
  std::vector<long long> shape;
  std::string_view data;
};

NpyView npy_view(const Location& at, std::string_view bytes, long long least) {
  std::string_view header;
  NpyView view{};
  view.data = bytes.substr(npy_data(at, bytes, header));
  view.type = npy_value(at, header, "descr").substr(0, 5);
  const bool known = view.type.size() == 5 && view.type[4] == '\'' &&
                     std::string_view("<>=|").find(view.type[1]) != std::string_view::npos;
  view.kind = known ? view.type[2] : '?';
  view.size =
      known && view.type[3] > '0' && view.type[3] <= '9' ? static_cast<std::size_t>(view.type[3] - '0') : 0;
  const char other = std::endian::native == std::endian::little ? '>' : '<';
  const std::endian swapped =
      std::endian::native == std::endian::little ? std::endian::big : std::endian::little;
  view.order = known && view.type[1] == other ? swapped : std::endian::native;
  if (!npy_value(at, header, "fortran_order").starts_with("False"))
    at.fail("is in Fortran's order, expected C's: np.ascontiguousarray(a)");
  view.shape = npy_shape(at, npy_value(at, header, "shape"), least);
  return view;
}

/// How many; as many bytes must be there.
std::size_t npy_count(const Location& at, const NpyView& view, std::size_t size) {
  std::size_t count = 1;
  for (const long long length : view.shape) count *= static_cast<std::size_t>(length);
  if (view.data.size() != count * size)
    at.fail("has " + std::to_string(view.data.size()) + " bytes of numbers, expected " +
            std::to_string(count * size));
  return count;
}

/// Of real numbers, integers or truth values.
NumberType npy_type(const Location& at, const NpyView& view, bool real) {
  using enum NumberType;
  const auto is = [&](std::string_view kinds, std::size_t size) {
    return kinds.find(view.kind) != kinds.npos && view.size == size;
  };
  if (real && is("f", 4)) return f32;
  if (real && is("f", 8)) return f64;
  if (is("i", 1)) return i8;
  if (is("ub", 1)) return u8;
  if (is("i", 2)) return i16;
  if (is("u", 2)) return u16;
  if (is("i", 4)) return i32;
  if (is("u", 4)) return u32;
  if (is("i", 8)) return i64;
  if (is("u", 8)) return u64;
  at.fail("has numbers of the type " + quoted(view.type) + ", expected " +
          (real ? "real numbers of 4 or 8 bytes, or integers" : "integers"));
}

}  // namespace

NpyArray parse_npy(const std::string& source, std::string_view bytes) {
  const Location at{source, 0};
  NpyView view = npy_view(at, bytes, 1);
  if (view.kind != 'f' || (view.size != 4 && view.size != 8) || view.type[1] == '|')
    at.fail("has numbers of the type " + quoted(view.type) + ", expected '<f8', '<f4', '>f8' or '>f4'");
  NpyArray array{std::move(view.shape), {}};
  view.shape = array.shape;
  array.values.resize(npy_count(at, view, view.size));
  BinaryReader reader(source, view.data, view.order);
  for (double& value : array.values) value = reader.number(npy_type(at, view, true), "");
  return array;
}

std::vector<double> npy_numbers(const std::string& source, std::string_view bytes) {
  const Location at{source, 0};
  const NpyView view = npy_view(at, bytes, 0);
  const NumberType type = npy_type(at, view, true);
  std::vector<double> values(npy_count(at, view, view.size));
  BinaryReader reader(source, view.data, view.order);
  for (double& value : values) value = reader.number(type, "");
  return values;
}

std::vector<long long> npy_integers(const std::string& source, std::string_view bytes) {
  const Location at{source, 0};
  const NpyView view = npy_view(at, bytes, 0);
  const NumberType type = npy_type(at, view, false);
  std::vector<long long> values(npy_count(at, view, view.size));
  BinaryReader reader(source, view.data, view.order);
  for (long long& value : values) value = reader.integer(type, "");
  return values;
}

std::string npy_letters(const std::string& source, std::string_view bytes) {
  const Location at{source, 0};
  const NpyView view = npy_view(at, bytes, 0);
  if (view.kind != 'S' && view.kind != 'U')
    at.fail("has the type " + quoted(view.type) + ", expected a string of at most nine letters");
  npy_count(at, view, view.kind == 'U' ? 4 * view.size : view.size);
  std::string letters(view.data);
  std::erase(letters, '\0');  // a letter of kind U has four bytes
  return letters;
}

NpyArray read_npy(const std::string& path) {
  std::ifstream file(path, std::ios::binary);
  std::ostringstream bytes;
  if (!file || !(bytes << file.rdbuf())) throw InputError(path, 0, "cannot be read, expected a .npy file");
  return parse_npy(path, bytes.view());
}

}  // namespace springstab
