#include "analysis/proofs/supernodal_cholesky.h"

#include <cholmod.h>
#include <dlfcn.h>

#include <cmath>
#include <limits>
#include <stdexcept>
#include <string>
#include <vector>

#include "analysis/blas.h"
#include "analysis/proofs/graph_parts.h"

namespace springstab {
namespace {

// CHOLMOD spreads small loops over four OpenMP threads, which wait in the meantime at full speed. While one
// of these lives there is one, if OpenMP is in the process at all.
class OneThread {
 public:
  OneThread() {
    const auto get = reinterpret_cast<int (*)()>(dlsym(RTLD_DEFAULT, "omp_get_max_active_levels"));
    set_ = reinterpret_cast<void (*)(int)>(dlsym(RTLD_DEFAULT, "omp_set_max_active_levels"));
    if (!get || !set_) return;
    levels_ = get();
    set_(0);
  }
  ~OneThread() {
    if (levels_ >= 0) set_(levels_);
  }
  OneThread(const OneThread&) = delete;
  OneThread& operator=(const OneThread&) = delete;

 private:
  void (*set_)(int) = nullptr;
  int levels_ = -1;
};

}  // namespace

struct SupernodalCholesky::Workspace {
  cholmod_common common{};
  cholmod_factor* factor = nullptr;
  std::vector<SuiteSparse_long> start, row;  // CHOLMOD's sizes need 64 bits, also where Eigen's do not
  cholmod_sparse matrix{};

  Workspace() {
    use_one_blas_thread();
    cholmod_l_start(&common);
    common.print = 0;
    common.nmethods = 1;
    common.method[0].ordering = CHOLMOD_GIVEN;
    // More zeros in a block than by default: the products pay for them.
    common.nrelax[0] = 8, common.nrelax[1] = 32, common.nrelax[2] = 96;
    common.zrelax[0] = 0.9, common.zrelax[1] = 0.3, common.zrelax[2] = 0.1;
    common.supernodal = CHOLMOD_SUPERNODAL;
    common.quick_return_if_not_posdef = 1;
  }
  ~Workspace() {
    cholmod_l_free_factor(&factor, &common);
    cholmod_l_finish(&common);
  }
  Workspace(const Workspace&) = delete;
  Workspace& operator=(const Workspace&) = delete;

  // Not every BLAS looks for NaN, but an entry of L that is not finite makes the pivot of its row so: it
  // subtracts the entry's square.
  bool pivots_are_finite() const {
    const auto* const super = static_cast<const SuiteSparse_long*>(factor->super);
    const auto* const rows = static_cast<const SuiteSparse_long*>(factor->pi);
    const auto* const values = static_cast<const SuiteSparse_long*>(factor->px);
    const auto* const x = static_cast<const double*>(factor->x);
    for (std::size_t s = 0; s < factor->nsuper; ++s) {
      const SuiteSparse_long height = rows[s + 1] - rows[s];
      for (SuiteSparse_long j = 0; j < super[s + 1] - super[s]; ++j)
        if (const double pivot = x[values[s] + j * (height + 1)]; !(pivot > 0 && std::isfinite(pivot)))
          return false;
    }
    return true;
  }
};

SupernodalCholesky::SupernodalCholesky(const Eigen::SparseMatrix<double>& pattern)
    : workspace_(std::make_unique<Workspace>()) {
  Workspace& w = *workspace_;
  w.start.assign(pattern.outerIndexPtr(), pattern.outerIndexPtr() + pattern.cols() + 1);
  w.row.assign(pattern.innerIndexPtr(), pattern.innerIndexPtr() + pattern.nonZeros());
  cholmod_sparse& a = w.matrix;
  a.nrow = a.ncol = static_cast<std::size_t>(pattern.rows());
  a.nzmax = w.row.size();
  a.p = w.start.data();
  a.i = w.row.data();
  a.stype = -1;  // the lower triangle is read
  a.itype = CHOLMOD_LONG;
  a.xtype = CHOLMOD_PATTERN;
  a.dtype = CHOLMOD_DOUBLE;
  a.sorted = a.packed = 1;
  std::vector<SuiteSparse_long> order = dissection_order(pattern);
  if (!order.empty()) w.factor = cholmod_l_analyze_p(&a, order.data(), nullptr, 0, &w.common);
}

SupernodalCholesky::~SupernodalCholesky() = default;

double SupernodalCholesky::entries() const {
  return workspace_->factor ? workspace_->common.lnz : std::numeric_limits<double>::infinity();
}

bool SupernodalCholesky::factorize(const Eigen::SparseMatrix<double>& a) {
  Workspace& w = *workspace_;
  if (!w.factor) return false;
  if (a.rows() != static_cast<Eigen::Index>(w.matrix.nrow) || !a.isCompressed() ||
      a.nonZeros() != static_cast<Eigen::Index>(w.row.size()))
    throw std::invalid_argument("a matrix to factorize has " + std::to_string(a.nonZeros()) +
                                " entries, expected the pattern that was analyzed, of " +
                                std::to_string(w.row.size()));
  if (!a.coeffs().allFinite()) return false;
  w.matrix.xtype = CHOLMOD_REAL;
  w.matrix.x = const_cast<double*>(a.valuePtr());  // read only
  w.common.status = CHOLMOD_OK;
  const OneThread guard;
  const bool done = cholmod_l_factorize(&w.matrix, w.factor, &w.common) != 0;
  w.matrix.x = nullptr;
  return done && w.common.status == CHOLMOD_OK && w.factor->minor == w.factor->n && w.factor->is_super &&
         w.factor->xtype == CHOLMOD_REAL && w.pivots_are_finite();
}

}  // namespace springstab
