// What is wrong with an input is said in one line: where, what, and what was expected.
#pragma once

#include <boost/test/unit_test.hpp>
#include <functional>
#include <string>

#include "solvers/io/input_error.h"

namespace springstab::test {

/// Checks that the action throws InputError with this place and these words.
inline void expect_error(const std::function<void()>& action, const std::string& place,
                         const std::string& words) {
  try {
    action();
    BOOST_ERROR("nothing was thrown, expected \"" + words + '"');
  } catch (const InputError& error) {
    const std::string what = error.what();
    BOOST_TEST(what.starts_with(place + ": "), what << " does not start with " << place);
    BOOST_TEST(what.find(words) != std::string::npos, what << " does not say " << words);
    BOOST_TEST(what.find("expected") != std::string::npos, what << " does not say what was expected");
    BOOST_TEST(what.find('\n') == std::string::npos, what << " is more than one line");
  }
}

}  // namespace springstab::test
