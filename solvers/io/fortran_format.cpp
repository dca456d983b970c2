#include "solvers/io/fortran_format.h"

#include <algorithm>
#include <charconv>
#include <optional>

namespace springstab {
namespace {

/// Walks through a format and lists its fields. What is wrong is said in problem().
class FormatWalk {
 public:
  FormatWalk(std::string_view format, std::string_view kinds) : format_(format), kinds_(kinds) {}

  /// From `begin`, within the outer parentheses, to the format's end; a scale factor stays in force.
  std::vector<FortranField> fields(std::size_t begin) {
    rest_ = format_.substr(begin);
    fields_.clear();
    line_ = column_ = 0;
    list(0);
    if (good_ && !rest_.empty()) good_ = false;
    return fields_;
  }
  bool good() const { return good_; }
  long long lines() const { return line_ + 1; }
  /// Where the last group of the outermost level begins, with its repeat count; else the whole.
  std::size_t last_group() const { return last_group_; }

 private:
  static constexpr int most = 10'000;  // fields, columns, lines: of a format one types

  bool skip(std::string_view word) {
    if (!rest_.starts_with(word)) return false;
    rest_.remove_prefix(word.size());
    return true;
  }

  /// A number, if one stands here; the sign of a scale factor is not part of it.
  std::optional<int> number() {
    int value = 0;
    const auto [end, error] = std::from_chars(rest_.data(), rest_.data() + rest_.size(), value);
    if (error == std::errc::invalid_argument || rest_.starts_with('-')) return std::nullopt;
    rest_.remove_prefix(static_cast<std::size_t>(end - rest_.data()));
    if (error != std::errc() || value > most) good_ = false;
    return value;
  }

  /// Items up to and including a closing parenthesis.
  void list(int depth) {
    while (good_ && !skip(")")) {
      if (rest_.empty() || depth > 10 || ++items_ > most) good_ = false;
      if (good_ && !skip(",")) item(depth);
    }
  }

  void item(int depth) {
    const std::size_t begin = format_.size() - rest_.size();
    const bool negative = skip("-");
    if (!negative) skip("+");
    const std::optional<int> count = number();
    const int times = count.value_or(1);
    if (count && skip("P")) {
      scale_ = negative ? -times : times;
      return;
    }
    if (negative || times < 1 || line_ > most || column_ > most) good_ = false;
    if (!good_) return;
    if (skip("(")) {
      if (depth == 0) last_group_ = begin;
      group(times, depth);
    } else if (skip("X")) {
      column_ += times;
    } else if (skip("/")) {
      line_ += times;
      column_ = 0;
    } else if (!count && skip("T")) {
      tabulate();
    } else if (count || !(skip(":") || skip("BN") || skip("SP") || skip("SS") || skip("S"))) {
      data(times);
    }
  }

  void group(int times, int depth) {
    const std::string_view inside = rest_;
    for (int i = 0; i < times && good_; ++i) {
      rest_ = inside;
      list(depth + 1);
    }
  }

  void tabulate() {
    const bool left = skip("L"), right = !left && skip("R");
    const int n = number().value_or(0);
    if (n < 1) good_ = false;
    column_ = left ? std::max(0, column_ - n) : right ? column_ + n : n - 1;
  }

  void data(int times) {
    if (rest_.empty() || kinds_.find(rest_.front()) == kinds_.npos) {
      good_ = false;
      return;
    }
    FortranField field;
    field.kind = rest_.front();
    rest_.remove_prefix(1);
    if (field.kind == 'E' && !skip("S")) skip("N");
    field.width = number().value_or(0);
    if (skip(".")) field.decimals = number().value_or(-1);
    if (field.kind != 'I' && skip("E") && !number()) good_ = false;  // width of the exponent
    if (field.kind == 'I') field.decimals = 0;                       // Iw.m: digits to write
    if (field.width < 1 || field.decimals < 0) good_ = false;
    field.scale = scale_;
    for (int i = 0; i < times && good_; ++i) {
      field.line = line_;
      field.column = column_;
      fields_.push_back(field);
      column_ += field.width;
      if (fields_.size() > most) good_ = false;
    }
  }

  std::string_view format_, kinds_, rest_;
  std::vector<FortranField> fields_;
  std::size_t last_group_ = 1;
  int line_ = 0, column_ = 0, scale_ = 0, items_ = 0;
  bool good_ = true;
};

}  // namespace

FortranFormat FortranFormat::take(std::string_view& line, std::string_view kinds, const Location& at) {
  FortranFormat format;
  const std::size_t open = std::min(line.find('('), line.size());
  std::size_t end = open;
  int depth = 0;
  do {
    if (end == line.size()) break;
    const char c = line[end++];
    depth += c == '(' ? 1 : c == ')' ? -1 : 0;
    if (c != ' ') format.text_ += c;
  } while (depth > 0);
  format.text_ = uppercase(format.text_);
  line.remove_prefix(end);

  FormatWalk walk(format.text_, kinds);
  if (!format.text_.empty()) {
    format.first_ = walk.fields(1);
    format.first_lines_ = walk.lines();
    format.again_ = walk.fields(walk.last_group());
    format.again_lines_ = walk.lines();
  }
  if (!walk.good() || format.again_.empty())
    at.fail("cannot use the format " + quoted(format.text_) + ", expected one such as " +
            (kinds == "I" ? "(16I5)" : "(4E20.12), (1P,5D16.8) or (10F7.1)"));
  return format;
}

FortranField FortranFormat::field(long long k) const {
  const auto once = static_cast<long long>(first_.size()), again = static_cast<long long>(again_.size());
  if (k < once) return first_[static_cast<std::size_t>(k)];
  FortranField field = again_[static_cast<std::size_t>((k - once) % again)];
  field.line += first_lines_ + (k - once) / again * again_lines_;
  return field;
}

long long FortranFormat::lines_for(long long numbers) const {
  if (numbers == 0) return 0;
  // Up to the field that no number is left for; a format that ends there takes no further line.
  const auto once = static_cast<long long>(first_.size()), again = static_cast<long long>(again_.size());
  const bool at_end = numbers >= once && (numbers - once) % again == 0;
  return at_end ? first_lines_ + (numbers - once) / again * again_lines_ : field(numbers).line + 1;
}

double fortran_number(std::string_view text, const FortranField& field, const Location& at) {
  const std::size_t exponent = text.find_first_of("EeDdQq+-", 1);
  std::string number(text.substr(0, exponent));
  if (exponent != text.npos) {
    const bool letter = text[exponent] != '+' && text[exponent] != '-';
    number += 'e';
    for (const char c : text.substr(exponent + letter))
      if (c != ' ') number += c;
  } else if (field.scale != 0) {
    number += 'e' + std::to_string(-field.scale);
  }
  const double value = at.real_shown_as(number, text);
  if (value == 0) return value;
  if (field.kind != 'I' && field.decimals > 0 && text.find('.') == text.npos)
    at.fail(quoted(text) + " has no decimal point, expected one, as the format implies " +
            std::to_string(field.decimals) + " decimals");
  if (field.kind == 'G' && field.scale != 0 && exponent == text.npos)
    at.fail(quoted(text) + " has no exponent, expected one under G with a scale factor");
  return value;
}

}  // namespace springstab
