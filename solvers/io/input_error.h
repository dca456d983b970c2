// What is wrong with something the user gave: a file, a line of it, an option.
// Thrown by the readers and by everything that builds a system from user input; the command turns it
// into one line on stderr and exit status 2.
#pragma once

#include <cstddef>
#include <stdexcept>
#include <string>

namespace springstab {

/// Where a binary file has no lines: a place in it, by its bytes from 0, as a negative "line".
inline long at_byte(std::size_t offset) { return -1 - static_cast<long>(offset); }

/// "line 12" or "byte 84".
inline std::string place_name(long line) {
  return line < 0 ? "byte " + std::to_string(-1 - line) : "line " + std::to_string(line);
}

/// "source:12: ", "source: at byte 84: ", or "source: " where no line applies, which 0 means.
inline std::string place_of(const std::string& source, long line) {
  return line > 0 ? source + ":" + std::to_string(line) + ": "
                  : source + ": " + (line < 0 ? "at " + place_name(line) + ": " : "");
}

/// Unusable input. `what()` reads "source:line: what is wrong, what was expected".
class InputError : public std::runtime_error {
 public:
  InputError(const std::string& source, long line, const std::string& message)
      : std::runtime_error(place_of(source, line) + message) {}
};

}  // namespace springstab
