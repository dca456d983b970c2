// The files in a ZIP archive, stored or deflated, of any size (PKWARE's APPNOTE, with its 64-bit extensions).
#pragma once

#include <cstdint>
#include <map>
#include <string>
#include <string_view>

#include "solvers/io/text_file.h"

namespace springstab {

bool is_zip(std::string_view beginning);

class ZipArchive {
 public:
  /// Reads the directory at the end. Source and bytes must outlive it. Throws InputError, with the byte,
  /// where there is none.
  ZipArchive(std::string_view source, std::string_view bytes);

  bool has(std::string_view name) const { return entries_.contains(name); }

  /// The content of a file. Throws InputError where the archive does not have it, where it is encrypted,
  /// packed in another way, or damaged (its check sum says so).
  std::string content(std::string_view name) const;

 private:
  struct Entry {
    std::uint32_t method, flags, check_sum;
    std::uint64_t packed, size, offset;
  };
  void directory();

  std::string_view source_, bytes_;
  std::map<std::string, Entry, std::less<>> entries_;
};

}  // namespace springstab
