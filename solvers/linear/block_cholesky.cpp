#include "solvers/linear/block_cholesky.h"

#include <Eigen/Cholesky>
#include <Eigen/OrderingMethods>
#include <algorithm>

#include "solvers/linear/four.h"

namespace springstab {
namespace {

using BlockAt = Eigen::Map<Block3>;
using ConstBlockAt = Eigen::Map<const Block3>;
using WideBlock = Eigen::Matrix<double, 3, 4, Eigen::RowMajor>;  // the last column zero

// Every block (i, j), i >= j, of the two matrices together, some twice.
template <class Visit>
void for_each_block(const BlockSparseMatrix& stiffness, const BlockSparseMatrix* damping,
                    const Visit& visit) {
  for (const BlockSparseMatrix* a : {&stiffness, damping})
    for (int i = 0; a && i < a->rows(); ++i)
      for (long p = a->row_begin(i); p <= a->diagonal(i); ++p) visit(i, a->column(p));
}

std::vector<int> minimum_degree_order(const BlockSparseMatrix& stiffness, const BlockSparseMatrix* damping) {
  std::vector<Eigen::Triplet<double>> entries;
  for_each_block(stiffness, damping, [&](int i, int j) {
    entries.emplace_back(i, j, 1.0);
    entries.emplace_back(j, i, 1.0);
  });
  Eigen::SparseMatrix<double> graph(stiffness.rows(), stiffness.rows());
  graph.setFromTriplets(entries.begin(), entries.end());
  Eigen::PermutationMatrix<Eigen::Dynamic, Eigen::Dynamic, int> order;
  Eigen::AMDOrdering<int>()(graph, order);
  return {order.indices().begin(), order.indices().end()};
}

}  // namespace

void BlockCholesky::set_pattern(const BlockSparseMatrix& stiffness, const BlockSparseMatrix* damping) {
  order_ = minimum_degree_order(stiffness, damping);
  const int n = rows();
  place_.resize(n);
  for (int k = 0; k < n; ++k) place_[order_[k]] = k;

  std::vector<std::pair<int, int>> above;  // column, row
  for_each_block(stiffness, damping, [&](int i, int j) {
    if (i != j) above.emplace_back(std::max(place_[i], place_[j]), std::min(place_[i], place_[j]));
  });
  std::sort(above.begin(), above.end());
  above.erase(std::unique(above.begin(), above.end()), above.end());
  above_start_.assign(n + 1, 0);
  for (const auto& [column, row] : above) {
    ++above_start_[column + 1];
    above_.push_back(row);
  }
  for (int k = 0; k < n; ++k) above_start_[k + 1] += above_start_[k];

  stiffness_.set(stiffness, place_);
  if (damping) damping_.set(*damping, place_);

  visited_.assign(n, -1);
  path_.resize(n);
  reach_.resize(n);
  parent_.assign(n, -1);
  start_.assign(n + 1, 0);
  for (int k = 0; k < n; ++k) {
    visited_[k] = k;
    for (long p = above_start_[k]; p < above_start_[k + 1]; ++p)
      for (int i = above_[p]; visited_[i] != k; i = parent_[i]) {
        if (parent_[i] < 0) parent_[i] = k;
        visited_[i] = k;
        ++start_[i + 1];
      }
  }
  for (int k = 0; k < n; ++k) start_[k + 1] += start_[k];
  end_.resize(n);
  row_.resize(start_[n]);
  value_.resize(9 * start_[n]);
  inverse_pivot_.resize(9 * static_cast<std::size_t>(n));
  column_.assign(12 * static_cast<std::size_t>(n), 0);
}

// Visits the columns i < k in which row k of L has a block, each after those below it in the tree.
template <class Visit>
void BlockCholesky::for_each_in_row_of_l(int k, const Visit& visit) {
  int first = rows();
  visited_[k] = k;
  for (long p = above_start_[k]; p < above_start_[k + 1]; ++p) {
    int length = 0;
    for (int i = above_[p]; visited_[i] != k; i = parent_[i]) {
      visited_[i] = k;
      path_[length++] = i;
    }
    while (length > 0) reach_[--first] = path_[--length];
  }
  for (; first < rows(); ++first) visit(reach_[first]);
}

void BlockCholesky::Columns::set(const BlockSparseMatrix& matrix, const std::vector<int>& place) {
  start_.assign(place.size() + 1, 0);
  const auto for_each = [&](const auto& visit) {
    for (int i = 0; i < matrix.rows(); ++i)
      for (long p = matrix.row_begin(i); p <= matrix.diagonal(i); ++p)
        visit(place[i], place[matrix.column(p)], p);
  };
  for_each([&](int i, int j, long) { ++start_[std::max(i, j) + 1]; });
  for (std::size_t k = 0; k < place.size(); ++k) start_[k + 1] += start_[k];
  entries_.resize(start_.back());
  std::vector<long> next = start_;
  for_each([&](int i, int j, long p) { entries_[next[std::max(i, j)]++] = {std::min(i, j), i > j, p}; });
}

void BlockCholesky::Columns::add(int k, double factor, const BlockSparseMatrix& matrix,
                                 std::vector<double>& to) const {
  for (long e = start_[k]; e < start_[k + 1]; ++e) {
    const auto [row, transposed, where] = entries_[e];
    const ConstBlockAt block(matrix.block(where));
    auto place = Eigen::Map<WideBlock>(&to[12 * static_cast<long>(row)]).leftCols<3>();
    if (transposed) {
      place += factor * block.transpose();
    } else {
      place += factor * block;
    }
  }
}

bool BlockCholesky::factorize(double m, const std::vector<double>& mass, double k_factor,
                              const BlockSparseMatrix& stiffness, double c,
                              const BlockSparseMatrix* damping) {
  if (order_.empty()) set_pattern(stiffness, damping);
  std::fill(visited_.begin(), visited_.end(), -1);
  std::fill(column_.begin(), column_.end(), 0.0);
  std::copy(start_.begin(), start_.end() - 1, end_.begin());
  for (int k = 0; k < rows(); ++k) {
    stiffness_.add(k, k_factor, stiffness, column_);
    if (damping) damping_.add(k, c, *damping, column_);
    Eigen::Map<WideBlock> diagonal(&column_[12 * static_cast<long>(k)]);
    Block3 pivot = diagonal.leftCols<3>();
    pivot.diagonal().array() += m * mass[order_[k]];
    diagonal.setZero();

    // L_ki = (L_ii⁻¹ h_i)ᵀ, and h_j -= L_ji L_kiᵀ for what column i has above row k.
    for_each_in_row_of_l(k, [&](int i) {
      Eigen::Map<WideBlock> h(&column_[12 * static_cast<long>(i)]);
      const WideBlock z =
          ConstBlockAt(&inverse_pivot_[9 * static_cast<long>(i)]).triangularView<Eigen::Lower>() * h;
      h.setZero();
      const Four z0 = z.row(0).array(), z1 = z.row(1).array(), z2 = z.row(2).array();
      const double* l = &value_[9 * start_[i]];
      for (long p = start_[i]; p < end_[i]; ++p, l += 9) {
        double* const to = &column_[12 * static_cast<long>(row_[p])];
        for (int r = 0; r < 3; ++r)
          FourAt{to + 4 * r} -= l[3 * r] * z0 + l[3 * r + 1] * z1 + l[3 * r + 2] * z2;
      }
      const Block3 l_ki = z.leftCols<3>().transpose();
      pivot.noalias() -= l_ki * l_ki.transpose();
      BlockAt{&value_[9 * end_[i]]} = l_ki;
      row_[end_[i]++] = k;
    });

    const Eigen::LLT<Block3> cholesky(pivot);
    if (cholesky.info() != Eigen::Success) return false;
    BlockAt{&inverse_pivot_[9 * static_cast<long>(k)]} = cholesky.matrixL().solve(Block3::Identity());
  }
  return true;
}

void BlockCholesky::solve(const Vector& b, Vector& y) {
  y.resize(b.size());
  solution_.resize(b.size());
  Vector& u = solution_;
  for (long k = 0; k < rows(); ++k) u.segment<3>(3 * k) = b.segment<3>(3 * order_[k]);
  for (long i = 0; i < rows(); ++i) {
    const Eigen::Vector3d ui = ConstBlockAt(&inverse_pivot_[9 * i]) * u.segment<3>(3 * i);
    u.segment<3>(3 * i) = ui;
    for (long p = start_[i]; p < end_[i]; ++p) u.segment<3>(3 * row_[p]) -= ConstBlockAt(&value_[9 * p]) * ui;
  }
  for (long i = rows() - 1; i >= 0; --i) {
    Eigen::Vector3d ui = u.segment<3>(3 * i);
    for (long p = start_[i]; p < end_[i]; ++p)
      ui -= ConstBlockAt(&value_[9 * p]).transpose() * u.segment<3>(3 * row_[p]);
    u.segment<3>(3 * i) = ConstBlockAt(&inverse_pivot_[9 * i]).transpose() * ui;
    y.segment<3>(3 * order_[i]) = u.segment<3>(3 * i);
  }
}

}  // namespace springstab
