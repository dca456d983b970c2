// JSON text as a small tree whose values know their lines, so that a message about any of them can say where.
#pragma once

#include <string>
#include <string_view>
#include <vector>

namespace springstab {

/// A JSON value, the line it stands on, and the name it goes by in messages.
struct JsonValue {
  enum class Kind { literal, number, string, array, object };
  Kind kind = Kind::literal;
  std::string text;   // of a string; of a number (shortened) or literal as it was written
  double number = 0;  // finite
  std::string key{};  // of an object's member
  long key_line = 0;
  std::string name;  // 'gravity', or 'gravity'[1] for an entry of an array
  long line = 0;
  std::vector<JsonValue> items{};  // entries of an array, members of an object
};

/// The tree of a document of at most 16 MB, nested at most 16 deep. Duplicate keys are all there. Throws
/// InputError(source, line, ...) for what is not JSON.
JsonValue parse_json(const std::string& source, std::string_view text);

}  // namespace springstab
