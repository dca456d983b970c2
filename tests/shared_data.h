// Third-party meshes and matrices that some tests read. They are not part of the project: the tests look for
// them in the directory that the environment variable SPRINGSTAB_TEST_DATA names or else in ../shared/data
// beside the source tree, and say what they skip where they are absent.
#pragma once

#include <boost/test/unit_test.hpp>
#include <cstdlib>
#include <filesystem>
#include <optional>
#include <string>

#include "tests/places.h"

namespace springstab::test {

/// The file or directory `relative` of the shared data ("matrices/bcsstk01.mtx"); nothing, and a message,
/// where it is absent.
inline std::optional<std::filesystem::path> shared_data(const std::string& relative) {
  const char* directory = std::getenv("SPRINGSTAB_TEST_DATA");
  const auto root = directory ? std::filesystem::path(directory)
                              : std::filesystem::path(source_folder()) / ".." / "shared" / "data";
  const auto path = root / relative;
  if (std::filesystem::exists(path)) return path;
  BOOST_TEST_MESSAGE("skipped, for there is no " << path << " (SPRINGSTAB_TEST_DATA may name the directory)");
  return std::nullopt;
}

}  // namespace springstab::test
