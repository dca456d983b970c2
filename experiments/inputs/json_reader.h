// What the readers of JSON files have in common: keys that are known, and messages that say where.
#pragma once

#include <Eigen/Core>
#include <string>
#include <string_view>
#include <vector>

#include "experiments/inputs/json_with_lines.h"

namespace springstab {

class JsonReader {
 public:
  /// The name of the file in messages; it is kept by reference.
  explicit JsonReader(const std::string& source) : source_(source) {}

 protected:
  /// Throws InputError.
  [[noreturn]] void fail(long line, const std::string& message) const;
  [[noreturn]] void wrong(const JsonValue& json, const std::string& expected) const;

  /// Nothing but these keys, none of them twice.
  void expect_members(const JsonValue& object, const std::vector<std::string_view>& known) const;
  /// Null where there is none.
  static const JsonValue* find(const JsonValue& object, std::string_view key);

  const JsonValue& needed(const JsonValue& object, std::string_view key, const std::string& expected) const;

  enum class Sign { any, not_negative, positive };
  double number(const JsonValue& json, Sign sign) const;
  int integer(const JsonValue& json, int least, int most) const;
  Eigen::Vector3d vector(const JsonValue& json, Sign sign = Sign::any) const;
  std::string text(const JsonValue& json, const std::string& expected) const;
  /// `value` stays as it is where there is no such key.
  template <class T>
  void read_number(const JsonValue& object, std::string_view key, Sign sign, T& value) const {
    if (const JsonValue* member = find(object, key)) value = number(*member, sign);
  }

  const std::string& source_;
};

}  // namespace springstab
