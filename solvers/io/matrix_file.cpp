#include "solvers/io/matrix_file.h"

#include <filesystem>
#include <string_view>

#include "solvers/io/abaqus.h"
#include "solvers/io/harwell_boeing.h"
#include "solvers/io/input_error.h"
#include "solvers/io/matrix_market.h"
#include "solvers/io/npz.h"
#include "solvers/io/petsc.h"
#include "solvers/io/text_file.h"
#include "solvers/io/zip.h"

namespace springstab {
namespace {

/// .hb, .rb, or a matrix type: real, complex, pattern or integer; its symmetry; assembled or elemental.
bool is_harwell_boeing_suffix(std::string_view suffix) {
  const auto has = [suffix](std::size_t i, std::string_view letters) {
    return letters.find(suffix[i]) != letters.npos;
  };
  return suffix == ".hb" || suffix == ".rb" ||
         (suffix.size() == 4 && has(1, "rcpi") && has(2, "suhzr") && has(3, "ae"));
}

}  // namespace

Eigen::SparseMatrix<double> read_matrix(const std::string& path, Duplicates duplicates) {
  const std::string text = read_file(
      path, [](std::string_view beginning) { return is_zip(beginning) || is_petsc_matrix(beginning); });
  if (is_zip(text)) return parse_npz(path, text, duplicates);
  if (is_petsc_matrix(text)) return parse_petsc(path, text, duplicates);
  if (has_matrix_market_banner(text)) return parse_matrix_market(path, text, duplicates);
  if (looks_like_harwell_boeing(text)) return parse_harwell_boeing(path, text, duplicates);
  if (looks_like_abaqus(text)) return parse_abaqus(path, text, duplicates);
  const std::string suffix = lowercase(std::filesystem::path(path).extension().string());
  if (suffix == ".mtx" || suffix == ".mm") return parse_matrix_market(path, text, duplicates);
  if (is_harwell_boeing_suffix(suffix)) return parse_harwell_boeing(path, text, duplicates);
  throw InputError(
      path, 1,
      "neither a Matrix Market banner nor a Harwell-Boeing header, expected a file that begins with "
      "'%%MatrixMarket' or one of Harwell-Boeing's");
}

}  // namespace springstab
