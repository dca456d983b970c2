#include <CLI/CLI.hpp>
#include <iostream>
#include <map>
#include <memory>

#include "analysis/method.h"
#include "experiments/command/app_pages.h"

namespace springstab {
namespace {

enum class ValueKind { none, words, file, folder, other };

/// What may follow an option, or stand for an operand.
struct OptionValue {
  ValueKind kind;
  std::vector<std::string> words{};
  std::string label{};
};

std::vector<const CLI::App*> subcommands_of(const CLI::App& app) {
  std::vector<const CLI::App*> all;
  for (const CLI::App* each : app.get_subcommands({})) all.push_back(each);
  return all;
}

std::vector<std::string> words_of(const std::string& list, char separator) {
  std::vector<std::string> words;
  std::istringstream in(list);
  for (std::string word; std::getline(in, word, separator);) words.push_back(word);
  return words;
}

// By its type in the help: {a,b} are all words there are.
OptionValue value_of(const CLI::Option& option) {
  if (option.get_items_expected_max() == 0) return {ValueKind::none};
  const std::string type = option.get_type_name(), name = option.get_name();
  const std::size_t open = type.find('{'), close = type.rfind('}');
  const std::string label = type.substr(0, type.find(':'));
  if (open != std::string::npos && close > open)
    return {ValueKind::words, words_of(type.substr(open + 1, close - open - 1), ','), label};
  if (name == "--method" || name == "--methods" || name == "METHOD") {
    std::vector<std::string> names;
    for (const Method& method : built_in_methods()) names.push_back(method.name());
    return {ValueKind::words, names, "METHOD"};
  }
  if (type.starts_with("DIR")) return {ValueKind::folder, {}, "DIR"};
  if (type.starts_with("FILE") || type.starts_with("F.")) return {ValueKind::file, {}, "FILE"};
  return {ValueKind::other, {}, label.empty() ? "value" : label};
}

std::vector<std::string> dashed_names(const CLI::Option& option) {
  std::vector<std::string> names;
  for (const std::string& name : option.get_snames()) names.push_back("-" + name);
  for (const std::string& name : option.get_lnames()) names.push_back("--" + name);
  return names;
}

std::string joined_words(const std::vector<std::string>& words, const char* between = " ") {
  std::string all;
  for (const std::string& word : words) all += (all.empty() ? "" : between) + word;
  return all;
}

// In single quotes; `quote` is how a quote within is written, and each of `special` follows a backslash.
std::string in_quotes(const std::string& text, const char* quote, const std::string& special = "") {
  std::string out = "'";
  for (const char c : text) {
    if (special.find(c) != std::string::npos) out += '\\';
    out += c == '\'' ? quote : std::string(1, c);
  }
  return out + "'";
}

std::string bash_action(const OptionValue& value) {
  switch (value.kind) {
    case ValueKind::words:
      return "COMPREPLY=($(compgen -W '" + joined_words(value.words) + "' -- \"$current\"))";
    case ValueKind::file:
      return "_springstab_files -f";
    case ValueKind::folder:
      return "_springstab_files -d";
    default:
      return ":";
  }
}

std::string options_in(const CLI::App& app) {
  std::vector<std::string> names;
  for (const CLI::Option* option : app.get_options())
    for (const std::string& name : dashed_names(*option)) names.push_back(name);
  return joined_words(names);
}

// Patterns "subcommand:option" by what is to be done there.
void add_bash_patterns(const CLI::App& app, const std::string& subcommand,
                       std::map<std::string, std::vector<std::string>>& patterns) {
  for (const CLI::Option* option : app.get_options()) {
    const OptionValue value = value_of(*option);
    if (value.kind == ValueKind::none) continue;
    for (const std::string& name : dashed_names(*option))
      patterns[bash_action(value)].push_back(subcommand + ":" + name);
  }
}

std::string bash_script(const CLI::App& app) {
  std::map<std::string, std::vector<std::string>> patterns;
  std::vector<std::string> names;
  std::string options, operands;
  add_bash_patterns(app, "*", patterns);
  for (const CLI::App* each : subcommands_of(app)) {
    const std::string name = each->get_name();
    names.push_back(name);
    add_bash_patterns(*each, name, patterns);
    options += "    " + name + ") options=\"$options " + options_in(*each) + "\" ;;\n";
    for (const CLI::Option* option : each->get_options())
      if (option->get_positional() && value_of(*option).kind == ValueKind::words)
        operands += "    " + name + ") " + bash_action(value_of(*option)) + "; return ;;\n";
  }
  std::string cases;
  for (const auto& [action, list] : patterns)
    cases += "    " + joined_words(list, "|") + ") " + action + "; return ;;\n";
  return R"(# bash completion for springstab
_springstab_files() {
  compopt -o filenames 2>/dev/null
  mapfile -t COMPREPLY < <(compgen "$1" -- "$current")
}
_springstab() {
  local current=${COMP_WORDS[COMP_CWORD]} before=${COMP_WORDS[COMP_CWORD-1]} subcommand='' word
  COMPREPLY=()
  for word in "${COMP_WORDS[@]:1:COMP_CWORD-1}"; do
    case $word in )" +
         joined_words(names, "|") + R"() subcommand=$word; break ;; esac
  done
  case $subcommand:$before in
)" + cases +
         R"(  esac
  local options=')" +
         options_in(app) + R"('
  case $subcommand in
)" + options +
         R"(  esac
  if [[ $current == -* ]]; then
    COMPREPLY=($(compgen -W "$options" -- "$current"))
    return
  fi
  case $subcommand in
    '') COMPREPLY=($(compgen -W ')" +
         joined_words(names) + R"(' -- "$current")); return ;;
)" + operands +
         R"(  esac
  _springstab_files -f
}
complete -F _springstab springstab
)";
}

