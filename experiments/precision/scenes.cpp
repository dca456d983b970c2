#include "experiments/precision/scenes.h"

#include <cmath>
#include <numbers>

namespace springstab {
namespace {

Problem chain(const std::string& title, double tenth_spring, const CommonOptions& common) {
  constexpr int n = 1000;
  std::vector<double> stiffness(n + 1, 1e6);
  for (int i = 0; i <= n; i += 10) stiffness[i] = tenth_spring;
  Vector x(n);
  for (int i = 0; i < n; ++i) {
    const double s = (i + 1.) / (n + 1.), away = (s - 0.3) / 0.05;
    x[i] = std::exp(-away * away);
  }
  return {title, SpringChain(std::vector<double>(n, 1.), stiffness, {1, 1e-4}), x, 1, common};
}

}  // namespace

Problem uniform_chain(const CommonOptions& common) {
  return chain("Uniform chain of 1000 masses", 1e6, common);
}

Problem stiff_chain(const CommonOptions& common) {
  return chain("The same, every tenth spring 10⁴ times stiffer", 1e10, common);
}

Problem oscillator(const CommonOptions& common) {
  const double omega = 2 * std::numbers::pi;
  return {"Undamped oscillator, one period", SpringChain({1.}, {omega * omega, 0}, {0, 0}), Vector::Ones(1),
          1, common};
}

}  // namespace springstab
