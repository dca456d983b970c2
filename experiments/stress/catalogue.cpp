#include "experiments/stress/catalogue.h"

#include <Eigen/Core>
#include <cmath>

#include "experiments/output.h"

namespace springstab {
namespace {

using Matrix = Eigen::MatrixXd;
using enum StressOutcome;

// Without damping these methods have no stable step.
const Expectation undamped{
    right, {{"explicit-euler", no_step}, {"rk2", no_step}, {"linearized-explicit-euler", no_step}}};
const Expectation damped{right};
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
const Expectation impossible{refused};

// --- files ---

void write_text(const std::string& path, const std::string& contents) {
  OutputFile file(path);
  file.stream() << contents;
  file.commit();
}

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

/// A scene file, and beside it mesh.obj where there is one.
std::function<InputOptions(const std::string&)> scene(std::string json, std::string obj = "") {
  return [json = std::move(json), obj = std::move(obj)](const std::string& folder) {
    InputOptions input;
    input.file = folder + "/scene.json";
    write_text(input.file, json);
    if (!obj.empty()) write_text(folder + "/mesh.obj", obj);
    return input;
  };
}

std::function<InputOptions(const std::string&)> mesh(const std::string& obj, const std::string& more) {
  return scene(R"({"geometry": {"mesh": "mesh.obj"}, )" + more + "}", obj);
}

// --- matrices ---

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
  add("damping", "negative", {right, {{"symplectic-euler", no_step}}}, {k4, {}, -0.01 * k4});  // it grows
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

// --- scenes ---

constexpr char quad[] = "v 0 0 0\nv 1 0 0\nv 1 0 1\nv 0 0 1\nf 1 2 3 4\n";
constexpr char two_triangles[] = "v 0 0 0\nv 1 0 0\nv 1 0 1\nv 0 0 1\nf 1 2 3\nf 1 3 4\n";
constexpr char springs[] = R"("material": {"structural": 10, "shear": 5, "bending": 1}, )";
constexpr char cloth_material[] =
    R"("material": {"model": "baraff-witkin", "stretch": 10, "shear": 1, "bending": 1e-3}, )";
constexpr char drag[] = R"("damping": {"d0": 1, "alpha": 1e-3})";

void add_scenes(std::vector<StressCase>& all) {
  const auto grid = [&](const std::string& name, const Expectation& expected, double duration,
                        const std::string& size, const std::string& more, bool compared = true) {
    all.push_back({"scene", name, expected,
                   scene(R"({"geometry": {"grid": )" + size + R"(, "spacing": 0.1})" +
                         (more.empty() ? "" : ", " + more) + "}"),
                   duration, std::nullopt, compared});
  };
  const std::string pinned = R"("pins": "first-row", )", s = springs, d = drag;
  grid("one particle", damped, 0.5, "[1, 1]", "");
  grid("one particle, air drag", damped, 0.5, "[1, 1]", R"("damping": {"d0": 2})");
  grid("one particle, pinned", impossible, 0.5, "[1, 1]", R"("pins": "0")");
  grid("everything pinned", impossible, 0.5, "[2, 2]", R"("pins": "corners")");
  grid("everything pinned but one", damped, 0.1, "[3, 3]", s + R"("pins": "0-3,5-8", )" + d);
  grid("no pins: free fall", damped, 0.5, "[3, 3]", s + d);
  grid("undamped", undamped, 0.1, "[4, 4]",
       pinned + R"("material": {"structural": 10, "shear": 5, "bending": 1})");
  grid("let go flat", damped, 0.2, "[4, 4]", s + pinned + d);
  grid("at rest without gravity", undamped, 0.2, "[4, 4]",
       cloth_material + pinned + R"("gravity": [0, 0, 0])", false);
  grid("slack: all springs at half length", damped, 0.01, "[4, 4]",
       s + pinned + d + R"(, "initial": {"stretch": [0.5, 1, 0.5]})");
  grid("compressed to a hundredth", damped, 1e-3, "[4, 4]",
       s + pinned + d + R"(, "initial": {"stretch": [0.01, 1, 0.01]})");
  grid("all particles at one place", impossible, 0.01, "[4, 4]",
       s + pinned + d + R"(, "initial": {"stretch": [0, 0, 0]})");
  grid("stretched tenfold", damped, 0.05, "[4, 4]",
       s + pinned + d + R"(, "initial": {"stretch": [10, 1, 10]})");
  grid("inverted", impossible, 0.05, "[4, 4]", s + pinned + d + R"(, "initial": {"stretch": [-1, 1, 1]})");
  grid("impulse of 10³ m/s", damped, 1e-3, "[4, 4]",
       s + pinned + d + R"(, "initial": {"velocity": [0, 1000, 0]})");
  grid("impulse of 10⁶ m/s", damped, 1e-6, "[4, 4]",
       s + pinned + d + R"(, "initial": {"velocity": [0, 1e6, 0]})");
  grid("impulse of 10⁶ m/s, long", damped, 1e-2, "[4, 4]",
       s + pinned + d + R"(, "initial": {"velocity": [0, 1e6, 0]})");
  grid("gravity of 10⁶ m/s²", damped, 0.01, "[4, 4]", s + pinned + d + R"(, "gravity": [0, -1e6, 0])");
  grid("springs of 1e12 N/m", undamped, 1e-6, "[4, 4]",
       R"("material": {"structural": 1e12, "shear": 1e12, "bending": 1e12}, "pins": "first-row")");
  grid("springs of 1e-12 N/m", undamped, 1, "[4, 4]",
       R"("material": {"structural": 1e-12, "shear": 1e-12, "bending": 1e-12}, "pins": "first-row")");
  grid("bending 10⁶ times stiffer", damped, 0.01, "[4, 4]",
       R"("material": {"structural": 1, "shear": 1, "bending": 1e6}, )" + pinned +
           R"("damping": {"d0": 1, "alpha": 1e-6})");
  grid("no springs at all", damped, 0.5, "[3, 3]",
       R"("material": {"structural": 0, "shear": 0, "bending": 0}, "pins": "first-row")");
  grid("particles of 1e-12 kg", undamped, 1e-6, "[4, 4]",
       R"("material": {"particle_mass": 1e-12}, "pins": "first-row")");
  grid("particles of 1e12 kg", undamped, 1, "[4, 4]",
       R"("material": {"particle_mass": 1e12}, "pins": "first-row")");
  grid(
      "dampers, overdamped", damped, 0.05, "[4, 4]",
      R"("material": {"structural": 10, "shear": 5, "bending": 1, "damping": {"structural": 1, "shear": 1, "bending": 1}}, )" +
          pinned + R"("damping": {"d0": 1})");
  grid("air drag of 10⁶ 1/s", damped, 1e-3, "[4, 4]", s + pinned + R"("damping": {"d0": 1e6})");
  grid("negative air drag", impossible, 0.1, "[4, 4]", s + pinned + R"("damping": {"d0": -1})");
  grid("negative spring", impossible, 0.1, "[4, 4]", R"("material": {"structural": -1})");
  grid("mass of 0", impossible, 0.1, "[4, 4]", R"("material": {"particle_mass": 0})");
  grid("stiffness beyond double", impossible, 0.1, "[4, 4]", R"("material": {"structural": 1e309})");
  grid("designed damping", damped, 0.05, "[4, 4]",
       s + pinned + R"("damping": {"d0": 1, "alpha": "designed"})");
  grid("a row of 300", damped, 0.02, "[300, 1]", s + R"("pins": "0", )" + d);
  grid("10⁵ particles", damped, 2e-3, "[316, 317]",
       R"("pins": "first-row", "damping": {"d0": 1, "alpha": 1e-3})", false);
  grid("10⁹ particles", impossible, 0.1, "[100000, 10000]", "");

  const auto add = [&](const std::string& name, const Expectation& expected, const std::string& obj,
                       const std::string& material, double duration = 0.05) {
    all.push_back({"mesh", name, expected, mesh(obj, material + R"("pins": "0", )" + d), duration});
  };
  const std::string c = cloth_material;
  add("triangles", damped, two_triangles, c);
  add("a quad of springs", damped, quad, s);
  add("two pieces", damped, std::string(quad) + "v 5 0 0\nv 6 0 0\nv 6 0 1\nf 5 6 7\n", s);
  add("two pieces of triangles", damped, std::string(two_triangles) + "v 5 0 0\nv 6 0 0\nv 6 0 1\nf 5 6 7\n",
      c);
  add("opposite windings", damped, "v 0 0 0\nv 1 0 0\nv 1 0 1\nv 0 0 1\nf 1 2 3\nf 1 4 3\n", c);
  add("a triangle twice", damped, std::string(two_triangles) + "f 1 2 3\n", c);
  add("a triangle twice, springs", damped, std::string(two_triangles) + "f 1 2 3\n", s);
  add("three triangles at an edge", damped, std::string(two_triangles) + "v 0.5 1 0.5\nf 1 3 5\n", c);
  add("three triangles at an edge, springs", damped, std::string(two_triangles) + "v 0.5 1 0.5\nf 1 3 5\n",
      s);
  add("a sliver, 10⁵ : 1", damped, "v 0 0 0\nv 1 0 0\nv 0.5 0 1e-5\nf 1 2 3\n", s, 1e-3);
  add("a triangle sliver, 10³ : 1", damped, "v 0 0 0\nv 1 0 0\nv 0.5 0 1e-3\nf 1 2 3\n", c, 1e-3);
  add("a triangle without area", impossible, "v 0 0 0\nv 1 0 0\nv 2 0 0\nf 1 2 3\n", c);
  add("an edge of length 0", impossible, "v 0 0 0\nv 1 0 0\nv 1 0 0\nf 1 2 3\n", s);
  add("an edge of 1e-9 m", damped, "v 0 0 0\nv 1 0 0\nv 1 0 1e-9\nf 1 2 3\n", s, 1e-4);
  add("a corner twice", impossible, "v 0 0 0\nv 1 0 0\nf 1 2 2\n", s);
  add("a corner that is not there", impossible, "v 0 0 0\nv 1 0 0\nf 1 2 3\n", s);
  add("a vertex without a face", damped, std::string(quad) + "v 9 9 9\n", s);
  add("NaN in a vertex", impossible, "v 0 0 nan\nv 1 0 0\nv 1 0 1\nf 1 2 3\n", s);
  add("no faces", impossible, "v 0 0 0\nv 1 0 0\nv 1 0 1\n", s);
  add("1e-9 m small", damped, "v 0 0 0\nv 1e-9 0 0\nv 1e-9 0 1e-9\nf 1 2 3\n",
      R"("material": {"structural": 10, "shear": 5, "bending": 1, "particle_mass": 1e-3}, )");
  add("1e9 m large", damped, "v 0 0 0\nv 1e9 0 0\nv 1e9 0 1e9\nf 1 2 3\n",
      R"("material": {"structural": 10, "shear": 5, "bending": 1, "particle_mass": 1e-3}, )");
}

}  // namespace

const char* name(StressOutcome outcome) {
  switch (outcome) {
    case right:
      return "right";
    case diverges:
      return "diverges";
    case refused:
      return "refused";
    case no_step:
      return "no step";
    case limit:
      return "limit";
    case wrong:
      break;
  }
  return "wrong";
}

StressOutcome Expectation::of(std::string_view method) const {
  for (const auto& [name, other] : but)
    if (name == method) return other;
  return outcome;
}

std::vector<StressCase> stress_catalogue() {
  std::vector<StressCase> all;
  add_matrices(all);
  add_scenes(all);
  return all;
}

}  // namespace springstab
