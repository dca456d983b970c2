#include "experiments/mpi/matrix_rows.h"

#include <fcntl.h>
#include <sys/mman.h>
#include <sys/stat.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <cmath>
#include <limits>
#include <memory>
#include <sstream>
#include <string_view>
#include <system_error>

#include "experiments/mpi/agreement.h"
#include "solvers/io/input_error.h"
#include "solvers/io/matrix_market.h"
#include "solvers/io/text_file.h"

namespace springstab::mpi {
namespace {

// A file in the address space: pages come and go, no rank holds it.
class MappedFile {
 public:
  explicit MappedFile(const std::string& path) {
    const int file = open(path.c_str(), O_RDONLY | O_CLOEXEC | O_NONBLOCK);
    if (file < 0) fail(path, errno);
    struct stat status = {};
    const bool regular = fstat(file, &status) == 0 && S_ISREG(status.st_mode);
    size_ = regular ? static_cast<std::size_t>(status.st_size) : 0;
    if (size_ > 0) data_ = mmap(nullptr, size_, PROT_READ, MAP_PRIVATE, file, 0);
    const int error = errno;
    close(file);
    if (!regular) throw InputError(path, 0, "is no regular file, expected one that every rank can read");
    if (size_ == 0) throw InputError(path, 0, "the file is empty, expected a matrix");
    if (data_ == MAP_FAILED) fail(path, error);
  }
  ~MappedFile() { munmap(data_, size_); }
  MappedFile(const MappedFile&) = delete;
  MappedFile& operator=(const MappedFile&) = delete;

  std::string_view bytes() const { return {static_cast<const char*>(data_), size_}; }

