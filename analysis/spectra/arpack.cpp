#include "analysis/spectra/arpack.h"

#include <arpack/arpack.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <mutex>
#include <random>
#include <stdexcept>
#include <string>

#include "analysis/blas.h"

namespace springstab {
namespace {

// ARPACK's SAVE variables forbid a second solve at a time, from another thread or from inside a product.
std::mutex arpack_mutex;
thread_local bool solving = false;

class Solving {
 public:
  Solving() {
    if (solving) throw std::logic_error("an eigenvalue solve was started from inside another one's product");
    lock_ = std::unique_lock(arpack_mutex);
    solving = true;
    use_one_blas_thread();
  }
  ~Solving() { solving = false; }
  Solving(const Solving&) = delete;
  Solving& operator=(const Solving&) = delete;

 private:
  std::unique_lock<std::mutex> lock_;
};

using Aupd = decltype(&dsaupd_c);  // dnaupd_c has the same signature

// The arrays of one solve, and the reverse communication that fills them.
struct Iteration {
  const LinearOperator& a;
  a_int n, nev, ncv;
  const char* which;
  double tolerance;
  Eigen::VectorXd start;
  Eigen::MatrixXd basis;
  Eigen::VectorXd workd, workl;
  std::array<a_int, 11> iparam{};
  std::array<a_int, 14> ipntr{};
  a_int info = 1;  // start from our own vector
  long products = 0;
  std::function<void()> before_product;

