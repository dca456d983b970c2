#include "analysis/regions/matrix_form.h"

#include <Eigen/SVD>
#include <complex>

#include "solvers/linear/dense_solvers.h"
#include "solvers/linear/matrix_system.h"

namespace springstab {
namespace {

using Matrix = Eigen::MatrixXd;

constexpr Eigen::Index order = 3;  // of the matrices tried

// The state transition matrix of a step of length 1, from unit states; nothing where a step fails.
std::optional<Matrix> transition(const Method& method, const Matrix& stiffness, const Matrix& damping) {
  StructuralMatrices s;
  s.stiffness = stiffness.sparseView();
  s.damping = damping.sparseView();
  s.mass = Matrix::Identity(order, order).sparseView();
  MatrixSystem system(std::move(s));
  const auto stepper = method.stepper();
  const Eigen::Index m = method.size();
  Matrix a(m * order, m * order);
  for (Eigen::Index j = 0; j < m * order; ++j) {
    const Vector unit = Vector::Unit(m * order, j);
    State<Vector> state{unit.head(order), unit.segment(order, order)};
    for (Eigen::Index i = 2; i < m; ++i) state.memory.emplace_back(unit.segment(i * order, order));
    if (stepper->step(system, 1, state) != StepStatus::done) return std::nullopt;
    a.col(j).head(order) = state.x;
    a.col(j).segment(order, order) = state.v;
    for (Eigen::Index i = 2; i < m; ++i)
      a.col(j).segment(i * order, order) = state.memory[static_cast<std::size_t>(i - 2)];
  }
  return a;
}

bool commutes_with_generator(const Matrix& a, const Matrix& stiffness, const Matrix& damping) {
  if (a.rows() != 2 * order) return false;
  Matrix c = Matrix::Zero(2 * order, 2 * order);
  c.topRightCorner(order, order).setIdentity();
  c.bottomLeftCorner(order, order) = -stiffness;
  c.bottomRightCorner(order, order) = -damping;
  return (a * c - c * a).norm() <= 1e-12 * a.norm() * c.norm();
}

// Whether Q(λ) is singular at every eigenvalue of the step that was not divided out.
bool has_scalar_coefficients(const Matrix& a, const Matrix& stiffness, const Matrix& damping,
                             const std::vector<std::array<double, 3>>& coefficients) {
  constexpr double divided_out = 1e-6, singular = 1e-8;
  const bool divided = static_cast<Eigen::Index>(coefficients.size()) - 1 < a.rows() / order;
  for (const std::complex<double> lambda : a.eigenvalues()) {
    if (std::abs(lambda) < divided_out || (divided && std::abs(std::abs(lambda) - 1) < divided_out)) continue;
    Eigen::MatrixXcd q = Eigen::MatrixXcd::Zero(order, order);
    std::complex<double> power = 1;
    for (const auto& [one, of_damping, of_stiffness] : coefficients) {
      q += power * (one * Matrix::Identity(order, order) + of_damping * damping + of_stiffness * stiffness);
      power *= lambda;
    }
    const Eigen::VectorXd values = Eigen::JacobiSVD<Eigen::MatrixXcd>(q).singularValues();
    if (!(values[order - 1] <= singular * values[0])) return false;
  }
  return true;
}

}  // namespace

std::optional<std::vector<std::array<double, 3>>> affine_coefficients(
    const CharacteristicPolynomial& polynomial) {
  const BivariatePolynomial one = 1.0;
  BivariatePolynomial common = one;
  for (const RationalFunction& c : polynomial.coefficients())
    if (!(c.denominator() == one)) common = c.denominator();
  std::vector<std::array<double, 3>> all;
  for (const RationalFunction& c : polynomial.coefficients()) {
    const bool whole = c.denominator() == one;
    if (!whole && !(c.denominator() == common)) return std::nullopt;
    const auto affine = (whole ? c.numerator() * common : c.numerator()).affine();
    if (!affine) return std::nullopt;
    all.push_back(*affine);
  }
  return all;
}

MatrixForm matrix_form(const Method& method, const CharacteristicPolynomial& polynomial) {
  const Matrix stiffness{{0.37, -0.11, 0.05}, {-0.11, 0.23, -0.07}, {0.05, -0.07, 0.41}};
  const Matrix damping{{0.19, 0.06, -0.03}, {0.06, 0.13, 0.08}, {-0.03, 0.08, 0.29}};
  const std::optional<Matrix> a = transition(method, stiffness, damping);
  if (!a) return MatrixForm::none;
  if (commutes_with_generator(*a, stiffness, damping)) return MatrixForm::stability_function;
  const auto coefficients = affine_coefficients(polynomial);
  return coefficients && has_scalar_coefficients(*a, stiffness, damping, *coefficients)
             ? MatrixForm::scalar_coefficients
             : MatrixForm::none;
}

}  // namespace springstab
