// The fuzzer: READER=obj springstab_fuzz CORPUS... [libFuzzer's options]. An exception that escapes, a
// sanitizer's report, too much memory or time is a finding.
#include <cstdint>
#include <cstdio>
#include <cstdlib>
#include <string>

#include "tests/fuzz/readers.h"

namespace {

const springstab::test::Reader& chosen_reader() {
  const char* name = std::getenv("READER");
  std::string known;
  for (const auto& reader : springstab::test::readers()) {
    if (name && reader.name == name) return reader;
    known += ' ' + reader.name;
  }
  std::fprintf(stderr, "no reader '%s', expected READER to be one of%s\n", name ? name : "", known.c_str());
  std::exit(2);
}

}  // namespace

// NOLINTNEXTLINE(readability-identifier-naming): the name that libFuzzer calls
extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  static const springstab::test::Reader& reader = chosen_reader();
  springstab::test::reads(reader, {reinterpret_cast<const char*>(data), size});
  return 0;
}
