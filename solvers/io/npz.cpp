#include "solvers/io/npz.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <vector>

#include "solvers/io/npy.h"
#include "solvers/io/zip.h"

namespace springstab {
namespace {

class NpzReader {
 public:
  NpzReader(const std::string& source, std::string_view bytes) : source_(source), archive_(source, bytes) {}

  Eigen::SparseMatrix<double> read(Duplicates duplicates) {
    const std::string form = letters("format.npy");
    if (form != "csr" && form != "csc" && form != "coo")
      fail("the matrix is in the form " + springstab::quoted(form) + ", expected csr, csc or coo: A.tocsr()");
    const std::vector<long long> shape = integers("shape.npy");
    constexpr long long most = std::numeric_limits<int>::max();
    if (shape.size() != 2 || std::ranges::any_of(shape, [](long long n) { return n < 1 || n > most; }))
      fail("the shape is none of a matrix, expected two numbers from 1 to 2^31 - 1");
    const std::vector<double> values = npy_numbers(place("data.npy"), archive_.content("data.npy"));
    for (std::size_t i = 0; i < values.size(); ++i)
      if (!std::isfinite(values[i]))
        fail("number " + std::to_string(i) + " of data is not finite, expected finite numbers");
    check_rows({source_}, static_cast<int>(shape[0]), static_cast<int>(shape[1]),
               static_cast<long long>(values.size()));
    MatrixBuilder builder(source_, static_cast<int>(shape[0]), static_cast<int>(shape[1]), Symmetry::general);
    builder.reserve(values.size());
    if (form == "coo") {
      const std::vector<long long> rows = integers("row.npy"), columns = integers("col.npy");
      check_size("row", rows.size(), values.size());
      check_size("col", columns.size(), values.size());
      for (std::size_t i = 0; i < values.size(); ++i)
        builder.add(0, one_more(rows[i]), one_more(columns[i]), values[i]);
    } else {
      compressed(builder, form == "csr", static_cast<std::size_t>(shape[form == "csr" ? 0 : 1]), values);
    }
    return std::move(builder).build(duplicates);
  }

 private:
  /// Line (row or column) l has the entries from ends[l] to ends[l + 1].
  void compressed(MatrixBuilder& builder, bool by_rows, std::size_t lines,
                  const std::vector<double>& values) {
    const std::vector<long long> ends = integers("indptr.npy"), indices = integers("indices.npy");
    check_size("indices", indices.size(), values.size());
    check_size("indptr", ends.size(), lines + 1);
    if (ends.front() != 0 || ends.back() != static_cast<long long>(values.size()) ||
        !std::ranges::is_sorted(ends))
      fail("indptr is out of order, expected numbers that ascend from 0 to the " +
           std::to_string(values.size()) + " of data");
    for (std::size_t line = 0; line < lines; ++line)
      for (auto i = static_cast<std::size_t>(ends[line]); i < static_cast<std::size_t>(ends[line + 1]); ++i) {
        const auto number = static_cast<long long>(line) + 1, index = one_more(indices[i]);
        builder.add(0, by_rows ? number : index, by_rows ? index : number, values[i]);
      }
  }

  /// The builder counts from 1.
  static long long one_more(long long index) {
    return index < std::numeric_limits<int>::max() ? index + 1 : index;
  }

  std::string place(const std::string& file) const { return source_ + ": " + file; }
  [[noreturn]] void fail(const std::string& what) const { Location{source_}.fail(what); }
  std::vector<long long> integers(const std::string& file) const {
    return npy_integers(place(file), archive_.content(file));
  }
  std::string letters(const std::string& file) const {
    return npy_letters(place(file), archive_.content(file));
  }
  void check_size(const std::string& array, std::size_t size, std::size_t expected) const {
    if (size != expected)
      fail(array + " has " + std::to_string(size) + " numbers, expected " + std::to_string(expected));
  }

  const std::string& source_;
  ZipArchive archive_;
};

}  // namespace

Eigen::SparseMatrix<double> parse_npz(const std::string& source, std::string_view bytes,
                                      Duplicates duplicates) {
  return NpzReader(source, bytes).read(duplicates);
}

}  // namespace springstab
