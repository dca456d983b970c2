// A symmetric sparse matrix of 3x3 blocks, for the stiffness and damping of particle systems. Only the lower
// triangle is stored: half the memory, and half of what a product reads.
//
// Blocks are stored one after another in the order of the pattern, those on the diagonal symmetric. A block
// is 9 doubles, row by row. The pattern is fixed at construction, values change.
#pragma once

#include <Eigen/SparseCore>
#include <optional>
#include <vector>

#include "solvers/linear/block_pattern.h"
#include "solvers/linear/four.h"
#include "solvers/linear/row_parts.h"

namespace springstab {

/// A block as it is stored, row by row.
using Block3 = Eigen::Matrix<double, 3, 3, Eigen::RowMajor>;

class BlockSparseMatrix {
 public:
  /// Zero, with a block at each place of the pattern.
  explicit BlockSparseMatrix(SharedPattern pattern);
  /// With a pattern of its own.
  BlockSparseMatrix(int rows, std::span<const std::pair<int, int>> couplings)
      : BlockSparseMatrix(std::make_shared<BlockPattern>(rows, couplings)) {}

  const SharedPattern& pattern() const { return pattern_; }
  int rows() const { return pattern_->rows(); }
  /// Those stored.
  long blocks() const { return pattern_->blocks(); }

  double* block(long place) { return &value_[9 * place]; }
  const double* block(long place) const { return &value_[9 * place]; }
  /// See BlockPattern.
  long find(int i, int j) const { return pattern_->find(i, j); }
  long diagonal(int i) const { return pattern_->diagonal(i); }
  long row_begin(int i) const { return pattern_->row_begin(i); }
  int column(long place) const { return pattern_->column(place); }

  /// What the matrix takes in memory, with its pattern.
  std::size_t bytes() const {
    return sizeof(double) * (value_.size() + static_cast<std::size_t>(sum_.size())) + pattern_->bytes();
  }

  void set_zero();

  /// Becomes diag(d) A diag(d).
  void scale(const Eigen::VectorXd& d);

  /// out = A in; both of length 3·rows(), not overlapping. Moves 76 bytes per block and 120 per row. Not for
  /// two callers at a time: it works in memory of the matrix's own.
  void multiply(const double* in, double* out) const;

  /// The same, row by row from the last to the first: take(i, y) gets the three numbers of row i, so that
  /// what is done with the product needs no further pass over memory.
  template <class Take>
  void multiply_rows(const double* in, const Take& take) const;
  /// The same for some of the rows, after all that come after them: a product in parts, whose last part ends
  /// with row 0. Row i reads from `in` the rows up to i alone. Parts of several products may alternate whose
  /// rows are more than a bandwidth apart.
  template <class Take>
  void multiply_rows(const double* in, const IndexRange& rows, const Take& take) const {
    multiply_rows<Above::within>(in, rows, 0, take);
  }
  /// The same, where it is worth it with the rows divided among threads (solvers/team.h), which take at once.
  template <class Take>
  void share_rows(const double* in, const Take& take) const;

  /// Both triangles.
  Eigen::SparseMatrix<double> to_sparse() const;

 private:
  SharedPattern pattern_;
  std::vector<double> value_;    // 9 per block, and one to read beyond the last
  mutable Eigen::VectorXd sum_;  // of a product, what the rows below have added: 4 per row, zeros in between
  mutable RowParts parts_;

  template <class Visit>
  void visit_entries(const Visit& visit) const;

  enum class Above { within, beyond };  // whether rows have blocks in the columns before their own part
  template <Above above, class Take>
  void multiply_rows(const double* in, const IndexRange& rows, long first_column, const Take& take) const;
  void add_from_below(const double* in, const RowPart& part) const;
};

// Block (i, j) serves row i and, transposed, row j, to which the rows below have added all they have by the
// time it is its turn. Blocks are read by rows of four numbers, of which the last belongs to what follows:
// its product is dropped at the end of the row. Sums are padded to four, lest a vector is read back that lies
// across two which have not left the store buffer yet.
template <BlockSparseMatrix::Above above, class Take>
void BlockSparseMatrix::multiply_rows(const double* in, const IndexRange& range, long first_column,
                                      const Take& take) const {
  constexpr long ahead =
      256;  // numbers to prefetch, two kilobytes: the hardware alone reaches 80 % of the memory
  if (range.first == range.last) return;
  const int last = rows() - 1;
  const double* const in_last = in + 3 * (range.last - 1);  // of what others may be making, nothing
  const double copy[4] = {in_last[0], in_last[1], in_last[2], 0};
  const long* const row_start = pattern_->row_start_.data();
  const int* const column = pattern_->column_.data();
  const double* b = value_.data() + 9 * row_start[range.last];
  double* const sum = sum_.data();
  for (int i = static_cast<int>(range.last) - 1; i >= range.first; --i) {
    const double* const ui = i == last ? copy : in + 3 * static_cast<long>(i);
    const Four u0 = Four::Constant(ui[0]), u1 = Four::Constant(ui[1]), u2 = Four::Constant(ui[2]);
    const Four u = ConstFourAt(ui);
    b -= 9;
    Four s0 = ConstFourAt(b) * u, s1 = ConstFourAt(b + 3) * u, s2 = ConstFourAt(b + 6) * u;
    for (long k = row_start[i + 1] - 1; k-- > row_start[i];) {
      b -= 9;
      __builtin_prefetch(b - ahead);
      __builtin_prefetch(b - ahead + 8);
      const long j = column[k];
      const Four r0 = ConstFourAt(b), r1 = ConstFourAt(b + 3), r2 = ConstFourAt(b + 6),
                 uj = ConstFourAt(in + 3 * j);
      s0 += r0 * uj;
      s1 += r1 * uj;
      s2 += r2 * uj;
      if (above == Above::beyond && j < first_column) continue;  // whose part adds it itself
      FourAt to(sum + 4 * j);
      to += r0 * u0 + r1 * u1 + r2 * u2;
    }
    FourAt own(sum + 4 * static_cast<long>(i));
    const Four total = own + sums_of_three(s0, s1, s2);
    own = Four::Zero();
    const Eigen::Vector3d y(total[0], total[1], total[2]);
    take(i, y);
  }
}

template <class Take>
void BlockSparseMatrix::multiply_rows(const double* in, const Take& take) const {
  multiply_rows<Above::within>(in, {0, rows()}, 0, take);
}

// Each part first adds up what the rows below it have for its own, in the order in which they would have
// added it themselves.
template <class Take>
void BlockSparseMatrix::share_rows(const double* in, const Take& take) const {
  const std::span<const RowPart> parts = parts_.of(*pattern_);
  if (parts.size() <= 1) return multiply_rows(in, take);
  share(static_cast<int>(parts.size()), [&](int p) {
    const RowPart& part = parts[p];
    add_from_below(in, part);
    multiply_rows<Above::within>(in, {part.inner, part.rows.last}, 0, take);
    multiply_rows<Above::beyond>(in, {part.rows.first, part.inner}, part.rows.first, take);
  });
}

/// A symmetric matrix as blocks, where its rows come in threes and this takes less memory; else nothing.
std::optional<BlockSparseMatrix> in_blocks(const Eigen::SparseMatrix<double>& a);

/// block += a I + b n nᵀ, with n a vector of 3: the shape of every spring's Jacobian.
inline void add_isotropic_and_axial(double* block, double a, double b, const double* n) {
  for (int r = 0; r < 3; ++r)
    for (int c = 0; c < 3; ++c) block[3 * r + c] += (r == c ? a : 0.0) + b * (n[r] * n[c]);
}

}  // namespace springstab
