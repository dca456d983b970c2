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

// L̂ and what its rows leave for each other. By value: the compiler takes anything in memory for changed
// wherever four numbers are stored.
struct Triangle {
  const long* row_start;
  const int* column;
  const double* value;
  double *solution, *sum;

  // u_i = right(i) - Σ L̂_ij u_j with the solution's u_j, in fours; returns take(i, u_i).
  template <class Right, class Take>
  Four gather(long i, const Right& right, const Take& take) const {
    const double* b = value + 9 * row_start[i];
    Four s0 = Four::Zero(), s1 = s0, s2 = s0;
    for (long k = row_start[i]; k < row_start[i + 1]; ++k, b += 9) {
      const ConstFourAt uj(solution + 4 * static_cast<long>(column[k]));
      const Rows row(b);
      s0 += row.r0 * uj;
      s1 += row.r1 * uj;
      s2 += row.r2 * uj;
    }
    const Four ui = right(i) - sums_of_three(s0, s1, s2);
    FourAt{solution + 4 * i} = ui;
    return take(i, ui);
  }

  // u_i = right(i) - what was scattered to it, in fours, and L̂_ijᵀ u_i scattered to each j; returns
  // take(i, u_i).
  template <class Right, class Take>
  Four scatter(long i, const Right& right, const Take& take) const {
    Four ui = right(i) - ConstFourAt(sum + 4 * i);
    ui[3] = 0;
    FourAt{sum + 4 * i} = Four::Zero();
    const Four taken = take(i, ui);
    for (long k = row_start[i]; k < row_start[i + 1]; ++k)
      FourAt{sum + 4 * static_cast<long>(column[k])} += Rows(value + 9 * k).transposed_times(ui.data());
    return taken;
  }
};

using FactorRows = Eigen::Matrix<double, 3, 4, Eigen::RowMajor>;  // of C⁻ᵀ, the last column zero

// H = m M + k K + c C.
struct Combination {
  double m;
  const std::vector<double>& mass;
  double k;
  const BlockSparseMatrix& stiffness;
  double c;
  const BlockSparseMatrix* damping;

  Block3 diagonal(int i) const {
    Block3 sum = k * Eigen::Map<const Block3>(stiffness.block(stiffness.diagonal(i)));
    if (damping) sum += c * Eigen::Map<const Block3>(damping->block(damping->diagonal(i)));
    sum.diagonal().array() += m * mass[i];
    return sum;
  }
};

// The blocks of a row of H below the diagonal, asked for by ascending columns.
class BelowDiagonal {
 public:
  BelowDiagonal(const Combination& h, int i)
      : h_(h),
        in_stiffness_(h.stiffness.row_begin(i)),
        in_damping_(h.damping ? h.damping->row_begin(i) : 0) {}

  Rows at(int column) {
    Rows sum;
    if (h_.stiffness.column(in_stiffness_) == column) sum.add(h_.k, h_.stiffness.block(in_stiffness_++));
    if (h_.damping && h_.damping->column(in_damping_) == column)
      sum.add(h_.c, h_.damping->block(in_damping_++));
    return sum;
  }

 private:
  const Combination& h_;
  long in_stiffness_, in_damping_;
};

// Of the diagonal block; false where it is not positive definite.
bool invert_factor(const Block3& diagonal, double* factor) {
  const Eigen::LLT<Block3> cholesky(diagonal / BlockSsor::relaxation);
  const Block3 inverse = cholesky.matrixL().solve(Block3::Identity());
  Eigen::Map<FactorRows>{factor} << inverse.transpose(), Eigen::Vector3d::Zero();
  return cholesky.info() == Eigen::Success;
}

// out = own⁻¹ h other⁻ᵀ.
void scale_block(const FactorRows& own, const Rows& h, const double* other, double* out) {
  for (int r = 0; r < 3; ++r) {
    const Four half = h.r0 * own(0, r) + h.r1 * own(1, r) + h.r2 * own(2, r);
    const Four row =
        ConstFourAt(other) * half[0] + ConstFourAt(other + 4) * half[1] + ConstFourAt(other + 8) * half[2];
    Eigen::Map<Eigen::Array3d>{out + 3 * r} = row.head<3>();
  }
}

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
  divide();
}

