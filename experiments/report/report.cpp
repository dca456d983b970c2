// `springstab report`: the answer of `limits` as one page to look at and to show, which opens without a
// network.
#include <chrono>
#include <cmath>
#include <filesystem>
#include <iostream>
#include <memory>

#include "experiments/command/interrupt.h"
#include "experiments/command/programs.h"
#include "experiments/command/shared_options.h"
#include "experiments/inputs/mesh_report.h"
#include "experiments/inputs/size_report.h"
#include "experiments/report/browser.h"
#include "experiments/report/report_page.h"
#include "solvers/io/input_error.h"

namespace springstab {
namespace {

// Before anything is computed.
void expect_writable(const std::string& path) {
  if (std::filesystem::exists(path) && !std::filesystem::is_regular_file(path)) return;
  const OutputFile would_be(path);  // not committed: gone
}

void check_report_options(const CommonOptions& common, const ReportOptions& options) {
  if (options.limits.for_step && !(*options.limits.for_step > 0 && std::isfinite(*options.limits.for_step)))
    throw InputError("--step", 0,
                     text("is %g, expected a positive number of seconds", *options.limits.for_step));
  if (options.duration && !(*options.duration > 0 && std::isfinite(*options.duration)))
    throw InputError("--duration", 0,
                     text("is %g, expected a positive number of seconds", *options.duration));
  check_limits_options(common, options.limits);
  if (options.pdf == options.output)
    throw InputError(options.pdf, 0, "is to be written twice, expected a file for each output");
  if (!options.pdf.empty() && !find_browser()) throw InputError("--pdf", 0, needs_browser);
  if (!std::filesystem::is_regular_file(options.plots + "/scene.gp"))
    throw InputError(options.plots, 0,
                     "has no scene.gp, expected the folder of the gnuplot scripts (--plots)");
  expect_writable(options.output);
  if (!options.pdf.empty()) expect_writable(options.pdf);
}

int say_interrupted() {
  std::cerr << "springstab: interrupted; nothing was saved\n";
  return interrupted;
}

// The page last: where it stands, all of it does.
void write_whole(const ReportOptions& options, const std::string& page, const std::string& pdf) {
  OutputFile file(options.output);
  file.stream() << page;
  if (!options.pdf.empty()) {
    OutputFile printed(options.pdf);
    printed.stream() << pdf;
    printed.commit();
  }
  file.commit();
}

int run_report(const CommonOptions& common, const ReportOptions& options) {
  const auto begin = std::chrono::steady_clock::now();
  check_report_options(common, options);
  const std::vector<Method> methods = methods_of(options.limits);
  Subject subject(options.limits.input, true);
  CommonOptions of_limits = common;
  of_limits.json = true;  // what `limits --json` says, the page has
  LimitsAnswer answer(of_limits, options.limits, methods, subject, true);
  std::vector<std::string> remarks = mesh_notes(subject);
  if (const std::string warning = size_warning(subject); !warning.empty()) remarks.push_back(warning);
  for (const std::string& remark : answer.remarks()) remarks.push_back(remark);
  if (!find_program("gnuplot")) remarks.emplace_back("note: " + std::string(without_pictures));
  for (const std::string& remark : remarks) std::cerr << "springstab: " << remark << '\n';

  const std::string page = ReportPage(common, options, answer, remarks).html();
  std::string pdf;
  if (!options.pdf.empty()) {
    const StopOnInterrupt interrupt;
    const Waiting waiting("printing", common.quiet);
    pdf = printed_as_pdf(page, [&] { return interrupt.requested(); });
    if (interrupt.requested()) return say_interrupted();
  }
  write_whole(options, page, pdf);
  const std::chrono::duration<double> seconds = std::chrono::steady_clock::now() - begin;
  Json files{options.output};
  if (!options.pdf.empty()) files.push_back(options.pdf);
  if (common.json) {
    print_json(Json{{"files", files}, {"seconds", seconds.count()}});
  } else {
    for (const Json& file : files) std::cout << file.get<std::string>() << '\n';
  }
  return answer.status();
}

}  // namespace

Subcommand report_command() {
  const auto o = std::make_shared<ReportOptions>();
  return {
      .name = "report",
      .title = "The answer for a scene, a mesh or matrices as one page to show",
      .footer =
          "One HTML file with everything in it, which opens without a network, in a light or dark window: "
          "the "
          "answer,\n"
          "a picture, the limits as `limits` has them, the modes in the regions of the methods to use, error "
          "against\n"
          "run time, k0 along a motion, what decides the step, and the command to repeat it. Pictures are "
          "drawn "
          "by\n"
          "gnuplot where it is installed; --pdf has Chromium print the page. JSON: files, seconds.\n\n"
          "example: springstab report skirt.obj --pin 0-63 -o report.html",
      .options = with_input(
          o->limits.input,
          {Option("-o,--output", &o->output, "the page to write").needed().shown_as("FILE.html"),
           Option("--pdf", &o->pdf, "the same page as PDF (needs Chromium)").shown_as("FILE.pdf"),
           Option("--step", &o->limits.for_step, "a step of yours, to be shown beside those to use")
               .shown_as("[s]"),
           methods_option(o->limits.methods),
           Option("--safety", &o->limits.safety, "factor F >= 1 on the stiffness for the step to use")
               .with_default(),
           Option("--max-step", &o->limits.max_step, "to use where nothing limits the step, in seconds")
               .with_default(),
           Option("--duration", &o->duration,
                  "of the motions that errors and k0 are told of (default: as long as it is quick)")
               .shown_as("[s]"),
           plots_option(o->plots)}),
      .run = [o](const CommonOptions& common) { return run_report(common, *o); }};
}

}  // namespace springstab