 private:
  [[noreturn]] static void fail(const std::string& path, int error) {
    throw InputError(path, 0,
                     "cannot be opened (" + std::generic_category().message(error) + "), expected a matrix");
  }
  void* data_ = MAP_FAILED;
  std::size_t size_ = 0;
};

IndexRange own_rows(long rows) { return {rows * rank() / ranks(), rows * (rank() + 1) / ranks()}; }

// --- PETSc's binary format: big-endian 32-bit integers, MAT_FILE_CLASSID, rows, columns, entries first ---

PetscInt integer_at(std::string_view bytes, std::size_t place) {
  unsigned value = 0;
  for (int k = 0; k < 4; ++k)
    value = value << 8 | static_cast<unsigned char>(bytes[4 * place + static_cast<std::size_t>(k)]);
  return static_cast<PetscInt>(value);
}

bool is_petsc_binary(std::string_view bytes) {
  return bytes.size() >= 16 && integer_at(bytes, 0) == MAT_FILE_CLASSID;
}

// Its rows, once the file holds what its header announces.
PetscInt rows_of_binary(const std::string& path, std::string_view bytes) {
  const PetscInt rows = integer_at(bytes, 1), columns = integer_at(bytes, 2), entries = integer_at(bytes, 3);
  if (rows < 1 || rows != columns)
    throw InputError(
        path, 0,
        "a matrix of " + std::to_string(rows) + " by " + std::to_string(columns) + ", expected a square one");
  if (entries >= 0 &&
      bytes.size() < 16 + 4 * static_cast<std::size_t>(rows) + 12 * static_cast<std::size_t>(entries))
    throw InputError(
        path, 0, "the file ends early, expected " + std::to_string(entries) + " entries as its header says");
  return rows;
}

OwnedMat load_binary(const std::string& path, PetscInt rows) {
  const IndexRange own = own_rows(rows);
  const auto count = static_cast<PetscInt>(own.last - own.first);
  OwnedMat a;
  petsc(MatCreate(PETSC_COMM_WORLD, a.out()));
  petsc(MatSetType(a, MATAIJ));
  petsc(MatSetSizes(a, count, count, rows, rows));
  petsc(MatSetFromOptions(a));
  PetscViewer viewer = nullptr;
  petsc(PetscViewerBinaryOpen(PETSC_COMM_WORLD, path.c_str(), FILE_MODE_READ, &viewer));
  petsc(PetscViewerBinarySetSkipInfo(viewer, PETSC_TRUE));
  petsc(MatLoad(a, viewer));
  petsc(PetscViewerDestroy(&viewer));
  return a;
}

// --- Matrix Market ---

MatrixRows read_text(const std::string& path, std::string_view text, Duplicates duplicates) {
  const std::string_view beginning = text.substr(0, 4096);
  if (beginning.starts_with("\x1f\x8b") || beginning.find('\0') != beginning.npos)
    throw InputError(path, 0, binary_file_message(beginning));
  if (!has_matrix_market_banner(beginning))
    throw InputError(path, 1,
                     "neither a Matrix Market banner nor a matrix in PETSc's binary format, expected one of "
                     "them (springstab limits reads Harwell-Boeing, too)");
  return parse_matrix_market_rows(path, text, own_rows, duplicates);
}

OwnedMat distributed(const MatrixRows& rows) {
  const auto count = static_cast<PetscInt>(rows.own.rows());
  OwnedMat a;
  petsc(MatCreate(PETSC_COMM_WORLD, a.out()));
  petsc(MatSetType(a, MATAIJ));
  petsc(MatSetSizes(a, count, count, static_cast<PetscInt>(rows.all_rows),
                    static_cast<PetscInt>(rows.all_rows)));
  petsc(MatSetFromOptions(a));
  // Of these two one is for the type at hand, and the other does nothing.
  const auto* start = rows.own.outerIndexPtr();
  const auto* column = rows.own.innerIndexPtr();
  petsc(MatSeqAIJSetPreallocationCSR(a, start, column, rows.own.valuePtr()));
  petsc(MatMPIAIJSetPreallocationCSR(a, start, column, rows.own.valuePtr()));
  return a;
}

// --- symmetry ---

constexpr double symmetry_tolerance = 1e-10;  // real matrices are symmetric to rounding

// Throws for the first entry that differs from its mirror image; `unit` has a diagonal of ±1 or 0, `off` is
// its transpose minus itself.
void check_symmetry(Mat unit, Mat off, Mat original, const std::string& name) {
  const OwnRows own(unit);
  for (PetscInt i = own.first; i < own.last; ++i) {
    const Row difference(off, i);
    for (int k = 0; k < difference.size(); ++k) {
      if (std::abs(difference.value(k)) <= symmetry_tolerance) continue;
      const Row row(unit, i), entries(original, i);
      double here = 0, shown = 0;
      for (int l = 0; l < row.size(); ++l)
        if (row.column(l) == difference.column(k)) here = row.value(l);
      for (int l = 0; l < entries.size(); ++l)
        if (entries.column(l) == difference.column(k)) shown = entries.value(l);
      const double larger = std::max(std::abs(here), std::abs(here + difference.value(k)));
      if (std::abs(difference.value(k)) <= symmetry_tolerance * larger) continue;
      std::ostringstream message;
      message << "the " << name << " matrix is not symmetric (entry " << i + 1 << ", "
              << difference.column(k) + 1 << " is " << shown
              << " and differs from its mirror image), expected a symmetric one"
              << " (springstab limits takes any)";
      throw std::invalid_argument(message.str());
    }
  }
}

// 1/√|a_ii|, or 1 where that is 0.
OwnedVec inverse_root_of_diagonal(Mat a) {
  OwnedVec d = diagonal_of(a);
  PetscInt size = 0;
  PetscScalar* entries = nullptr;
  petsc(VecGetLocalSize(d, &size));
  petsc(VecGetArray(d, &entries));
  for (PetscInt i = 0; i < size; ++i) entries[i] = entries[i] == 0 ? 1 : 1 / std::sqrt(std::abs(entries[i]));
  petsc(VecRestoreArray(d, &entries));
  return d;
}

OwnedMat transpose_minus(Mat a) {
  OwnedMat off;
  petsc(MatTranspose(a, MAT_INITIAL_MATRIX, off.out()));
  petsc(MatAXPY(off, -1, a, DIFFERENT_NONZERO_PATTERN));
  return off;
}

OwnedMat symmetric_part(OwnedMat a, const std::string& name) {
  OwnedMat off = transpose_minus(a);
  PetscReal size = 0;
  petsc(MatNorm(off, NORM_FROBENIUS, &size));
  if (std::isnan(size)) throw std::invalid_argument("the " + name + " matrix is not finite");
  if (size == 0) return a;
  const OwnedVec root = inverse_root_of_diagonal(a);
  const OwnedMat unit = copy_of(a), unit_off = copy_of(off);
  scale(unit, root);
  scale(unit_off, root);
  together([&] { check_symmetry(unit, unit_off, a, name); });
  petsc(MatAXPY(a, 0.5, off, DIFFERENT_NONZERO_PATTERN));
  return a;
}

void check_finite(Mat a, const std::string& name) {
  const OwnRows own(a);
  for (PetscInt i = own.first; i < own.last; ++i) {
    const Row row(a, i);
    for (int k = 0; k < row.size(); ++k)
      if (!std::isfinite(row.value(k)))
        throw std::invalid_argument("the " + name +
                                    " matrix has an entry that is not finite, expected finite numbers");
  }
}

void check_size(PetscInt rows, PetscInt columns, PetscInt size, const std::string& name) {
  const PetscInt wanted = size > 0 ? size : rows;
  if (rows == wanted && columns == wanted) return;
  throw std::invalid_argument("the " + name + " matrix is " + std::to_string(rows) + " x " +
                              std::to_string(columns) + ", expected " + std::to_string(wanted) + " x " +
                              std::to_string(wanted));
}

}  // namespace

OwnedMat read_symmetric_rows(const std::string& path, const std::string& name, PetscInt size,
                             Duplicates duplicates) {
  PetscInt binary_rows = 0;
  MatrixRows rows{};
  together([&] {
    const MappedFile file(path);
    if (is_petsc_binary(file.bytes())) {
      binary_rows = rows_of_binary(path, file.bytes());
      check_size(binary_rows, binary_rows, size, name);
    } else {
      rows = read_text(path, file.bytes(), duplicates);
      check_size(static_cast<PetscInt>(rows.all_rows), static_cast<PetscInt>(rows.columns), size, name);
    }
  });
  OwnedMat a = binary_rows > 0 ? load_binary(path, binary_rows) : distributed(rows);
  rows = {};
  if (binary_rows > 0) together([&] { check_finite(a, name); });
  return symmetric_part(std::move(a), name);
}

}  // namespace springstab::mpi
