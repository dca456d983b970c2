#include "solvers/io/vtk_arrays.h"

#include <algorithm>
#include <array>
#include <limits>

#include "solvers/io/inflate.h"

namespace springstab {
namespace {

NumberType vtk_xml_type(const XmlElement& array) {
  using enum NumberType;
  constexpr struct {
    std::string_view name;
    NumberType type;
  } types[] = {{"Int8", i8},    {"UInt8", u8},  {"Int16", i16},  {"UInt16", u16},  {"Int32", i32},
               {"UInt32", u32}, {"Int64", i64}, {"UInt64", u64}, {"Float32", f32}, {"Float64", f64}};
  for (const auto& known : types)
    if (known.name == array.attribute("type")) return known.type;
  array.at.fail("an array of type " + quoted(array.attribute("type")) +
                ", expected one such as Int64 or Float32");
}

/// Bytes as they are, or in base64, which may end and begin anew.
class EncodedBytes {
 public:
  EncodedBytes(std::string_view text, bool base64, const Location& at)
      : text_(text), base64_(base64), at_(at) {}

  /// Fails, before it allocates, where the text is too short for so many.
  std::string take(std::size_t bytes) {
    std::string taken;
    if (bytes > text_.size()) end();
    if (!base64_) {
      taken = text_.substr(0, bytes);
      text_.remove_prefix(bytes);
      return taken;
    }
    while (taken.size() + decoded_.size() < bytes) {
      taken += decoded_;
      decode_group();
    }
    const std::size_t rest = bytes - taken.size();
    taken += decoded_.substr(0, rest);
    decoded_.erase(0, rest);
    return taken;
  }

 private:
  [[noreturn]] void end() const {
    at_.fail("the encoded data end, expected all that their length announces");
  }

  /// Four signs of six bits; = where fewer than three bytes were left.
  void decode_group() {
    constexpr std::string_view signs = "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
    unsigned bits = 0;
    int found = 0, padding = 0;
    for (; found < 4; text_.remove_prefix(1)) {
      if (text_.empty()) end();
      const char sign = text_.front();
      if (sign == ' ' || sign == '\n' || sign == '\r' || sign == '\t') continue;
      const std::size_t value = sign == '=' ? 0 : signs.find(sign);
      if (value == signs.npos || (padding > 0 && sign != '='))
        at_.fail(quoted(text_.substr(0, 1)) + " among the encoded data, expected the signs of base64");
      padding += sign == '=';
      bits = bits << 6 | static_cast<unsigned>(value);
      ++found;
    }
    if (padding > 2) at_.fail("a group of base64 has no bytes, expected one to three");
    decoded_.clear();
    for (int byte = 0; byte < 3 - padding; ++byte) decoded_ += static_cast<char>(bits >> (16 - 8 * byte));
  }

