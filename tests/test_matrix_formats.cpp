// The readers of matrices of other programs: SciPy's archives, PETSc's binary files and Abaqus' entries. One
// matrix is the same in each; what is not exactly right is refused with its reason.
#include <Eigen/Core>
#include <algorithm>
#include <bit>
#include <boost/test/unit_test.hpp>
#include <cstdint>
#include <cstring>
#include <functional>
#include <limits>
#include <string>

#include "solvers/io/abaqus.h"
#include "solvers/io/input_error.h"
#include "solvers/io/matrix_file.h"
#include "solvers/io/npz.h"
#include "solvers/io/petsc.h"
#include "solvers/io/zip.h"
#include "tests/places.h"
#include "tests/refusals.h"
#include "tests/scratch.h"
#include "tests/texts.h"

BOOST_AUTO_TEST_SUITE(matrix_formats)

using namespace springstab;
using springstab::test::content_of;
using springstab::test::expect_error;
using springstab::test::replaced;

namespace {

/// What the other programs were given.
const Eigen::Matrix4d given{{4, -1, 0, 0}, {-1, 4.1, -2, 0}, {0, -2, 5, 1e-3}, {0, 0, 1e-3, 0.1}};

std::string corpus(const std::string& name) { return test::source_folder() + "/tests/fuzz/corpus/" + name; }

template <class Number>
std::string big_endian(Number value) {
  std::string text(sizeof value, '\0');
  std::memcpy(text.data(), &value, sizeof value);
  if (std::endian::native == std::endian::little) std::ranges::reverse(text);
  return text;
}

/// A ZIP archive of stored files, with their check sums where they are wanted to be right.
class Archive {
 public:
  void add(const std::string& name, const std::string& content, bool sound = true) {
    const std::string sizes = little<std::uint32_t>(check_sum(content) + !sound) +
                              little<std::uint32_t>(content.size()) + little<std::uint32_t>(content.size()) +
                              little<std::uint16_t>(name.size()) + little<std::uint16_t>(0);
    const std::string head =
        little<std::uint16_t>(20) + std::string(8, '\0');  // version; flags, method, time
    directory_ += "PK\1\2" + little<std::uint16_t>(20) + head + sizes + std::string(10, '\0') +
                  little<std::uint32_t>(files_.size()) + name;
    files_ += "PK\3\4" + head + sizes + name + content;
    ++count_;
  }
  std::string bytes() const {
    return files_ + directory_ + "PK\5\6" + std::string(4, '\0') + little<std::uint16_t>(count_) +
           little<std::uint16_t>(count_) + little<std::uint32_t>(directory_.size()) +
           little<std::uint32_t>(files_.size()) + little<std::uint16_t>(0);
  }

 private:
  template <class Number>
  static std::string little(std::size_t value) {
    std::string text;
    for (std::size_t i = 0; i < sizeof(Number); ++i) text += static_cast<char>(value >> (8 * i));
    return text;
  }
  static std::uint32_t check_sum(const std::string& bytes) {  // bit by bit
    std::uint32_t sum = ~0U;
    for (const char c : bytes) {
      sum ^= static_cast<unsigned char>(c);
      for (int bit = 0; bit < 8; ++bit) sum = sum >> 1 ^ (sum & 1 ? 0xEDB88320U : 0U);
    }
    return ~sum;
  }

  std::string files_, directory_;
  int count_ = 0;
};

std::string npy(const std::string& type, const std::string& shape, const std::string& data) {
  const std::string header = "{'descr': '" + type + "', 'fortran_order': False, 'shape': (" + shape + "), }";
  return "\x93NUMPY\1" + std::string(1, '\0') + static_cast<char>(header.size()) + std::string(1, '\0') +
         header + data;
}

std::string integers(const std::vector<std::int32_t>& values) {
  std::string data;
  for (const std::int32_t value : values) data += big_endian(value);
  return npy(">i4", std::to_string(values.size()) + ",", data);
}

struct Npz {
  std::string format = npy("|S3", "", "csr"), shape = integers({2, 2}), data = integers({5, 7}),
              ends = integers({0, 1, 2}), indices = integers({1, 0});
  bool sound = true;

  std::string bytes() const {
    Archive archive;
    archive.add("format.npy", format);
    archive.add("shape.npy", shape);
    archive.add("data.npy", data, sound);
    archive.add("indptr.npy", ends);
    archive.add("indices.npy", indices);
    return archive.bytes();
  }
};

}  // namespace

