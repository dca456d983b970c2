// The header of a PLY file and the walk through the numbers behind it, which are text or binary: for whoever
// reads meshes and for whoever reads frames.
#pragma once

#include <bit>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "solvers/io/binary_reader.h"
#include "solvers/io/text_file.h"

namespace springstab {

struct PlyProperty {
  std::string name;
  NumberType type;
  std::optional<NumberType> count;  // of a list
};

struct PlyElement {
  std::string name;
  long long count;
  std::vector<PlyProperty> properties;
  Location at;
};

/// Reads the header and then number after number. Source and text must outlive it.
class PlyNumbers {
 public:
  /// Throws InputError, with the line, for a header that is none of this format's.
  PlyNumbers(std::string_view source, std::string_view text);

  const std::vector<PlyElement>& elements() const { return elements_; }

  /// Fails unless the file has room for all of an element's records, each of which takes some.
  void expect_room(const PlyElement& element) const;
  /// Steps to the next record, in ASCII a line; its place.
  Location begin(const PlyElement& element);
  /// The next number of the record; it may be one that is not finite.
  double next(NumberType type, const std::string& name);
  /// The length of a list: what is left of the file has room for it.
  long long length(const PlyProperty& list);
  /// Fails if the record has more.
  void end(const PlyElement& element);
  /// Fails if the file has more.
  void finish();

 private:
  void header();
  void format();
  void property();

  LineReader lines_;
  std::vector<std::string_view> words_;
  std::size_t next_word_ = 0;
  std::string_view source_, text_;
  std::optional<std::endian> order_;  // where it is binary
  std::optional<BinaryReader> binary_;
  std::vector<PlyElement> elements_;
};

}  // namespace springstab
