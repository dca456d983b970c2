#include "analysis/proofs/sparse_cholesky.h"

#include <Eigen/SparseCholesky>
#include <limits>
#include <optional>

#include "analysis/constants.h"

#ifdef SPRINGSTAB_CHOLMOD
#include "analysis/proofs/supernodal_cholesky.h"
#endif

namespace springstab {
namespace {

struct Unblocked : Eigen::SimplicialLLT<SparseMatrix> {
  explicit Unblocked(const SparseMatrix& pattern) { analyzePattern(pattern); }
  double entries() const { return static_cast<double>(m_matrix.nonZeros()); }
  bool factorize(const SparseMatrix& a) {
    SimplicialLLT::factorize(a);
    return info() == Eigen::Success;
  }
};

#ifdef SPRINGSTAB_CHOLMOD
using Blocked = SupernodalCholesky;
#else
using Blocked = Unblocked;
#endif

}  // namespace

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
  std::optional<Unblocked> unblocked;
  std::optional<Blocked> blocked;
};

SparseCholesky::SparseCholesky() : engine_(std::make_unique<Engine>()) {}
SparseCholesky::~SparseCholesky() = default;
SparseCholesky::SparseCholesky(SparseCholesky&&) noexcept = default;

bool SparseCholesky::analyze(const SparseMatrix& pattern) {
  Engine& e = *engine_;
  if (pattern.rows() > unknowns_limit) return false;
  if (!e.unblocked && !e.blocked) {
    if (pattern.rows() < blocked_from) {
      e.unblocked.emplace(pattern);
    } else {
      e.blocked.emplace(pattern);
    }
  }
  return entries() <= entries_limit;
}

double SparseCholesky::entries() const {
  return engine_->blocked ? engine_->blocked->entries() : engine_->unblocked->entries();
}

bool SparseCholesky::factorize(const SparseMatrix& a) {
  if (!analyze(a)) return false;
  return engine_->blocked ? engine_->blocked->factorize(a) : engine_->unblocked->factorize(a);
}

}  // namespace springstab
