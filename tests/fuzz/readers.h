// Every reader of files with the law that it keeps whatever it is given. The fuzzer tries inputs of its own
// on it, the test suite those in corpus/NAME/.
#pragma once

#include <string>
#include <string_view>
#include <vector>

namespace springstab::test {

struct Reader {
  std::string name;                     // its seeds lie in corpus/NAME/
  void (*read)(std::string_view text);  // throws std::logic_error for a value that no file can have
};

/// All of them, one a line in readers.cpp.
const std::vector<Reader>& readers();

/// Reads the text: true if that gives a value, with finite numbers and indices in range; false if it is
/// refused with an InputError of one printable line that names a line of the text, or none. Anything else
/// escapes as an exception.
bool reads(const Reader& reader, std::string_view text);

}  // namespace springstab::test
