// The arrays of numbers in VTK's XML files, however they are written: as text, in base64 or as they are,
// within the file or behind it, compressed or not (VTK File Formats, "XML File Formats").
#pragma once

#include <bit>
#include <string>
#include <string_view>
#include <vector>

#include "solvers/io/binary_reader.h"
#include "solvers/io/xml_file.h"

namespace springstab {

/// An array's numbers and where each stands: of one that is encoded, where the array does.
template <class Number>
struct VtkArray {
  std::vector<Number> values;
  std::vector<Location> at;  // one for each value, or one for all

  const Location& place(std::size_t i) const { return at.size() == 1 ? at.front() : at[i]; }
};

class VtkArrays {
 public:
  /// Source and text must outlive it. Throws InputError, with the line, for what is none of VTK's XML files.
  VtkArrays(std::string_view source, std::string_view text);

  const XmlFile& xml() const { return xml_; }

  /// The numbers of an element DataArray. Throws InputError, with the line, for numbers that are not finite,
  /// or no integers, for encoded data that end or are damaged, and before anything is allocated that the file
  /// cannot back.
  VtkArray<double> reals(const XmlElement& array) const;
  VtkArray<long long> integers(const XmlElement& array) const;

 private:
  template <class Number>
  VtkArray<Number> numbers(const XmlElement& array) const;
  std::string bytes_of_array(const XmlElement& array) const;

  XmlFile xml_;
  std::string_view appended_;
  bool appended_in_base64_ = false, compressed_ = false;
  std::endian order_ = std::endian::little;
  NumberType length_ = NumberType::u32;
};

}  // namespace springstab
