#include "experiments/mpi/petsc.h"

namespace springstab::mpi {
namespace {

std::string first_message;

PetscErrorCode keep(MPI_Comm, int, const char*, const char*, PetscErrorCode code, PetscErrorType type,
                    const char* message, void*) {
  if (type == PETSC_ERROR_INITIAL) first_message = message ? message : "";
  return code;
}

bool is_users(PetscErrorCode code) {
  return code == PETSC_ERR_ARG_UNKNOWN_TYPE || code == PETSC_ERR_USER_INPUT ||
         code == PETSC_ERR_ARG_OUTOFRANGE || code == PETSC_ERR_FILE_OPEN || code == PETSC_ERR_FILE_READ ||
         code == PETSC_ERR_FILE_UNEXPECTED || code == PETSC_ERR_ARG_WRONG || code == PETSC_ERR_SUP ||
         code == PETSC_ERR_MISSING_FACTOR;
}

}  // namespace

void keep_petsc_errors() {
  petsc(PetscPushErrorHandler(keep, nullptr));
  petsc(PetscPopSignalHandler());
}

void petsc(PetscErrorCode code) {
  if (code == 0) return;
  const char* text = nullptr;
  PetscErrorMessage(code, &text, nullptr);
  std::string message =
      first_message.empty() ? (text ? text : "error " + std::to_string(code)) : first_message;
  first_message.clear();
  message = message.substr(0, message.find('\n'));
  throw PetscFailure("PETSc: " + message, is_users(code));
}

OwnedVec vector_like(Mat a) {
  OwnedVec v;
  petsc(MatCreateVecs(a, nullptr, v.out()));
  return v;
}

OwnedVec diagonal_of(Mat a) {
  OwnedVec d = vector_like(a);
  petsc(MatGetDiagonal(a, d));
  return d;
}

OwnedMat copy_of(Mat a) {
  OwnedMat copy;
  petsc(MatDuplicate(a, MAT_COPY_VALUES, copy.out()));
  return copy;
}

}  // namespace springstab::mpi