std::string zsh_action(const OptionValue& value) {
  switch (value.kind) {
    case ValueKind::none:
      return "";
    case ValueKind::words:
      return ":" + value.label + ":(" + joined_words(value.words) + ")";
    case ValueKind::file:
      return ":file:_files";
    case ValueKind::folder:
      return ":folder:_files -/";
    case ValueKind::other:
      break;
  }
  return ":value: ";
}

std::string zsh_specs(const CLI::App& app) {
  std::string all;
  for (const CLI::Option* option : app.get_options()) {
    const OptionValue value = value_of(*option);
    std::string help;
    for (const char c : option->get_description())
      help += (c == '[' || c == ']' || c == '\\' ? "\\" : "") + std::string(1, c);
    for (const std::string& name : dashed_names(*option))
      all += "      " + in_quotes("*" + name + "[" + help + "]" + zsh_action(value), "'\\''") + "\n";
    if (option->get_positional())
      all += "      " +
             in_quotes("*" + (value.kind == ValueKind::words ? zsh_action(value) : ":file:_files"), "'\\''") +
             "\n";
  }
  return all;
}

std::string zsh_script(const CLI::App& app) {
  std::string titles, cases;
  for (const CLI::App* each : subcommands_of(app)) {
    titles += "    " + in_quotes(each->get_name() + ":" + each->get_description(), "'\\''") + "\n";
    cases += "    " + each->get_name() + ") _arguments \"${common[@]}\" \\\n";
    std::string specs = zsh_specs(*each);
    for (std::size_t at = 0; (at = specs.find("\n", at)) != std::string::npos; at += 3)
      specs.replace(at, 1, " \\\n");
    cases += specs + "      ;;\n";
  }
  return "#compdef springstab\n_springstab() {\n  local curcontext=\"$curcontext\" state line\n  typeset -A "
         "opt_args\n"
         "  local -a common subcommands\n  common=(\n" +
         zsh_specs(app) + "  )\n  subcommands=(\n" + titles +
         "  )\n  _arguments -C \"${common[@]}\" '1: :->subcommand' '*:: :->rest'\n  case $state in\n"
         "  subcommand) _describe subcommand subcommands ;;\n  rest) case $words[1] in\n" +
         cases + "    esac ;;\n  esac\n}\n_springstab \"$@\"\n";
}

std::string fish_value(const OptionValue& value) {
  switch (value.kind) {
    case ValueKind::none:
      return "";
    case ValueKind::words:
      return " -x -a '" + joined_words(value.words) + "'";
    case ValueKind::file:
      return " -r -F";
    case ValueKind::folder:
      return " -x -a '(__fish_complete_directories)'";
    case ValueKind::other:
      break;
  }
  return " -x";
}

std::string fish_options(const CLI::App& app, const std::string& condition) {
  std::string all;
  for (const CLI::Option* option : app.get_options()) {
    const OptionValue value = value_of(*option);
    const std::string begin = "complete -c springstab" + condition;
    if (option->get_positional()) {
      if (value.kind == ValueKind::words) all += begin + " -f -a '" + joined_words(value.words) + "'\n";
      continue;
    }
    all += begin;
    for (const std::string& name : option->get_snames()) all += " -s " + name;
    for (const std::string& name : option->get_lnames()) all += " -l " + name;
    all += fish_value(value) + " -d " + in_quotes(option->get_description(), "\\'", "\\") + "\n";
  }
  return all;
}

std::string fish_script(const CLI::App& app) {
  std::string all = "# fish completion for springstab\n" + fish_options(app, "");
  for (const CLI::App* each : subcommands_of(app)) {
    all += "complete -c springstab -n __fish_use_subcommand -f -a " + each->get_name() + " -d " +
           in_quotes(each->get_description(), "\\'", "\\") + "\n";
    all += fish_options(*each, " -n '__fish_seen_subcommand_from " + each->get_name() + "'");
  }
  return all;
}

}  // namespace

std::string completion_script(const CLI::App& app, const std::string& shell) {
  return shell == "bash" ? bash_script(app) : shell == "zsh" ? zsh_script(app) : fish_script(app);
}

Subcommand completion_command(const CLI::App& app) {
  const auto shell = std::make_shared<std::string>();
  return {
      .name = "completion",
      .title = "Prints what completes this command's words in a shell",
      .footer =
          "Installed with the command. From a build folder, for the shell that is open:\n\n"
          "example: source <(springstab completion bash)",
      .options =
          {Option("SHELL", shell.get(), "for which").needed().shown_as("").one_of({"bash", "zsh", "fish"})},
      .run = [shell, &app](const CommonOptions&) {
        std::cout << completion_script(app, *shell);
        return done;
      }};
}

}  // namespace springstab
