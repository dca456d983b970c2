#include "solvers/methods/parameters.h"

#include <algorithm>
#include <charconv>
#include <cmath>
#include <cstdio>
#include <stdexcept>

namespace springstab {
namespace {

template <class T>
bool read_whole(const std::string& text, T& value) {
  const char* const end = text.data() + text.size();
  const auto [rest, error] = std::from_chars(text.data(), end, value);
  return error == std::errc() && rest == end;
}

}  // namespace

Parameters::Parameters(std::string_view text) : text_(text) {
  const std::size_t colon = text.find(':');
  name_ = text.substr(0, colon);
  if (colon == std::string_view::npos) return;
  for (std::string_view rest = text.substr(colon + 1);;) {
    const std::size_t comma = rest.find(',');
    const std::string_view item = rest.substr(0, comma);
    const std::size_t equals = item.find('=');
    if (equals == std::string_view::npos || equals == 0)
      refuse("'" + std::string(item) + "' stands where key=value is expected");
    const std::string key(item.substr(0, equals));
    if (std::any_of(values_.begin(), values_.end(), [&](const auto& known) { return known.first == key; }))
      refuse(key + " is given twice, expected once");
    values_.emplace_back(key, item.substr(equals + 1));
    if (comma == std::string_view::npos) return;
    rest = rest.substr(comma + 1);
  }
}

double Parameters::number(std::string_view key, double otherwise) {
  const std::string* const text = find(key);
  if (!text) return otherwise;
  double value = 0;
  if (!read_whole(*text, value) || !std::isfinite(value))
    refuse(std::string(key) + " is '" + *text + "', expected a number");
  return value;
}

long Parameters::count(std::string_view key, long otherwise) {
  const std::string* const text = find(key);
  if (!text) return otherwise;
  long value = 0;
  if (!read_whole(*text, value)) refuse(std::string(key) + " is '" + *text + "', expected a whole number");
  return value;
}

std::string Parameters::word(std::string_view key, std::string_view otherwise) {
  const std::string* const text = find(key);
  return text ? *text : std::string(otherwise);
}

void Parameters::require(bool holds, std::string_view rule) const {
  if (!holds) refuse("expected " + std::string(rule));
}

void Parameters::check_all_asked_for() const {
  std::string known;
  for (const std::string& key : asked_for_) known += (known.empty() ? "" : ", ") + key;
  for (const auto& [key, value] : values_)
    if (!asked_for_.contains(key))
      refuse("unknown parameter '" + key + "', expected " + (known.empty() ? "none" : "one of " + known));
}

const std::string* Parameters::find(std::string_view key) {
  asked_for_.emplace(key);
  for (const auto& [known, value] : values_)
    if (known == key) return &value;
  return nullptr;
}

void Parameters::refuse(const std::string& what) const {
  throw std::invalid_argument("method '" + text_ + "': " + what);
}

std::string with_values(std::string title,
                        std::initializer_list<std::pair<std::string_view, double>> values) {
  for (const auto& [name, value] : values) {
    char digits[32];
    std::snprintf(digits, sizeof digits, "%.4g", value);
    title.append(", ").append(name).append(" = ").append(digits);
  }
  return title;
}

}  // namespace springstab