BOOST_AUTO_TEST_CASE(matrices_of_other_programs_read_back_equal) {
  for (const std::string name :
       {"npz/scipy_csc_stored.npz",
#ifdef SPRINGSTAB_ZLIB
        "npz/scipy_csr.npz", "npz/scipy_coo.npz", "npz/numpy_zip64.npz", "npz/python_zip64_directory.npz",
#endif
        "petsc/petsc_aij.dat", "abaqus/nodes.mtx", "abaqus/coordinate.mtx"})
    BOOST_TEST_CONTEXT(name) { BOOST_TEST((read_matrix(corpus(name)).toDense() == given)); }
}

BOOST_AUTO_TEST_CASE(entries_at_one_position_are_refused_or_summed_as_in_every_format) {
  const struct {
    std::string name, words;
    Eigen::Matrix2d sum;
  } cases[] = {
#ifdef SPRINGSTAB_ZLIB
      {"npz/scipy_twice.npz", "a second entry (2, 2), expected one", Eigen::Matrix2d{{1, 0}, {0, 5}}},
#endif
      {"abaqus/twice.mtx", "a second entry (2, 1) or its mirror image after that of line 2",
       Eigen::Matrix2d{{2.5, -0.5}, {-0.5, 0}}}};
  for (const auto& c : cases) BOOST_TEST_CONTEXT(c.name) {
      const std::string line = c.name.starts_with("abaqus") ? ":3" : "";
      expect_error([&] { read_matrix(corpus(c.name)); }, corpus(c.name) + line, c.words);
      BOOST_TEST((read_matrix(corpus(c.name), Duplicates::summed).toDense() == c.sum));
    }
}

BOOST_AUTO_TEST_CASE(a_malformed_npz_file_is_refused_with_its_reason) {
  const auto refused = [](const Npz& npz, const std::string& words, const std::string& place = "a file") {
    expect_error([&] { parse_npz("a file", npz.bytes()); }, place, words);
  };
  Npz npz;
  BOOST_TEST((parse_npz("a file", npz.bytes()).toDense() == Eigen::Matrix2d{{0, 5}, {7, 0}}));
  npz.format = npy("<U3", "", std::string("c\0\0\0s\0\0\0c\0\0\0", 12));
  BOOST_TEST((parse_npz("a file", npz.bytes()).toDense() == Eigen::Matrix2d{{0, 7}, {5, 0}}));

  refused({.format = npy("|S3", "", "bsr")}, "in the form 'bsr', expected csr, csc or coo");
  refused({.format = npy("<f8", "", std::string(8, '\0'))}, "expected a string", "a file: format.npy");
  refused({.format = npy("|S3", "", "coo")}, "no file 'row.npy'");
  refused({.shape = integers({2})}, "the shape is none of a matrix");
  refused({.shape = integers({2, -2})}, "the shape is none of a matrix");
  refused({.shape = integers({3, 2})}, "indptr has 3 numbers, expected 4");
  refused({.shape = integers({60'000'000, 2})}, "60000000 by 2");
  refused({.shape = npy("<f8", "2,", std::string(16, '\0'))}, "expected integers", "a file: shape.npy");
  refused({.data = npy("<c8", "2,", std::string(16, '\0'))}, "expected real numbers", "a file: data.npy");
  refused({.data = npy(">f8", "2,", big_endian(1.) + big_endian(std::numeric_limits<double>::infinity()))},
          "number 1 of data is not finite");
  refused({.data = npy("<f8", "2,", std::string(15, '\0'))}, "has 15 bytes of numbers, expected 16",
          "a file: data.npy");
  refused({.data = npy("<f8", "2147483648,", "")}, "expected 1 to 2^31 - 1", "a file: data.npy");
  refused({.data = integers({5})}, "indices has 2 numbers, expected 1");
  refused({.ends = integers({0, 2, 1})}, "indptr is out of order");
  refused({.ends = integers({0, 3, 2})}, "indptr is out of order");
  refused({.indices = integers({2, 0})}, "(1, 3) lies outside");
  refused({.indices = integers({-1, 0})}, "(1, 0) lies outside");

  Npz damaged;
  damaged.sound = false;
  const std::size_t data = damaged.bytes().find("PK\3\4", damaged.bytes().find("shape.npy"));
  refused(damaged, "'data.npy' of the archive is damaged", "a file: at byte " + std::to_string(data));
  const std::string whole = Npz().bytes();
  for (std::size_t end = 0; end < whole.size(); ++end)
    BOOST_CHECK_THROW(parse_npz("a file", whole.substr(0, end)), InputError);
  std::string encrypted = whole;
  encrypted[whole.find("PK\1\2") + 8] = 1;
  expect_error([&] { parse_npz("a file", encrypted); }, "a file: at byte 0", "is encrypted");
  std::string packed = whole;
  packed[whole.find("PK\1\2") + 10] = 14;
  expect_error([&] { parse_npz("a file", packed); }, "a file: at byte 0", "packed by method 14");
  std::string far = whole;
  far[whole.find("PK\1\2") + 45] = '\x7f';
  expect_error([&] { parse_npz("a file", far); }, "a file: at byte " + std::to_string(whole.size()),
               "is not here");
}