  Iteration(const LinearOperator& op, Eigen::Index count, const ArpackOptions& options, const char* what,
            Eigen::Index margin)
      : a(op), which(what), tolerance(options.tolerance) {
    if (op.size > 2'000'000'000) throw std::invalid_argument("the operator is too large for 32-bit ARPACK");
    if (count < 1 || count + margin > op.size)
      throw std::invalid_argument("cannot find " + std::to_string(count) +
                                  " eigenvalues of an operator of size " + std::to_string(op.size) +
                                  " iteratively, solve it densely");
    n = static_cast<a_int>(op.size);
    nev = static_cast<a_int>(count);
    ncv = static_cast<a_int>(std::min(op.size, std::max(options.basis_size, 2 * count + 2)));
    iparam[0] = 1;  // exact shifts
    iparam[2] = options.max_restarts;
    iparam[6] = 1;  // A v = θ v
    start = start_vector(n, options.start, options.seed);
    before_product = options.before_product;
    basis.setZero(n, ncv);
    workd.setZero(3 * static_cast<Eigen::Index>(n));
  }

  void product(const double* in, double* out) {
    if (before_product) before_product();
    input_ = Eigen::Map<const Eigen::VectorXd>(in, n);
    a.apply(input_, output_);
    ++products;
    if (output_.size() != n || !output_.allFinite())
      throw std::invalid_argument("the operator's product is not finite, expected finite matrices");
    Eigen::Map<Eigen::VectorXd>(out, n) = output_ / scale;
  }

  // True when everything wanted converged, false when the restarts ran out.
  bool run(Aupd aupd, Eigen::Index workl_size) {
    workl.setZero(workl_size);
    product(start.data(), workd.data());
    const double size = workd.head(n).cwiseAbs().maxCoeff();
    if (size == 0) return zero_operator = true;
    scale = std::exp2(std::ilogb(size));
    a_int ido = 0;
    while (true) {
      aupd(&ido, "I", n, which, nev, tolerance, start.data(), ncv, basis.data(), n, iparam.data(),
           ipntr.data(), workd.data(), workl.data(), static_cast<a_int>(workl.size()), &info);
      if (ido == 99) break;
      if (ido == -1 || ido == 1) {
        product(&workd[ipntr[0] - 1], &workd[ipntr[1] - 1]);
      } else {
        throw std::runtime_error("ARPACK asked for something unexpected, ido = " + std::to_string(ido));
      }
    }
    if (info < 0 || info > 3) throw std::runtime_error("ARPACK failed, info = " + std::to_string(info));
    return info == 0 && converged() >= nev;
  }

  a_int converged() const { return iparam[4]; }

  bool zero_operator = false;  // A times the start vector vanished
  // ARPACK is given A/scale, about of unit size: below ε^(2/3) its test of convergence is absolute, and
  // passes. (A power of two, so that nothing is rounded.)
  double scale = 1;

 private:
  Eigen::VectorXd input_, output_;
};

}  // namespace

Eigen::VectorXd start_vector(Eigen::Index size, const Eigen::VectorXd& start, std::uint64_t seed) {
  if (size < 1) throw std::invalid_argument("the operator has size 0, expected at least 1");
  if (start.size() == 0) {
    Eigen::VectorXd random(size);
    std::mt19937_64 engine(seed);
    std::uniform_real_distribution<double> uniform(-1, 1);
    for (double& entry : random) entry = uniform(engine);
    return random;
  }
  if (start.size() != size || !start.allFinite() || start.isZero(0))
    throw std::invalid_argument("the start vector has " + std::to_string(start.size()) +
                                " entries, expected " + std::to_string(size) + ", finite and not all zero");
  return start;
}

SymmetricEigenpairs largest_eigenpairs(const LinearOperator& a, Eigen::Index count,
                                       const ArpackOptions& options) {
  const Solving guard;
  Iteration iteration(a, count, options, "LA", 1);
  SymmetricEigenpairs found;
  const a_int ncv = iteration.ncv, nev = iteration.nev, n = iteration.n;
  found.converged = iteration.run(&dsaupd_c, static_cast<Eigen::Index>(ncv) * (ncv + 8));
  if (iteration.zero_operator) {  // a random vector is not in the null space of anything but zero
    found.values.assign(count, 0.0);
    found.vectors = Eigen::MatrixXd::Identity(n, count);
    found.residuals.assign(count, 0.0);
    found.products = iteration.products;
    return found;
  }

  const a_int usable = std::min(iteration.converged(), nev);
  if (usable > 0) {
    Eigen::VectorXd values = Eigen::VectorXd::Zero(nev);
    Eigen::MatrixXd vectors = Eigen::MatrixXd::Zero(n, nev);
    std::vector<a_int> select(ncv);
    a_int info = 0;
    dseupd_c(1, "A", select.data(), values.data(), vectors.data(), n, 0, "I", n, iteration.which, nev,
             iteration.tolerance, iteration.start.data(), ncv, iteration.basis.data(), n,
             iteration.iparam.data(), iteration.ipntr.data(), iteration.workd.data(), iteration.workl.data(),
             static_cast<a_int>(iteration.workl.size()), &info);
    if (info != 0) throw std::runtime_error("ARPACK could not extract, info = " + std::to_string(info));
    Eigen::VectorXd image(n);
    found.vectors.resize(n, usable);
    for (a_int i = 0; i < usable; ++i) {  // ascending in ARPACK
      const a_int column = usable - 1 - i;
      if (!std::isfinite(values[column]))
        throw std::runtime_error("ARPACK returned an eigenvalue that is not finite");
      found.values.push_back(iteration.scale * values[column]);
      found.vectors.col(i) = vectors.col(column);
      iteration.product(vectors.col(column).data(), image.data());
      found.residuals.push_back(iteration.scale * (image - values[column] * vectors.col(column)).norm());
    }
  }
  found.products = iteration.products;
  return found;
}

Eigenvalues dominant_eigenvalues(const LinearOperator& a, Eigen::Index count, const ArpackOptions& options) {
  const Solving guard;
  Iteration iteration(a, count, options, "LM", 2);
  Eigenvalues found;
  const a_int ncv = iteration.ncv, nev = iteration.nev, n = iteration.n;
  found.converged = iteration.run(&dnaupd_c, 3 * static_cast<Eigen::Index>(ncv) * (ncv + 2));
  if (iteration.zero_operator) {
    found.values.assign(count, 0.0);
    found.products = iteration.products;
    return found;
  }

  if (found.converged) {
    Eigen::VectorXd real = Eigen::VectorXd::Zero(nev + 1), imaginary = Eigen::VectorXd::Zero(nev + 1);
    Eigen::VectorXd workev = Eigen::VectorXd::Zero(3 * static_cast<Eigen::Index>(ncv));
    Eigen::MatrixXd vectors = Eigen::MatrixXd::Zero(n, nev + 1);
    std::vector<a_int> select(ncv);
    a_int info = 0;
    dneupd_c(1, "A", select.data(), real.data(), imaginary.data(), vectors.data(), n, 0, 0, workev.data(),
             "I", n, iteration.which, nev, iteration.tolerance, iteration.start.data(), ncv,
             iteration.basis.data(), n, iteration.iparam.data(), iteration.ipntr.data(),
             iteration.workd.data(), iteration.workl.data(), static_cast<a_int>(iteration.workl.size()),
             &info);
    if (info != 0) throw std::runtime_error("ARPACK could not extract, info = " + std::to_string(info));
    std::vector<std::pair<std::complex<double>, Eigen::VectorXcd>> pairs;
    const a_int usable = std::min(iteration.converged(), nev + 1);
    for (a_int i = 0; i < usable; ++i) {
      const std::complex<double> value(iteration.scale * real[i], iteration.scale * imaginary[i]);
      if (!std::isfinite(std::abs(value)))
        throw std::runtime_error("ARPACK returned an eigenvalue that is not finite");
      Eigen::VectorXcd vector = vectors.col(i).cast<std::complex<double>>();
      if (imaginary[i] != 0 && i + 1 < usable) {  // and its conjugate: one column is real, one imaginary
        vector += std::complex<double>(0, 1) * vectors.col(++i);
        pairs.emplace_back(std::conj(value), vector.conjugate().normalized());
      }
      pairs.emplace_back(value, vector.normalized());
    }
    std::stable_sort(pairs.begin(), pairs.end(),
                     [](const auto& p, const auto& q) { return std::abs(p.first) > std::abs(q.first); });
    found.vectors.resize(n, static_cast<Eigen::Index>(pairs.size()));
    for (std::size_t i = 0; i < pairs.size(); ++i) {
      found.values.push_back(pairs[i].first);
      found.vectors.col(static_cast<Eigen::Index>(i)) = pairs[i].second;
    }
  }
  found.products = iteration.products;
  return found;
}

}  // namespace springstab
