#include <CLI/CLI.hpp>
#include <iostream>
#include <memory>

#include "experiments/command/app_pages.h"
#include "experiments/command/output.h"
#include "experiments/command/words.h"
#include "solvers/io/input_error.h"
#include "solvers/io/text_file.h"

namespace springstab {
namespace {

// No character of it is a request or an escape, and dashes are those of the keyboard.
std::string roff(const std::string& text) {
  std::string out;
  bool line_begins = true;
  for (const char c : text) {
    if (line_begins && (c == '.' || c == '\'')) out += "\\&";
    if (c == '\\')
      out += "\\e";
    else if (c == '-')
      out += "\\-";
    else
      out += c;
    line_begins = c == '\n';
  }
  return out;
}

std::string upper(std::string word) {
  for (char& c : word) c = static_cast<char>(std::toupper(static_cast<unsigned char>(c)));
  return word;
}

std::string option_entry(const CLI::Option& option) {
  std::string names;
  for (const std::string& name : option.get_snames())
    names += (names.empty() ? "\\fB\\-" : ", \\fB\\-") + roff(name) + "\\fR";
  for (const std::string& name : option.get_lnames())
    names += (names.empty() ? "\\fB\\-\\-" : ", \\fB\\-\\-") + roff(name) + "\\fR";
  if (names.empty()) names = "\\fI" + roff(option.get_name()) + "\\fR";
  const std::string type = option.get_items_expected_max() == 0 ? "" : option.get_type_name();
  std::string entry = ".TP\n" + names +
                      (type.empty() || option.get_positional() ? "" : " \\fI" + roff(type) + "\\fR") + "\n" +
                      roff(option.get_description());
  if (!option.get_default_str().empty()) entry += " (default: " + roff(option.get_default_str()) + ")";
  if (option.get_required()) entry += " (required)";
  return entry + "\n";
}

std::string entries_of(const CLI::App& app) {
  std::string all;
  for (const CLI::Option* option : app.get_options()) all += option_entry(*option);
  return all;
}

// A line that ends with a full stop ends a paragraph.
std::string in_paragraphs(std::string text) {
  for (std::size_t at = 0; (at = text.find(".\n", at)) != std::string::npos; at += 6)
    text.replace(at, 2, ".\n.PP\n");
  return text;
}

// Its text as paragraphs, its examples as they are.
std::string footer_sections(const std::string& footer) {
  const std::size_t examples = footer.find("example");
  const bool has_examples = examples == 0 || (examples != std::string::npos && footer[examples - 1] == '\n');
  const std::string words = footer.substr(0, has_examples ? examples : footer.size());
  std::string all;
  if (words.find_first_not_of(" \n") != std::string::npos)
    all += ".SH DESCRIPTION\n" + in_paragraphs(roff(words)) + "\n";
  if (has_examples) {
    std::string lines = footer.substr(footer.find(':', examples) + 1);
    for (std::size_t at = 0; (at = lines.find("\n          ", at)) != std::string::npos;)
      lines.erase(at + 1, 10);
    all += ".SH EXAMPLES\n.nf\n" + roff(lines.substr(lines.find_first_not_of(' '))) + "\n.fi\n";
  }
  for (std::size_t at = 0; (at = all.find("\n\n", at)) != std::string::npos;) all.replace(at, 2, "\n");
  return all;
}

std::string heading(const std::string& name, const std::string& title) {
  return ".TH \"" + upper(name) +
         "\" 1 \"\" \"springstab " SPRINGSTAB_VERSION "\" \"User Commands\"\n.SH NAME\n" + roff(name) +
         " \\- " + roff(title) + "\n";
}

constexpr char status_section[] =
    ".SH EXIT STATUS\n0 done, 1 internal error, 2 wrong usage or input, 3 there is no answer, 4 the "
    "simulation "
    "diverged, 130 interrupted.\n";

std::string command_page(const CLI::App& app) {
  std::string all =
      heading("springstab", app.get_description()) +
      ".SH SYNOPSIS\n\\fBspringstab\\fR \\fISUBCOMMAND\\fR [\\fIOPTIONS\\fR]\n.SH SUBCOMMANDS\n";
  for (const CLI::App* each : app.get_subcommands({}))
    all += ".TP\n\\fB" + roff(each->get_name()) + "\\fR\n" + roff(each->get_description()) +
           "; springstab\\-" + roff(each->get_name()) + "(1)\n";
  return all + ".SH OPTIONS\nThey are accepted before and after a subcommand.\n" + entries_of(app) +
         status_section;
}

std::string subcommand_page(const CLI::App& each) {
  std::string operands;
  for (const CLI::Option* option : each.get_options())
    if (option->get_positional())
      operands += option->get_required() ? " \\fI" + roff(option->get_name()) + "\\fR"
                                         : " [\\fI" + roff(option->get_name()) + "\\fR]";
  return heading("springstab-" + each.get_name(), each.get_description()) + ".SH SYNOPSIS\n\\fBspringstab " +
         roff(each.get_name()) + "\\fR" + operands + " [\\fIOPTIONS\\fR]\n" +
         footer_sections(each.get_footer()) + ".SH OPTIONS\n" + entries_of(each) + status_section +
         ".SH SEE ALSO\nspringstab(1)\n";
}

void write_pages(const CLI::App& app, const std::string& folder) {
  make_folder(folder);
  std::vector<std::string> names{""};
  for (const CLI::App* each : app.get_subcommands({})) names.push_back(each->get_name());
  for (const std::string& name : names) {
    OutputFile file(folder + "/springstab" + (name.empty() ? "" : "-" + name) + ".1");
    file.stream() << man_page(app, name);
    file.commit();
  }
}

}  // namespace

std::string man_page(const CLI::App& app, const std::string& subcommand) {
  if (subcommand.empty()) return command_page(app);
  std::vector<std::string> names;
  for (const CLI::App* each : app.get_subcommands({})) {
    if (each->get_name() == subcommand) return subcommand_page(*each);
    names.push_back(each->get_name());
  }
  throw std::invalid_argument("unknown subcommand " + springstab::quoted(subcommand) + ", " +
                              expected_one_of(subcommand, {names.begin(), names.end()}));
}

Subcommand man_command(const CLI::App& app) {
  struct ManOptions {
    std::string subcommand, output;
  };
  const auto o = std::make_shared<ManOptions>();
  return {.name = "man",
          .title = "Prints the man page of the command or of a subcommand",
          .footer = "example: springstab man limits | man -l -",
          .options =
              {Option("SUBCOMMAND", &o->subcommand, "of which (default: of springstab itself)").shown_as(""),
               Option("--output", &o->output, "writes all pages into this folder instead").shown_as("DIR")},
          .run = [o, &app](const CommonOptions&) {
            if (o->output.empty())
              std::cout << man_page(app, o->subcommand);
            else
              write_pages(app, o->output);
            return done;
          }};
}

}  // namespace springstab
