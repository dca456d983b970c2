#include "solvers/linear/block_ssor.h"

#include <Eigen/Cholesky>
#include <algorithm>

#include "solvers/linear/four.h"

namespace springstab {
namespace {

// Blocks have rows of three. Read as four, the last number belongs to what follows and is dropped in the end.
struct Rows {
  Four r0 = Four::Zero(), r1 = r0, r2 = r0;

  Rows() = default;
  explicit Rows(const double* block)
      : r0(ConstFourAt(block)), r1(ConstFourAt(block + 3)), r2(ConstFourAt(block + 6)) {}
  void add(double factor, const double* block) {
    r0 += factor * ConstFourAt(block);
    r1 += factor * ConstFourAt(block + 3);
    r2 += factor * ConstFourAt(block + 6);
  }
  Four transposed_times(const double* w) const { return r0 * w[0] + r1 * w[1] + r2 * w[2]; }
};

}  // namespace

void BlockSsor::set_pattern(const BlockSparseMatrix& stiffness, const BlockSparseMatrix* damping) {
  row_start_.assign(1, 0);
  for (int i = 0; i < stiffness.rows(); ++i) {
    const long begin = row_start_.back();
    for (const BlockSparseMatrix* a : {&stiffness, damping})
      for (long k = a ? a->row_begin(i) : 0; a && k < a->diagonal(i); ++k) column_.push_back(a->column(k));
    std::sort(column_.begin() + begin, column_.end());
    column_.erase(std::unique(column_.begin() + begin, column_.end()), column_.end());
    row_start_.push_back(static_cast<long>(column_.size()));
  }
  value_.resize(9 * column_.size() + 1);
  factor_.resize(12 * static_cast<std::size_t>(rows()));
  solution_.setZero(4 * static_cast<long>(rows()));
  sum_.setZero(4 * static_cast<long>(rows()));
}

bool BlockSsor::set(double m, const std::vector<double>& mass, double k, const BlockSparseMatrix& stiffness,
                    double c, const BlockSparseMatrix* damping) {
  if (row_start_.empty()) set_pattern(stiffness, damping);
  double* out = value_.data();
  for (int i = 0; i < rows(); ++i) {
    Block3 diagonal = k * Eigen::Map<const Block3>(stiffness.block(stiffness.diagonal(i)));
    if (damping) diagonal += c * Eigen::Map<const Block3>(damping->block(damping->diagonal(i)));
    diagonal.diagonal().array() += m * mass[i];
    const Eigen::LLT<Block3> cholesky(diagonal / relaxation);
    if (cholesky.info() != Eigen::Success) return false;
    const Block3 inverse = cholesky.matrixL().solve(Block3::Identity());
    Eigen::Map<Eigen::Matrix<double, 3, 4, Eigen::RowMajor>>(&factor_[12 * static_cast<long>(i)])
        << inverse.transpose(),
        Eigen::Vector3d::Zero();

    // L̂_ij = C_i⁻¹ H_ij C_j⁻ᵀ, row by row; what spills over the end of a row is overwritten by the next.
    long in_stiffness = stiffness.row_begin(i), in_damping = damping ? damping->row_begin(i) : 0;
    for (long place = row_start_[i]; place < row_start_[i + 1]; ++place, out += 9) {
      const int j = column_[place];
      Rows h;
      if (stiffness.column(in_stiffness) == j) h.add(k, stiffness.block(in_stiffness++));
      if (damping && damping->column(in_damping) == j) h.add(c, damping->block(in_damping++));
      const double* other = &factor_[12 * static_cast<long>(j)];
      for (int r = 0; r < 3; ++r) {
        const Four half = h.r0 * inverse(r, 0) + h.r1 * inverse(r, 1) + h.r2 * inverse(r, 2);
        FourAt{out + 3 * r} = ConstFourAt(other) * half[0] + ConstFourAt(other + 4) * half[1] +
                              ConstFourAt(other + 8) * half[2];
      }
    }
  }
  return true;
}

// u = (1 + L̂)⁻¹ r with r_i = right(i) and take(i, u_i), i ascending, in fours.
template <class Right, class Take>
void BlockSsor::solve(const Right& right, const Take& take) {
  const double* b = value_.data();
  double* const u = solution_.data();
  for (long i = 0; i < rows(); ++i) {
    Four s0 = Four::Zero(), s1 = s0, s2 = s0;
    for (long k = row_start_[i]; k < row_start_[i + 1]; ++k, b += 9) {
      const ConstFourAt uj(u + 4 * static_cast<long>(column_[k]));
      const Rows row(b);
      s0 += row.r0 * uj;
      s1 += row.r1 * uj;
      s2 += row.r2 * uj;
    }
    const Four ui = right(i) - sums_of_three(s0, s1, s2);
    FourAt{u + 4 * i} = ui;
    take(i, ui);
  }
}

// u = (1 + L̂)⁻ᵀ r with r_i = right(i) and take(i, u_i), i descending, in fours.
template <class Right, class Take>
void BlockSsor::solve_transposed(const Right& right, const Take& take) {
  double* const sum = sum_.data();
  for (long i = rows() - 1; i >= 0; --i) {
    Four ui = right(i) - ConstFourAt(sum + 4 * i);
    ui[3] = 0;
    FourAt{sum + 4 * i} = Four::Zero();
    take(i, ui);
    for (long k = row_start_[i]; k < row_start_[i + 1]; ++k)
      FourAt{sum + 4 * static_cast<long>(column_[k])} += Rows(&value_[9 * k]).transposed_times(ui.data());
  }
}

void BlockSsor::transform(const Vector& b, Vector& transformed) {
  transformed.resize(4 * static_cast<long>(rows()));
  solve(
      [&](long i) -> Four {  // C⁻¹ b
        const Eigen::Map<const Eigen::Matrix<double, 4, 3>> inverse(&factor_[12 * i]);
        return (inverse * b.segment<3>(3 * i)).array();
      },
      [&](long i, const Four& u) { FourAt{transformed.data() + 4 * i} = u; });
}

void BlockSsor::transform_back(const Vector& transformed, Vector& y) {
  y.resize(3 * static_cast<long>(rows()));
  solve_transposed([&](long i) -> Four { return ConstFourAt(transformed.data() + 4 * i); },
                   [&](long i, const Four& u) {  // C⁻ᵀ u
                     const Eigen::Map<const Eigen::Matrix<double, 4, 3>> inverse(&factor_[12 * i]);
                     y.segment<3>(3 * i) = inverse.transpose() * u.matrix();
                   });
}

double BlockSsor::multiply(const Vector& in, Vector& out) {
  out.resize(in.size());
  const double* const p = in.data();
  double* const q = out.data();
  Four dot = Four::Zero();
  solve_transposed([&](long i) -> Four { return ConstFourAt(p + 4 * i); },
                   [&](long i, const Four& t) { FourAt{q + 4 * i} = t; });
  solve([&](long i) -> Four { return ConstFourAt(p + 4 * i) - (2 - relaxation) * ConstFourAt(q + 4 * i); },
        [&](long i, const Four& u) {
          FourAt qi(q + 4 * i);
          qi += u;
          dot += qi * ConstFourAt(p + 4 * i);
        });
  return dot.sum();
}

}  // namespace springstab