// The longest upper side that has no more blocks than the lower one, which begins where no row reaches up to
// it any more; without two sides all is the middle.
void BlockSsor::divide() {
  const long n = rows(), all = row_start_.back();
  rows_of_ = {IndexRange{0, 0}, {n, n}, {0, n}};
  std::vector<long> reach(static_cast<std::size_t>(n) + 1,
                          n);  // the first column of a row and those below it
  for (long i = n - 1; i >= 0; --i)
    reach[i] = std::min(reach[i + 1], row_start_[i] < row_start_[i + 1] ? column_[row_start_[i]] : i);
  long lower = 0;
  for (long upper = 1; upper < n && row_start_[upper] <= all - row_start_[lower]; ++upper) {
    while (lower < n && reach[lower] < upper) ++lower;
    if (lower < n && row_start_[upper] <= all - row_start_[lower])
      rows_of_ = {IndexRange{0, upper}, {lower, n}, {upper, lower}};
  }
}

bool BlockSsor::worth_two_threads() const {
  constexpr double block_cost = 4;  // [ns], there and back
  return loop_threads() > 1 && static_cast<double>(column_.size()) * block_cost > worth_sharing;
}

bool BlockSsor::set(double m, const std::vector<double>& mass, double k, const BlockSparseMatrix& stiffness,
                    double c, const BlockSparseMatrix* damping) {
  if (row_start_.empty()) set_pattern(stiffness, damping);
  const Combination h{m, mass, k, stiffness, c, damping};
  const auto factorize = [&](long i) {
    return invert_factor(h.diagonal(static_cast<int>(i)), &factor_[12 * i]);
  };
  const auto scale = [&](long i) {  // L̂_ij = C_i⁻¹ H_ij C_j⁻ᵀ
    const FactorRows own(&factor_[12 * i]);
    BelowDiagonal row(h, static_cast<int>(i));
    for (long place = row_start_[i]; place < row_start_[i + 1]; ++place) {
      const int j = column_[place];
      scale_block(own, row.at(j), &factor_[12 * static_cast<long>(j)], &value_[9 * place]);
    }
  };
  bool usable[2] = {true, true};
  const auto set_side = [&](int side) {
    bool all = true;
    if (side == lower_side)  // whose rows have blocks in the middle's columns
      for (long i = middle().first; i < middle().last; ++i) all = factorize(i) && all;
    for (long i = rows_of_[side].first; i < rows_of_[side].last; ++i) {
      all = factorize(i) && all;
      scale(i);
    }
    usable[side] = all;
  };
  if (worth_two_threads()) {
    share(2, set_side);
  } else {
    for (const int side : {upper_side, lower_side}) set_side(side);
  }
  for (long i = middle().first; i < middle().last; ++i) scale(i);
  return usable[upper_side] && usable[lower_side];
}

// Of what upper_row(k) and lower_row(k) return, k rows from where their side begins: each side on a thread,
// or a row of the one and a row of the other in turn. The functions are copied for the reason that Triangle
// has.
template <class UpperRow, class LowerRow>
Four BlockSsor::sum_over_sides(const UpperRow& upper_row, const LowerRow& lower_row) const {
  const auto length = [&](Part side) { return rows_of_[side].last - rows_of_[side].first; };
  const long upper = length(upper_side), lower = length(lower_side), both = std::min(upper, lower);
  const auto rest = [](Four sum, auto row, long first, long last) {
    for (long k = first; k < last; ++k) sum += row(k);
    return sum;
  };
  if (worth_two_threads()) {
    Four sums[2];
    share(2, [&](int side) {
      sums[side] = side == upper_side ? rest(Four::Zero(), upper_row, 0, upper)
                                      : rest(Four::Zero(), lower_row, 0, lower);
    });
    return sums[upper_side] + sums[lower_side];
  }
  const auto in_turn = [both, upper, lower, rest](auto row, auto other_row) -> Four {
    Four sum = Four::Zero(), other_sum = sum;
    for (long k = 0; k < both; ++k) {
      sum += row(k);
      other_sum += other_row(k);
    }
    return rest(sum, row, both, upper) + rest(other_sum, other_row, both, lower);
  };
  return in_turn(upper_row, lower_row);
}

