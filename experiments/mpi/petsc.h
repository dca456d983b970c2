// PETSc's and SLEPc's objects with owners, and their error codes as exceptions.
#pragma once

#include <slepceps.h>

#include <stdexcept>
#include <string>
#include <utility>

namespace springstab::mpi {

/// What PETSc found wrong. `by_user`: with an option or a file, not with the program.
struct PetscFailure : std::runtime_error {
  PetscFailure(const std::string& message, bool of_user) : runtime_error(message), by_user(of_user) {}
  bool by_user;
};

/// Throws PetscFailure for any code but that of success: petsc(MatMult(a, x, y)).
void petsc(PetscErrorCode code);

/// From now on PETSc's errors are kept for petsc() to tell, and its signal handler is gone.
void keep_petsc_errors();

template <class T, PetscErrorCode (*destroy)(T*)>
class Owned {
 public:
  Owned() = default;
  Owned(Owned&& other) noexcept : object_(std::exchange(other.object_, nullptr)) {}
  Owned& operator=(Owned&& other) noexcept {
    std::swap(object_, other.object_);
    return *this;
  }
  ~Owned() {
    if (object_) destroy(&object_);
  }

  operator T() const { return object_; }
  /// Where a call puts the object it makes; what was there goes.
  T* out() {
    if (object_) destroy(&object_);
    object_ = nullptr;
    return &object_;
  }
  /// For calls that replace it.
  T* at() { return &object_; }

 private:
  T object_ = nullptr;
};

using OwnedMat = Owned<Mat, MatDestroy>;
using OwnedVec = Owned<Vec, VecDestroy>;
using OwnedIS = Owned<IS, ISDestroy>;
using OwnedScatter = Owned<VecScatter, VecScatterDestroy>;
using OwnedEps = Owned<EPS, EPSDestroy>;

/// A row of a matrix, of this rank.
class Row {
 public:
  Row(Mat a, PetscInt row) : a_(a), row_(row) { petsc(MatGetRow(a_, row_, &size_, &columns_, &values_)); }
  ~Row() { MatRestoreRow(a_, row_, &size_, &columns_, &values_); }
  Row(const Row&) = delete;
  Row& operator=(const Row&) = delete;

  int size() const { return size_; }
  PetscInt column(int k) const { return columns_[k]; }
  double value(int k) const { return values_[k]; }

 private:
  Mat a_;
  PetscInt row_, size_ = 0;
  const PetscInt* columns_ = nullptr;
  const PetscScalar* values_ = nullptr;
};

/// Its rows on this rank.
struct OwnRows {
  explicit OwnRows(Mat a) { petsc(MatGetOwnershipRange(a, &first, &last)); }
  PetscInt first = 0, last = 0;
};

OwnedVec vector_like(Mat a);
OwnedVec diagonal_of(Mat a);
OwnedMat copy_of(Mat a);

/// diag(d) A diag(d), in place.
inline void scale(Mat a, Vec d) { petsc(MatDiagonalScale(a, d, d)); }

}  // namespace springstab::mpi
