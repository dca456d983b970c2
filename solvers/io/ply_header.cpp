#include "solvers/io/ply_header.h"

#include <limits>

#include "solvers/io/mesh_builder.h"

namespace springstab {
namespace {

NumberType ply_type(const Location& at, std::string_view name) {
  using enum NumberType;
  constexpr struct {
    std::string_view old_name, name;
    NumberType type;
  } types[] = {{"char", "int8", i8},      {"uchar", "uint8", u8},    {"short", "int16", i16},
               {"ushort", "uint16", u16}, {"int", "int32", i32},     {"uint", "uint32", u32},
               {"float", "float32", f32}, {"double", "float64", f64}};
  for (const auto& known : types)
    if (name == known.old_name || name == known.name) return known.type;
  at.fail("unknown type " + quoted(name) + ", expected one such as uchar, int, float or double");
}

}  // namespace

PlyNumbers::PlyNumbers(std::string_view source, std::string_view text)
    : lines_(source, text), source_(source), text_(text) {
  header();
}

void PlyNumbers::header() {
  const auto next_words = [&] {
    words_.clear();
    if (!lines_.next()) lines_.at().fail("the file ends in its header, expected end_header");
    append_words(lines_.line(), words_);
  };
  if (!lines_.next() || trimmed(lines_.line()) != "ply")
    lines_.at().fail(quoted(lines_.line()) + " begins the file, expected ply");
  next_words();
  format();
  for (next_words(); words_.empty() || words_[0] != "end_header"; next_words()) {
    if (words_.empty() || words_[0] == "comment" || words_[0] == "obj_info") continue;
    const Location at = lines_.at();
    if (words_[0] == "element" && words_.size() == 3) {
      elements_.push_back({std::string(words_[1]), count_of(at, words_[2], "of them"), {}, at});
    } else if (words_[0] == "property" && !elements_.empty()) {
      property();
    } else {
      at.fail(quoted(lines_.line()) +
              " in the header, expected 'element NAME COUNT' or, behind one, 'property TYPE NAME'");
    }
  }
  if (order_) binary_.emplace(source_, text_, *order_, lines_.position());
}

void PlyNumbers::format() {
  const std::string_view kind = words_.size() == 3 && words_[0] == "format" ? words_[1] : "";
  if (kind == "binary_little_endian" || kind == "binary_big_endian")
    order_ = kind == "binary_big_endian" ? std::endian::big : std::endian::little;
  else if (kind != "ascii")
    lines_.at().fail(quoted(lines_.line()) +
                     " behind the first line, expected 'format ascii 1.0', or binary_little_endian or "
                     "binary_big_endian in place of ascii");
}

/// property TYPE NAME, or property list TYPE TYPE NAME: of the length and of what is in it.
void PlyNumbers::property() {
  const Location at = lines_.at();
  const bool list = words_.size() > 1 && words_[1] == "list";
  if (words_.size() != (list ? 5U : 3U))
    at.fail(quoted(lines_.line()) +
            " in the header, expected 'property TYPE NAME' or 'property list TYPE TYPE NAME'");
  PlyProperty property{std::string(words_.back()), ply_type(at, words_[list ? 3 : 1]), {}};
  if (list) property.count = ply_type(at, words_[2]);
  if (list && is_real(*property.count))
    at.fail("a list's length of type " + quoted(words_[2]) + ", expected an integer's");
  elements_.back().properties.push_back(std::move(property));
}

void PlyNumbers::expect_room(const PlyElement& element) const {
  std::size_t least = 0;  // bytes; in ASCII a digit and a blank or an end of line for each number
  for (const PlyProperty& p : element.properties) least += binary_ ? bytes_of(p.count.value_or(p.type)) : 2;
  if (element.properties.empty())
    element.at.fail("the element " + springstab::quoted(element.name) + " has no properties, expected some");
  const std::size_t left =
      binary_ ? binary_->bytes_left() : lines_.bytes_left() + 1;  // the last end may be missing
  if (const auto most = static_cast<long long>(left / least); element.count > most)
    element.at.fail(std::to_string(element.count) + " of the element " + springstab::quoted(element.name) +
                    " are announced, expected at most the " + std::to_string(most) +
                    " that the rest of the file has room for");
}

Location PlyNumbers::begin(const PlyElement& element) {
  if (binary_) return binary_->at();
  words_.clear();
  next_word_ = 0;
  while (words_.empty()) {
    if (!lines_.next())
      lines_.at().fail("the file ends, expected " + std::to_string(element.count) + " of the element " +
                       springstab::quoted(element.name));
    append_words(lines_.line(), words_);
  }
  return lines_.at();
}

double PlyNumbers::next(NumberType type, const std::string& name) {
  if (!binary_) {
    if (next_word_ == words_.size()) lines_.at().fail("the line ends, expected " + springstab::quoted(name));
    const std::string_view word = words_[next_word_++];
    if (!is_real(type)) return static_cast<double>(lines_.at().integer(word));
    return is_not_finite(word) ? std::numeric_limits<double>::quiet_NaN() : lines_.at().real(word);
  }
  if (bytes_of(type) > binary_->bytes_left())
    binary_->at().fail("the file ends, expected " + springstab::quoted(name));
  return binary_->number(type, name);
}

long long PlyNumbers::length(const PlyProperty& list) {
  const Location here = binary_ ? binary_->at() : lines_.at();
  const double length = next(*list.count, "the length of the list " + list.name);
  const std::size_t most = binary_ ? binary_->bytes_left() / bytes_of(list.type) : words_.size() - next_word_;
  if (!(length >= 0 && length <= static_cast<double>(most)))
    here.fail("the list " + springstab::quoted(list.name) + " has the length " +
              std::to_string(static_cast<long long>(length)) + ", expected at most the " +
              std::to_string(most) +
              (binary_ ? " that the rest of the file has room for" : " numbers behind it"));
  return static_cast<long long>(length);
}

void PlyNumbers::end(const PlyElement& element) {
  if (!binary_ && next_word_ < words_.size())
    lines_.at().fail(quoted(words_[next_word_]) + " stands behind the last property of the element " +
                     springstab::quoted(element.name) + ", expected the end of the line");
}

void PlyNumbers::finish() {
  if (binary_) {
    const std::string_view rest = binary_->take(binary_->bytes_left(), "");
    if (rest.find_first_not_of(" \t\r\n") != rest.npos)
      Location{source_, at_byte(text_.size() - rest.size())}.fail(
          std::to_string(rest.size()) + " bytes behind the last element, expected the end of the file");
    return;
  }
  while (lines_.next())
    if (!trimmed(lines_.line()).empty())
      lines_.at().fail(quoted(lines_.line()) +
                       " stands behind the last element, expected the end of the file");
}

}  // namespace springstab
