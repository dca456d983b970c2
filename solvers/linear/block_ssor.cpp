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
  divide();
}

// The longest upper side that has no more blocks than the lower one, which begins where no row reaches up to
// it any more; without two sides all is the middle.
void BlockSsor::divide() {
  const long n = rows(), all = row_start_.back();
  rows_of_ = {IndexRange{0, 0}, {n, n}, {0, n}};
  std::vector<int> reach(static_cast<std::size_t>(n) + 1, static_cast<int>(n));  // of this row and those below
  for (long i = n - 1; i >= 0; --i)
    reach[i] = std::min(row_start_[i] < row_start_[i + 1] ? column_[row_start_[i]] : static_cast<int>(i),
                        reach[i + 1]);
  long lower = 0;
  for (long upper = 1; upper < n && row_start_[upper] <= all - row_start_[lower]; ++upper) {
    while (lower < n && reach[lower] < upper) ++lower;
    if (lower < n && row_start_[upper] <= all - row_start_[lower])
      rows_of_ = {IndexRange{0, upper}, {lower, n}, {upper, lower}};
  }
}

template <class Work>
void BlockSsor::for_both_sides(const Work& work) {
  constexpr double block_cost = 4;  // [ns]
  if (loop_threads() > 1 && static_cast<double>(column_.size()) * block_cost > worth_sharing) {
    share(2, [&](int side) { work(static_cast<Part>(side)); });
  } else {
    work(upper_side);
    work(lower_side);
  }
}

bool BlockSsor::set(double m, const std::vector<double>& mass, double k, const BlockSparseMatrix& stiffness,
                    double c, const BlockSparseMatrix* damping) {
  if (row_start_.empty()) set_pattern(stiffness, damping);
  const auto factorize = [&](long row) {
    const int i = static_cast<int>(row);
    Block3 diagonal = k * Eigen::Map<const Block3>(stiffness.block(stiffness.diagonal(i)));
    if (damping) diagonal += c * Eigen::Map<const Block3>(damping->block(damping->diagonal(i)));
    diagonal.diagonal().array() += m * mass[i];
    const Eigen::LLT<Block3> cholesky(diagonal / relaxation);
    const Block3 inverse = cholesky.matrixL().solve(Block3::Identity());
    Eigen::Map<Eigen::Matrix<double, 3, 4, Eigen::RowMajor>>(&factor_[12 * row]) << inverse.transpose(),
        Eigen::Vector3d::Zero();
    return cholesky.info() == Eigen::Success;
  };
  // L̂_ij = C_i⁻¹ H_ij C_j⁻ᵀ, row by row.
  const auto scale = [&](long row) {
    const int i = static_cast<int>(row);
    const Eigen::Matrix<double, 3, 4, Eigen::RowMajor> own(&factor_[12 * row]);
    double* out = &value_[9 * row_start_[row]];
    long in_stiffness = stiffness.row_begin(i), in_damping = damping ? damping->row_begin(i) : 0;
    for (long place = row_start_[row]; place < row_start_[row + 1]; ++place, out += 9) {
      const int j = column_[place];
      Rows h;
      if (stiffness.column(in_stiffness) == j) h.add(k, stiffness.block(in_stiffness++));
      if (damping && damping->column(in_damping) == j) h.add(c, damping->block(in_damping++));
      const double* other = &factor_[12 * static_cast<long>(j)];
      for (int r = 0; r < 3; ++r) {
        const Four half = h.r0 * own(0, r) + h.r1 * own(1, r) + h.r2 * own(2, r);
        const Four row_r = ConstFourAt(other) * half[0] + ConstFourAt(other + 4) * half[1] +
                           ConstFourAt(other + 8) * half[2];
        Eigen::Map<Eigen::Array3d>{out + 3 * r} = row_r.head<3>();
      }
    }
  };
  bool usable[2] = {true, true};
  for_both_sides([&](Part side) {
    bool all = true;
    if (side == lower_side)  // whose blocks beside the middle are its own
      for (long i = middle().first; i < middle().last; ++i) all = factorize(i) && all;
    for (long i = rows_of_[side].first; i < rows_of_[side].last; ++i) {
      all = factorize(i) && all;
      scale(i);
    }
    usable[side] = all;
  });
  for (long i = middle().first; i < middle().last; ++i) scale(i);
  return usable[upper_side] && usable[lower_side];
}

