// Walks through the numbers of a binary file, of either byte order: all that the readers of binary formats
// share. It never reads beyond the end, and says at which byte something is wrong.
#pragma once

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <cstdint>
#include <cstring>
#include <string>
#include <string_view>
#include <type_traits>

#include "solvers/io/input_error.h"
#include "solvers/io/text_file.h"

namespace springstab {

static_assert(std::endian::native == std::endian::little || std::endian::native == std::endian::big);

/// The number that these bytes, sizeof(Number) of them, are in that order.
template <class Number>
Number number_of(std::string_view bytes, std::endian order) {
  std::array<char, sizeof(Number)> own;
  std::memcpy(own.data(), bytes.data(), own.size());
  if (order != std::endian::native) std::ranges::reverse(own);
  return std::bit_cast<Number>(own);
}

/// Integers with and without sign, and floating point numbers, by their bits.
enum class NumberType { i8, u8, i16, u16, i32, u32, i64, u64, f32, f64 };

/// visit(Number()) with the type's own Number.
template <class Visit>
auto with_type(NumberType type, const Visit& visit) {
  switch (type) {
    case NumberType::i8:
      return visit(std::int8_t());
    case NumberType::u8:
      return visit(std::uint8_t());
    case NumberType::i16:
      return visit(std::int16_t());
    case NumberType::u16:
      return visit(std::uint16_t());
    case NumberType::i32:
      return visit(std::int32_t());
    case NumberType::u32:
      return visit(std::uint32_t());
    case NumberType::i64:
      return visit(std::int64_t());
    case NumberType::u64:
      return visit(std::uint64_t());
    case NumberType::f32:
      return visit(float());
    case NumberType::f64:
      break;
  }
  return visit(double());
}

inline std::size_t bytes_of(NumberType type) {
  return with_type(type, [](auto number) { return sizeof number; });
}
inline bool is_real(NumberType type) { return type == NumberType::f32 || type == NumberType::f64; }

/// Source and bytes must outlive it.
class BinaryReader {
 public:
  BinaryReader(std::string_view source, std::string_view bytes, std::endian order, std::size_t position = 0)
      : source_(source), bytes_(bytes), position_(position), order_(order) {}

  std::size_t position() const { return position_; }
  std::size_t bytes_left() const { return bytes_.size() - position_; }
  Location at() const { return {source_, at_byte(position_)}; }

  /// The next bytes; `what` they are is told where the file ends before.
  std::string_view take(std::size_t bytes, const std::string& what) {
    if (bytes > bytes_left()) at().fail("the file ends, expected " + what);
    position_ += bytes;
    return bytes_.substr(position_ - bytes, bytes);
  }

  template <class Number>
  Number next(const std::string& what) {
    return number_of<Number>(take(sizeof(Number), what), order_);
  }

  /// A number of any type; it may be one that is not finite.
  double number(NumberType type, const std::string& what) {
    return with_type(type, [&](auto n) { return static_cast<double>(next<decltype(n)>(what)); });
  }

  double finite(NumberType type, const std::string& what) {
    const Location here = at();
    const double value = number(type, what);
    if (!std::isfinite(value)) here.fail(what + " is not finite, expected a finite number");
    return value;
  }

  /// A number of an integer type; one without sign that is beyond those with sign comes out negative.
  long long integer(NumberType type, const std::string& what) {
    return with_type(type, [&](auto n) {
      if constexpr (std::is_integral_v<decltype(n)>) return static_cast<long long>(next<decltype(n)>(what));
      return -1LL;
    });
  }

  /// A header of a few bytes must not make anyone allocate gigabytes: fails unless the rest of the file has
  /// room for so many things of that size each.
  void expect_room(long long count, std::size_t size_each, const std::string& things) const {
    const auto most = static_cast<long long>(bytes_left() / size_each);
    if (count < 0 || count > most)
      at().fail(std::to_string(count) + " " + things + " are announced, expected at most the " +
                std::to_string(most) + " that the rest of the file has room for");
  }

 private:
  std::string_view source_, bytes_;
  std::size_t position_;
  std::endian order_;
};

}  // namespace springstab
