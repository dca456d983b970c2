// `springstab stress`: the catalogue of stiff, extreme and hostile cases by every method, against what was
// expected of them; and its figure, a map method by case.
#include "experiments/studies/stress/stress.h"

#include <stdlib.h>

#include <algorithm>
#include <filesystem>
#include <iostream>
#include <map>
#include <memory>

#include "analysis/method.h"
#include "experiments/command/output.h"
#include "experiments/command/subcommand_list.h"
#include "experiments/studies/figure_list.h"
#include "experiments/studies/gnuplot.h"
#include "solvers/io/input_error.h"

namespace springstab {
namespace {

namespace fs = std::filesystem;

struct StressOptions {
  std::string filter;  // part of a case's class or name, empty for all
  std::string output;  // folder, empty for none
};

/// A folder of its own for the cases' files, removed at the end.
class ScratchFolder {
 public:
  ScratchFolder() : path_((fs::temp_directory_path() / "springstab-stress-XXXXXX").string()) {
    if (!mkdtemp(path_.data()))
      throw InputError(path_, 0, "could not be created, expected a writable folder");
  }
  ~ScratchFolder() {
    std::error_code ignored;
    fs::remove_all(path_, ignored);
  }
  ScratchFolder(const ScratchFolder&) = delete;
  ScratchFolder& operator=(const ScratchFolder&) = delete;
  const std::string& path() const { return path_; }

