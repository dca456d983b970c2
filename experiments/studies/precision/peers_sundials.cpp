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

// What the three solvers have each under a name of its own.
struct Cvode {
  static void* create(N_Vector start, SUNContext context) {
    void* memory = CVodeCreate(CV_BDF, context);
    return CVodeInit(memory, derivative, 0, start) == CV_SUCCESS ? memory : nullptr;
  }
  static constexpr auto set_error_file = CVodeSetErrFile;
  static constexpr auto set_tolerances = CVodeSVtolerances;
  static constexpr auto set_user_data = CVodeSetUserData;
  static constexpr auto set_most_steps = CVodeSetMaxNumSteps;
  static constexpr auto set_stop_time = CVodeSetStopTime;
  static constexpr auto set_linear_solver = CVodeSetLinearSolver;
  static constexpr auto advance = CVode;
  static constexpr auto steps = CVodeGetNumSteps;
  static constexpr auto release = CVodeFree;
};
struct Dirk {
  static void* create(N_Vector start, SUNContext context) {
    return ARKStepCreate(nullptr, derivative, 0, start, context);
  }
  static constexpr auto set_error_file = ARKStepSetErrFile;
  static constexpr auto set_tolerances = ARKStepSVtolerances;
  static constexpr auto set_user_data = ARKStepSetUserData;
  static constexpr auto set_most_steps = ARKStepSetMaxNumSteps;
  static constexpr auto set_stop_time = ARKStepSetStopTime;
  static constexpr auto set_linear_solver = ARKStepSetLinearSolver;
  static constexpr auto advance = ARKStepEvolve;
  static constexpr auto steps = ARKStepGetNumSteps;
  static constexpr auto release = ARKStepFree;
};
struct Explicit {
  static void* create(N_Vector start, SUNContext context) {
    return ERKStepCreate(derivative, 0, start, context);
  }
  static constexpr auto set_error_file = ERKStepSetErrFile;
  static constexpr auto set_tolerances = ERKStepSVtolerances;
  static constexpr auto set_user_data = ERKStepSetUserData;
  static constexpr auto set_most_steps = ERKStepSetMaxNumSteps;
  static constexpr auto set_stop_time = ERKStepSetStopTime;
  static constexpr auto advance = ERKStepEvolve;
  static constexpr auto steps = ERKStepGetNumSteps;
  static constexpr auto release = ERKStepFree;
};

template <class Library>
constexpr bool is_implicit = requires {
  Library::set_linear_solver;
};

template <class Library>
Attempt attempt(Problem& problem, double tolerance, double time_limit) {
  FirstOrderProblem equations(problem, time_limit);
  const Context context;
  Vector y = equations.start(), absolute = absolute_tolerances(problem, tolerance);
  const VectorView state = view(y, context), tolerances = view(absolute, context);
  void* memory = Library::create(state.get(), context);
  SUNLinearSolver solver = nullptr;
  bool good = memory && Library::set_error_file(memory, nullptr) == 0 &&
              Library::set_tolerances(memory, tolerance, tolerances.get()) == 0 &&
              Library::set_user_data(memory, &equations) == 0 && Library::set_most_steps(memory, -1) == 0 &&
              Library::set_stop_time(memory, problem.duration()) == 0;
  if constexpr (is_implicit<Library>) {
    solver = SUNLinSol_SPGMR(state.get(), SUN_PREC_NONE, krylov_basis, context);
    good = good && Library::set_linear_solver(memory, solver, nullptr) == 0;
  }
  good = good && through_samples(problem, equations, y, [&](double t) {
           realtype reached = 0;
           constexpr int to_the_time = 1;  // CV_NORMAL, ARK_NORMAL
           return Library::advance(memory, t, state.get(), &reached, to_the_time) >= 0;
         });
  long steps = 0;
  if (memory) Library::steps(memory, &steps);
  Library::release(&memory);
  if (solver) SUNLinSolFree(solver);
  return equations.finish(good, steps);
}

static_assert(CV_NORMAL == 1 && ARK_NORMAL == 1 && CV_SUCCESS == 0 && ARK_SUCCESS == 0);

}  // namespace

std::vector<Contestant> sundials_contestants(Problem& problem) {
  return {library_contestant("CVODE BDF GMRES", problem, attempt<Cvode>),
          library_contestant("ARKODE DIRK GMRES", problem, attempt<Dirk>),
          library_contestant("ARKODE explicit", problem, attempt<Explicit>)};
}

}  // namespace springstab
