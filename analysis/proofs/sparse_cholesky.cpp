#include "analysis/proofs/sparse_cholesky.h"

#include <Eigen/SparseCholesky>
#include <limits>
#include <optional>

#include "analysis/constants.h"

#ifdef SPRINGSTAB_CHOLMOD
#include "analysis/proofs/supernodal_cholesky.h"
#endif

namespace springstab {

#ifdef SPRINGSTAB_CHOLMOD
bool has_cholmod() { return true; }
const Eigen::Index SparseCholesky::blocked_from = many_unknowns;
const Eigen::Index SparseCholesky::unknowns_limit = 2'000'000;
#else
bool has_cholmod() { return false; }
const Eigen::Index SparseCholesky::blocked_from = std::numeric_limits<Eigen::Index>::max();
const Eigen::Index SparseCholesky::unknowns_limit = 150'000;
#endif

struct SparseCholesky::Engine {
  struct Unblocked : Eigen::SimplicialLLT<SparseMatrix> {
    explicit Unblocked(const SparseMatrix& pattern) { analyzePattern(pattern); }
    double entries() const { return static_cast<double>(m_matrix.nonZeros()); }
    bool factorize(const SparseMatrix& a) {
      SimplicialLLT::factorize(a);
      return info() == Eigen::Success && m_matrix.coeffs().allFinite();  // NaN passes for a pivot
    }
  };
#ifdef SPRINGSTAB_CHOLMOD
  using Blocked = SupernodalCholesky;
#else
  using Blocked = Unblocked;
#endif

  Eigen::Index size = 0;
  std::optional<double> entries;  // once they are known; nothing else is kept of what is too large
  std::optional<Unblocked> unblocked;
  std::optional<Blocked> blocked;
};

SparseCholesky::SparseCholesky() : engine_(std::make_unique<Engine>()) {}
SparseCholesky::~SparseCholesky() = default;
SparseCholesky::SparseCholesky(SparseCholesky&&) noexcept = default;

bool SparseCholesky::analyze(const SparseMatrix& pattern) {
  Engine& e = *engine_;
  e.size = pattern.rows();
  // Of more, only what hardly fills has a factor that is small enough, and an analysis takes ten times them.
  constexpr double most_analyzed = entries_limit / 2;
  if (pattern.rows() > unknowns_limit || static_cast<double>(pattern.nonZeros()) > most_analyzed)
    return false;
  if (!e.entries) {
    constexpr double much_fill = 300;  // entries a row, as of solids
    const auto rows = static_cast<double>(pattern.rows());
    if (pattern.rows() < blocked_from) e.entries = e.unblocked.emplace(pattern).entries();
    if (!e.entries || (has_cholmod() && *e.entries > much_fill * rows)) {
      e.unblocked.reset();
      e.entries = e.blocked.emplace(pattern).entries();
    }
    if (*e.entries > entries_limit) e.unblocked.reset(), e.blocked.reset();
  }
  return *e.entries <= entries_limit;
}

// A bound e: the factorization is that of A + ΔA with -e diag(A) <= ΔA <= e diag(A).
//
// Row i of L has l_i entries, the last on the diagonal. Each l_ij (or l_ii²) comes from a_ij - Σ_k l_ik l_jk,
// at most l_i - 1 products. In whatever order they are summed, by single numbers or by blocks, into parts of
// their own or at once, with fused operations or without, a product is rounded once and passes through no
// more than l_i - 1 sums; what is divided by l_jj is rounded once, or twice where a BLAS multiplies by the
// reciprocal, as OpenBLAS does. (Products with the zeros that pad a block are exact zeros and round nothing.)
// So, with u the unit roundoff and γ_k = k u/(1 - k u),
//     |ΔA_ij| <= γ(min(l_i, l_j) + 2) Σ_k |l_ik| |l_jk| <= √φ_i √a_ii √φ_j √a_jj,  φ_i = γ(l_i+2)/(1 -
//     γ(l_i+2)),
// by Cauchy and Schwarz, as Σ_k l_ik² <= a_ii/(1 - γ): in the scale where A has a unit diagonal, ΔA is at
// most Σ φ_i, the norm of a matrix of rank one. (Rump 2006, Verification of positive definiteness, BIT 46;
// Higham 2002, Accuracy and Stability, §3.1 and §10.1. It holds for any BLAS that multiplies and adds as the
// definition says, not for Strassen's products or triangular inverses by blocks.)
double SparseCholesky::error() const {
  return 1.01 * unit_roundoff * (entries() + 2 * static_cast<double>(engine_->size));
}

double SparseCholesky::entries() const { return engine_->entries.value(); }

bool SparseCholesky::factorize(const SparseMatrix& a) {
  if (!analyze(a)) return false;
  return engine_->blocked ? engine_->blocked->factorize(a) : engine_->unblocked->factorize(a);
}

}  // namespace springstab
