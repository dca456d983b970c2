#include "solvers/io/zip.h"

#include <algorithm>
#include <array>
#include <limits>

#include "solvers/io/binary_reader.h"
#include "solvers/io/inflate.h"

namespace springstab {
namespace {

constexpr std::string_view zip_local = "PK\3\4", zip_entry = "PK\1\2", zip_end = "PK\5\6",
                           zip_end_64 = "PK\6\6", zip_locator = "PK\6\7";

constexpr std::array<std::uint32_t, 256> zip_remainders = [] {
  std::array<std::uint32_t, 256> table{};
  for (std::uint32_t byte = 0; byte < table.size(); ++byte) {
    table[byte] = byte;
    for (int bit = 0; bit < 8; ++bit) table[byte] = table[byte] >> 1 ^ (table[byte] & 1 ? 0xEDB88320U : 0U);
  }
  return table;
}();

/// CRC-32: the remainder of the bytes, as a polynomial, by that of the table.
std::uint32_t zip_check_sum(std::string_view bytes) {
  std::uint32_t sum = 0xFFFFFFFFU;
  for (const char c : bytes) sum = zip_remainders[(sum ^ static_cast<unsigned char>(c)) & 0xFFU] ^ sum >> 8;
  return ~sum;
}

template <class Number>
std::uint64_t zip_number(std::string_view record, std::size_t at) {
  return number_of<Number>(record.substr(at, sizeof(Number)), std::endian::little);
}

}  // namespace

bool is_zip(std::string_view beginning) { return beginning.starts_with(zip_local); }

ZipArchive::ZipArchive(std::string_view source, std::string_view bytes) : source_(source), bytes_(bytes) {
  directory();
}

void ZipArchive::directory() {
  constexpr std::size_t end_size = 22, locator_size = 20, end_64_size = 56, entry_size = 46;
  constexpr std::uint64_t see_64 = 0xFFFFFFFF;
  BinaryReader reader(source_, bytes_, std::endian::little);
  const auto record = [&](std::uint64_t position, std::size_t size, std::string_view mark, const char* what) {
    if (position > bytes_.size() || bytes_.size() - position < size ||
        !bytes_.substr(position).starts_with(mark))
      Location{source_, at_byte(std::min(position, std::uint64_t{bytes_.size()}))}.fail(
          std::string("no ") + what + " stands here, expected a whole archive");
    return bytes_.substr(position, size);
  };
  const std::size_t end = bytes_.rfind(zip_end);
  const std::string_view last = record(end, end_size, zip_end, "end of a directory");
  std::uint64_t files = zip_number<std::uint16_t>(last, 10), position = zip_number<std::uint32_t>(last, 16);
  if (files == 0xFFFF || position == see_64) {
    const std::string_view locator = record(end < locator_size ? bytes_.size() : end - locator_size,
                                            locator_size, zip_locator, "place of a directory");
    const std::string_view end_64 =
        record(zip_number<std::uint64_t>(locator, 8), end_64_size, zip_end_64, "end of a directory");
    files = zip_number<std::uint64_t>(end_64, 32), position = zip_number<std::uint64_t>(end_64, 48);
  }
  for (std::uint64_t f = 0; f < files; ++f) {
    const std::string_view fixed = record(position, entry_size, zip_entry, "entry of a directory");
    const auto name_size = zip_number<std::uint16_t>(fixed, 28),
               extra_size = zip_number<std::uint16_t>(fixed, 30);
    const std::string_view whole =
        record(position, entry_size + name_size + extra_size, zip_entry, "whole entry of a directory");
    Entry entry{static_cast<std::uint32_t>(zip_number<std::uint16_t>(fixed, 10)),
                static_cast<std::uint32_t>(zip_number<std::uint16_t>(fixed, 8)),
                static_cast<std::uint32_t>(zip_number<std::uint32_t>(fixed, 16)),
                zip_number<std::uint32_t>(fixed, 20),
                zip_number<std::uint32_t>(fixed, 24),
                zip_number<std::uint32_t>(fixed, 42)};
    // What does not fit stands behind the name, in parts of a kind, a size and a content; of kind 1 these.
    std::string_view extra = whole.substr(entry_size + name_size);
    while (extra.size() >= 4) {
      const auto kind = zip_number<std::uint16_t>(extra, 0), size = zip_number<std::uint16_t>(extra, 2);
      std::string_view part = extra.substr(4, size);
      extra.remove_prefix(std::min<std::size_t>(4 + size, extra.size()));
      for (std::uint64_t* number : {&entry.size, &entry.packed, &entry.offset}) {
        if (kind != 1 || *number != see_64 || part.size() < 8) continue;
        *number = zip_number<std::uint64_t>(part, 0);
        part.remove_prefix(8);
      }
    }
    entries_.emplace(whole.substr(entry_size, name_size), entry);
    position += entry_size + name_size + extra_size + zip_number<std::uint16_t>(fixed, 32);
  }
}

std::string ZipArchive::content(std::string_view name) const {
  const auto found = entries_.find(name);
  if (found == entries_.end())
    Location{source_}.fail("the archive has no file " + springstab::quoted(name) + ", expected it");
  const Entry& entry = found->second;
  const std::string file = "the file " + springstab::quoted(name) + " of the archive ";
  constexpr std::size_t head = 30;
  const Location at{source_, at_byte(std::min<std::size_t>(entry.offset, bytes_.size()))};
  if (entry.offset > bytes_.size() || bytes_.size() - entry.offset < head ||
      !bytes_.substr(entry.offset).starts_with(zip_local))
    at.fail(file + "is not here, expected it");
  const std::string_view local = bytes_.substr(entry.offset);
  const std::size_t begin =
      head + zip_number<std::uint16_t>(local, 26) + zip_number<std::uint16_t>(local, 28);
  if (begin > local.size() || entry.packed > local.size() - begin)
    at.fail(file + "ends behind the archive, expected all of it");
  constexpr std::uint32_t encrypted = 1, stored = 0, deflated = 8;
  if (entry.flags & encrypted) at.fail(file + "is encrypted, expected one that is not");
  if (entry.method != stored && entry.method != deflated)
    at.fail(file + "is packed by method " + std::to_string(entry.method) +
            ", expected 0 (stored) or 8 (deflated)");
  if (entry.method == stored && entry.packed != entry.size) at.fail(file + "has two sizes, expected one");
  const std::string_view packed = local.substr(begin, entry.packed);
  std::string content =
      entry.method == stored ? std::string(packed) : inflated(packed, entry.size, Deflated::raw, at);
  if (zip_check_sum(content) != entry.check_sum)
    at.fail(file + "is damaged, expected its check sum to be right");
  return content;
}

}  // namespace springstab
