#include "solvers/io/text_file.h"

#include <fcntl.h>
#include <poll.h>
#include <sys/stat.h>

#include <algorithm>
#include <array>
#include <cerrno>
#include <charconv>
#include <cmath>
#include <cstdio>
#include <limits>
#include <memory>
#include <system_error>

#include "solvers/io/input_error.h"

namespace springstab {
namespace {

constexpr std::string_view blanks = " \t\v\f\r";
constexpr std::string_view gzip = "\x1f\x8b";  // what its files begin with

/// std::from_chars does not know the sign '+'; here it may stand before a number, but not before another
/// sign.
std::string_view without_plus(std::string_view word) {
  const bool plus = word.size() > 1 && word[0] == '+' && word[1] != '-';
  return plus ? word.substr(1) : word;
}

/// A named pipe that nobody has opened for writing would read as empty. One who waits for its reader gets a
/// second to come; from then on reading blocks, however slow the writer.
void wait_for_writer(int pipe) {
  pollfd readable{pipe, POLLIN, 0};
  poll(&readable, 1, 1000);
  fcntl(pipe, F_SETFL, 0);
}

/// Of a decimal number outside the range of double precision, whether it lies below that range: whether the
/// power of ten of its first digit that is not 0 is negative.
bool is_tiny(std::string_view number) {
  const std::size_t letter = std::min(number.find_first_of("eE"), number.size());
  const std::string_view mantissa = number.substr(0, letter);
  const auto point = static_cast<long long>(std::min(mantissa.find('.'), mantissa.size()));
  const auto digit = static_cast<long long>(mantissa.find_first_of("123456789"));
  const std::string_view power = without_plus(number.substr(std::min(letter + 1, number.size())));
  long long exponent = 0;
  const auto error = std::from_chars(power.data(), power.data() + power.size(), exponent).ec;
  if (error == std::errc::result_out_of_range) return power.starts_with('-');
  return exponent < digit - point + (digit < point ? 1 : 0);
}

}  // namespace

std::string read_text_file(const std::string& path) {
  return read_file(path, [](std::string_view) { return false; });
}

std::string read_file(const std::string& path, bool (*is_binary)(std::string_view)) {
  const auto refuse = [&path](const std::string& why) {
    throw InputError(path, 0, why + ", expected a text file");
  };
  const auto fail = [&](const char* what, int error) {
    refuse(what + (" (" + std::generic_category().message(error)) + ')');
  };
  constexpr auto most = static_cast<std::size_t>(std::numeric_limits<int>::max());
  const auto check_size = [&](std::size_t bytes) {
    if (bytes > most) refuse("has more than 2^31 - 1 bytes");
  };

  const int descriptor = open(path.c_str(), O_RDONLY | O_CLOEXEC | O_NONBLOCK);
  if (descriptor < 0) fail("cannot be opened", errno);
  const std::unique_ptr<std::FILE, int (*)(std::FILE*)> file(fdopen(descriptor, "rb"), std::fclose);
  struct stat status = {};
  if (!file || fstat(descriptor, &status) != 0) fail("cannot be opened", errno);
  if (S_ISFIFO(status.st_mode))
    wait_for_writer(descriptor);
  else if (S_ISREG(status.st_mode))
    check_size(static_cast<std::size_t>(status.st_size));
  else if (!S_ISDIR(status.st_mode))  // a directory cannot be read, as will be said
    refuse("is a device");

  std::string text;
  bool binary = false;
  std::array<char, 1 << 16> buffer{};
  while (const std::size_t read = std::fread(buffer.data(), 1, buffer.size(), file.get())) {
    const std::size_t before = text.size();
    text.append(buffer.data(), read);
    check_size(text.size());
    if (before == 0) binary = is_binary(text);
    if (binary) continue;
    if (const std::size_t zero = text.find('\0', before); zero != text.npos) {
      const long lines = std::count(text.begin(), text.begin() + static_cast<std::ptrdiff_t>(zero), '\n');
      Location{path, 1 + lines}.fail(binary_file_message(text));
    }
  }
  if (std::ferror(file.get())) fail("cannot be read", errno);
  if (text.starts_with(gzip)) throw InputError(path, 0, binary_file_message(text));
  if (text.empty()) throw InputError(path, 0, "the file is empty, expected text");
  return text;
}

void Location::fail(const std::string& message) const {
  throw InputError(std::string(source), line, message);
}

std::string binary_file_message(std::string_view beginning) {
  const auto begins = [&](std::string_view magic) { return beginning.starts_with(magic); };
  const std::string_view remedy = begins("$MeshFormat")
                                      ? "`gmsh FILE -save -setnumber Mesh.Binary 0 -o NEW.msh` writes it"
                                  : begins(gzip) ? "`gunzip` unpacks it"
                                                 : "";
  return remedy.empty() ? "a zero byte, expected text in ASCII or UTF-8"
                        : "the file is binary, expected text: " + std::string(remedy);
}

double Location::real_shown_as(std::string_view number, std::string_view word) const {
  number = without_plus(number);
  double value = 0;
  const auto [end, error] = std::from_chars(number.data(), number.data() + number.size(), value);
  const bool whole = end == number.data() + number.size();
  if (error == std::errc() && whole && std::isfinite(value)) return value;
  if (is_not_finite(word)) fail(quoted(word) + " is not finite, expected a finite number");
  if (error != std::errc::result_out_of_range || !whole)
    fail(quoted(word) + " is not a number, expected one such as 1.5 or -2e-3");
  if (!is_tiny(number))
    fail(quoted(word) + " is out of range, expected a number that fits in double precision");
  return number.starts_with('-') ? -0.0 : 0.0;
}

double Location::fortran_real(std::string_view word) const {
  const std::size_t exponent = word.find_first_of("DdQqEe+-", 1);
  if (exponent == word.npos || word[exponent] == 'e' || word[exponent] == 'E') return real(word);
  const bool letter = word[exponent] != '+' && word[exponent] != '-';
  const std::string number =
      std::string(word.substr(0, exponent)) + 'e' + std::string(word.substr(exponent + letter));
  return real_shown_as(number, word);
}

long long Location::integer(std::string_view word) const {
  const std::string_view number = without_plus(word);
  long long value = 0;
  const auto [end, error] = std::from_chars(number.data(), number.data() + number.size(), value);
  if (error == std::errc::invalid_argument || end != number.data() + number.size())
    fail(quoted(word) + " is not an integer, expected one such as 12");
  if (error == std::errc::result_out_of_range)
    fail(quoted(word) + " is out of range, expected an integer of at most 18 digits");
  return value;
}

std::string quoted(std::string_view word) {
  constexpr std::size_t longest = 40;
  std::string shown(word.substr(0, longest));
  std::replace_if(
      shown.begin(), shown.end(), [](unsigned char c) { return c < ' ' || c > '~'; }, '?');
  return "'" + shown + (word.size() > longest ? "...'" : "'");
}

std::string lowercase(std::string_view text) {
  std::string lower(text);
  for (char& c : lower)
    if (c >= 'A' && c <= 'Z') c = static_cast<char>(c - 'A' + 'a');
  return lower;
}

std::string uppercase(std::string_view text) {
  std::string upper(text);
  for (char& c : upper)
    if (c >= 'a' && c <= 'z') c = static_cast<char>(c - 'a' + 'A');
  return upper;
}

std::string_view trimmed(std::string_view text) {
  const std::size_t begin = text.find_first_not_of(blanks);
  if (begin == text.npos) return {};
  return text.substr(begin, text.find_last_not_of(blanks) + 1 - begin);
}

bool is_not_finite(std::string_view word) {
  if (word.starts_with('+') || word.starts_with('-')) word.remove_prefix(1);
  if (word.starts_with("1.#")) return true;  // what the C library of MSVC prints
  const std::string lower = lowercase(word);
  return lower == "nan" || lower.starts_with("nan(") || lower == "inf" || lower == "infinity";
}

bool append_words(std::string_view line, std::vector<std::string_view>& words, char comment) {
  std::size_t end = 0;
  while (true) {
    const std::size_t begin = line.find_first_not_of(blanks, end);
    if (begin == line.npos) return true;
    if (line[begin] == comment) return false;
    end = std::min(line.find_first_of(blanks, begin), line.size());
    words.push_back(line.substr(begin, end - begin));
  }
}

LineReader::LineReader(std::string_view source, std::string_view text)
    : text_(text), rest_(text), at_{source, 0} {
  constexpr std::string_view byte_order_mark = "\xEF\xBB\xBF";
  if (rest_.starts_with(byte_order_mark)) rest_.remove_prefix(byte_order_mark.size());
}

void LineReader::go_to(std::size_t position) {
  rest_ = text_.substr(position);
  has_lines_ = false;
  at_.line = at_byte(position);
}

bool LineReader::next() {
  constexpr char end_of_file = '\x1a';  // how DOS ends one
  if (rest_.empty() || (rest_.size() == 1 && rest_[0] == end_of_file)) return false;
  if (!has_lines_) at_.line = at_byte(position());
  const auto ends_line = [](char c) { return c == '\n' || c == '\r'; };
  const auto end = static_cast<std::size_t>(std::ranges::find_if(rest_, ends_line) - rest_.begin());
  line_ = rest_.substr(0, end);
  const bool two = rest_.substr(end).starts_with("\r\n");
  rest_.remove_prefix(std::min(end + (two ? 2 : 1), rest_.size()));
  if (rest_.empty() && line_.ends_with(end_of_file)) line_.remove_suffix(1);
  if (has_lines_) ++at_.line;
  return true;
}

}  // namespace springstab
