#include "solvers/linear/block_linear_system.h"

#include <Eigen/Cholesky>
#include <algorithm>

#include "solvers/linear/coupled_stages.h"
#include "solvers/linear/wavefront.h"
#include "solvers/step_by_rows.h"

namespace springstab {
namespace {

constexpr double bytes_at_once = 17e6;  // that steps taken together are at: half of a last cache of 32 MB
constexpr double vector_bytes = 200;    // of these beside the matrices, a row
constexpr long most_at_once = 1000;     // steps, of a system that is within it as a whole

}  // namespace

BlockLinearSystem::BlockLinearSystem(std::vector<double> mass, RayleighDamping damping,
                                     SharedPattern stiffness, SharedPattern own_damping)
    : mass_(std::move(mass)), damping_(damping), stiffness_(std::move(stiffness)) {
  for (const double m : mass_) inverse_mass_.push_back(1 / m);
  if (own_damping) own_damping_.emplace(std::move(own_damping));
}

inline void BlockLinearSystem::set_acceleration(long i, const Eigen::Vector3d& force, const Vector& v,
                                                Vector& a) const {
  a.segment<3>(3 * i) = -inverse_mass_[i] * force - damping_.d0 * v.segment<3>(3 * i);
}

void BlockLinearSystem::acceleration(const Vector& x, const Vector& v, Vector& out) {
  out.resize(size());
  const Vector* in = &x;
  if (damping_.alpha != 0) {
    w_ = x + damping_.alpha * v;
    in = &w_;
  }
  if (own_damping_) {
    product_.resize(size());
    own_damping_->multiply(v.data(), product_.data());
  }
  stiffness_.share_rows(in->data(), [&](long i, Eigen::Vector3d force) {
    if (own_damping_) force += product_.segment<3>(3 * i);
    set_acceleration(i, force, v, out);
  });
}

void BlockLinearSystem::stiffness_times(const Vector& u, Vector& out) {
  out.resize(size());
  stiffness_.share_rows(u.data(), [&](long i, const Eigen::Vector3d& force) {
    out.segment<3>(3 * i) = inverse_mass_[i] * force;
  });
}

void BlockLinearSystem::damping_times(const Vector& u, Vector& out) {
  w_.setZero(size());
  acceleration(w_, u, out);
  out = -out;
}

bool BlockLinearSystem::invert_diagonal_blocks(double mass_factor, double stiffness_factor,
                                               double damping_factor) {
  inverse_blocks_.resize(9 * mass_.size());
  for (int i = 0; i < stiffness_.rows(); ++i) {
    Block3 h = stiffness_factor * Eigen::Map<const Block3>(stiffness_.block(stiffness_.diagonal(i)));
    if (own_damping_)
      h += damping_factor * Eigen::Map<const Block3>(own_damping_->block(own_damping_->diagonal(i)));
    h.diagonal().array() += mass_factor * mass_[i];
    const Eigen::LLT<Block3> factor(h);
    if (factor.info() != Eigen::Success) return false;
    Eigen::Map<Block3> inverse(&inverse_blocks_[9 * static_cast<long>(i)]);
    inverse = factor.solve(Block3::Identity());
  }
  return true;
}

// M (m + dD' + kK') = (m + d d0) M + (d alpha + k) K + dC is symmetric.
SolveReport BlockLinearSystem::solve_shifted(const Shift& shift, const Vector& rhs, Vector& out) {
  rhs_.resize(size());
  for (long i = 0; i < stiffness_.rows(); ++i) rhs_.segment<3>(3 * i) = mass_[i] * rhs.segment<3>(3 * i);
  if (solver.kind == SolverKind::cholesky) return solve_by_cholesky(shift, out);
  return solver.preconditioner == Preconditioner::block_ssor ? solve_by_block_ssor(shift, out)
                                                             : solve_by_block_jacobi(shift, out);
}

SolveReport BlockLinearSystem::solve_by_cholesky(const Shift& shift, Vector& out) {
  if (!cholesky_.factorize(shift.mass + shift.damping * damping_.d0, mass_,
                           shift.of_stiffness(damping_.alpha), stiffness_, shift.damping, own_damping()))
    return {.status = StepStatus::not_positive_definite};
  cholesky_.solve(rhs_, out);
  return {.status = out.allFinite() ? StepStatus::done : StepStatus::diverged};
}

SolveReport BlockLinearSystem::solve_by_block_ssor(const Shift& shift, Vector& out) {
  if (!ssor_.set(shift.mass + shift.damping * damping_.d0, mass_, shift.of_stiffness(damping_.alpha),
                 stiffness_, shift.damping, own_damping()))
    return {.status = StepStatus::not_positive_definite};
  ssor_.transform(rhs_, transformed_rhs_);
  SolveReport report =
      conjugate_gradient_.solve([&](const Vector& p, Vector& q) { return ssor_.multiply(p, q); },
                                transformed_rhs_, transformed_out_, solver);
  ssor_.transform_back(transformed_out_, out);
  report.products = report.iterations;
  return report;
}

SolveReport BlockLinearSystem::solve_by_block_jacobi(const Shift& shift, Vector& out) {
  const double mass_factor = shift.mass + shift.damping * damping_.d0,
               stiffness_factor = shift.of_stiffness(damping_.alpha), damping_factor = shift.damping;
  if (!invert_diagonal_blocks(mass_factor, stiffness_factor, damping_factor))
    return {.status = StepStatus::not_positive_definite};
  const auto apply = [&](const Vector& p, Vector& q) {
    q.resize(size());
    if (own_damping_) {
      product_.resize(size());
      own_damping_->multiply(p.data(), product_.data());
    }
    Eigen::Array3d dot = Eigen::Array3d::Zero();
    stiffness_.multiply_rows(p.data(), [&](long i, const Eigen::Vector3d& force) {
      const Eigen::Vector3d pi = p.segment<3>(3 * i);
      Eigen::Vector3d qi = stiffness_factor * force + mass_factor * mass_[i] * pi;
      if (own_damping_) qi += damping_factor * product_.segment<3>(3 * i);
      q.segment<3>(3 * i) = qi;
      dot += pi.array() * qi.array();
    });
    return dot.sum();
  };
  const auto precondition = [&](const IndexRange& range, const Vector& r, Vector& z) {
    Eigen::Array3d dot = Eigen::Array3d::Zero();
    for (long i = range.first / 3; i < range.last / 3; ++i) {
      const Eigen::Vector3d ri = r.segment<3>(3 * i);
      const Eigen::Vector3d zi = Eigen::Map<const Block3>(&inverse_blocks_[9 * i]) * ri;
      z.segment<3>(3 * i) = zi;
      dot += ri.array() * zi.array();
    }
    return dot.sum();
  };
  SolveReport report = conjugate_gradient_.solve(apply, precondition, rhs_, out, solver);
  report.products = report.iterations * (own_damping_ ? 2 : 1);
  return report;
}

SolveReport BlockLinearSystem::solve_coupled(const StageCoupling& coupling, const std::vector<Vector>& rhs,
                                             std::vector<Vector>& out) {
  StructuralMatrices s;
  s.stiffness = stiffness_.to_sparse();
  s.mass = lumped_mass(mass_);
  s.damping = damping_.d0 * s.mass + damping_.alpha * s.stiffness;
  if (own_damping_) s.damping += own_damping_->to_sparse();
  CoupledStages stages;
  stages.factorize(coupling, s);
  return stages.solve(s.mass, rhs, out);
}

SolveReport BlockLinearSystem::solve_damping(DampingPart part, double h, const Vector& rhs, Vector& out) {
  if (part == DampingPart::all) return solve_shifted({1, h, 0}, rhs, out);
  out.resize(size());
  for (int i = 0; i < stiffness_.rows(); ++i) {
    const Eigen::Map<const Block3> k(stiffness_.block(stiffness_.diagonal(i)));
    Eigen::Vector3d d = Eigen::Vector3d::Constant(mass_[i] * damping_.d0) + damping_.alpha * k.diagonal();
    if (own_damping_)
      d += Eigen::Map<const Block3>(own_damping_->block(own_damping_->diagonal(i))).diagonal();
    const Eigen::Vector3d sum = (h * d).array() + mass_[i];
    if (!(sum.minCoeff() > 0)) return {.status = StepStatus::not_positive_definite};
    const long first = 3 * static_cast<long>(i);
    out.segment<3>(first) = mass_[i] * rhs.segment<3>(first).cwiseQuotient(sum);
  }
  return {};
}

Wavefront BlockLinearSystem::wavefront() const {
  long bandwidth = stiffness_.pattern()->bandwidth();
  if (own_damping_) bandwidth = std::max<long>(bandwidth, own_damping_->pattern()->bandwidth());
  return {stiffness_.rows(), bandwidth};
}

long BlockLinearSystem::steps_at_once(int stages) const {
  const std::size_t matrices = stiffness_.bytes() + (own_damping_ ? own_damping_->bytes() : 0);
  const double rows = stiffness_.rows(), row_bytes = static_cast<double>(matrices) / rows + vector_bytes;
  if (row_bytes * rows <= bytes_at_once) return most_at_once;
  return static_cast<long>(bytes_at_once / row_bytes) / wavefront().rows_apart() / stages;
}

bool BlockLinearSystem::take_steps(long steps, StepByRows& step) {
  const int stages = step.stages();
  bool accepted = true;
  w_.resize(size());
  if (own_damping_) product_.resize(size());
  kinetic_.assign(static_cast<std::size_t>(steps), 0.0);
  place(step, 0, {0, stiffness_.rows()});
  wavefront().go(
      steps * stages,
      [&](long pass, const IndexRange& rows) {
        const auto stage = static_cast<int>(pass % stages);
        take_stage(step, stage, rows);
        if (stage + 1 == stages) kinetic_[pass / stages] += kinetic_energy(step.v(0), rows);
      },
      [&](long pass) {
        if ((pass + 1) % stages == 0) accepted = step.accept(kinetic_[pass / stages]) && accepted;
      });
  return accepted;
}

// Some rows, when those after them have gone through the stage.
void BlockLinearSystem::take_stage(StepByRows& step, int stage, const IndexRange& rows) {
  const Vector& v = step.v(stage);
  Vector& a = step.acceleration(stage);
  if (own_damping_)
    own_damping_->multiply_rows(
        v.data(), rows, [&](long i, const Eigen::Vector3d& force) { product_.segment<3>(3 * i) = force; });
  const double* const in = damping_.alpha == 0 ? step.x(stage).data() : w_.data();
  stiffness_.multiply_rows(in, rows, [&](long i, Eigen::Vector3d force) {
    if (own_damping_) force += product_.segment<3>(3 * i);
    set_acceleration(i, force, v, a);
  });
  step.advance(stage, {3 * rows.first, 3 * rows.last});
  place(step, (stage + 1) % step.stages(), rows);
}

// What a stage multiplies K with.
void BlockLinearSystem::place(const StepByRows& step, int stage, const IndexRange& rows) {
  if (damping_.alpha == 0) return;
  const auto part = entries({3 * rows.first, 3 * rows.last});
  part(w_) = part(step.x(stage)) + damping_.alpha * part(step.v(stage));
}

double BlockLinearSystem::kinetic_energy(const Vector& v, const IndexRange& rows) const {
  double sum = 0;
  for (long i = rows.first; i < rows.last; ++i) sum += mass_[i] * v.segment<3>(3 * i).squaredNorm();
  return sum / 2;
}

double BlockLinearSystem::kinetic_energy(const Vector& v) {
  return kinetic_energy(v, {0, stiffness_.rows()});
}

double BlockLinearSystem::potential_energy(const Vector& x) {
  product_.resize(size());
  stiffness_.multiply(x.data(), product_.data());
  return x.dot(product_) / 2;
}

}  // namespace springstab
