// Counts what a run costs, independently of any clock: a decorator around a system, so that nothing else
// has to carry counters.
#pragma once

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
  explicit CountingSystem(System& system, const Counts& so_far = {}) : system_(system), counts_(so_far) {}
  const Counts& counts() const { return counts_; }

  Eigen::Index size() const override { return system_.size(); }
  void acceleration(const Vector& x, const Vector& v, Vector& out) override {
    ++counts_.force_evaluations;
    system_.acceleration(x, v, out);
  }
  LinearSystem& linearized(const Vector& x, const Vector& v) override {
    ++counts_.hessian_assemblies;
    linear_.target = &system_.linearized(x, v);
    return linear_;
  }
  double kinetic_energy(const Vector& v) override { return system_.kinetic_energy(v); }
  double potential_energy(const Vector& x) override { return system_.potential_energy(x); }

 private:
  struct CountingLinearSystem final : LinearSystem {
    explicit CountingLinearSystem(Counts& c) : counts(c) {}
    Eigen::Index size() const override { return target->size(); }
    void acceleration(const Vector& x, const Vector& v, Vector& out) override {
      ++counts.block_products;
      target->acceleration(x, v, out);
    }
    void stiffness_times(const Vector& u, Vector& out) override {
      ++counts.block_products;
      target->stiffness_times(u, out);
    }
    void damping_times(const Vector& u, Vector& out) override {
      ++counts.block_products;
      target->damping_times(u, out);
    }
    SolveReport solve_shifted(const Shift& shift, const Vector& rhs, Vector& out) override {
      const SolveReport report = target->solve_shifted(shift, rhs, out);
      counts.cg_iterations += report.iterations;
      counts.block_products += report.products;
      return report;
    }
    double kinetic_energy(const Vector& v) override { return target->kinetic_energy(v); }
    double potential_energy(const Vector& x) override { return target->potential_energy(x); }

    Counts& counts;
    LinearSystem* target = nullptr;
  };

  System& system_;
  Counts counts_;
  CountingLinearSystem linear_{counts_};
};

}  // namespace springstab
