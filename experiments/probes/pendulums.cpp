// Coupled pendulums, stepped by velocity Verlet: what `springstab probe` asks a program for, in C++.
//     g++ -std=c++17 pendulums.cpp -o pendulums      (with nlohmann-json3-dev)
#include <iostream>
#include <nlohmann/json.hpp>

using Numbers = std::vector<double>;

double acceleration(const Numbers& x, std::size_t i) {
  const double left = i > 0 ? x[i - 1] : 0, right = i + 1 < x.size() ? x[i + 1] : 0;
  return 400 * (left - 2 * x[i] + right) - 10 * x[i];
}

int main() {
  for (std::string line; std::getline(std::cin, line);) {
    const auto state = nlohmann::json::parse(line);
    const double h = state["h"];
    Numbers x = state["x"], v = state["v"], next = x;
    for (std::size_t i = 0; i < x.size(); ++i) next[i] = x[i] + h * (v[i] + h / 2 * acceleration(x, i));
    for (std::size_t i = 0; i < x.size(); ++i) v[i] += h / 2 * (acceleration(x, i) + acceleration(next, i));
    std::cout << nlohmann::json{{"x", next}, {"v", v}} << std::endl;
  }
}
