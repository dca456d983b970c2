// The catalogue's matrices: K, M and D as Matrix Market files.
#include <Eigen/Core>
#include <cmath>

#include "experiments/command/output.h"
#include "experiments/studies/stress/catalogue_parts.h"

namespace springstab {
namespace {

using Matrix = Eigen::MatrixXd;
using enum StressOutcome;

// The step is a millionth of the motion and less.
const Expectation undamped_stiff{limit,
                                 {{"explicit-euler", no_step},
                                  {"rk2", no_step},
                                  {"linearized-explicit-euler", no_step},
                                  {"implicit-euler", right}}};
// The longest stable step of an explicit method is some 1/d0, a millionth of the motion and less.
const Expectation drowned{limit, {{"implicit-euler", right}}};
// Its longest stable step is d/k.
const Expectation lightly_damped{right, {{"explicit-euler", limit}, {"linearized-explicit-euler", limit}}};

std::string matrix_market(const Matrix& a) {
  std::string entries;
  long count = 0;
  for (Eigen::Index j = 0; j < a.cols(); ++j)
    for (Eigen::Index i = 0; i < a.rows(); ++i)
      if (a(i, j) != 0) {
        entries += text("%ld %ld %.17g\n", static_cast<long>(i + 1), static_cast<long>(j + 1), a(i, j));
        ++count;
      }
  return "%%MatrixMarket matrix coordinate real general\n" +
         text("%ld %ld %ld\n", static_cast<long>(a.rows()), static_cast<long>(a.cols()), count) + entries;
}

/// M x'' = -K x - D v; M or D of no rows is left out.
struct Matrices {
  Matrix k, m{}, d{};

