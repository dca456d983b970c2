// The options and the help of `springstab simulate`.
#include "experiments/simulate_options.h"

#include <memory>

#include "experiments/command/shared_options.h"

namespace springstab {
namespace {

// As they are typed.
struct TypedSimulateOptions : SimulateOptions {
  std::string damping = "own", hessian = "exact", solver = "cg";
};

}  // namespace

Subcommand simulate_command() {
  const auto o = std::make_shared<TypedSimulateOptions>();
  return {
      .name = "simulate",
      .title = "Runs a scene, a mesh or matrices",
      .footer =
          "The step is shortened so that a whole number of steps ends at the duration. Units are SI. "
          "Matrices "
          "start from a\n"
          "random displacement of unit M-norm (--seed) at rest, without force.\n"
          "Unless --step is given, a run that diverges goes back to its last checkpoint and on with a step "
          "for "
          "the stiffness\n"
          "it has there; a linearized method then also linearizes twice as often.\n"
          "With --error the cheapest method and step are those of `limits --error` over the duration. A "
          "second "
          "run at half the\n"
          "step says how far the positions are off in the mean, and if that is more than E the run is made "
          "once more with\n"
          "shorter steps; JSON: error.estimated, error.status (reached, missed, unknown), error.reason. Exit "
          "status 3 where it is missed.\n"
          "JSON: energy.gained is what kinetic, elastic and gravity's energy together have grown [J]; extent "
          "[m], total_mass [kg]\n"
          "and springs are those of the scene at rest; with --keep-diverged, diverged_frames of the last "
          "frames "
          "are single steps.\n"
          "" +
          std::string(leapfrog_words) +
          "\n"
          "Exit status 3: no stable step, or a linear solve failed; 4: the run diverged.\n\n"
          "example: springstab simulate --grid 32x32 --pin first-row --method symplectic-euler --duration 2 "
          "--output drape\n"
          "         the same with --resume after Ctrl-C or a crash",
      .options = with_input(
          o->input,
          {Option("--method", &o->method,
                  "one of " + method_names() + "; needed without --method-file, unless --error chooses it")
               .shown_as("NAME"),
           Option(
               "--error", &o->error,
               "choose method and step for this error, relative to what moves, and estimate what was reached")
               .shown_as("E"),
           Option("--methods", &o->methods, "to choose from with --error: all, or names with commas")
               .shown_as("all|LIST"),
           Option("--duration", &o->duration, "time to simulate").needed().shown_as("[s]"),
           Option("--step", &o->step, "step (default: the recommended one of `limits`)").shown_as("[s]"),
           Option("--max-step", &o->max_step, "largest step to choose (default 0.01 where nothing limits it)")
               .shown_as("[s]"),
           Option("--safety", &o->safety, "factor F >= 1 on the stiffness for the recommended step")
               .with_default(),
           Option("--relinearize", &o->relinearize, "of linearized methods: time between linearizations")
               .shown_as("[s]")
               .with_default(),
           Option("--damping", &o->damping, "own, or designed: alpha fitted to the step")
               .one_of({"own", "designed"})
               .with_default(),
           Option("--hessian", &o->hessian,
                  "exact, or projected to be positive semidefinite, in implicit and linearized methods")
               .one_of({"exact", "projected"})
               .with_default(),
           Option("--explain", &o->explain,
                  "first say what the scene has, what each part costs a step, and what was left out"),
           Option("--output", &o->output,
                  "folder for the frames and their energies, energy.csv (matrices: trajectory.csv has both)")
               .shown_as("DIR"),
           Option("--format", &o->format,
                  "of the frames: obj, ply (binary), vtk (legacy), pvd (VTK's XML, and a series with times "
                  "for ParaView) or gltf (one animation)")
               .one_of({"gltf", "obj", "ply", "pvd", "vtk"})
               .with_default(),
           Option("--frames", &o->frames, "number of frames after the first, evenly spaced").with_default(),
           Option("--picture", &o->picture,
                  "a quick look by gnuplot: the end of the run (FILE.png) or its motion (FILE.gif)")
               .shown_as("FILE"),
           Option("--solver", &o->solver,
                  "of implicit methods' linear systems: cg (conjugate gradients) or direct (sparse Cholesky)")
               .one_of({"cg", "direct"})
               .with_default(),
           Option("--cg-tolerance", &o->cg_tolerance,
                  "relative residual of implicit methods' conjugate gradients")
               .with_default(),
           Option("--newton", &o->newton,
                  "of implicit methods: at most so many Newton steps within a step; fewer where a correction "
                  "is below 1e-10 of what it corrects")
               .shown_as("N")
               .with_default(),
           Option("--keep-diverged", &o->keep_diverged,
                  "of a run that diverges, also record every one of its last 32 steps before that"),
           resume_option(o->earlier),
           overwrite_option(o->earlier)}),
      .run = [o](const CommonOptions& common) {
        if (!o->error) o->method = method_asked_for(o->method, "--method");
        o->designed_damping = o->damping == "designed";
        o->projected_hessian = o->hessian == "projected";
        o->direct = o->solver == "direct";
        return run_simulate(common, *o);
      }};
}

}  // namespace springstab
