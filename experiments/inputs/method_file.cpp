#include "experiments/inputs/method_file.h"

#include <algorithm>
#include <charconv>
#include <cmath>
#include <optional>
#include <sstream>
#include <stdexcept>

#include "analysis/method_of_coefficients.h"
#include "experiments/command/words.h"
#include "experiments/inputs/json_reader.h"
#include "solvers/io/text_file.h"

namespace springstab {
namespace {

constexpr std::size_t most_stages = 50, most_coupled_stages = 6, most_steps = 10;
constexpr double rounding_of_files = 1e-9;  // of the coefficients they give in decimals

// "p" or "p/q".
std::optional<double> fraction(std::string_view text) {
  const auto whole = [](std::string_view part) -> std::optional<double> {
    double value = 0;
    const auto [rest, error] = std::from_chars(part.data(), part.data() + part.size(), value);
    const bool good = error == std::errc() && rest == part.data() + part.size() && std::isfinite(value);
    return good ? std::optional(value) : std::nullopt;
  };
  const std::size_t slash = text.find('/');
  const auto p = whole(text.substr(0, slash));
  if (slash == std::string_view::npos || !p) return p;
  const auto q = whole(text.substr(slash + 1));
  return q && *q != 0 ? std::optional(*p / *q) : std::nullopt;
}

class MethodReader : private JsonReader {
 public:
  using JsonReader::JsonReader;

  Method method(const JsonValue& json) const {
    if (json.kind != JsonValue::Kind::object) wrong(json, "an object");
    const JsonValue& kind_json = needed(json, "kind", "a word");
    const std::string kind = word(kind_json);
    if (kind == "runge-kutta") return of_tableau(json, {"A", "b", "c"}, &MethodReader::of_one);
    if (kind == "partitioned") return of_tableau(json, {"position", "velocity"}, &MethodReader::of_two);
    if (kind == "nystrom") return of_tableau(json, {"c", "position", "velocity"}, &MethodReader::of_nystrom);
    if (kind == "multistep") return of_multistep(json);
    wrong(kind_json, expected_one_of(kind, {"runge-kutta", "partitioned", "nystrom", "multistep"}).substr(9));
  }

 private:
  static constexpr std::string_view common_keys[] = {"name", "title", "kind"};

  void expect_keys(const JsonValue& json, std::vector<std::string_view> keys) const {
    keys.insert(keys.begin(), std::begin(common_keys), std::end(common_keys));
    expect_members(json, keys);
  }

  std::string word(const JsonValue& json) const {
    if (json.kind != JsonValue::Kind::string) wrong(json, "a word in quotes");
    return json.text;
  }

  // What is typed on command lines and stands in the names of files.
  MethodName name(const JsonValue& json) const {
    const JsonValue& name_json = needed(json, "name", "a word by which the method is asked for");
    const std::string name = word(name_json);
    const auto good = [](unsigned char c) { return std::isalnum(c) || c == '-' || c == '_' || c == '.'; };
    if (name.empty() || name.size() > 40 || name[0] == '-' || !std::all_of(name.begin(), name.end(), good))
      wrong(name_json, "up to 40 letters, digits, -, _ and .");
    const JsonValue* const title = find(json, "title");
    return {name, title ? word(*title) : name};
  }

  double coefficient(const JsonValue& json) const {
    if (json.kind == JsonValue::Kind::number) return json.number;
    const auto value = json.kind == JsonValue::Kind::string ? fraction(json.text) : std::nullopt;
    if (!value) wrong(json, "a number, or a fraction in quotes such as \"1/6\"");
    return *value;
  }

  std::vector<double> coefficients(const JsonValue& json, std::size_t least, std::size_t most) const {
    if (json.kind != JsonValue::Kind::array) wrong(json, "an array of coefficients");
    if (json.items.size() < least || json.items.size() > most)
      fail(json.line, json.name + " has " + std::to_string(json.items.size()) + " entries, expected " +
                          (least == most ? "" : std::to_string(least) + " to ") + std::to_string(most));
    std::vector<double> all;
    for (const JsonValue& item : json.items) all.push_back(coefficient(item));
    return all;
  }

  Eigen::VectorXd vector(const JsonValue& json, std::size_t least, std::size_t most) const {
    const std::vector<double> all = coefficients(json, least, most);
    return Eigen::Map<const Eigen::VectorXd>(all.data(), static_cast<Eigen::Index>(all.size()));
  }

  struct Weighted {
    Eigen::MatrixXd a;
    Eigen::VectorXd b;
  };

  // A and b of s stages; s = 0: as many as b has. Rows may end with the last that is not zero.
  Weighted weighted(const JsonValue& json, std::size_t s) const {
    Weighted t;
    t.b = vector(needed(json, "b", "the weights of the stages"), s ? s : 1, s ? s : most_stages);
    const auto stages = static_cast<std::size_t>(t.b.size());
    const JsonValue& rows = needed(json, "A", "an array of one row for each stage");
    if (rows.kind != JsonValue::Kind::array) wrong(rows, "an array of one row for each stage");
    if (rows.items.size() != stages)
      fail(rows.line, rows.name + " has " + std::to_string(rows.items.size()) + " rows, expected " +
                          std::to_string(stages) + ", as 'b' has entries");
    t.a.setZero(t.b.size(), t.b.size());
    for (std::size_t i = 0; i < stages; ++i) {
      const Eigen::VectorXd row = vector(rows.items[i], 0, stages);
      t.a.row(static_cast<Eigen::Index>(i)).head(row.size()) = row;
    }
    return t;
  }

