// The command line of `springstab`: options, help, and exit statuses.
#include <CLI/CLI.hpp>
#include <functional>
#include <iostream>
#include <new>
#include <stdexcept>

#include "experiments/experiments.h"
#include "experiments/interrupt.h"
#include "solvers/io/input_error.h"
#include "solvers/stepper.h"

namespace springstab {
namespace {

std::string method_names() {
  std::string names;
  for (const MethodInfo& info : all_methods()) names += (names.empty() ? "" : ", ") + std::string(info.name);
  return names;
}

void add_input(CLI::App& command, InputOptions& input) {
  command
      .add_option("INPUT", input.file, "SCENE.json, a surface .obj, tetrahedra .veg, or either .msh, .vtk")
      ->type_name("FILE");
  command
      .add_option("--grid", input.grid, "N x M particles in the xz-plane; particle i*M + j at (j*s, 0, i*s)")
      ->type_name("NxM");
  command.add_option("--spacing", input.spacing, "distance s of the grid's particles (default 0.025)")
      ->type_name("[m]");
  command
      .add_option("--material", input.material,
                  "default, soft, stiff (springs), and for surfaces baraff-witkin")
      ->type_name("NAME");
  command.add_option("--pin", input.pin, "none, first-row, corners or particle numbers like 0,5-9")
      ->type_name("SPEC");
  command.add_option("--stiffness", input.stiffness, "K: Matrix Market, Harwell-Boeing or Rutherford-Boeing")
      ->type_name("FILE");
  command.add_option("--mass", input.mass, "M (default: the unit matrix)")->type_name("FILE");
  command.add_option("--damping-matrix", input.damping_matrix, "D (default: none)")->type_name("FILE");
  command.add_flag("--sum-duplicates", input.sum_duplicates,
                   "add up entries of a matrix file that have one position");
}

// For the commands that keep what they have finished.
void add_resume(CLI::App& command, bool& resume) {
  command.add_flag("--resume", resume,
                   "go on where the same command was interrupted; what it had finished is in --output");
}

void add_methods(CLI::App& app, const CommonOptions& common, std::function<int()>& chosen) {
  CLI::App* command = app.add_subcommand("methods", "The methods and their constants");
  command->footer(
      "Y_max: largest stable Y = h^2 k over all damping, and the X = h d where it is; real axis: largest\n"
      "stable X at Y = 0; imaginary axis: largest stable h*sqrt(k) without damping.\n\n"
      "example: springstab methods --json");
  command->callback([&] { chosen = [&] { return run_methods(common); }; });
}

void add_region(CLI::App& app, const CommonOptions& common, RegionOptions& o, std::function<int()>& chosen) {
  CLI::App* command =
      app.add_subcommand("region", "The stable region of a method in the X-Y plane (X = hd, Y = h^2 k)");
  command->add_option("METHOD", o.method, "one of " + method_names())->required()->type_name("");
  command->add_option("--x", o.x, "range of X (default: the region's own extent)")->type_name("A:B");
  command->add_option("--y", o.y, "range of Y")->type_name("A:B");
  command->add_option("--nx", o.nx, "cells along X")->capture_default_str();
  command->add_option("--ny", o.ny, "cells along Y")->capture_default_str();
  command->add_option("--raster", o.raster, "write x,y,spectral_radius at cell centres")->type_name("F.csv");
  command
      ->add_option("--boundary", o.boundary,
                   "write the exact boundary: condition,x,y, a blank line ends an arc")
      ->type_name("F.csv");
  command->add_option("--pieces", o.pieces, "write the region to fill: x,y_lower,y_upper")
      ->type_name("F.csv");
  command->add_option("--simulate", o.simulated_cells, "simulate N x N cells and compare with theory")
      ->type_name("N");
  command->add_option("--cells", o.cells, "write the simulated cells: x,y,spectral_radius,diverged")
      ->type_name("F.csv");
  command->add_option("--steps", o.cell_steps, "steps of each simulated cell")->capture_default_str();
  command->footer(
      "All quantities are dimensionless. Cells count as neutral where |rho - 1| <= 1e-9.\n\n"
      "example: springstab region rk4 --x -0.6:6 --y 0:9 --boundary rk4.csv");
  command->callback([&] { chosen = [&] { return run_region(common, o); }; });
}

void add_limits(CLI::App& app, const CommonOptions& common, LimitsOptions& o, std::function<int()>& chosen) {
  CLI::App* command = app.add_subcommand("limits", "Stable steps and damping of a scene, a mesh or matrices");
  add_input(*command, o.input);
  command->add_option("--method", o.method, "one of " + method_names() + " (default: all)")
      ->type_name("NAME");
  command->add_option("--safety", o.safety, "factor F >= 1 on the stiffness for the recommended step")
      ->capture_default_str();
  command->add_option("--max-step", o.max_step, "recommended where nothing limits the step, in seconds")
      ->capture_default_str();
  command->add_flag("--certify", o.certify, "exit 3 unless every method asked for has a certified step");
  command->footer(
      "h_max [s]: every smaller step keeps every mode bounded, with the input's own damping. certified [s]: "
      "proved.\n"
      "use [s]: with the safety factor. With fitted damping: the largest step over all alpha, and that alpha "
      "[s].\n"
      "JSON: h_max_source is exact (for the given k0) or estimate (from computed eigenvalues); h_every_pose "
      "is proved for\n"
      "every pose of a spring scene whose K is semidefinite; transient_growth is how far √energy may grow "
      "before it decays,\n"
      "at least, at the recommended step; h_certified_source says what proves, reason why nothing does; "
      "growth_rate is how\n"
      "fast the motion itself grows [1/s]. K and D need not be symmetric: then nothing is certified.\n"
      "mesh says what was mended in a mesh file: a surface of springs or triangles (.obj), or a solid of\n"
      "tetrahedra (.msh, .veg, .vtk); its texture_map, by which factor the cloth differs from it at most.\n"
      "Exit status 3: the --method asked for has no stable step.\n\n"
      "examples: springstab limits --grid 32x32 --pin first-row\n"
      "          springstab limits skirt.obj --method symplectic-euler --json\n"
      "          springstab limits --stiffness K.mtx --mass M.mtx");
  command->callback([&] { chosen = [&] { return run_limits(common, o); }; });
}

void add_simulate(CLI::App& app, const CommonOptions& common, SimulateOptions& o, std::string& damping,
                  std::string& hessian, std::string& solver, std::function<int()>& chosen) {
  CLI::App* command = app.add_subcommand("simulate", "Runs a scene, a mesh or matrices");
  add_input(*command, o.input);
  command->add_option("--method", o.method, "one of " + method_names())->required()->type_name("NAME");
  command->add_option("--duration", o.duration, "time to simulate")->required()->type_name("[s]");
  command->add_option("--step", o.step, "step (default: the recommended one of `limits`)")->type_name("[s]");
  command
      ->add_option("--max-step", o.max_step, "largest step to choose (default 0.01 where nothing limits it)")
      ->type_name("[s]");
  command->add_option("--safety", o.safety, "factor F >= 1 on the stiffness for the recommended step")
      ->capture_default_str();
  command->add_option("--relinearize", o.relinearize, "of linearized methods: time between linearizations")
      ->type_name("[s]")
      ->capture_default_str();
  command->add_option("--damping", damping, "own, or designed: alpha fitted to the step")
      ->check(CLI::IsMember({"own", "designed"}))
      ->capture_default_str();
  command
      ->add_option("--hessian", hessian,
                   "exact, or projected to be positive semidefinite, in implicit and linearized methods")
      ->check(CLI::IsMember({"exact", "projected"}))
      ->capture_default_str();
  command->add_flag("--explain", o.explain,
                    "first say what the scene has, what each part costs a step, and what was left out");
  command->add_option("--output", o.output, "folder for the frames (matrices: trajectory.csv)")
      ->type_name("DIR");
  command->add_option("--format", o.format, "of the frames: obj or vtk")
      ->check(CLI::IsMember({"obj", "vtk"}))
      ->capture_default_str();
  command->add_option("--frames", o.frames, "number of frames after the first, evenly spaced")
      ->capture_default_str();
  command
      ->add_option("--solver", solver,
                   "of implicit Euler's linear systems: cg (conjugate gradients) or direct (sparse Cholesky)")
      ->check(CLI::IsMember({"cg", "direct"}))
      ->capture_default_str();
  command
      ->add_option("--cg-tolerance", o.cg_tolerance,
                   "relative residual of implicit Euler's conjugate gradients")
      ->capture_default_str();
  add_resume(*command, o.resume);
  command->footer(
      "The step is shortened so that a whole number of steps ends at the duration. Units are SI. Matrices "
      "start from a\n"
      "random displacement of unit M-norm (--seed) at rest, without force.\n"
      "Unless --step is given, a run that diverges goes back to its last checkpoint and on with a step for "
      "the stiffness\n"
      "it has there; a linearized method then also linearizes twice as often.\n"
      "Exit status 3: no stable step, or a linear solve failed; 4: the run diverged.\n\n"
      "example: springstab simulate --grid 32x32 --pin first-row --method symplectic-euler --duration 2 "
      "--output drape\n"
      "         the same with --resume after Ctrl-C or a crash");
  command->callback([&] {
    chosen = [&] {
      o.designed_damping = damping == "designed";
      o.projected_hessian = hessian == "projected";
      o.direct = solver == "direct";
      return run_simulate(common, o);
    };
  });
}

void add_complexity(CLI::App& app, const CommonOptions& common, ComplexityOptions& o,
                    std::function<int()>& chosen) {
  CLI::App* command = app.add_subcommand("complexity", "What the methods cost on a draping cloth");
  command->add_flag("--quick", o.quick, "smaller cloths, a shorter time, three rounds: within a minute");
  command->add_option("--output", o.output, "folder for Figures 5 to 7 and every run as CSV")
      ->type_name("DIR");
  command->add_option("--plots", o.plots, "folder of the gnuplot scripts")
      ->type_name("DIR")
      ->capture_default_str();
  add_resume(*command, o.resume);
  command->footer(
      "CPU time against the number of particles, the square root of k0 [1/s] and implicit Euler's step [s]: "
      "the\n"
      "exponent of its growth with a 95 % confidence interval, medians of five interleaved rounds, in 5 to 7 "
      "minutes.\n"
      "JSON: tables[] (as printed), studies[] {name, series[] {name, exponent, half_width, points[]}}, "
      "all_finished,\n"
      "rollbacks, provenance, files. Exit status 3: a run did not come to its end.\n\n"
      "example: springstab complexity --output figures\n"
      "         springstab complexity --output figures --resume    (after Ctrl-C or a crash)");
  command->callback([&] { chosen = [&] { return run_complexity(common, o); }; });
}

void add_work_precision(CLI::App& app, const CommonOptions& common, WorkPrecisionOptions& o,
                        std::string& damping, std::function<int()>& chosen) {
  CLI::App* command = app.add_subcommand("work-precision", "Error against run time of every method");
  add_input(*command, o.input);
  command->add_option("--duration", o.duration, "time to simulate")->required()->type_name("[s]");
  command->add_option("--damping", damping, "own, or designed: alpha fitted to each step; errors against own")
      ->check(CLI::IsMember({"own", "designed"}))
      ->capture_default_str();
  command->add_option("--time-limit", o.time_limit, "of one run; a contestant ends with the first above it")
      ->type_name("[CPU s]")
      ->capture_default_str();
  command->add_option("--repetitions", o.repetitions, "timed runs, after one that is not")
      ->capture_default_str();
  command->add_flag("!--no-libraries", o.libraries, "without SUNDIALS, GSL and Boost.odeint");
  command->add_option("--output", o.output, "folder for the runs as CSV, the figure, and the reference")
      ->type_name("DIR");
  command->add_option("--plots", o.plots, "folder of the gnuplot scripts")
      ->type_name("DIR")
      ->capture_default_str();
  add_resume(*command, o.resume);
  command->footer(
      "Every method runs with steps from its stability limit down, halved each time, and each library with\n"
      "tolerances from 0.1 down, until a run takes too long or is within 100 times the reference's own "
      "error.\n"
      "Errors are relative and mass-weighted, against a reference in closed form (linear systems) or by "
      "GSL's\n"
      "rk8pd at two tolerances. Where a limit is not known the ladder begins at 4/sqrt(k0). Linearized "
      "methods\n"
      "linearize every 8 steps; implicit Euler's conjugate gradients have the tolerances 1e-2, 1e-4 and "
      "1e-8.\n"
      "Choose a duration on which the motion is not chaotic: the reference then says how precise it is.\n"
      "Cost: CPU seconds, and passes over all springs or blocks (force evaluations, assemblies, products).\n"
      "JSON: reference {method, error}, contestants[] {name, library, limit, runs[]}, provenance, files.\n\n"
      "example: springstab work-precision --grid 16x16 --pin first-row --duration 0.1 --output precision\n"
      "         the same with --resume after Ctrl-C or a crash");
  command->callback([&] {
    chosen = [&] {
      o.designed_damping = damping == "designed";
      return run_work_precision(common, o);
    };
  });
}

void add_divergence(CLI::App& app, const CommonOptions& common, DivergenceOptions& o,
                    std::function<int()>& chosen) {
  CLI::App* command = app.add_subcommand("divergence", "Compares regions and limits with simulations");
  command->add_option("SCENES", o.scenes, "scene files and meshes, besides the built-in scenes")
      ->type_name("FILE");
  command->add_option("--pin", o.pin, "pins of the meshes: particle numbers like 0,5-9")
      ->capture_default_str();
  command->add_option("--cells", o.cells, "cells of the X-Y plane, per side")->capture_default_str();
  command->add_option("--steps", o.steps, "steps of each cell")->capture_default_str();
  command->add_flag("--quick", o.quick, "small scenes, few steps; 100 cells a side unless given");
  command->add_option("--output", o.output, "folder for the CSV files")->type_name("DIR");
  add_resume(*command, o.resume);
  command->footer(
      "X-Y plane: one oscillator per cell and method. `differ` counts those that diverge where |λ| <= 1 or "
      "stay\n"
      "bounded where it is larger, `outside it` those of them for which the steps were enough to tell.\n"
      "Cloth: runs at 0.5 to 1.5 of the limit of the linear system at the start, under three dampings: air "
      "drag,\n"
      "alpha = 1e-4 s, and fitted to the step. A scene's own `damping` is set aside, a material with damping "
      "refused.\n"
      "`bounded`: up to this ratio no run of the scene diverged. `k0 grows`: largest k0(t)/k0(0).\n"
      "`needs F`: the safety factor on k0 that would have given such a step. - where even the shortest one "
      "tried\n"
      "diverged.\n"
      "JSON: cells, disagreements, outside_band, plane[], safety[], switching, pendulum.\n\n"
      "example: springstab divergence skirt.obj --pin 0-15 --output results\n"
      "         the same with --resume after Ctrl-C or a crash");
  command->callback([&, command] {
    chosen = [&, command] {
      if (o.quick && command->count("--cells") == 0) o.cells = 100;
      if (o.quick && command->count("--steps") == 0) o.steps = 500;
      return run_divergence(common, o);
    };
  });
}

void add_stress(CLI::App& app, const CommonOptions& common, StressOptions& o, std::function<int()>& chosen) {
  CLI::App* command = app.add_subcommand("stress", "Stiff, extreme and hostile cases by every method");
  command->add_option("--filter", o.filter, "only cases whose class or name contains this")
      ->type_name("TEXT");
  command->add_option("--output", o.output, "folder for the table, stress.csv")->type_name("DIR");
  command->footer(
      "Each case is a file or several, run as `simulate` would with steps of at most a hundredth of its "
      "duration [s].\n"
      "Outcomes: right (within a tenth of the true motion, or bounded below a limit), diverges (above one), "
      "refused (the\n"
      "input, with a reason), no step (the method has no stable one), limit (right as far as it came: the "
      "whole "
      "motion\n"
      "would take too many steps), wrong (anything else).\n"
      "JSON: cases, runs, unexpected, outcomes, results[] {class, case, method, expectation, outcome, "
      "as_expected,\n"
      "detail, step, steps, error}, files. Exit status 3: an outcome is not the expected one.\n\n"
      "example: springstab stress --filter 'mass ratio' --output results");
  command->callback([&] { chosen = [&] { return run_stress_command(common, o); }; });
}

void add_figures(CLI::App& app, const CommonOptions& common, FiguresOptions& o,
                 std::function<int()>& chosen) {
  CLI::App* command = app.add_subcommand("figures", "Computes and plots the figures (needs gnuplot)");
  command
      ->add_option(
          "NAMES", o.names,
          "1 to 7 (the paper's), frames, k0, precision-linear and others, long-runs, stress or a method's "
          "name (default: all)")
      ->type_name("");
  command->add_flag("--quick", o.quick, "fewer simulated cells, smaller cloths");
  command->add_option("--plots", o.plots, "folder of the gnuplot scripts")
      ->type_name("DIR")
      ->capture_default_str();
  command->add_option("--output", o.output, "folder for the figures and their data")
      ->type_name("DIR")
      ->capture_default_str();
  command->footer("example: springstab figures 1 2 --output figures");
  command->callback([&] { chosen = [&] { return run_figures(common, o); }; });
}

}  // namespace

int run_command(int argc, const char* const* argv) {
  CommonOptions common;
  RegionOptions region;
  LimitsOptions limits;
  SimulateOptions simulate;
  ComplexityOptions complexity{.plots = SPRINGSTAB_PLOTS_DIR, .output = ""};
  WorkPrecisionOptions precision;
  precision.plots = SPRINGSTAB_PLOTS_DIR;
  DivergenceOptions divergence;
  StressOptions stress;
  FiguresOptions figures{.names = {}, .plots = SPRINGSTAB_PLOTS_DIR, .output = "paper_figures"};
  std::string damping = "own", precision_damping = "own", hessian = "exact", solver = "cg";
  std::function<int()> chosen;

  CLI::App app{"Stable time steps, damping and regions for mass-spring simulation.", "springstab"};
  app.set_version_flag("--version", SPRINGSTAB_VERSION);
  app.add_flag("--json", common.json, "one JSON document on stdout");
  app.add_flag("--quiet", common.quiet, "no progress on stderr");
  app.add_option("--seed", common.seed, "of everything random")
      ->check(CLI::NonNegativeNumber)
      ->capture_default_str();
  app.add_option("--threads", common.threads, "for the X-Y planes of region, divergence and figures")
      ->check(CLI::Range(1, 1024))
      ->capture_default_str();
  app.require_subcommand(1);
  app.fallthrough();
  app.footer(
      "The options above are accepted before and after a subcommand, which has its own --help.\n"
      "Exit status: 0 done, 1 internal error, 2 wrong usage or input,\n"
      "3 there is no answer, 4 the simulation diverged, 130 interrupted.");
  add_methods(app, common, chosen);
  add_region(app, common, region, chosen);
  add_limits(app, common, limits, chosen);
  add_simulate(app, common, simulate, damping, hessian, solver, chosen);
  add_complexity(app, common, complexity, chosen);
  add_work_precision(app, common, precision, precision_damping, chosen);
  add_divergence(app, common, divergence, chosen);
  add_stress(app, common, stress, chosen);
  add_figures(app, common, figures, chosen);

  exit_on_interrupt("nothing was saved");
  try {
    app.parse(argc, argv);
    return chosen();
  } catch (const CLI::ParseError& error) {
    if (error.get_exit_code() == 0) return app.exit(error);  // --help, --version
    std::cerr << "springstab: " << error.what() << "; see springstab --help\n";
    return bad_input;
  } catch (const InputError& error) {
    std::cerr << "springstab: " << error.what() << '\n';
    return bad_input;
  } catch (const std::invalid_argument& error) {
    std::cerr << "springstab: " << error.what() << '\n';
    return bad_input;
  } catch (const std::bad_alloc&) {
    std::cerr << "springstab: not enough memory for this input\n";
    return bad_input;
  } catch (const std::exception& error) {
    std::cerr << "springstab: internal error: " << error.what() << '\n';
    return internal_error;
  }
}

}  // namespace springstab