  std::string_view text_;
  bool base64_;
  Location at_;
  std::string decoded_;  // and not taken
};

}  // namespace

VtkArrays::VtkArrays(std::string_view source, std::string_view text)
    : xml_(read_xml(source, text, "AppendedData")) {
  if (xml_.elements.empty()) Location{source}.fail("no elements, expected VTKFile");
  const XmlElement& file = xml_.elements.front();
  if (file.name != "VTKFile")
    file.at.fail("the element " + springstab::quoted(file.name) + " is the first, expected VTKFile");
  const auto one_of = [&](std::string_view key, std::string_view usual, std::string_view other) {
    const std::string_view value = file.attribute(key, usual);
    if (value != usual && value != other)
      file.at.fail(std::string(key) + " is " + quoted(value) + ", expected " + std::string(usual) + " or " +
                   std::string(other));
    return value == other;
  };
  if (one_of("byte_order", "LittleEndian", "BigEndian")) order_ = std::endian::big;
  if (one_of("header_type", "UInt32", "UInt64")) length_ = NumberType::u64;
  const std::string_view compressor = file.attribute("compressor");
  compressed_ = compressor == "vtkZLibDataCompressor";
  if (!compressed_ && !compressor.empty())
    file.at.fail("compressed by " + quoted(compressor) + ", expected vtkZLibDataCompressor or none");
  const XmlElement& last = xml_.elements.back();
  if (last.name != "AppendedData") return;
  appended_in_base64_ = last.attribute("encoding") == "base64";
  if (!appended_in_base64_ && last.attribute("encoding") != "raw")
    last.at.fail("the encoding is " + quoted(last.attribute("encoding")) + ", expected raw or base64");
  const std::size_t begin = xml_.rest.find_first_not_of(" \t\r\n");
  if (begin == xml_.rest.npos || xml_.rest[begin] != '_') last.at.fail("no data, expected them behind a '_'");
  appended_ = xml_.rest.substr(begin + 1);
}

/// A length, then the bytes; or, compressed, numbers of blocks, bytes of a block and, where the last one is
/// smaller, bytes of it; the compressed bytes of each block; and the blocks.
std::string VtkArrays::bytes_of_array(const XmlElement& array) const {
  const bool appended = array.attribute("format") == "appended";
  std::string_view text = array.text;
  if (appended) {
    const long long offset = array.at.integer(array.attribute("offset"));
    if (offset < 0 || offset > static_cast<long long>(appended_.size()))
      array.at.fail("the offset is " + std::to_string(offset) + ", expected at most the " +
                    std::to_string(appended_.size()) + " bytes of appended data");
    text = appended_.substr(static_cast<std::size_t>(offset));
  }
  const bool base64 = !appended || appended_in_base64_;
  EncodedBytes encoded(text, base64, array.at);
  const auto lengths = [&](std::size_t count) {
    const std::string bytes = encoded.take(count * springstab::bytes_of(length_));
    BinaryReader reader(array.at.source, bytes, order_);
    std::vector<std::size_t> all;
    while (reader.bytes_left() > 0) {
      all.push_back(static_cast<std::size_t>(reader.integer(length_, "a length")));
      if (all.back() > static_cast<std::size_t>(std::numeric_limits<int>::max()))
        array.at.fail("a length of " + std::to_string(all.back()) +
                      " among the encoded data, expected at most 2^31 - 1");
    }
    return all;
  };
  const std::size_t first = lengths(1)[0];
  if (!compressed_ || first == 0) return encoded.take(first);
  const std::vector<std::size_t> sizes = lengths(2), packed = lengths(first);
  std::string all;
  for (std::size_t block = 0; block < first; ++block) {
    const bool partial = block + 1 == first && sizes[1] > 0;
    all += inflated(encoded.take(packed[block]), partial ? sizes[1] : sizes[0], Deflated::with_zlib_header,
                    array.at);
  }
  return all;
}

template <class Number>
VtkArray<Number> VtkArrays::numbers(const XmlElement& array) const {
  constexpr bool real = std::is_floating_point_v<Number>;
  const NumberType type = vtk_xml_type(array);
  if (!real && is_real(type))
    array.at.fail("an array of type " + quoted(array.attribute("type")) + ", expected integers");
  VtkArray<Number> result;
  if (array.attribute("format", "ascii") == "ascii") {
    std::vector<std::string_view> words;
    for (LineReader lines(array.at.source, array.text); lines.next();) {
      const Location at{array.at.source, array.text_at.line + lines.at().line - 1};
      words.clear();
      append_words(lines.line(), words);
      for (const std::string_view word : words) {
        if constexpr (real)
          result.values.push_back(at.real(word));
        else
          result.values.push_back(at.integer(word));
        result.at.push_back(at);
      }
    }
    if (result.at.empty()) result.at.push_back(array.at);
    return result;
  }
  if (array.attribute("format") != "binary" && array.attribute("format") != "appended")
    array.at.fail("the format is " + quoted(array.attribute("format")) +
                  ", expected ascii, binary or appended");
  const std::string bytes = bytes_of_array(array);
  result.at.push_back(array.at);
  if (bytes.size() % springstab::bytes_of(type) != 0)
    array.at.fail(std::to_string(bytes.size()) + " bytes of data, expected whole numbers of " +
                  std::to_string(springstab::bytes_of(type)) + " bytes");
  for (BinaryReader reader(array.at.source, bytes, order_); reader.bytes_left() > 0;) {
    if constexpr (real)
      result.values.push_back(reader.number(type, ""));
    else
      result.values.push_back(reader.integer(type, ""));
    if constexpr (real)
      if (!std::isfinite(result.values.back()))
        array.at.fail("number " + std::to_string(result.values.size()) +
                      " of the array is not finite, expected finite numbers");
  }
  return result;
}

VtkArray<double> VtkArrays::reals(const XmlElement& array) const { return numbers<double>(array); }
VtkArray<long long> VtkArrays::integers(const XmlElement& array) const { return numbers<long long>(array); }

}  // namespace springstab
