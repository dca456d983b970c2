// Has gnuplot draw: one script, its settings, and pictures that are never half-drawn.
#pragma once

#include <string>
#include <vector>

namespace springstab {

/// Where a figure goes: its pictures, and the data they are drawn from. Folder and name, without suffix.
struct FigureFiles {
  std::string picture, data;
};

/// gnuplot's string literal.
std::string gnuplot_literal(const std::string& s);

/// Runs `script` with the settings "name=value; ..." as BASE.svg and BASE.png, moved into place when
/// complete; the script finds them as `type` and `output_file`. Returns the two paths. Throws InputError if
/// there is no gnuplot, std::runtime_error if it fails.
std::vector<std::string> draw(const std::string& script, const std::string& settings,
                              const std::string& base);

/// What gnuplot draws to its stdout when it is given these lines. No file is written. Throws as draw() does.
std::string drawn(const std::string& lines);

/// Data of a drawing, as the lines that define it: "$name << EOD".
std::string gnuplot_data(const std::string& name, const std::string& rows);

}  // namespace springstab