  InputOptions operator()(const std::string& folder) const {
    InputOptions input;
    const auto put = [&](const Matrix& a, const char* name, std::string& path) {
      if (a.rows() == 0) return;
      path = folder + name;
      write_text(path, matrix_market(a));
    };
    put(k, "/K.mtx", input.stiffness);
    put(m, "/M.mtx", input.mass);
    put(d, "/D.mtx", input.damping_matrix);
    return input;
  }
};

std::function<InputOptions(const std::string&)> matrix_text(std::string contents) {
  return [contents = std::move(contents)](const std::string& folder) {
    InputOptions input;
    input.stiffness = folder + "/K.mtx";
    write_text(input.stiffness, contents);
    return input;
  };
}

/// Springs between two walls; the first or the last may be 0.
Matrix chain(const std::vector<double>& springs) {
  const Eigen::Index n = static_cast<Eigen::Index>(springs.size()) - 1;
  Matrix k = Matrix::Zero(n, n);
  for (Eigen::Index i = 0; i < n; ++i) {
    k(i, i) = springs[i] + springs[i + 1];
    if (i > 0) k(i, i - 1) = k(i - 1, i) = -springs[i];
  }
  return k;
}

Matrix alternating_chain(int n, double one, double other) {
  std::vector<double> springs;
  for (int i = 0; i <= n; ++i) springs.push_back(i % 2 ? other : one);
  return chain(springs);
}

Matrix uniform(int n, double k) { return alternating_chain(n, k, k); }

Matrix masses(int n, double one, double other) {
  Vector m(n);
  for (int i = 0; i < n; ++i) m[i] = i % 2 ? other : one;
  return m.asDiagonal();
}

Matrix rayleigh(const Matrix& k, double d0, double alpha) {
  return d0 * Matrix::Identity(k.rows(), k.rows()) + alpha * k;
}

void add_matrices(std::vector<StressCase>& all) {
  const auto add = [&](const char* kind, const std::string& name, const Expectation& expected,
                       const Matrices& matrices) {
    all.push_back({kind, name, expected, matrices});
  };
  for (double k : {1e-12, 1e-6, 1., 1e6, 1e12, 1e16})
    add("stiffness", text("k = %g", k), undamped, {uniform(4, k)});
  for (double k : {1e-12, 1., 1e16})
    add("stiffness", text("k = %g, damped", k), damped,
        {uniform(4, k), {}, rayleigh(uniform(4, k), 0, 0.1 / std::sqrt(k))});
  for (double ratio : {1e2, 1e4, 1e6, 1e8})
    add("stiffness ratio", text("%g", ratio), undamped, {alternating_chain(8, 1, ratio)});
  for (double ratio : {1e12})
    add("stiffness ratio", text("%g", ratio), undamped_stiff, {alternating_chain(8, 1, ratio)});
  for (double ratio : {1e3, 1e6, 1e-6})
    add("mass ratio", text("%g", ratio), undamped, {uniform(4, 1), masses(4, 1, ratio)});
  for (double ratio : {1e12, 1e-12})
    add("mass ratio", text("%g", ratio), undamped_stiff, {uniform(4, 1), masses(4, 1, ratio)});
  add("mass ratio", "a mass of 1e30", undamped, {uniform(4, 1), Vector{{1, 1e30, 1, 1}}.asDiagonal()});

  const Matrix k4 = uniform(4, 1);
  add("damping", "d0 = 1e-6 √k", lightly_damped, {k4, {}, rayleigh(k4, 1e-6, 0)});
  add("damping", "alpha = 1e-6 /√k", lightly_damped, {k4, {}, rayleigh(k4, 0, 1e-6)});
  add("damping", "critical", damped, {k4, {}, rayleigh(k4, 2 * std::sqrt(0.3819660112501051), 0)});
  add("damping", "d0 = 100 √k", damped, {k4, {}, rayleigh(k4, 100, 0)});
  add("damping", "d0 = 1e6 √k", drowned, {k4, {}, rayleigh(k4, 1e6, 0)});
  add("damping", "alpha = 100 /√k", damped, {k4, {}, rayleigh(k4, 0, 100)});
  Matrix dashpots = Matrix::Zero(4, 4), one = dashpots;
  dashpots.diagonal() << 0.3, 0.1, 0.02, 0.5;
  one(0, 0) = 0.5;
  add("damping", "does not commute", damped, {k4, {}, dashpots});
  add("damping", "does not commute, 1000 times", damped, {k4, {}, 1000 * dashpots});
  add("damping", "one dashpot", damped, {k4, {}, one});
  const Matrix apart = Vector{{1, 1e-13}}.asDiagonal();
  add("damping", "of a mass of 1e-13, eightfold", damped, {apart, apart, Vector{{1, 8e-13}}.asDiagonal()});
  add("damping", "negative", {right}, {k4, {}, -0.01 * k4});  // it grows, and every method follows
  add("damping", "skew (gyroscopic)", impossible,
      {k4, {}, Matrix{{0, 1, 0, 0}, {-1, 0, 0, 0}, {0, 0, 0, 0}, {0, 0, 0, 0}}});

  add("stiffness", "one spring negative", undamped, {chain({1, 1, -0.6, 1, 1})});
  add("stiffness", "one spring negative, damped", damped,
      {chain({1, 1, -0.6, 1, 1}), {}, rayleigh(chain({1, 1, -0.6, 1, 1}), 0.1, 0)});
  add("stiffness", "all negative", damped, {-k4});
  add("stiffness", "none", damped, {Matrix::Zero(4, 4)});
  add("stiffness", "none, air drag", damped, {Matrix::Zero(4, 4), {}, rayleigh(k4, 1, 0)});

  const std::pair<const char*, Matrices> systems[] = {
      {"undamped", {k4}},
      {"alpha", {k4, {}, rayleigh(k4, 0.05, 0.2)}},
      {"overdamped", {k4, {}, rayleigh(k4, 20, 0)}},
  };
  for (const auto& [name, matrices] : systems)
    for (double ratio : {0.99, 0.999, 1.001, 1.01}) {
      const bool none = matrices.d.rows() == 0;
      Expectation expected{ratio < 1 ? right : diverges, {{"implicit-euler", right}}};
      for (const char* method : {"explicit-euler", "rk2", "linearized-explicit-euler"})
        if (none) expected.but.emplace_back(method, no_step);
      all.push_back({"limit", text("%g h_max, %s", ratio, name), expected, matrices, 0, ratio});
    }

  const Matrix kr = uniform(4, 3);
  for (const auto& [name, unit] :
       {std::pair{"ns", 1e-9}, {"µs", 1e-6}, {"hours", 3600.}, {"years", 3.15576e7}})
    add("time unit", name, damped, {unit * unit * kr, {}, unit * rayleigh(kr, 0.05, 0.1)});

  add("structure", "one mass", undamped, {uniform(1, 1)});
  add("structure", "rigid mode", undamped, {chain({0, 1, 1, 1, 0})});
  add("structure", "equal modes", undamped, {Matrix::Identity(6, 6)});
  add("structure", "a massless joint", undamped, {uniform(3, 1), Vector{{1, 0, 1}}.asDiagonal()});
  add("structure", "massless and loose", impossible, {chain({1, 0, 0, 1}), Vector{{1, 0, 1}}.asDiagonal()});
  add("structure", "negative mass", impossible, {uniform(3, 1), Vector{{1, -1, 1}}.asDiagonal()});
  add("structure", "K not symmetric", impossible, {Matrix{{2, -1}, {0, 2}}});
  add("structure", "K not symmetric beside 1e12", impossible, {Matrix{{1e12, 0, 0}, {0, 1, 3}, {0, -3, 1}}});
  add("structure", "K not square", impossible, {Matrix::Ones(2, 3)});
  add("structure", "M of another size", impossible, {uniform(3, 1), Matrix::Identity(4, 4)});
  const std::string banner = "%%MatrixMarket matrix coordinate real general\n";
  all.push_back({"structure", "NaN in K", impossible, matrix_text(banner + "1 1 1\n1 1 nan\n")});
  all.push_back({"structure", "∞ in K", impossible, matrix_text(banner + "1 1 1\n1 1 inf\n")});
  all.push_back({"structure", "1e400 in K", impossible, matrix_text(banner + "1 1 1\n1 1 1e400\n")});
  all.push_back({"structure", "10⁹ entries said, 1 there", impossible,
                 matrix_text(banner + "1000000000 1000000000 1000000000\n1 1 1\n")});
  add("structure", "denormal K", undamped, {uniform(2, 1e-310)});
  add("structure", "K and M of 1e-150", undamped, {uniform(2, 1e-150), 1e-150 * masses(2, 1, 1)});
  add("structure", "K of 1e60, M of 1e-60", undamped, {uniform(2, 1e60), 1e-60 * masses(2, 1, 1)});
  for (double rate : {1e-100, 1e80})
    add("structure", text("rates of %g, damped", rate), impossible,
        {rate * rate * Matrix{{2, -1}, {-1, 2}}, {}, rate * Matrix{{1, 0}, {0, 2}}});
  Expectation overflowing = undamped;
  overflowing.outcome = diverges;
  add("structure", "K of 1e150, M of 1e-150: v² overflows", overflowing,
      {uniform(2, 1e150), 1e-150 * masses(2, 1, 1)});
}

}  // namespace

std::vector<StressCase> matrix_cases() {
  std::vector<StressCase> all;
  add_matrices(all);
  return all;
}

}  // namespace springstab
