// The test program: every tests/test_<subject>.cpp is linked into it as one suite.
#define BOOST_TEST_MODULE springstab
#include <boost/test/unit_test.hpp>

#include "tests/places.h"

namespace springstab::test {

std::string source_folder() { return SPRINGSTAB_SOURCE_DIR; }
std::string command_path() { return SPRINGSTAB_COMMAND; }

}  // namespace springstab::test
