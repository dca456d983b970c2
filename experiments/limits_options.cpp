// The options and the help of `springstab limits`.
#include "experiments/limits_options.h"

#include <memory>

#include "experiments/command/shared_options.h"

namespace springstab {

Subcommand limits_command() { return limits_command(run_limits); }

Subcommand limits_command(std::function<int(const CommonOptions&, const LimitsOptions&)> run) {
  const auto o = std::make_shared<LimitsOptions>();
  return {
      .name = "limits",
      .title = "Stable steps and damping of a scene, a mesh or matrices",
      .footer =
          "h_max [s]: every smaller step keeps every mode bounded, with the input's own damping. certified "
          "[s]: "
          "proved.\n"
          "use [s]: with the safety factor. With fitted damping: the largest step over all alpha, and that "
          "alpha "
          "[s].\n"
          "JSON: h_max_source is exact (for the given k0) or estimate (from computed eigenvalues); "
          "h_every_pose "
          "is proved for\n"
          "every pose of a spring scene whose K is semidefinite; transient_growth is how far √energy may "
          "grow "
          "before it decays,\n"
          "at least, at the recommended step; h_certified_source says what proves, reason why nothing does; "
          "growth_rate is how\n"
          "fast the motion itself grows [1/s]. K and D need not be symmetric: then nothing is certified.\n"
          "mesh says what was mended in a mesh file: a surface of springs or triangles (.obj), or a solid "
          "of\n"
          "tetrahedra (.msh, .veg, .vtk); its texture_map, by which factor the cloth differs from it at "
          "most.\n"
          "extent [m], total_mass [kg] and springs are those of the scene at rest.\n"
          "cheapest is the method that costs least CPU time a simulated second at its own step, measured "
          "over a "
          "few steps here and now:\n"
          "stable only, or with --error at the step at which the linear system's own modes are predicted to "
          "be off by E, in the mean over\n"
          "the slowest period (1 s where nothing comes back), of which JSON gives each method's error_step "
          "and "
          "predicted_error;\n"
          "with --frame-rate, substeps and frame_step [s]. JSON has cheapest where one of the two is "
          "given.\n" +
          std::string(leapfrog_words) +
          "\n"
          "--for-step H, or --frame-rate with --substeps: where a method does not hold, what alone would "
          "make "
          "it hold (d0, alpha\n"
          "and dampers kept): the largest factor on the stiffness, alphas from to [s], the least factor on "
          "all "
          "masses, the least\n"
          "mass added to single particles [kg], the fewest substeps. JSON has it in for_step, by method; "
          "indices count from 0.\n"
          "JSON: stiffest are the ten elements (of matrices unknowns) with most of the stiffest mode's "
          "energy; "
          "cheap_bounds are\n"
          "two bounds on k0 without an eigenvalue of the whole, and which part of the step they leave "
          "unused.\n"
          "Exit status 3: the --method asked for has no stable step.\n\n"
          "examples: springstab limits --grid 32x32 --pin first-row\n"
          "          springstab limits skirt.obj --method symplectic-euler --json\n"
          "          springstab limits --stiffness K.mtx --mass M.mtx\n"
          "          springstab limits --grid 32x32 --frame-rate 60 --substeps 10",
      .options = with_input(
          o->input,
          {Option("--method", &o->method, "only this one of " + method_names() + "; NAME:key=value,...")
               .shown_as("NAME"),
           methods_option(o->methods),
           Option("--safety", &o->safety, "factor F >= 1 on the stiffness for the recommended step")
               .with_default(),
           Option("--max-step", &o->max_step, "recommended where nothing limits the step, in seconds")
               .with_default(),
           Option("--digits", &o->digits, "of h, 1 to 10 (default: all, or 4 from 20 000 unknowns on)")
               .shown_as("N"),
           Option("--certify-loss", &o->certify_loss,
                  "part of h that a proof by pieces of a large system may lose")
               .with_default()
               .shown_as("X"),
           Option("--certify", &o->certify, "exit 3 unless every method asked for has a certified step"),
           Option("--error", &o->error, "that the cheapest method is to reach, relative to what moves: 0.01")
               .shown_as("E"),
           Option("--frame-rate", &o->frame_rate, "also say how many steps make a frame of 1/FPS seconds")
               .shown_as("FPS"),
           Option("--substeps", &o->substeps, "of such a frame: says of that step what --for-step says")
               .shown_as("N"),
           Option("--for-step", &o->for_step,
                  "whether each method holds at this step, and what would make it hold")
               .shown_as("[s]"),
           Option("--explain", &o->explain, "what decides the step: where the stiffest mode's energy is"),
           Option("--picture", &o->picture, "the scene, drawn by gnuplot").shown_as("FILE.png"),
           Option("--mode", &o->mode, "writes the stiffest mode, vertex by vertex, as CSV")
               .shown_as("FILE")}),
      .run = [o, run](const CommonOptions& common) { return run(common, *o); }};
}

}  // namespace springstab
