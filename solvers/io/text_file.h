// A text file in memory, its lines, words and numbers, and the place that an error must name: all that the
// strict readers of this folder share. Numbers are read with std::from_chars, whatever the locale.
#pragma once

#include <algorithm>
#include <cstddef>
#include <string>
#include <string_view>
#include <vector>

namespace springstab {

/// The whole file, or what comes through a pipe. Throws InputError where there is no text of at most 2^31 - 1
/// bytes: missing, unreadable, a directory, a device (which may have no end), empty, with a zero byte (which
/// no text has, but a binary file does and the hole of a sparse one), or a pipe that nobody opens for writing
/// within a second.
std::string read_text_file(const std::string& path);

/// The same, but with zero bytes where the file's beginning (64 KiB, or all of it) shows a binary format that
/// the caller reads.
std::string read_file(const std::string& path, bool (*is_binary)(std::string_view beginning));

/// "the file is binary, expected text: ..." with what makes text of it, where its beginning tells the format;
/// else that it has a zero byte.
std::string binary_file_message(std::string_view beginning);

/// A line (from 1) of a source, or at_byte() of a binary one; what is read from it fails with an InputError
/// that names it.
struct Location {
  std::string_view source;
  long line = 0;

  [[noreturn]] void fail(const std::string& message) const;

  /// `word` as a finite number: "1", "+.5", "-2e-3", never "inf", "1.#QNAN", "0x1" or "1,5". One that is too
  /// small for double precision is 0.
  double real(std::string_view word) const { return real_shown_as(word, word); }
  /// The same, with exponents as Fortran writes them, too: "1D2", "1d2", "1q2" and "1.5-103".
  double fortran_real(std::string_view word) const;
  /// `number`, which messages quote as `word`.
  double real_shown_as(std::string_view number, std::string_view word) const;
  /// `word` as a decimal integer.
  long long integer(std::string_view word) const;
};

/// `word` in quotes as a message can show it: shortened, in printable ASCII.
std::string quoted(std::string_view word);

/// The text with its ASCII letters in one case.
std::string lowercase(std::string_view text);
std::string uppercase(std::string_view text);

/// Whether a list holds a value.
template <class Values, class Value>
bool is_among(const Values& values, const Value& value) {
  return std::ranges::find(values, value) != values.end();
}

/// `text` without its leading and trailing blanks.
std::string_view trimmed(std::string_view text);

/// Whether `word` is how some program writes what is no finite number: "nan", "-inf", "1.#IND00".
bool is_not_finite(std::string_view word);

/// Appends the blank-separated words of `line`, as views into it, up to one that begins with the sign of a
/// comment: within a word that sign begins none. Returns whether there was no comment.
bool append_words(std::string_view line, std::vector<std::string_view>& words, char comment = '\n');

/// Walks through a text line by line. Lines end in LF, CR LF or CR; a UTF-8 byte order mark and a final
/// Ctrl-Z are skipped.
/// Source and text must outlive the reader.
class LineReader {
 public:
  LineReader(std::string_view source, std::string_view text);

  /// Steps to the next line; false when there is none (line() and at() then stay at the last).
  bool next();
  std::string_view line() const { return line_; }
  Location at() const { return at_; }
  std::size_t bytes_left() const { return rest_.size(); }

  /// How many bytes of the text lie before what comes next.
  std::size_t position() const { return text_.size() - rest_.size(); }
  /// Goes on there, behind what is no text: from then on places are bytes.
  void go_to(std::size_t position);

 private:
  std::string_view text_, rest_, line_;
  Location at_;
  bool has_lines_ = true;
};

}  // namespace springstab
