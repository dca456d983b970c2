// A method as a value: all that the analysis asks of it, made from the one template that is the method.
//
//     const Method mine = make_method(MyEuler());               // see solvers/methods/method_info.h
//     const double y_max = stability_region(mine).constants().y_max;
//     const Method rk4 = "rk4";                                  // a built-in one
//     simulate(scene, *mine.stepper(), plan, watch, state);
//
// With k vectors that it carries, a method on one oscillator, X = hd, Y = h²k (paper Eq. 21), is an m x m
// matrix A(X, Y), m = 2 + k: its columns are the method's own steps from the unit states of (x, v, carried
// ...) with h = 1.
#pragma once

#include <Eigen/Core>
#include <memory>
#include <optional>
#include <span>
#include <stdexcept>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "analysis/proofs/step_magnitude.h"
#include "analysis/regions/oscillator_steps.h"
#include "analysis/regions/polynomial.h"
#include "solvers/stepper.h"

namespace springstab {

/// Of a name that no built-in method has.
struct UnknownMethod : std::invalid_argument {
  UnknownMethod(std::string its_name, const std::string& what)
      : std::invalid_argument(what), name(std::move(its_name)) {}
  std::string name;
};

/// Cheap to copy, and safe to share between threads.
class Method {
 public:
  /// The built-in method of that name, which may have parameters: "newmark:beta=0.25,gamma=0.5". Equal texts
  /// give copies of one value. Throws UnknownMethod, which lists the known names, and
  /// std::invalid_argument that lists the known parameters.
  Method(std::string_view name);
  Method(const std::string& name) : Method(std::string_view(name)) {}
  Method(const char* name) : Method(std::string_view(name)) {}

  const MethodInfo& info() const { return self_->info; }
  const std::string& name() const { return info().name; }
  Eigen::Index size() const { return 2 + info().memory; }  // m

  std::unique_ptr<Stepper> stepper() const { return self_->stepper(); }

  /// A as rational functions of X and Y, row by row.
  std::vector<RationalFunction> symbolic_step() const { return self_->symbolic_step(); }
  /// A at one point. All ∞ at a pole and where the step overflows.
  Eigen::MatrixXd amplification(double x, double y) const { return self_->amplification(x, y); }
  /// What a run starts from at one point, m x 2: of the starts (x, v) = (1, 0) and (0, 1).
  Eigen::MatrixXd starts(double x, double y) const { return self_->starts(x, y); }
  /// See spectral_radius and simulate_cells in regions/amplification.h.
  void radii(std::span<const double> x, std::span<const double> y, std::span<double> rho) const {
    self_->radii(x, y, rho);
  }
  void fates(std::span<const double> x, std::span<const double> y, long steps, double threshold,
             std::span<CellFate> fate) const {
    self_->fates(x, y, steps, threshold, fate);
  }

  /// The transition matrix, mn x mn over (x, v, carried ...), of one step of length 1 of x'' = -Kx - Dv with
  /// every term taken as positive: |K|, |D| entry by entry, differences as sums, factors by their size, a
  /// solution by a bound on it and on the rounding of its factorization. An entry computed in floating point
  /// is off by at most a few roundings of it. Nothing for methods that need more of a system than
  /// MagnitudeSystem has, and where a solve fails.
  std::optional<Eigen::MatrixXd> magnitude(const SizedMatrices& matrices) const {
    return self_->magnitude(matrices);
  }
  std::optional<Eigen::MatrixXd> magnitude(const Eigen::MatrixXd& stiffness,
                                           const Eigen::MatrixXd& damping) const {
    return magnitude({stiffness, damping, stiffness.cwiseAbs(), damping.cwiseAbs()});
  }
  bool has_magnitude() const { return self_->has_magnitude(); }

  /// Whether they are copies of one value: what is known of one is known of the other.
  friend bool operator==(const Method& a, const Method& b) { return a.self_ == b.self_; }
  /// Any order in which copies are alike.
  struct ByIdentity {
    bool operator()(const Method& a, const Method& b) const { return std::less<>()(a.self_, b.self_); }
  };

 private:
  struct Interface {
    MethodInfo info;

    explicit Interface(MethodInfo i) : info(std::move(i)) {}
    virtual ~Interface() = default;
    virtual std::unique_ptr<Stepper> stepper() const = 0;
    virtual std::vector<RationalFunction> symbolic_step() const = 0;
    virtual Eigen::MatrixXd amplification(double x, double y) const = 0;
    virtual Eigen::MatrixXd starts(double x, double y) const = 0;
    virtual void radii(std::span<const double> x, std::span<const double> y, std::span<double> rho) const = 0;
    virtual void fates(std::span<const double> x, std::span<const double> y, long steps, double threshold,
                       std::span<CellFate> fate) const = 0;
    virtual std::optional<Eigen::MatrixXd> magnitude(const SizedMatrices& matrices) const = 0;
    virtual bool has_magnitude() const = 0;
  };

  template <class Description>
  struct Described final : Interface {
    Description description;

    explicit Described(Description d) : Interface(d.info()), description(std::move(d)) {}
    std::unique_ptr<Stepper> stepper() const override { return make_stepper(description); }
    std::vector<RationalFunction> symbolic_step() const override {
      return *oscillator_matrix<RationalFunction>(
          description, {.k = BivariatePolynomial::y(), .d = BivariatePolynomial::x()}, 1.0, 0.0);
    }
    Eigen::MatrixXd amplification(double x, double y) const override {
      return amplification_at(description, x, y);
    }
    Eigen::MatrixXd starts(double x, double y) const override { return starts_at(description, x, y); }
    void radii(std::span<const double> x, std::span<const double> y, std::span<double> rho) const override {
      radii_of(description, x, y, rho);
    }
    void fates(std::span<const double> x, std::span<const double> y, long steps, double threshold,
               std::span<CellFate> fate) const override {
      fates_of(description, x, y, steps, threshold, fate);
    }
    std::optional<Eigen::MatrixXd> magnitude(const SizedMatrices& matrices) const override {
      return step_magnitude(description, matrices);
    }
    bool has_magnitude() const override { return has_step_magnitude<Description>; }
  };

  explicit Method(std::shared_ptr<const Interface> self) : self_(std::move(self)) {}
  template <class Description>
  friend Method make_method(Description description);

  std::shared_ptr<const Interface> self_;
};

/// The method of a description, which is an object with the method's parameters. Throws std::invalid_argument
/// for one that make_stepper refuses.
template <class Description>
Method make_method(Description description) {
  make_stepper(description);
  return Method(std::make_shared<Method::Described<Description>>(std::move(description)));
}

/// The methods that tables and figures show where none is named, in the order of the list.
const std::vector<Method>& all_methods();
/// The others that are built in, with the parameters they have where none are given.
const std::vector<Method>& more_methods();
/// Both, in this order.
std::vector<Method> built_in_methods();

/// From here on Method(name) is this one, for the whole program. Throws std::invalid_argument for the name of
/// a built-in method, or of another one added. Not while other threads ask for methods.
void add_method(const Method& method);
/// Those, in order.
const std::vector<Method>& added_methods();

}  // namespace springstab
