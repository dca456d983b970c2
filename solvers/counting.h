// Counts what a run costs, independently of any clock: a decorator around a system, so that nothing else
// has to carry counters.
#pragma once

#include "solvers/step_by_rows.h"
#include "solvers/system.h"

namespace springstab {

struct Counts {
  long force_evaluations = 0;   // accelerations
  long hessian_assemblies = 0;  // linearizations
  long block_products = 0;      // with K or D, those inside linear solves included
  long cg_iterations = 0;
};

/// Passes everything on to `system`, which must outlive it, and counts.
class CountingSystem final : public System {
 public:
  explicit CountingSystem(System& system, const Counts& so_far = {})
      : system_(system), counts_(std::make_shared<Counts>(so_far)) {}
  const Counts& counts() const { return *counts_; }

  Eigen::Index size() const override { return system_.size(); }
  void acceleration(const Vector& x, const Vector& v, Vector& out) override {
    ++counts_->force_evaluations;
    system_.acceleration(x, v, out);
  }
  void linearize(const Vector& x, const Vector& v, Linearization<Vector>& linear) override {
    ++counts_->hessian_assemblies;
    auto mine = std::dynamic_pointer_cast<CountingLinearSystem>(std::move(linear));
    if (!mine || mine.use_count() > 1) mine = std::make_shared<CountingLinearSystem>();
    mine->counts = counts_;
    system_.linearize(x, v, mine->target);
    linear = std::move(mine);
  }
  double kinetic_energy(const Vector& v) override { return system_.kinetic_energy(v); }
  double potential_energy(const Vector& x) override { return system_.potential_energy(x); }

 private:
  struct CountingLinearSystem final : LinearSystem {
    Eigen::Index size() const override { return target->size(); }
    void acceleration(const Vector& x, const Vector& v, Vector& out) override {
      ++counts->block_products;
      target->acceleration(x, v, out);
    }
    void stiffness_times(const Vector& u, Vector& out) override {
      ++counts->block_products;
      target->stiffness_times(u, out);
    }
    void damping_times(const Vector& u, Vector& out) override {
      ++counts->block_products;
      target->damping_times(u, out);
    }
    SolveReport solve_shifted(const Shift& shift, const Vector& rhs, Vector& out) override {
      return counted(target->solve_shifted(shift, rhs, out));
    }
    SolveReport solve_damping(DampingPart part, double h, const Vector& rhs, Vector& out) override {
      return counted(target->solve_damping(part, h, rhs, out));
    }
    SolveReport solve_coupled(const StageCoupling& coupling, const std::vector<Vector>& rhs,
                              std::vector<Vector>& out) override {
      return target->solve_coupled(coupling, rhs, out);
    }
    long steps_at_once(int stages) const override { return target->steps_at_once(stages); }
    bool take_steps(long steps, StepByRows& step) override {  // those that are lost are taken again
      const bool taken = target->take_steps(steps, step);
      if (taken) counts->block_products += steps * step.stages();
      return taken;
    }
    double kinetic_energy(const Vector& v) override { return target->kinetic_energy(v); }
    double potential_energy(const Vector& x) override { return target->potential_energy(x); }

    SolveReport counted(const SolveReport& report) {
      counts->cg_iterations += report.iterations;
      counts->block_products += report.products;
      return report;
    }

    std::shared_ptr<Counts> counts;
    Linearization<Vector> target;
  };

  System& system_;
  std::shared_ptr<Counts> counts_;  // with the linearizations, which may outlive this
};

}  // namespace springstab
