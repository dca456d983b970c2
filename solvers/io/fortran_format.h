// Fortran's formats of numbers, as the header of a Harwell-Boeing file gives them: which columns of which
// line hold the next number, and what it is (ISO/IEC 1539-1, "Input/output editing").
#pragma once

#include <string>
#include <string_view>
#include <vector>

#include "solvers/io/text_file.h"

namespace springstab {

/// Where a number stands: `width` columns from `column` (from 0) of a line; and how it is written.
struct FortranField {
  long long line = 0;  // from 0, of those that the format describes
  int column = 0, width = 0, decimals = 0, scale = 0;
  char kind = 'I';  // I, F, E, D or G
};

/// A parsed format: (16I5), (1P,5D16.8), (1X,8I9), (3(1P,E24.16)), (I3,T10,2F8.0/4(2X,ES12.4E3)). Its fields
/// are read in their order; when numbers are left at its end, the next line begins and the last group in
/// parentheses, or the whole if there is none, is taken again.
class FortranFormat {
 public:
  FortranFormat() = default;

  /// Takes the next format in parentheses out of a line of the header. Throws InputError for what is no
  /// format of numbers of `kinds`: "I" for integers, "IFEDG" for numbers.
  static FortranFormat take(std::string_view& line, std::string_view kinds, const Location& at);

  /// In capitals, without blanks.
  const std::string& text() const { return text_; }

  /// Of number k, from 0.
  FortranField field(long long k) const;
  /// How many lines a READ of so many numbers takes.
  long long lines_for(long long numbers) const;

 private:
  std::string text_;
  std::vector<FortranField> first_, again_;  // the fields of the whole format; of what is repeated
  long long first_lines_ = 0, again_lines_ = 0;
};

/// The number in a field, trimmed and not empty, as a READ would give it: an exponent may have the letter E,
/// D or Q or none ("1.5-103") and a blank in place of its plus sign; without an exponent a scale factor kP
/// divides by 10^k. An error where programs do not agree on the meaning, unless the number is 0: an implied
/// decimal point, and a scale factor under G, which a WRITE would not have applied.
double fortran_number(std::string_view text, const FortranField& field, const Location& at);

}  // namespace springstab