#ifdef SPRINGSTAB_ZLIB
// 4 GiB announced, and compressed bytes that are no stream, in a file of a kilobyte.
BOOST_AUTO_TEST_CASE(a_size_that_the_compressed_bytes_cannot_have_is_refused) {
  const std::string sound = content_of(corpus("npz/scipy_csr.npz"));
  const std::size_t entry = sound.find("PK\1\2");
  std::string lying = sound;
  lying.replace(entry + 24, 4, "\xf0\xff\xff\xff");
  expect_error([&] { parse_npz("a file", lying); }, "a file: at byte 0", "too few for what is announced");
}
#else
BOOST_AUTO_TEST_CASE(without_zlib_what_is_compressed_is_refused_by_the_name_of_the_package) {
  expect_error([&] { read_matrix(corpus("npz/scipy_csr.npz")); }, corpus("npz/scipy_csr.npz") + ": at byte ",
               "zlib1g-dev");
}
#endif

BOOST_AUTO_TEST_CASE(a_malformed_petsc_file_is_refused_with_its_byte) {
  const std::string sound = content_of(corpus("petsc/petsc_aij.dat"));
  const auto refused = [&](std::size_t where, const std::string& what, std::size_t byte,
                           const std::string& words) {
    expect_error([&] { parse_petsc("a file", std::string(sound).replace(where, what.size(), what)); },
                 "a file: at byte " + std::to_string(byte), words);
  };
  refused(4, big_endian(0), 4, "a matrix of 0 by 4");
  refused(4, big_endian(std::numeric_limits<int>::max()), 16, "2147483647 rows are announced");
  refused(12, big_endian(-1), 4, "the matrix is dense");
  refused(12, big_endian(12), 16, "12 entries are announced");
  refused(12, big_endian(9), 28, "row 3 has 2 entries, expected 0 to the 1 that are left");
  refused(16, big_endian(1), 4, "the rows have 9 entries, expected 10");
  refused(16, big_endian(-1), 16, "row 0 has -1 entries");
  refused(36, big_endian(4), 36, "(1, 5) lies outside");
  refused(36, big_endian(0), 36, "a second entry (1, 1) after that of byte 32");
  refused(72, big_endian(std::numeric_limits<double>::quiet_NaN()), 72, "an entry is not finite");
  for (std::size_t end = 0; end < sound.size(); ++end)
    BOOST_CHECK_THROW(parse_petsc("a file", sound.substr(0, end)), InputError);
  expect_error([&] { parse_petsc("a file", sound + "x"); }, "a file: at byte 152",
               "1 bytes behind the matrix");

  // With integers of 64 bits, as PETSc may be built.
  std::string wide;
  for (std::size_t i = 0; i < 72; i += 4) wide += std::string(4, '\0') + sound.substr(i, 4);
  BOOST_TEST((parse_petsc("a file", wide + sound.substr(72)).toDense() == given));
}

BOOST_AUTO_TEST_CASE(entries_of_abaqus_are_told_from_a_matrix_market_file_without_its_banner) {
  BOOST_TEST(looks_like_abaqus("** a comment\n1,1, 1,1, 2.5\n"));
  BOOST_TEST(looks_like_abaqus("  1  1  2.5e+03\n"));
  for (const char* text : {"3 3 1\n1 1 1\n", "3 3 4\n1 1 2.5\n", "** only this\n", "1 2\n", "1 1 x\n",
                           "1,1,1,1,1\n", "1 1.5 2.5\n"})
    BOOST_TEST(!looks_like_abaqus(text), text);
  const auto refused = [](const std::string& text, const std::string& place, const std::string& words) {
    expect_error([&] { parse_abaqus("a file", text); }, "a file" + place, words);
  };
  const std::string nodes = content_of(corpus("abaqus/nodes.mtx"));
  refused(replaced(nodes, "7,1, 3,2,", "7,1, 3,"), ":6",
          "an entry of 4 numbers, expected the 5 of the first entry");
  refused(replaced(nodes, "7,1, 3,2,", "7,1, 3,x,"), ":6", "'x' is not an integer");
  refused(replaced(nodes, "-2.0", "nan"), ":6", "is not");
  refused("1 2\n", ":1", "an entry of 2 numbers, expected node");
  refused("0 1 2.5\n", ":1", "(0, 1) lies outside any matrix");
  refused("1 3000000000 2.5\n", ":1", "lies outside any matrix");
  refused("1 2000000000 2.5\n", "", "2000000000 by 2000000000");
  refused("** nothing\n", ":1", "no entries");
}

BOOST_AUTO_TEST_SUITE_END()
