#include "experiments/inputs/json_reader.h"

#include <algorithm>

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

const JsonValue* JsonReader::find(const JsonValue& object, std::string_view key) {
  const auto member = std::find_if(object.items.begin(), object.items.end(),
                                   [&](const JsonValue& item) { return item.key == key; });
  return member == object.items.end() ? nullptr : &*member;
}

}  // namespace springstab
