// The command line of `springstab`, assembled from its subcommands, and exit statuses.
#include "experiments/command/command_line.h"

#include <CLI/CLI.hpp>
#include <algorithm>
#include <iostream>
#include <new>
#include <stdexcept>

#include "analysis/method.h"
#include "experiments/command/app_pages.h"
#include "experiments/command/interrupt.h"
#include "experiments/command/optional_parts.h"
#include "experiments/command/subcommand_list.h"
#include "experiments/command/words.h"
#include "experiments/inputs/method_file.h"
#include "solvers/io/input_error.h"
#include "solvers/io/text_file.h"

namespace springstab {
namespace {

std::vector<Subcommand> all_subcommands() {
  return {methods_command(),  region_command(),     limits_command(),         report_command(),
          simulate_command(), complexity_command(), work_precision_command(), divergence_command(),
          stress_command(),   figures_command(),    probe_command(),          diagnose_command(),
          doctor_command()};
}

CLI::Option* add_target(CLI::App& app, const Option& option, bool* flag) {
  return app.add_flag(option.name, *flag, option.help);
}

template <class T>
CLI::Option* add_target(CLI::App& app, const Option& option, T* target) {
  return app.add_option(option.name, *target, option.help);
}

std::vector<std::string_view> views(const std::vector<std::string>& words) {
  return {words.begin(), words.end()};
}

CLI::Validator one_of(const std::vector<std::string>& known) {
  std::string list;
  for (const std::string& word : known) list += (list.empty() ? "" : ",") + word;
  return CLI::Validator(
      [known](const std::string& word) {
        if (std::find(known.begin(), known.end(), word) != known.end()) return std::string();
        return springstab::quoted(word) + " is unknown, " + expected_one_of(word, views(known));
      },
      '{' + list + '}');
}

// Of the first word that nothing was known of, an option or a subcommand: what was probably meant. Empty
// where there is no such word.
std::string misspelt(const CLI::App& app) {
  const std::vector<std::string> unknown = app.remaining(true);
  if (unknown.empty()) return {};
  const std::vector<CLI::App*> chosen = app.get_subcommands();
  const std::string word = unknown[0].substr(0, unknown[0].find('='));
  if (!word.starts_with('-')) {
    if (!chosen.empty()) return {};
    std::vector<std::string> names;
    for (const CLI::App* each : app.get_subcommands({})) names.push_back(each->get_name());
    return "unknown subcommand " + springstab::quoted(word) + ", " + expected_one_of(word, views(names));
  }
  std::vector<std::string> names;
  for (const CLI::App* each : {&app, chosen.empty() ? &app : static_cast<const CLI::App*>(chosen[0])})
    for (const CLI::Option* option : each->get_options())
      for (const std::string& name : option->get_lnames()) names.push_back("--" + name);
  return "unknown option " + springstab::quoted(word) + did_you_mean(word, views(names));
}

std::string unknown_method(const UnknownMethod& error) {
  std::vector<std::string> names;
  for (const Method& method : all_methods()) names.push_back(method.name());
  return error.what() + did_you_mean(error.name, views(names));
}

void add(CLI::App& app, const Option& option) {
  CLI::Option* added =
      std::visit([&](auto* target) { return add_target(app, option, target); }, option.target);
  if (option.required) added->required();
  if (option.value) added->type_name(*option.value);
  if (!option.known.empty()) added->check(one_of(option.known));
  if (!option.default_text.empty()) {
    added->default_str(option.default_text);
  } else if (option.default_shown) {
    added->capture_default_str();
  }
}

void add_common_options(CLI::App& app, CommonOptions& common) {
  app.set_version_flag("--version", SPRINGSTAB_VERSION "\n" + optional_parts_text());
  app.add_flag("--json", common.json, "one JSON document on stdout");
  app.add_flag("--quiet", common.quiet, "no progress on stderr");
  app.add_option("--seed", common.seed, "of everything random")
      ->check(CLI::NonNegativeNumber)
      ->capture_default_str();
  app.add_option(
         "--threads", common.threads,
         "of simulate's loops and of the X-Y planes of region, divergence and figures; what comes out "
         "does not depend on it")
      ->check(CLI::Range(1, 1024))
      ->default_str("all cores");
  app.add_option("--method-file", common.method_file,
                 "a method from a JSON file, for every subcommand that names or lists methods")
      ->type_name("F.json");
  app.require_subcommand(1);
  app.fallthrough();
  app.footer(
      "The options above are accepted before and after a subcommand, which has its own --help.\n"
      "Exit status: 0 done, 1 internal error, 2 wrong usage or input,\n"
      "3 there is no answer, 4 the simulation diverged, 130 interrupted.");
}

// As a shell reads it: in quotes where it has to be.
std::string shell_word(const std::string& word) {
  constexpr const char* plain = "abcdefghijklmnopqrstuvwxyzABCDEFGHIJKLMNOPQRSTUVWXYZ0123456789-_=+,./:@%";
  if (!word.empty() && word.find_first_not_of(plain) == std::string::npos) return word;
  std::string quoted = "'";
  for (const char c : word) quoted += c == '\'' ? "'\\''" : std::string(1, c);
  return quoted + "'";
}

// What was thrown as one line of the program's; the exit status.
int refuse(const std::string& program, const std::string& reason, int status = bad_input) {
  std::cerr << program << ": " << reason << '\n';
  return status;
}

}  // namespace

int run_command(int argc, const char* const* argv) {
  return run_command("springstab", all_subcommands(), argc, argv);
}

int run_command(const std::string& program, const std::vector<Subcommand>& subcommands, int argc,
                const char* const* argv) {
  CommonOptions common;
  const Subcommand* chosen = nullptr;
  CLI::App app{"Stable time steps, damping and regions for mass-spring simulation.", program};
  add_common_options(app, common);
  std::vector<Subcommand> all = subcommands;
  for (const auto& more : {completion_command(app), man_command(app)}) all.push_back(more);
  for (const Subcommand& subcommand : all) {
    CLI::App* added = app.add_subcommand(subcommand.name, subcommand.title);
    for (const Option& option : subcommand.options) add(*added, option);
    added->footer(subcommand.footer);
    added->callback([&, added] {
      chosen = &subcommand;
      for (const CLI::Option* option : added->get_options())
        if (option->count() > 0) common.given.insert(option->get_name());
    });
  }

  for (int i = 0; i < argc; ++i) common.command_line += (i > 0 ? " " : "") + shell_word(argv[i]);
  exit_on_interrupt("nothing was saved");
  try {
    app.parse(argc, argv);
    if (!common.method_file.empty()) add_method(read_method_file(common.method_file));
    return chosen->run(common);
  } catch (const CLI::ParseError& error) {
    if (error.get_exit_code() == 0) return app.exit(error);  // --help, --version
    const std::string unknown = misspelt(app);
    return refuse(program, (unknown.empty() ? error.what() : unknown) + "; see " + program + " --help");
  } catch (const InputError& error) {
    return refuse(program, error.what());
  } catch (const UnknownMethod& error) {
    return refuse(program, unknown_method(error));
  } catch (const std::invalid_argument& error) {
    return refuse(program, error.what());
  } catch (const std::bad_alloc&) {
    return refuse(program, "not enough memory for this input");
  } catch (const std::exception& error) {
    return refuse(program, std::string("internal error: ") + error.what(), internal_error);
  }
}

}  // namespace springstab