 private:
  std::string path_;
};

std::map<std::string, long> counts_of(const std::vector<StressResult>& results) {
  std::map<std::string, long> counts;
  for (const StressResult& r : results) ++counts[name(r.outcome)];
  return counts;
}

long unexpected(const std::vector<StressResult>& results) {
  return std::ranges::count_if(results, [](const StressResult& r) { return !r.as_expected(); });
}

std::string summary(const std::vector<StressResult>& results) {
  std::string list;
  for (const auto& [outcome, count] : counts_of(results)) list += text("%ld %s, ", count, outcome.c_str());
  return text("%zu runs: ", results.size()) + list + text("%ld not as expected", unexpected(results));
}

/// Doubles its quotation marks.
std::string csv_text(const std::string& s) {
  std::string quoted = "\"";
  for (char c : s) quoted += c == '"' ? std::string("\"\"") : std::string(1, c);
  return quoted + '"';
}

Json json_of(const StressResult& r) {
  return {{"class", r.kind},
          {"case", r.name},
          {"method", r.method},
          {"expectation", name(r.expected)},
          {"outcome", name(r.outcome)},
          {"as_expected", r.as_expected()},
          {"detail", r.detail},
          {"step", r.step > 0 ? number(r.step) : Json()},
          {"steps", r.steps},
          {"error", number(r.error)}};
}

// A row a case: its outcomes where they are not the same for all methods.
void print(const std::vector<StressResult>& results) {
  const std::size_t methods = all_methods().size();
  for (std::size_t i = 0; i < results.size(); i += methods) {
    const StressResult* const row = &results[i];
    std::cout << row->kind << ", " << row->name << ": ";
    const bool same = std::all_of(row, row + methods, [&](const StressResult& r) {
      return r.outcome == row->outcome && r.as_expected();
    });
    if (same) {
      std::cout << name(row->outcome) << (row->outcome == StressOutcome::refused ? ": " + row->detail : "")
                << '\n';
      continue;
    }
    for (std::size_t j = 0; j < methods; ++j)
      std::cout << (j ? ", " : "") << row[j].method << ' ' << name(row[j].outcome);
    std::cout << '\n';
    for (std::size_t j = 0; j < methods; ++j)
      if (!row[j].as_expected())
        std::cout << text("  %s: expected '%s', came out '%s': %s\n", row[j].method.c_str(),
                          name(row[j].expected), name(row[j].outcome), row[j].detail.c_str());
  }
}

Json draw_stress(const FigureFiles& files, const CommonOptions& common, const FiguresOptions& options) {
  const std::vector<StressResult> results = run_catalogue("", common);
  write_stress(files.data + ".csv", results);
  OutputFile points(files.data + "_points.csv");
  const std::size_t methods = all_methods().size();
  points.stream() << "# case;method;outcome;as_expected;label\n";
  for (std::size_t i = 0; i < results.size(); ++i)
    points.stream() << i / methods << ';' << i % methods << ';' << static_cast<int>(results[i].outcome) << ';'
                    << results[i].as_expected() << ';' << results[i].kind << ": " << results[i].name << '\n';
  points.commit();
  std::string settings = text("cases=%zu; methods=%zu; data=", results.size() / methods, methods) +
                         gnuplot_literal(files.data + "_points.csv") +
                         "; summary=" + gnuplot_literal(summary(results)) + "; ";
  for (std::size_t i = 0; i < methods; ++i)
    settings += text("method_%zu=", i) + gnuplot_literal(all_methods()[i].info().title) + "; ";
  std::vector<std::string> written = draw(options.plots + "/stress.gp", settings, files.picture);
  written.insert(written.end(), {files.data + ".csv", files.data + "_points.csv"});
  return {{"files", written}, {"holds", unexpected(results) == 0}, {"summary", summary(results)}};
}

}  // namespace

std::vector<StressResult> run_catalogue(const std::string& filter, const CommonOptions& common) {
  Progress progress("stress", common.quiet);
  const ScratchFolder folder;
  std::vector<StressResult> results;
  const std::vector<StressCase> all = stress_catalogue();
  for (std::size_t i = 0; i < all.size(); ++i) {
    if ((all[i].kind + ", " + all[i].name).find(filter) == std::string::npos) continue;
    std::optional<StiffestMode> k0;
    for (const Method& method : all_methods()) {
      results.push_back(run_stress(all[i], method.name(), folder.path(), common, k0));
      progress.update(static_cast<double>(i) / static_cast<double>(all.size()));
    }
  }
  return results;
}

void write_stress(const std::string& path, const std::vector<StressResult>& results) {
  OutputFile file(path);
  std::ostream& out = file.stream();
  out << "class,case,method,expectation,outcome,as_expected,step,steps,error,detail\n";
  for (const StressResult& r : results) {
    out << csv_text(r.kind) << ',' << csv_text(r.name) << ',' << r.method << ',' << name(r.expected) << ','
        << name(r.outcome) << ',' << r.as_expected() << ',';
    if (r.step > 0) out << text("%.6g", r.step);
    out << ',' << r.steps << ',';
    if (r.error) out << text("%.2g", *r.error);
    out << ',' << csv_text(r.detail) << '\n';
  }
  file.commit();
}

static int run_stress_command(const CommonOptions& common, const StressOptions& options) {
  const std::vector<StressResult> results = run_catalogue(options.filter, common);
  if (results.empty())
    throw InputError("--filter", 0, "no case's class or name contains '" + options.filter + "'");
  Json files = Json::array();
  if (!options.output.empty()) {
    make_folder(options.output);
    files.push_back(options.output + "/stress.csv");
    write_stress(options.output + "/stress.csv", results);
  }
  if (common.json) {
    Json list = Json::array();
    for (const StressResult& r : results) list.push_back(json_of(r));
    print_json(Json{{"cases", results.size() / all_methods().size()},
                    {"runs", results.size()},
                    {"unexpected", unexpected(results)},
                    {"outcomes", counts_of(results)},
                    {"results", list},
                    {"files", files}});
  } else {
    print(results);
    std::cout << '\n' << summary(results) << '\n';
  }
  return unexpected(results) == 0 ? done : no_answer;
}

std::vector<Figure> stress_figures() { return {{.file = "stress", .name = "stress", .draw = draw_stress}}; }

Subcommand stress_command() {
  const auto o = std::make_shared<StressOptions>();
  return {
      .name = "stress",
      .title = "Stiff, extreme and hostile cases by every method",
      .footer =
          "Each case is a file or several, run as `simulate` would with steps of at most a hundredth of its "
          "duration [s].\n"
          "Outcomes: right (within a tenth of the true motion, or bounded below a limit), diverges (above "
          "one), "
          "refused (the\n"
          "input, with a reason), no step (the method has no stable one), limit (right as far as it came: "
          "the "
          "whole "
          "motion\n"
          "would take too many steps), wrong (anything else).\n"
          "JSON: cases, runs, unexpected, outcomes, results[] {class, case, method, expectation, outcome, "
          "as_expected,\n"
          "detail, step, steps, error}, files. Exit status 3: an outcome is not the expected one.\n\n"
          "example: springstab stress --filter 'mass ratio' --output results",
      .options =
          {Option("--filter", &o->filter, "only cases whose class or name contains this").shown_as("TEXT"),
           Option("--output", &o->output, "folder for the table, stress.csv").shown_as("DIR")},
      .run = [o](const CommonOptions& common) { return run_stress_command(common, *o); }};
}

}  // namespace springstab
