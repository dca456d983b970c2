// Files' texts, changed as files come.
#pragma once

#include <boost/test/unit_test.hpp>
#include <string>

namespace springstab::test {

/// With the first `what`, which must be there, replaced.
inline std::string replaced(std::string text, const std::string& what, const std::string& by) {
  const std::size_t at = text.find(what);
  BOOST_REQUIRE(at != text.npos);
  return text.replace(at, what.size(), by);
}

inline std::string with_line_ends(const std::string& text, const std::string& end) {
  std::string changed;
  for (const char c : text) changed += c == '\n' ? end : std::string(1, c);
  return changed;
}

inline std::string with_crlf(const std::string& text) { return with_line_ends(text, "\r\n"); }

}  // namespace springstab::test
