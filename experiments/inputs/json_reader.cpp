#include "experiments/inputs/json_reader.h"

#include <algorithm>
#include <cmath>

#include "experiments/command/words.h"
#include "solvers/io/input_error.h"
#include "solvers/io/text_file.h"

namespace springstab {

void JsonReader::fail(long line, const std::string& message) const {
  throw InputError(source_, line, message);
}

void JsonReader::wrong(const JsonValue& json, const std::string& expected) const {
  const std::string found = json.kind == JsonValue::Kind::string ? springstab::quoted(json.text) : json.text;
  fail(json.line, json.name + " is " + found + ", expected " + expected);
}

void JsonReader::expect_members(const JsonValue& object, const std::vector<std::string_view>& known) const {
  if (object.kind != JsonValue::Kind::object) wrong(object, "an object");
  for (auto member = object.items.begin(); member != object.items.end(); ++member) {
    if (std::find(known.begin(), known.end(), member->key) == known.end())
      fail(member->key_line,
           "unknown key " + member->name + " in " + object.name + ", " + expected_one_of(member->key, known));
    const auto same = [&](const JsonValue& other) { return other.key == member->key; };
    const auto first = std::find_if(object.items.begin(), member, same);
    if (first != member)
      fail(member->key_line, "duplicate key " + member->name + ", expected it once (it stands on line " +
                                 std::to_string(first->key_line) + " too)");
  }
}

const JsonValue& JsonReader::needed(const JsonValue& object, std::string_view key,
                                    const std::string& expected) const {
  const JsonValue* const value = find(object, key);
  if (!value)
    fail(object.line, "'" + std::string(key) + "' is missing in " + object.name + ", expected " + expected);
  return *value;
}

double JsonReader::number(const JsonValue& json, Sign sign) const {
  const bool good =
      json.kind == JsonValue::Kind::number &&
      (sign == Sign::any || json.number > 0 || (sign == Sign::not_negative && json.number == 0));
  if (!good)
    wrong(json, sign == Sign::any            ? "a number"
                : sign == Sign::not_negative ? "zero or a positive number"
                                             : "a positive number");
  return json.number;
}

int JsonReader::integer(const JsonValue& json, int least, int most) const {
  if (json.kind != JsonValue::Kind::number || json.number < least || json.number > most ||
      json.number != std::trunc(json.number))
    wrong(json, "a whole number from " + std::to_string(least) + " to " + std::to_string(most));
  return static_cast<int>(json.number);
}

Eigen::Vector3d JsonReader::vector(const JsonValue& json, Sign sign) const {
  if (json.kind != JsonValue::Kind::array) wrong(json, "an array of three numbers");
  if (json.items.size() != 3)
    fail(json.line,
         json.name + " has " + std::to_string(json.items.size()) + " entries, expected three numbers");
  return {number(json.items[0], sign), number(json.items[1], sign), number(json.items[2], sign)};
}

std::string JsonReader::text(const JsonValue& json, const std::string& expected) const {
  if (json.kind != JsonValue::Kind::string) wrong(json, expected);
  return json.text;
}

const JsonValue* JsonReader::find(const JsonValue& object, std::string_view key) {
  const auto member = std::find_if(object.items.begin(), object.items.end(),
                                   [&](const JsonValue& item) { return item.key == key; });
  return member == object.items.end() ? nullptr : &*member;
}

}  // namespace springstab