// u_i = right(i) - Σ L̂_ij u_j with the solution's u_j, i ascending, in fours; then take(i, u_i).
template <class Right, class Take>
void BlockSsor::gather(const IndexRange& range, const Right& right, const Take& take) {
  const double* b = value_.data() + 9 * row_start_[range.first];
  double* const u = solution_.data();
  for (long i = range.first; i < range.last; ++i) {
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

// u_i = right(i) - what was scattered to it, i descending, in fours, and L̂_ijᵀ u_i scattered to each j; then
// take(i, u_i).
template <class Right, class Take>
void BlockSsor::scatter(const IndexRange& range, const Right& right, const Take& take) {
  double* const sum = sum_.data();
  for (long i = range.last - 1; i >= range.first; --i) {
    Four ui = right(i) - ConstFourAt(sum + 4 * i);
    ui[3] = 0;
    FourAt{sum + 4 * i} = Four::Zero();
    take(i, ui);
    for (long k = row_start_[i]; k < row_start_[i + 1]; ++k)
      FourAt{sum + 4 * static_cast<long>(column_[k])} += Rows(&value_[9 * k]).transposed_times(ui.data());
  }
}

// A part of u = (1 + L̂)⁻¹ r with r_i = right(i) and take(i, u_i); the middle after the sides.
template <class Right, class Take>
void BlockSsor::solve(Part part, const Right& right, const Take& take) {
  const IndexRange& range = rows_of_[part];
  if (part == upper_side) {
    gather(range, right, take);
  } else if (part == lower_side) {
    scatter(range, right, take);
  } else {
    double* const sum = sum_.data();
    gather(
        range,
        [&](long i) -> Four {
          const Four rest = right(i) - ConstFourAt(sum + 4 * i);
          FourAt{sum + 4 * i} = Four::Zero();
          return rest;
        },
        take);
  }
}

// A part of u = (1 + L̂)⁻ᵀ r; the middle before the sides.
template <class Right, class Take>
void BlockSsor::solve_transposed(Part part, const Right& right, const Take& take) {
  const IndexRange& range = rows_of_[part];
  if (part == upper_side) {
    scatter(range, right, take);
  } else if (part == lower_side) {
    gather(range, right, take);
  } else {
    scatter(range, right, [&](long i, const Four& u) {
      FourAt{solution_.data() + 4 * i} = u;
      take(i, u);
    });
  }
}

void BlockSsor::transform(const Vector& b, Vector& transformed) {
  transformed.resize(4 * static_cast<long>(rows()));
  const auto go = [&](Part part) {
    solve(
        part,
        [&](long i) -> Four {  // C⁻¹ b
          const Eigen::Map<const Eigen::Matrix<double, 4, 3>> inverse(&factor_[12 * i]);
          return (inverse * b.segment<3>(3 * i)).array();
        },
        [&](long i, const Four& u) { FourAt{transformed.data() + 4 * i} = u; });
  };
  for_both_sides(go);
  go(middle_part);
}

void BlockSsor::transform_back(const Vector& transformed, Vector& y) {
  y.resize(3 * static_cast<long>(rows()));
  const auto go = [&](Part part) {
    solve_transposed(
        part, [&](long i) -> Four { return ConstFourAt(transformed.data() + 4 * i); },
        [&](long i, const Four& u) {  // C⁻ᵀ u
          const Eigen::Map<const Eigen::Matrix<double, 4, 3>> inverse(&factor_[12 * i]);
          y.segment<3>(3 * i) = inverse.transpose() * u.matrix();
        });
  };
  go(middle_part);
  for_both_sides(go);
}

double BlockSsor::multiply(const Vector& in, Vector& out) {
  out.resize(in.size());
  const double* const p = in.data();
  double* const q = out.data();
  const auto outwards = [&](Part part) {
    solve_transposed(
        part, [&](long i) -> Four { return ConstFourAt(p + 4 * i); },
        [&](long i, const Four& t) { FourAt{q + 4 * i} = t; });
  };
  std::array<double, 3> dots{};
  const auto inwards = [&](Part part) {
    Four dot = Four::Zero();
    solve(
        part, [&](long i) -> Four { return ConstFourAt(p + 4 * i) - (2 - relaxation) * ConstFourAt(q + 4 * i); },
        [&](long i, const Four& u) {
          FourAt qi(q + 4 * i);
          qi += u;
          dot += qi * ConstFourAt(p + 4 * i);
        });
    dots[part] = dot.sum();
  };
  outwards(middle_part);
  for_both_sides([&](Part side) {
    outwards(side);
    inwards(side);
  });
  inwards(middle_part);
  return dots[upper_side] + dots[lower_side] + dots[middle_part];
}

}  // namespace springstab
