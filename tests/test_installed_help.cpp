// What the command tells shells, man and its doctor: completion that offers what fits, man pages with every
// option, and a self-check that comes out sound.
#include <boost/test/unit_test.hpp>
#include <filesystem>
#include <nlohmann/json.hpp>
#include <set>
#include <sstream>
#include <string>

#include "experiments/command/optional_parts.h"
#include "experiments/command/programs.h"
#include "tests/command.h"

BOOST_FIXTURE_TEST_SUITE(installed_help, springstab::test::Command)

using springstab::test::Command;
using springstab::test::content_of;
using springstab::test::Outcome;

namespace {

std::set<std::string> words_in(const std::string& text) {
  std::istringstream in(text);
  std::set<std::string> words;
  for (std::string word; in >> word;) words.insert(word);
  return words;
}

// What bash offers for the last of these words.
std::set<std::string> offered(const Command& command, const std::string& words) {
  const Outcome asked = command.shell(
      "\"$springstab\" completion bash > c.bash && bash -c 'source ./c.bash; COMP_WORDS=(springstab " +
      words + "); COMP_CWORD=$((${#COMP_WORDS[@]} - 1)); _springstab; printf \"%s\\n\" \"${COMPREPLY[@]}\"'");
  BOOST_REQUIRE_MESSAGE(asked.status == 0, asked.err);
  return words_in(asked.out);
}

// Options that a help text lists: words with two dashes at the beginning of its lines.
std::set<std::string> options_in_help(const std::string& help) {
  std::istringstream lines(help);
  std::set<std::string> options;
  for (std::string line; std::getline(lines, line);) {
    const std::size_t begin = line.find_first_not_of(' ');
    if (begin == std::string::npos || begin == 0 || begin > 4 || line[begin] != '-') continue;
    const std::size_t dashes = line.find("--");
    options.insert(line.substr(dashes, line.find_first_of(" ,=[{", dashes) - dashes));
  }
  return options;
}

std::set<std::string> subcommands_of(const Command& command) { return offered(command, "\"\""); }

}  // namespace

BOOST_AUTO_TEST_CASE(bash_completes_subcommands_options_and_words) {
  const std::set<std::string> subcommands = subcommands_of(*this);
  for (const char* name : {"limits", "simulate", "report", "doctor", "completion"})
    BOOST_TEST(subcommands.contains(name), name);
  BOOST_TEST(offered(*this, "lim") == std::set<std::string>{"limits"});
  BOOST_TEST(offered(*this, "--quiet lim") == std::set<std::string>{"limits"});
  BOOST_TEST(offered(*this, "limits --diag") == std::set<std::string>{"--diagonals"});
  BOOST_TEST(offered(*this, "limits --diagonals \"\"") == (std::set<std::string>{"alternating", "uniform"}));
  BOOST_TEST(offered(*this, "simulate --damping d") == std::set<std::string>{"designed"});
  BOOST_TEST(offered(*this, "region sym") == std::set<std::string>{"symplectic-euler"});
  BOOST_TEST(offered(*this, "limits --method rk4") == std::set<std::string>{"rk4"});
  BOOST_TEST(offered(*this, "limits --safety \"\"").empty());
  BOOST_TEST(offered(*this, "limits --plots-of-figures").empty());
  file("skirt of mine.obj", "");
  BOOST_TEST(offered(*this, "limits ski") == (std::set<std::string>{"skirt", "of", "mine.obj"}));
}

// Each option in the help of each subcommand is one that bash offers and one in its man page.
BOOST_AUTO_TEST_CASE(completion_and_man_pages_have_every_option_of_the_help) {
  BOOST_REQUIRE((*this)("man --output pages").status == 0);
  for (const std::string& subcommand : subcommands_of(*this)) {
    const std::set<std::string> options = options_in_help((*this)(subcommand + " --help").out);
    const std::set<std::string> completed = offered(*this, subcommand + " --");
    const std::string page = content_of(folder() / "pages" / ("springstab-" + subcommand + ".1"));
    BOOST_TEST(page == (*this)("man " + subcommand).out, subcommand);
    BOOST_TEST(!options.empty());
    for (const std::string& option : options) {
      BOOST_TEST(completed.contains(option), subcommand << ' ' << option);
      std::string in_roff = option;
      for (std::size_t at = 0; (at = in_roff.find('-', at)) != std::string::npos; at += 2)
        in_roff.insert(at, "\\");
      BOOST_TEST(page.find(in_roff + "\\fR") != std::string::npos, subcommand << ' ' << option);
    }
  }
  BOOST_TEST(content_of(folder() / "pages/springstab.1") == (*this)("man").out);
  const Outcome unknown = (*this)("man limit");
  BOOST_TEST(unknown.status == 2);
  BOOST_TEST(unknown.err.find("did you mean 'limits'?") != std::string::npos, unknown.err);
}

// No page has a request or an escape that the formatter does not know, and zsh and fish read their scripts.
BOOST_AUTO_TEST_CASE(formatters_and_shells_take_what_was_generated) {
  BOOST_REQUIRE((*this)("man --output pages").status == 0);
  if (springstab::find_program("groff")) {
    const Outcome formatted =
        shell("for page in pages/*.1; do groff -man -ww -Kutf8 -Tutf8 \"$page\" >/dev/null; done");
    BOOST_TEST(formatted.status == 0);
    BOOST_TEST(formatted.err == "");
  }
  for (const char* name : {"zsh", "fish"})
    if (springstab::find_program(name)) {
      const std::string of_it(name);
      const Outcome read = shell("\"$springstab\" completion " + of_it + " > c && " + of_it + " -n c");
      BOOST_TEST(read.status == 0, read.err);
      BOOST_TEST(read.err == "");
    }
  if (springstab::find_program("fish")) {
    const Outcome asked = shell(
        "\"$springstab\" completion fish > c.fish; HOME=$PWD fish -c 'source c.fish; complete -C "
        "\"springstab simulate "
        "--damping \"' | cut -f1");
    BOOST_TEST(words_in(asked.out) == (std::set<std::string>{"own", "designed"}));
  }
}

BOOST_AUTO_TEST_CASE(the_doctor_knows_what_is_there_and_finds_known_numbers) {
  const Outcome asked = (*this)("doctor --json");
  BOOST_TEST(asked.status == 0);
  const nlohmann::json report = asked.json();
  BOOST_TEST(report["sound"] == true);
  BOOST_TEST(report["checks"].size() >= 10u);
  for (const nlohmann::json& check : report["checks"]) {
    BOOST_TEST(check["holds"] == true, check["name"]);
    BOOST_TEST(std::abs(check["found"].get<double>() / check["expected"].get<double>() - 1) < 1e-9,
               check["name"]);
  }
  const std::string version = (*this)("--version").out;
  for (const nlohmann::json& part : report["parts"]) {
    const std::string told =
        (part["built_in"].get<bool>() ? "with " : "without ") + part["name"].get<std::string>();
    BOOST_TEST(version.find(told) != std::string::npos, told);
  }
  BOOST_TEST(shell("PATH= \"$springstab\" doctor").out.find("gnuplot                      not found") !=
             std::string::npos);
  BOOST_TEST((*this)("doctor").out.find("sound: all of") != std::string::npos);
}

BOOST_AUTO_TEST_SUITE_END()
