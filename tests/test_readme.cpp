// What README.md and the pages of docs/ show is true. Every `$ build/springstab …` in a code block is run, in
// a folder that holds the project's experiments/, and its output held against the lines that follow, and so
// is every `$ mpirun -np N build/springstab-mpi …` where that program was built; scenes are run, methods'
// files and C++ are those of the project, options exist, and links lead somewhere.
//
// A line of nothing but … stands for any lines. Words must be equal; numbers agree to 1e-6, what contact
// counts to 1 %, but for those that a clock or the last digits of a sum decide: CPU-seconds, the times of
// --explain, what the cheapest method costs and which method comes second, and residuals.
#include <algorithm>
#include <boost/test/unit_test.hpp>
#include <cctype>
#include <charconv>
#include <cmath>
#include <optional>
#include <regex>
#include <set>
#include <sstream>
#include <vector>

#include "analysis/regions/stability_region.h"
#include "solvers/contact/surface_pairs.h"
#include "solvers/methods/explicit_runge_kutta.h"
#include "tests/command.h"
#include "tests/places.h"

namespace springstab::test {
namespace {

using Lines = std::vector<std::string>;

struct Shown {
  std::string arguments;
  Lines output;
  std::string ranks{};  // of springstab-mpi; empty for springstab itself
};

// The method that a reader is told to add.
inline constexpr ExplicitTableau<3> rk3_tableau{
    .a = {{{}, {0.5}, {-1, 2}}},
    .b = {1. / 6, 2. / 3, 1. / 6},
};

struct Rk3 {
  MethodInfo info() const { return {"rk3", "Runge-Kutta 3", 3, false}; }
  template <class V>
  using Steps = ExplicitRungeKutta<V, rk3_tableau>;
};

const std::filesystem::path source = springstab::test::source_folder();

std::vector<std::filesystem::path> pages() {
  std::vector<std::filesystem::path> all{source / "README.md"};
  for (const auto& entry : std::filesystem::directory_iterator(source / "docs"))
    if (entry.path().extension() == ".md") all.push_back(entry.path());
  std::sort(all.begin(), all.end());
  return all;
}

Lines lines_of(std::istream& in) {
  Lines lines;
  for (std::string line; std::getline(in, line);) lines.push_back(line);
  return lines;
}

// The commands of the code blocks. One that is interrupted (^C) and resumed, or that shows a method which the
// reader is told to add, is not run.
std::vector<Shown> commands(const Lines& page) {
  static const std::regex prompt(R"(\$ (?:mpirun -np (\d+) build/springstab-mpi|build/springstab) (.*))");
  std::vector<Shown> found;
  bool in_output = false;
  for (const std::string& line : page) {
    if (std::smatch match; std::regex_match(line, match, prompt)) {
      found.push_back({match.str(2), {}, match.str(1)});
      in_output = true;
    } else if (line.starts_with("```")) {
      in_output = false;
    } else if (in_output) {
      found.back().output.push_back(line);
    }
  }
  std::erase_if(found, [](const Shown& shown) {
    std::string all = shown.arguments;
    for (const std::string& line : shown.output) all += line;
    return all.find("^C") != std::string::npos || all.find("--resume") != std::string::npos ||
           all.find("rk3") != std::string::npos;
  });
  for (Shown& shown : found)
    while (!shown.output.empty() && shown.output.back().empty()) shown.output.pop_back();
  return found;
}

std::optional<double> number(std::string word) {
  while (!word.empty() && (word.back() == ',' || word.back() == ')')) word.pop_back();
  if (word.starts_with('(')) word.erase(0, 1);
  double value = 0;
  const auto [end, error] = std::from_chars(word.data(), word.data() + word.size(), value);
  if (error != std::errc() || end != word.data() + word.size()) return std::nullopt;
  return value;
}

Lines words(const std::string& line) {
  std::istringstream in(line.substr(0, line.find("a step of ")));
  Lines all;
  for (std::string word; in >> word;) all.push_back(word);
  return all;
}

bool same(const std::string& shown, const std::string& printed) {
  const Lines a = words(shown), b = words(printed);
  if (a.size() != b.size()) return false;
  static const std::regex timed_part(R"(.* (force|Hessian|product|iteration|impulses) .*)");
  const bool timed = shown.starts_with("cheapest") || shown.starts_with("chosen") ||
                     (std::regex_match(shown, timed_part) && !shown.starts_with("left"));
  for (std::size_t i = 0; i < a.size(); ++i) {
    if (a[i] == b[i]) continue;
    const auto x = number(a[i]), y = number(b[i]);
    if (!x || !y) return false;
    const bool by_clock = (i + 1 < a.size() && a[i + 1].starts_with("CPU-seconds")) ||
                          (i > 0 && a[i - 1] == "residual") || timed;
    const double relative = shown.starts_with("contact: ") ? 0.01 : 1e-6;  // what touches is a matter of bits
    if (!by_clock && !(std::abs(*x - *y) <= relative * std::abs(*x) + 1e-12)) return false;
  }
  return true;
}

// The first line that is not as printed; nothing where all are.
std::optional<std::string> difference(const Lines& shown, const Lines& printed) {
  std::size_t next = 0;
  bool any = false;
  for (const std::string& line : shown) {
    if (line == "…") {
      any = true;
      continue;
    }
    while (any && next < printed.size() && !same(line, printed[next])) ++next;
    if (next >= printed.size() || !same(line, printed[next]))
      return line + "\n  is shown, printed is\n" + (next < printed.size() ? printed[next] : "nothing more");
    any = false;
    ++next;
  }
  while (next < printed.size() && printed[next].empty()) ++next;
  if (!any && next < printed.size()) return "printed beyond what is shown: " + printed[next];
  return std::nullopt;
}

// The code blocks that begin with ```language.
std::vector<std::string> blocks(const std::filesystem::path& page, const std::string& language) {
  std::ifstream file(page);
  std::vector<std::string> found;
  bool inside = false;
  for (const std::string& line : lines_of(file)) {
    if (line.starts_with("```")) {
      inside = line == "```" + language;
      if (inside) found.emplace_back();
    } else if (inside) {
      found.back() += line + '\n';
    }
  }
  return found;
}

// Without white space, and without the // before the lines of an example in a header.
std::string squeezed(const std::string& code) {
  std::istringstream in(code);
  std::string all;
  for (std::string line : lines_of(in)) {
    line.erase(0, line.find_first_not_of(' '));
    if (line.starts_with("//     ")) line.erase(0, 7);
    for (const char c : line)
      if (c != ' ') all += c;
    all += '\n';
  }
  return all;
}

// What is compiled: headers, whose examples test_examples.cpp includes, and programs.
std::vector<std::string> compiled_code() {
  std::vector<std::string> all;
  for (const char* folder : {"solvers", "analysis", "experiments", "tests"})
    for (const auto& entry : std::filesystem::recursive_directory_iterator(source / folder))
      if (entry.path().extension() == ".h" || entry.path().extension() == ".cpp")
        all.push_back(squeezed(content_of(entry.path())));
  return all;
}

// As GitHub and MkDocs name a heading.
std::string anchor_of(const std::string& heading) {
  std::string anchor;
  for (const char c : heading) {
    if (std::isalnum(static_cast<unsigned char>(c)) || c == '-' || c == '_')
      anchor += static_cast<char>(std::tolower(static_cast<unsigned char>(c)));
    else if (c == ' ')
      anchor += '-';
  }
  return anchor;
}

std::set<std::string> anchors_of(const std::filesystem::path& page) {
  std::set<std::string> anchors;
  std::ifstream file(page);
  for (const std::string& line : lines_of(file))
    if (line.starts_with('#')) anchors.insert(anchor_of(line.substr(line.find(' ') + 1)));
  return anchors;
}

std::set<std::string> matches(const std::string& text, const std::regex& pattern) {
  std::set<std::string> found;
  for (auto it = std::sregex_iterator(text.begin(), text.end(), pattern); it != std::sregex_iterator(); ++it)
    found.insert(it->str(1));
  return found;
}

// Of springstab-mpi, as Open MPI wants to be told of root and of few cores.
std::string mpi_line(const std::string& program, const Shown& shown) {
  return "OMPI_ALLOW_RUN_AS_ROOT=1 OMPI_ALLOW_RUN_AS_ROOT_CONFIRM=1 "
         "OMPI_MCA_rmaps_base_oversubscribe=1 OMPI_MCA_mpi_yield_when_idle=1 mpirun -q -np " +
         shown.ranks + " '" + program + "' " + shown.arguments;
}

/// In a folder of its own, with the project's experiments/ and the scenes' meshes.
struct InAFolder {
  InAFolder() {
    std::filesystem::create_directory_symlink(source / "experiments", springstab.folder() / "experiments");
    for (const char* mesh : {"skirt.obj", "beam.veg"})
      std::filesystem::create_symlink(source / "experiments/scenes" / mesh, springstab.folder() / mesh);
  }
  Command springstab;
};

}  // namespace

BOOST_AUTO_TEST_SUITE(readme)

BOOST_AUTO_TEST_CASE(commands_print_what_the_pages_show) {
  std::size_t run = 0;
  const std::string mpi_program = command_path() + "-mpi";
  for (const std::filesystem::path& page : pages()) {
    const InAFolder here;
    std::ifstream file(page);
    for (const Shown& shown : commands(lines_of(file))) {
      if (!shown.ranks.empty() && !std::filesystem::exists(mpi_program)) {
        BOOST_TEST_MESSAGE("skipped, for springstab-mpi was not built: " << shown.arguments);
        continue;
      }
      const Outcome outcome = shown.ranks.empty() ? here.springstab(shown.arguments)
                                                  : here.springstab.shell(mpi_line(mpi_program, shown));
      if (!has_embree() && outcome.err.find(embree_is_missing) != std::string::npos) continue;
      std::istringstream printed(outcome.err + outcome.out);
      const auto wrong = difference(shown.output, lines_of(printed));
      BOOST_TEST(!wrong, page.filename() << ": springstab " << shown.arguments << ":\n"
                                         << wrong.value_or(""));
      ++run;
    }
  }
  BOOST_TEST(run >= 12);
}

BOOST_AUTO_TEST_CASE(scenes_run_and_methods_are_those_of_the_project) {
  std::set<std::string> methods;
  for (const auto& entry : std::filesystem::directory_iterator(source / "experiments/methods"))
    methods.insert(nlohmann::json::parse(content_of(entry.path())).dump());
  int scenes = 0, files = 0;
  const InAFolder here;
  for (const std::filesystem::path& page : pages())
    for (const std::string& text : blocks(page, "json")) {
      if (text.find("\"geometry\"") != std::string::npos) {
        here.springstab.file("scene.json", text);
        const Outcome outcome =
            here.springstab("simulate scene.json --method symplectic-euler --step 1e-5 --duration 1e-4");
        BOOST_TEST(outcome.status == 0, page.filename() << ": " << outcome.err << text);
        ++scenes;
      } else if (text.find("\"kind\"") != std::string::npos) {
        BOOST_TEST(methods.contains(nlohmann::json::parse(text).dump()), page.filename() << ": " << text);
        ++files;
      }
    }
  BOOST_TEST(scenes >= 3);
  BOOST_TEST(files >= 1);
}

BOOST_AUTO_TEST_CASE(code_stands_so_in_what_is_compiled) {
  const std::vector<std::string> compiled = compiled_code();
  int found = 0;
  for (const std::filesystem::path& page : pages())
    for (const std::string& block : blocks(page, "cpp")) {
      const std::string code = squeezed(block);
      BOOST_TEST(std::any_of(compiled.begin(), compiled.end(),
                             [&](const std::string& file) { return file.find(code) != std::string::npos; }),
                 page.filename() << ":\n"
                                 << block);
      ++found;
    }
  BOOST_TEST(found >= 8);
}

BOOST_AUTO_TEST_CASE(the_method_to_be_added_has_the_numbers_shown) {
  const StabilityRegion region{make_method(Rk3())};
  BOOST_TEST(region.constants().y_max == 6.4415599553, boost::test_tools::tolerance(1e-10));
  BOOST_TEST(region.constants().x_at_y_max == 2.1526173758, boost::test_tools::tolerance(1e-8));
  BOOST_TEST(region.constants().real_interval == 2.512745327, boost::test_tools::tolerance(1e-9));
}

BOOST_AUTO_TEST_CASE(options_exist) {
  const Command springstab;
  const std::string list = springstab("--help").out;
  std::string help = list + content_of(source / "run");
  for (const std::string& name :
       matches(list.substr(list.find("Subcommands:")), std::regex("\n  ([a-z-]+) ")))
    help += springstab(name + " --help").out;
  const std::regex option("(--[a-z][a-z_-]*)");
  std::set<std::string> known = matches(help, option);
  // Of CMake, pip, Google Benchmark and Open MPI.
  known.insert({"--build", "--install", "--prefix", "--no-build-isolation", "--benchmark_filter",
                "--allow-run-as-root", "--oversubscribe"});
  for (const std::filesystem::path& page : pages())
    for (const std::string& name : matches(content_of(page), option))
      BOOST_TEST(known.contains(name), page.filename() << " speaks of " << name);
}

BOOST_AUTO_TEST_CASE(links_lead_to_files_and_headings) {
  const std::regex link(R"(\]\(([^)\s]+)\))");
  for (const std::filesystem::path& page : pages())
    for (const std::string& target : matches(content_of(page), link)) {
      if (target.find("://") != std::string::npos) continue;
      const std::size_t hash = std::min(target.find('#'), target.size());
      const std::filesystem::path file =
          hash == 0 ? page : page.parent_path() / std::filesystem::path(target.substr(0, hash));
      BOOST_TEST(std::filesystem::is_regular_file(file), page.filename() << " links to " << target);
      if (hash < target.size())
        BOOST_TEST(anchors_of(file).contains(target.substr(hash + 1)), page.filename()
                                                                           << " links to " << target);
    }
}

BOOST_AUTO_TEST_CASE(the_readme_is_short) { BOOST_TEST(lines(content_of(source / "README.md")) <= 200); }

BOOST_AUTO_TEST_CASE(another_number_or_word_is_a_difference) {
  const Lines printed{"k0 = 2.5 1/s² (Ritz value, residual 1e-9)", "done in 3 CPU-seconds"};
  BOOST_TEST(!difference({"k0 = 2.5 1/s² (Ritz value, residual 2e-5)", "…"}, printed));
  BOOST_TEST(!difference({"…", "done in 7 CPU-seconds"}, printed));
  BOOST_TEST(difference({"k0 = 2.51 1/s² (Ritz value, residual 1e-9)", "…"}, printed).has_value());
  BOOST_TEST(difference({"k0 = 2.5 1/s (Ritz value, residual 1e-9)", "…"}, printed).has_value());
  BOOST_TEST(difference({"k0 = 2.5 1/s² (Ritz value, residual 1e-9)"}, printed).has_value());
}

BOOST_AUTO_TEST_SUITE_END()

}  // namespace springstab::test
