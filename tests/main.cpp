// The test program: every tests/test_<subject>.cpp is linked into it as one suite.
#define BOOST_TEST_MODULE springstab
#include <boost/test/unit_test.hpp>
