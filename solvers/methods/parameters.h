// What a method is given beside its name, as "newmark:beta=0.25,gamma=0.5" on the command line.
//
//     Parameters given("newmark:beta=0.25");
//     given.number("beta", 0.25);     // 0.25
//     given.number("gamma", 0.5);     // 0.5, since none is given
//     given.check_all_asked_for();    // a key that nobody asked for is an error
//
// Depends on the standard library alone.
#pragma once

#include <initializer_list>
#include <set>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

namespace springstab {

class Parameters {
 public:
  /// "NAME" or "NAME:key=value,key=value". Throws std::invalid_argument for anything else, as do the others
  /// for a value that is not what they are to give.
  explicit Parameters(std::string_view text);

  const std::string& text() const { return text_; }  // as it was written
  const std::string& name() const { return name_; }

  double number(std::string_view key, double otherwise);
  long count(std::string_view key, long otherwise);
  std::string word(std::string_view key, std::string_view otherwise);

  /// `rule` says what is expected where `holds` is false.
  void require(bool holds, std::string_view rule) const;
  void check_all_asked_for() const;

 private:
  const std::string* find(std::string_view key);
  [[noreturn]] void refuse(const std::string& what) const;

  std::string text_, name_;
  std::vector<std::pair<std::string, std::string>> values_;
  std::set<std::string, std::less<>> asked_for_;
};

/// "Newmark, β = 0.25, γ = 0.5": a method's title with the values it has, given ones or not.
std::string with_values(std::string title, std::initializer_list<std::pair<std::string_view, double>> values);

}  // namespace springstab
