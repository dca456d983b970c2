// The 64-bit FNV-1a hash (Fowler, Noll, Vo): tells contents apart, not for secrets.
#pragma once

#include <cstddef>
#include <cstdint>
#include <string>
#include <string_view>

#include "experiments/command/output.h"
#include "solvers/system.h"

namespace springstab {

class Fnv1a {
 public:
  Fnv1a() = default;
  /// Goes on after what had this value.
  explicit Fnv1a(std::uint64_t value) : hash_(value) {}

  void add(const void* data, std::size_t bytes) {
    const auto* p = static_cast<const unsigned char*>(data);
    for (std::size_t i = 0; i < bytes; ++i) hash_ = (hash_ ^ p[i]) * 0x100000001b3u;
  }
  void add(double value) { add(&value, sizeof value); }
  void add(const Vector& u) { add(u.data(), sizeof(double) * static_cast<std::size_t>(u.size())); }
  void add(std::string_view bytes) { add(bytes.data(), bytes.size()); }
  std::uint64_t value() const { return hash_; }
  std::string hex() const { return text("%016llx", static_cast<unsigned long long>(hash_)); }  // 16 digits

 private:
  std::uint64_t hash_ = 0xcbf29ce484222325u;
};

inline std::string hash_of(std::string_view bytes) {
  Fnv1a hash;
  hash.add(bytes);
  return hash.hex();
}

}  // namespace springstab