  void check_nodes(const JsonValue& json, const Eigen::MatrixXd& a) const {
    const JsonValue* const given = find(json, "c");
    if (!given) return;
    const auto s = static_cast<std::size_t>(a.rows());
    const Eigen::VectorXd c = vector(*given, s, s);
    for (Eigen::Index i = 0; i < a.rows(); ++i) {
      const double sum = a.row(i).sum();
      if (std::abs(c[i] - sum) <= rounding_of_files) continue;
      std::ostringstream message;
      message.precision(12);
      message << "inconsistent: 'c'[" << i << "] is " << c[i] << ", expected " << sum << ", the sum of 'A'["
              << i << "]";
      fail(given->items[static_cast<std::size_t>(i)].line, message.str());
    }
  }

  StageTableau of_one(const JsonValue& json) const {
    const Weighted t = weighted(json, 0);
    check_nodes(json, t.a);
    return runge_kutta(t.a, t.b);
  }

  // The tableaus for x and for v.
  std::pair<Weighted, Weighted> pair_of(const JsonValue& json, std::size_t s,
                                        const std::vector<std::string_view>& keys) const {
    const JsonValue &of_x = needed(json, "position", "an object of 'A' and 'b'"),
                    &of_v = needed(json, "velocity", "an object of 'A' and 'b'");
    expect_members(of_x, keys);
    expect_members(of_v, keys);
    Weighted x = weighted(of_x, s), v = weighted(of_v, static_cast<std::size_t>(x.b.size()));
    check_nodes(of_x, x.a);
    check_nodes(of_v, v.a);
    return {std::move(x), std::move(v)};
  }

  StageTableau of_two(const JsonValue& json) const {
    const auto pair = pair_of(json, 0, {"A", "b", "c"});
    return partitioned(pair.first.a, pair.first.b, pair.second.a, pair.second.b);
  }

  StageTableau of_nystrom(const JsonValue& json) const {
    const Eigen::VectorXd c = vector(needed(json, "c", "the times of the stages"), 1, most_stages);
    const auto pair = pair_of(json, static_cast<std::size_t>(c.size()), {"A", "b"});
    StageTableau t{pair.first.a, pair.second.a, c, pair.first.b, pair.second.b};
    check_consistent(t);
    return t;
  }

  Method of_tableau(const JsonValue& json, std::vector<std::string_view> keys,
                    StageTableau (MethodReader::*read)(const JsonValue&) const) const {
    expect_keys(json, std::move(keys));
    return consistent(json, [&] {
      const StageTableau tableau = (this->*read)(json);
      if (kind_of(tableau) == StageKind::fully_implicit &&
          static_cast<std::size_t>(tableau.c.size()) > most_coupled_stages)
        fail(json.line, "has " + std::to_string(tableau.c.size()) +
                            " stages that depend on later ones, expected at most " +
                            std::to_string(most_coupled_stages));
      return method_of(name(json), tableau);
    });
  }

  Method of_multistep(const JsonValue& json) const {
    expect_keys(json, {"form", "alpha", "beta", "velocity"});
    const JsonValue& form_json = needed(json, "form", "'first-order' or 'second-order'");
    const std::string form = word(form_json);
    Multistep m{.alpha = coefficients(needed(json, "alpha", "coefficients of the states"), 2, most_steps + 1),
                .beta = {}};
    const std::size_t n = m.alpha.size();
    m.beta = coefficients(needed(json, "beta", "coefficients of the rates"), n, n);
    if (m.alpha.back() == 0)
      wrong(find(json, "alpha")->items.back(), "the coefficient of the new state, not 0");
    const JsonValue* const velocity = find(json, "velocity");
    if (form == "second-order") {
      m.second_order = true;
      const JsonValue& how = needed(json, "velocity", "an object of 'x' and 'a', from which v is formed");
      expect_members(how, {"x", "a"});
      m.velocity_of_x = coefficients(needed(how, "x", "coefficients of the positions"), n, n);
      const JsonValue* const of_a = find(how, "a");
      m.velocity_of_a = of_a ? coefficients(*of_a, n, n) : std::vector<double>(n, 0.0);
    } else if (form != "first-order") {
      wrong(form_json, "'first-order' or 'second-order'");
    } else if (velocity) {
      fail(velocity->key_line,
           "'velocity' stands in the first-order form, expected it in the second-order one");
    }
    return consistent(json, [&] {
      check_consistent(m);
      return method_of(name(json), m);
    });
  }

  template <class Make>
  Method consistent(const JsonValue& json, const Make& make) const {
    try {
      return make();
    } catch (const std::invalid_argument& error) {
      fail(json.line, error.what());
    }
  }
};

}  // namespace

Method parse_method(const std::string& source, std::string_view text) {
  JsonValue root = parse_json(source, text);
  root.name = "the method";
  return MethodReader(source).method(root);
}

Method read_method_file(const std::string& path) { return parse_method(path, read_text_file(path)); }

}  // namespace springstab
