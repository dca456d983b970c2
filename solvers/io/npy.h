// NumPy's .npy files: one array of real numbers (NumPy Enhancement Proposal 1, versions 1 to 3 of the
// format).
#pragma once

#include <string>
#include <string_view>
#include <vector>

namespace springstab {

struct NpyArray {
  std::vector<long long> shape;
  std::vector<double> values;  // the last index fastest
};

/// Parses floating point numbers of 4 or 8 bytes of either byte order. NaN and infinities are numbers. Throws
/// InputError for other types, for an order of indices other than C's, and for more or fewer bytes than the
/// shape says.
NpyArray parse_npy(const std::string& source, std::string_view bytes);

NpyArray read_npy(const std::string& path);

/// Arrays of one dimension, as archives have them; they may be empty. Numbers: real ones, integers or truth
/// values. Throw InputError likewise.
std::vector<double> npy_numbers(const std::string& source, std::string_view bytes);
std::vector<long long> npy_integers(const std::string& source, std::string_view bytes);

/// The ASCII letters of an array of one string.
std::string npy_letters(const std::string& source, std::string_view bytes);

}  // namespace springstab
