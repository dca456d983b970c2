// The JSON library's own tree would take the last of duplicate keys and forget the lines, so only its parser
// is used, through its events.
#include "experiments/inputs/json_with_lines.h"

#include <algorithm>
#include <iterator>
#include <nlohmann/json.hpp>

#include "solvers/io/input_error.h"
#include "solvers/io/text_file.h"

namespace springstab {
namespace {

/// Walks over text and keeps the line of the character read last. The parser reads one character beyond a
/// number, so a line break counts only once something after it was read.
class LineCounter {
 public:
  using iterator_category = std::input_iterator_tag;
  using value_type = char;
  using difference_type = std::ptrdiff_t;
  using pointer = const char*;
  using reference = const char&;

  LineCounter(const char* at, long* line) : at_(at), line_(line) {}
  reference operator*() const { return *at_; }
  LineCounter& operator++() {
    if (after_break_) ++*line_;
    after_break_ = *at_++ == '\n';
    return *this;
  }
  bool operator==(const LineCounter& other) const { return at_ == other.at_; }
  bool operator!=(const LineCounter& other) const { return at_ != other.at_; }

 private:
  const char* at_;
  long* line_;
  bool after_break_ = false;
};

/// Builds the tree from the parser's events.
class TreeBuilder final : public nlohmann::json_sax<nlohmann::json> {
 public:
  TreeBuilder(const std::string& source, const long& line) : source_(source), line_(line) {}
  JsonValue take_root() { return std::move(root_); }

  bool null() override { return add(JsonValue::Kind::literal, "null"); }
  bool boolean(bool value) override { return add(JsonValue::Kind::literal, value ? "true" : "false"); }
  bool number_integer(number_integer_t value) override {
    return add(JsonValue::Kind::number, std::to_string(value), static_cast<double>(value));
  }
  bool number_unsigned(number_unsigned_t value) override {
    return add(JsonValue::Kind::number, std::to_string(value), static_cast<double>(value));
  }
  bool number_float(number_float_t value, const string_t& text) override {
    return add(JsonValue::Kind::number, shortened(text), value);
  }
  bool string(string_t& text) override { return add(JsonValue::Kind::string, text); }
  bool binary(binary_t&) override { return false; }  // not in JSON text

  bool start_object(std::size_t) override { return open(JsonValue::Kind::object); }
  bool key(string_t& text) override {
    key_ = text;
    key_line_ = line_;
    return true;
  }
  bool end_object() override { return close(); }
  bool start_array(std::size_t) override { return open(JsonValue::Kind::array); }
  bool end_array() override { return close(); }

  bool parse_error(std::size_t, const std::string& last_token,
                   const nlohmann::json::exception& error) override {
    if (dynamic_cast<const nlohmann::json::out_of_range*>(&error))
      fail("the number " + shortened(last_token) + " is out of range, expected a finite one");
    std::string reason = error.what();  // "[id] parse error at ...: syntax error while parsing ... - reason"
    if (const auto dash = reason.find(" - "); dash != std::string::npos) reason.erase(0, dash + 3);
    if (const auto token = reason.find('\'' + last_token + '\''); token != std::string::npos)
      reason.replace(token, last_token.size() + 2, springstab::quoted(last_token));
    std::replace(reason.begin(), reason.end(), ';', ',');
    // "unexpected end of input" alone does not say what was expected.
    if (reason.find("expected ", reason.find(' ')) == std::string::npos)
      reason += ", expected JSON, which has no comments";
    fail("syntax error: " + reason);
  }

 private:
  static std::string shortened(const std::string& number) {
    return number.size() > 40 ? number.substr(0, 40) + "..." : number;
  }

  [[noreturn]] void fail(const std::string& message) const { throw InputError(source_, line_, message); }

  bool add(JsonValue::Kind kind, std::string text, double number = 0) {
    JsonValue value{
        .kind = kind, .text = std::move(text), .number = number, .name = "the scene", .line = line_};
    if (open_.empty()) {
      root_ = std::move(value);
      return true;
    }
    JsonValue& parent = *open_.back();
    if (parent.kind == JsonValue::Kind::object) {
      value.key = key_;
      value.key_line = key_line_;
      value.name = springstab::quoted(key_);
    } else {
      value.name = parent.name + '[' + std::to_string(parent.items.size()) + ']';
    }
    parent.items.push_back(std::move(value));
    return true;
  }

  bool open(JsonValue::Kind kind) {
    constexpr std::size_t deepest = 16;  // a scene needs three; the tree's destructor is recursive
    if (open_.size() == deepest)
      fail("values are nested too deeply, expected at most " + std::to_string(deepest));
    add(kind, kind == JsonValue::Kind::array ? "an array" : "an object");
    open_.push_back(open_.empty() ? &root_ : &open_.back()->items.back());
    return true;
  }

  bool close() {
    open_.pop_back();
    return true;
  }

  const std::string& source_;
  const long& line_;
  JsonValue root_;
  std::vector<JsonValue*> open_;  // from the root to the innermost; these do not move while they are open
  std::string key_;               // of the member to come
  long key_line_ = 0;
};

}  // namespace

JsonValue parse_json(const std::string& source, std::string_view text) {
  constexpr std::size_t most = std::size_t{1} << 24;  // two bytes can become a value of 150
  if (text.size() > most)
    throw InputError(source, 0,
                     "a scene of " + std::to_string(text.size()) +
                         " bytes, expected at most 16 MB; pins can be ranges such as \"0-999\"");
  long line = 1;
  TreeBuilder builder(source, line);
  nlohmann::json::sax_parse(LineCounter(text.data(), &line), LineCounter(text.data() + text.size(), &line),
                            &builder);
  return builder.take_root();
}

}  // namespace springstab
