// SUNDIALS: CVODE's BDF and ARKODE's diagonally implicit Runge-Kutta pair of order 4, both with GMRES,
// without a preconditioner and with Jacobian products by differences of forces; ARKODE's explicit pair of
// order 4. Default settings but for the tolerances, a basis of 20 vectors for GMRES, and no limit to the
// number of steps.
#include <arkode/arkode_arkstep.h>
#include <arkode/arkode_erkstep.h>
#include <cvode/cvode.h>
#include <nvector/nvector_serial.h>
#include <sundials/sundials_context.h>
#include <sunlinsol/sunlinsol_spgmr.h>

#include <memory>
#include <stdexcept>

#include "experiments/studies/precision/peers.h"
#include "experiments/studies/precision/scales.h"

namespace springstab {
namespace {

constexpr int krylov_basis = 20;

class Context {
 public:
  Context() {
    if (SUNContext_Create(nullptr, &context_) != 0) throw std::runtime_error("SUNDIALS has no context");
  }
  ~Context() { SUNContext_Free(&context_); }
  Context(const Context&) = delete;
  Context& operator=(const Context&) = delete;
  operator SUNContext() const { return context_; }

 private:
  SUNContext context_ = nullptr;
};

/// A library's vector over our memory.
struct Release {
  void operator()(N_Vector v) const { N_VDestroy(v); }
};
using VectorView = std::unique_ptr<std::remove_pointer_t<N_Vector>, Release>;

VectorView view(Vector& u, const Context& context) {
  return VectorView(N_VMake_Serial(u.size(), u.data(), context));
}

int derivative(realtype, N_Vector y, N_Vector dydt, void* equations_pointer) {
  auto& equations = *static_cast<FirstOrderProblem*>(equations_pointer);
  if (equations.derivative(N_VGetArrayPointer(y), N_VGetArrayPointer(dydt))) return 0;
  return equations.timed_out() ? -1 : 1;  // to be given up, or tried with a smaller step
}

Vector absolute_tolerances(const Problem& problem, double tolerance) {
  const Scales scales = scales_of(problem);
  const Eigen::Index n = problem.start().x.size();
  Vector absolute(2 * n);
  absolute << Vector::Constant(n, tolerance * scales.place), Vector::Constant(n, tolerance * scales.velocity);
  return absolute;
}

// advance(t) brings y to the time t and says whether it did.
template <class Advance>
bool through_samples(const Problem& problem, FirstOrderProblem& equations, const Vector& y,
                     const Advance& advance) {
  for (double t : sample_times(problem)) {
    if (!advance(t)) return false;
    equations.arrive(y.data());
  }
  return true;
}

Attempt attempt_cvode(Problem& problem, double tolerance, double time_limit) {
  FirstOrderProblem equations(problem, time_limit);
  const Context context;
  Vector y = equations.start(), absolute = absolute_tolerances(problem, tolerance);
  const VectorView state = view(y, context), tolerances = view(absolute, context);
  void* memory = CVodeCreate(CV_BDF, context);
  SUNLinearSolver solver = SUNLinSol_SPGMR(state.get(), SUN_PREC_NONE, krylov_basis, context);
  bool good = CVodeInit(memory, derivative, 0, state.get()) == CV_SUCCESS &&
              CVodeSetErrFile(memory, nullptr) == CV_SUCCESS &&
              CVodeSVtolerances(memory, tolerance, tolerances.get()) == CV_SUCCESS &&
              CVodeSetUserData(memory, &equations) == CV_SUCCESS &&
              CVodeSetMaxNumSteps(memory, -1) == CV_SUCCESS &&
              CVodeSetStopTime(memory, problem.duration()) == CV_SUCCESS &&
              CVodeSetLinearSolver(memory, solver, nullptr) == CV_SUCCESS;
  good = good && through_samples(problem, equations, y, [&](double t) {
           realtype reached = 0;
           return CVode(memory, t, state.get(), &reached, CV_NORMAL) >= 0;
         });
  long steps = 0;
  CVodeGetNumSteps(memory, &steps);
  CVodeFree(&memory);
  SUNLinSolFree(solver);
  return equations.finish(good, steps);
}

Attempt attempt_dirk(Problem& problem, double tolerance, double time_limit) {
  FirstOrderProblem equations(problem, time_limit);
  const Context context;
  Vector y = equations.start(), absolute = absolute_tolerances(problem, tolerance);
  const VectorView state = view(y, context), tolerances = view(absolute, context);
  void* memory = ARKStepCreate(nullptr, derivative, 0, state.get(), context);
  SUNLinearSolver solver = SUNLinSol_SPGMR(state.get(), SUN_PREC_NONE, krylov_basis, context);
  bool good = ARKStepSetErrFile(memory, nullptr) == ARK_SUCCESS &&
              ARKStepSVtolerances(memory, tolerance, tolerances.get()) == ARK_SUCCESS &&
              ARKStepSetUserData(memory, &equations) == ARK_SUCCESS &&
              ARKStepSetMaxNumSteps(memory, -1) == ARK_SUCCESS &&
              ARKStepSetStopTime(memory, problem.duration()) == ARK_SUCCESS &&
              ARKStepSetLinearSolver(memory, solver, nullptr) == ARK_SUCCESS;
  good = good && through_samples(problem, equations, y, [&](double t) {
           realtype reached = 0;
           return ARKStepEvolve(memory, t, state.get(), &reached, ARK_NORMAL) >= 0;
         });
  long steps = 0;
  ARKStepGetNumSteps(memory, &steps);
  ARKStepFree(&memory);
  SUNLinSolFree(solver);
  return equations.finish(good, steps);
}

Attempt attempt_arkode(Problem& problem, double tolerance, double time_limit) {
  FirstOrderProblem equations(problem, time_limit);
  const Context context;
  Vector y = equations.start(), absolute = absolute_tolerances(problem, tolerance);
  const VectorView state = view(y, context), tolerances = view(absolute, context);
  void* memory = ERKStepCreate(derivative, 0, state.get(), context);
  bool good = ERKStepSetErrFile(memory, nullptr) == ARK_SUCCESS &&
              ERKStepSVtolerances(memory, tolerance, tolerances.get()) == ARK_SUCCESS &&
              ERKStepSetUserData(memory, &equations) == ARK_SUCCESS &&
              ERKStepSetMaxNumSteps(memory, -1) == ARK_SUCCESS &&
              ERKStepSetStopTime(memory, problem.duration()) == ARK_SUCCESS;
  good = good && through_samples(problem, equations, y, [&](double t) {
           realtype reached = 0;
           return ERKStepEvolve(memory, t, state.get(), &reached, ARK_NORMAL) >= 0;
         });
  long steps = 0;
  ERKStepGetNumSteps(memory, &steps);
  ERKStepFree(&memory);
  return equations.finish(good, steps);
}

}  // namespace

std::vector<Contestant> sundials_contestants(Problem& problem) {
  return {library_contestant("CVODE BDF GMRES", problem, attempt_cvode),
          library_contestant("ARKODE DIRK GMRES", problem, attempt_dirk),
          library_contestant("ARKODE explicit", problem, attempt_arkode)};
}

}  // namespace springstab
