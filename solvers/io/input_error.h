// What is wrong with something the user gave: a file, a line of it, an option.
// Thrown by the readers and by everything that builds a system from user input; the command turns it
// into one line on stderr and exit status 2.
#pragma once

#include <stdexcept>
#include <string>

namespace springstab {

/// Unusable input. `what()` reads "source:line: what is wrong, what was expected"
/// (or "source: ..." when `line` is 0, which means that no line applies).
class InputError : public std::runtime_error {
 public:
  InputError(const std::string& source, long line, const std::string& message)
      : std::runtime_error(line > 0 ? source + ":" + std::to_string(line) + ": " + message
                                    : source + ": " + message) {}
};

}  // namespace springstab
