// What the README shows is what the command prints: every `$ build/springstab …` in a code block is run, in a
// folder that holds the project's experiments/, and its output held against the lines that follow.
//
// A line of nothing but … stands for any lines. Words must be equal; numbers agree to 1e-6, but for those
// that a clock or the last digits of a sum decide: CPU-seconds, the times of --explain, what the cheapest
// method costs, and residuals.
#include <boost/test/unit_test.hpp>
#include <charconv>
#include <cmath>
#include <optional>
#include <regex>
#include <sstream>
#include <vector>

#include "tests/command.h"

namespace springstab::test {
namespace {

using Lines = std::vector<std::string>;

struct Shown {
  std::string arguments;
  Lines output;
};

Lines lines_of(std::istream& in) {
  Lines lines;
  for (std::string line; std::getline(in, line);) lines.push_back(line);
  return lines;
}

// The commands of the code blocks. One that is interrupted (^C) and resumed, or that shows a method which the
// reader is told to add, is not run.
std::vector<Shown> commands(const Lines& readme) {
  const std::string prompt = "$ build/springstab ";
  std::vector<Shown> found;
  bool in_output = false;
  for (const std::string& line : readme) {
    if (line.starts_with(prompt)) {
      found.push_back({line.substr(prompt.size()), {}});
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
  std::istringstream in(line);
  Lines all;
  for (std::string word; in >> word;) all.push_back(word);
  return all;
}

bool same(const std::string& shown, const std::string& printed) {
  const Lines a = words(shown), b = words(printed);
  if (a.size() != b.size()) return false;
  static const std::regex timed_part(R"(.* (force|Hessian|product|iteration) .*)");
  const bool timed = shown.starts_with("cheapest") || shown.starts_with("chosen") ||
                     (std::regex_match(shown, timed_part) && !shown.starts_with("left"));
  for (std::size_t i = 0; i < a.size(); ++i) {
    if (a[i] == b[i]) continue;
    const auto x = number(a[i]), y = number(b[i]);
    if (!x || !y) return false;
    const bool by_clock = (i + 1 < a.size() && a[i + 1].starts_with("CPU-seconds")) ||
                          (i > 0 && a[i - 1] == "residual") || timed;
    if (!by_clock && !(std::abs(*x - *y) <= 1e-6 * std::abs(*x) + 1e-12)) return false;
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

}  // namespace

BOOST_AUTO_TEST_SUITE(readme)

BOOST_AUTO_TEST_CASE(commands_print_what_the_readme_shows) {
  std::ifstream file(SPRINGSTAB_SOURCE_DIR "/README.md");
  const std::vector<Shown> all = commands(lines_of(file));
  BOOST_TEST_REQUIRE(all.size() >= 8);
  const Command springstab;
  std::filesystem::create_directory_symlink(SPRINGSTAB_SOURCE_DIR "/experiments",
                                            springstab.folder() / "experiments");
  for (const Shown& shown : all) {
    const Outcome outcome = springstab(shown.arguments);
    std::istringstream printed(outcome.err + outcome.out);
    const auto wrong = difference(shown.output, lines_of(printed));
    BOOST_TEST(!wrong, "springstab " << shown.arguments << ":\n" << wrong.value_or(""));
  }
}

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
