// `springstab diagnose`: a run that blew up, of any simulator, from its frames: since when, by what factor a
// step, which vertices, and which method at which step does that.
#include <cmath>
#include <iostream>
#include <memory>

#include "experiments/command/output.h"
#include "experiments/command/shared_options.h"
#include "experiments/command/subcommand_list.h"
#include "experiments/diagnosis.h"
#include "experiments/inputs/mesh_report.h"
#include "solvers/io/input_error.h"

namespace springstab {
namespace {

struct DiagnoseOptions {
  InputOptions input;
  std::string frames;
  double step = 0;
  int every = 1;
};

void check(const DiagnoseOptions& options) {
  if (!(options.step > 0 && std::isfinite(options.step)))
    throw InputError("--step", 0, text("is %g, expected a positive number of seconds", options.step));
  if (options.every < 1) throw InputError("--every", 0, text("is %d, expected at least 1", options.every));
}

// Also where only what belongs to an input was given: then it is missing, which is said.
bool has_input(const InputOptions& input) {
  for (const std::string* word :
       {&input.file, &input.grid, &input.material, &input.pin, &input.diagonals, &input.stiffness,
        &input.mass, &input.damping_matrix, &input.implicit_damping_matrix, &input.rayleigh})
    if (!word->empty()) return true;
  return input.spacing || input.scale || input.sum_duplicates;
}

std::string words_of(std::complex<double> factor) {
  return factor.imag() == 0 ? text("%.6g", factor.real()) : text("%.6g%+.6gi", factor.real(), factor.imag());
}

const char* meaning(const std::string& kind) {
  if (kind == "alternating") return "from step to step it alternates: the step is too long";
  if (kind == "ringing") return "it rings and grows: the method amplifies at this step";
  return "it grows with one sign: buckling, contact or a motion that is itself unstable";
}

void print_factor(const Diagnosis& found) {
  const diagnosis::Growth& growth = *found.growth;
  const double seconds = found.run.h * found.run.every;
  std::cout << text("grows from frame %ld (%g s) on", static_cast<long>(growth.from),
                    seconds * static_cast<double>(growth.from));
  if (const auto factor = found.factor()) {
    std::cout << ", by " << words_of(*factor) << " a step";
    if (factor->imag() != 0) std::cout << text(", in size %.6g", std::abs(*factor));
    std::cout << text(": %s\n", meaning(kind_of(*factor)));
  } else {
    std::cout << text(
        ", by %.6g a step (%s a frame; between frames it may have turned any number of times)\n",
        std::pow(std::abs(growth.factor), 1.0 / found.run.every), words_of(growth.factor).c_str());
  }
  std::cout << text("followed over %.1f e-foldings, to frame %ld; the frames are explained to %.2g\n",
                    growth.e_foldings, static_cast<long>(growth.to), growth.residual);
  std::cout << "vertices with most of it, from 0:";
  for (std::size_t i = 0; i < found.vertices.size(); ++i)
    std::cout << text("%s %ld (%.1f %%)", i == 0 ? "" : ",", static_cast<long>(found.vertices[i]),
                      100 * found.shares[i]);
  std::cout << '\n';
}

void print_fit(const Diagnosis& found) {
  const auto& seen = *found.seen;
  std::cout << text("the pattern's stiffness is %.4g of the stiffest mode's", seen.of_stiffest);
  if (seen.overlap) std::cout << text(", with which it has the cosine %.3f", *seen.overlap);
  std::cout << '\n';
  if (!found.fit()) {
    std::cout << "no method of the list has this factor at this step";
    if (!seen.methods.empty())
      std::cout << text("; nearest is %s with %s", seen.methods[0].method.name().c_str(),
                        words_of(seen.methods[0].factor).c_str());
    std::cout << '\n';
    return;
  }
  const diagnosis::MethodOfGrowth& fit = *found.fit();
  std::cout << "fits " << fit.method.name();
  if (fit.step_over_limit) std::cout << text(" at %.4g of its limit", *fit.step_over_limit);
  std::cout << ", whose factor is " << words_of(fit.factor) << '\n';
  std::string others;
  for (const auto& one : seen.methods)
    if (one.fits && &one != &fit) others += (others.empty() ? "" : ", ") + one.method.name();
  if (!others.empty()) std::cout << "so do: " << others << '\n';
}

void print(const Diagnosis& found) {
  if (found.used < found.frames)
    std::cout << text(
        "%ld of %ld frames are used: from there on positions are not finite or beyond all measure\n",
        static_cast<long>(found.used), static_cast<long>(found.frames));
  if (found.status == Diagnosis::Status::no_growth)
    std::cout << text("no growth: in %ld frames nothing grows exponentially\n",
                      static_cast<long>(found.used));
  if (found.status == Diagnosis::Status::too_fast)
    std::cout << "it blew up, but not over enough frames by one factor: expected frames of every step\n";
  if (found.growth) print_factor(found);
  if (found.seen) print_fit(found);
}

int run_diagnose(const CommonOptions& common, const DiagnoseOptions& options) {
  check(options);
  const RunFrames frames = read_frames(options.frames);
  std::optional<Subject> subject;
  if (has_input(options.input)) {
    subject.emplace(options.input, true);
    print_mesh_notes(*subject);
  }
  const std::vector<Method> methods = methods_of("all");
  Diagnosis found;
  {
    const Waiting waiting("diagnosing", common.quiet);
    found = diagnose(frames, {.h = options.step, .every = options.every}, subject ? &*subject : nullptr,
                     subject && subject->scene() ? &*subject : nullptr, options.frames, methods);
  }
  if (common.json) {
    print_json(json_of(found));
  } else {
    print(found);
  }
  return done;
}

}  // namespace

Subcommand diagnose_command() {
  const auto o = std::make_shared<DiagnoseOptions>();
  std::vector<Option> options{
      Option("FRAMES", &o->frames,
             "folder of .obj, .ply, .vtk or .npy files, one a frame; or one .npy, (frames, vertices, 3)")
          .needed()
          .shown_as("PATH"),
      Option("--step", &o->step, "of the run, in seconds").needed().shown_as("H"),
      Option("--every", &o->every, "steps from one frame to the next").with_default().shown_as("N")};
  std::vector<Option> input = with_input(o->input, {});
  options.insert(options.end(), std::move_iterator(input.begin()), std::move_iterator(input.end()));
  return {
      .name = "diagnose",
      .title = "A run that blew up, of any simulator: since when, how fast, where, and of which method",
      .footer =
          "Near a blow-up frames are a trend and a pattern that grows by one factor a step. Negative: it "
          "alternates, the step is\n"
          "too long; complex: it rings; positive: buckling, contact or motion that is itself unstable. A "
          "factor counts once the\n"
          "pattern has followed it for five e-foldings, eight where its sign stays. What falls, swings or "
          "decays has none.\n"
          "With INPUT, the run's structure: how much of the stiffest mode is in the pattern, and which "
          "method grows by this factor\n"
          "on it at this step. Frames of a scene have all vertices of its mesh or its unknowns; of matrices, "
          "the unknowns.\n"
          "JSON: status is growing, no growth, or too fast (it blew up over too few frames); grows_from "
          "and vertices count from\n"
          "0; factor is [re, im]; frame_factor that of a frame; shares are squares of the pattern's; fits "
          "is null where none does.\n"
          "Frames that are not finite are left out, with all after them.\n\n"
          "example: springstab diagnose frames/ --step 1e-3 skirt.obj --pin 0-9",
      .options = std::move(options),
      .run = [o](const CommonOptions& common) { return run_diagnose(common, *o); }};
}

}  // namespace springstab