// u = (1 + L̂)⁻¹ r with r_i = right(i), in fours; returns Σ take(i, u_i).
template <class Right, class Take>
Four BlockSsor::solve(const Right& right, const Take& take) {
  const Triangle l{row_start_.data(), column_.data(), value_.data(), solution_.data(), sum_.data()};
  const long first = rows_of_[upper_side].first, last = rows_of_[lower_side].last - 1;
  Four total = sum_over_sides([=](long k) { return l.gather(first + k, right, take); },
                              [=](long k) { return l.scatter(last - k, right, take); });
  const auto rest = [&](long i) -> Four {
    FourAt scattered(l.sum + 4 * i);
    Four left = right(i) - scattered;
    left[3] = 0;
    scattered = Four::Zero();
    return left;
  };
  for (long i = middle().first; i < middle().last; ++i) total += l.gather(i, rest, take);
  return total;
}

// u = (1 + L̂)⁻ᵀ r, the same.
template <class Right, class Take>
Four BlockSsor::solve_transposed(const Right& right, const Take& take) {
  const Triangle l{row_start_.data(), column_.data(), value_.data(), solution_.data(), sum_.data()};
  const auto keep = [&](long i, const Four& u) {
    FourAt{l.solution + 4 * i} = u;
    return take(i, u);
  };
  Four total = Four::Zero();
  for (long i = middle().last - 1; i >= middle().first; --i) total += l.scatter(i, right, keep);
  const long last = rows_of_[upper_side].last - 1, first = rows_of_[lower_side].first;
  return total + sum_over_sides([=](long k) { return l.scatter(last - k, right, take); },
                                [=](long k) { return l.gather(first + k, right, take); });
}

void BlockSsor::transform(const Vector& b, Vector& transformed) {
  transformed.resize(4 * static_cast<long>(rows()));
  solve(
      [&](long i) -> Four {  // C⁻¹ b
        const Eigen::Map<const Eigen::Matrix<double, 4, 3>> inverse(&factor_[12 * i]);
        return (inverse * b.segment<3>(3 * i)).array();
      },
      [&](long i, const Four& u) -> Four { return FourAt{transformed.data() + 4 * i} = u; });
}

void BlockSsor::transform_back(const Vector& transformed, Vector& y) {
  y.resize(3 * static_cast<long>(rows()));
  solve_transposed([&](long i) -> Four { return ConstFourAt(transformed.data() + 4 * i); },
                   [&](long i, const Four& u) {  // C⁻ᵀ u
                     const Eigen::Map<const Eigen::Matrix<double, 4, 3>> inverse(&factor_[12 * i]);
                     y.segment<3>(3 * i) = inverse.transpose() * u.matrix();
                     return u;
                   });
}

double BlockSsor::multiply(const Vector& in, Vector& out) {
  out.resize(in.size());
  const double* const p = in.data();
  double* const q = out.data();
  solve_transposed([=](long i) -> Four { return ConstFourAt(p + 4 * i); },
                   [=](long i, const Four& t) -> Four { return FourAt{q + 4 * i} = t; });
  const Four dot = solve(
      [=](long i) -> Four { return ConstFourAt(p + 4 * i) - (2 - relaxation) * ConstFourAt(q + 4 * i); },
      [=](long i, const Four& u) -> Four {
        FourAt qi(q + 4 * i);
        qi += u;
        return qi * ConstFourAt(p + 4 * i);
      });
  return dot.sum();
}

}  // namespace springstab
