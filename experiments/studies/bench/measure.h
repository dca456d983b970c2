// What the benchmarks measure with: the least CPU time of several runs, and the two units beside it, the
// bandwidth of memory and the time of a block product.
#pragma once

#include <benchmark/benchmark.h>

#include <algorithm>
#include <ctime>
#include <limits>

#include "solvers/linear/block_sparse_matrix.h"
#include "solvers/system.h"

namespace springstab::bench {

/// CPU time of this thread [s].
inline double thread_seconds() {
  timespec now{};
  clock_gettime(CLOCK_THREAD_CPUTIME_ID, &now);
  return static_cast<double>(now.tv_sec) + 1e-9 * static_cast<double>(now.tv_nsec);
}

/// The least of several runs [s]: on a shared machine the others measure the neighbours.
template <class Work>
double least_seconds(int runs, const Work& work) {
  double least = std::numeric_limits<double>::infinity();
  for (int k = 0; k < runs; ++k) {
    const double start = thread_seconds();
    work();
    benchmark::ClobberMemory();
    least = std::min(least, thread_seconds() - start);
  }
  return least;
}

/// A plain sum over 256 MB [B/s].
inline double read_bandwidth() {
  static const Vector array = Vector::Ones(32 << 20);
  const double seconds = least_seconds(5, [] {
    double sum = array.sum();
    benchmark::DoNotOptimize(sum);
  });
  return static_cast<double>(array.size()) * sizeof(double) / seconds;
}

inline double product_seconds(const BlockSparseMatrix& matrix, const Vector& x) {
  Vector out(x.size());
  return least_seconds(20, [&] {
    matrix.multiply(x.data(), out.data());
    benchmark::DoNotOptimize(out.data());
  });
}

/// Of a product: every block with its column once, and of each row its start, the vector, the result and the
/// sum, read and written.
inline double product_bytes(const BlockSparseMatrix& matrix) {
  return 76.0 * static_cast<double>(matrix.blocks()) + 120.0 * matrix.rows();
}

}  // namespace springstab::bench
