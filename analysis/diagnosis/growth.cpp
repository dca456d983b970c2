#include "analysis/diagnosis/growth.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <numbers>
#include <utility>
#include <vector>

#include "analysis/constants.h"

namespace springstab::diagnosis {
namespace {

using Complex = std::complex<double>;
using Eigen::Index;

constexpr double largest_position = 1e120;
// In the order of what they leave of smooth motion: fourth differences least, but of slow growth, too.
constexpr std::array orders{4, 2, 1};
constexpr Index shortest_window = 8;
constexpr double rises = 1.5;     // e-foldings from a window's first to its last quarter, for a closer look
constexpr double dominant = 0.5;  // share of what grows, at a window's end
constexpr double coherent = 0.5, coherent_of_smooth = 0.25;  // of the amplitude, from its law
constexpr int most_rounds = 4;
constexpr double most_residual = 0.12;
// For a better window after the first with growth: lengths of that, and e-foldings short of the law's end,
// each of as many, since there it ends by what is no more linear.
constexpr Index searched = 4;
constexpr double at_most_back = 0.15;
constexpr double like_it = 0.3;                                           // |log| of its factor beside that
constexpr double enough = 5, enough_of_slow = 6, enough_of_one_sign = 8;  // e-foldings
constexpr Index fewest = 5;                                               // differences that follow the law
// Radians: in all, and beside -1 a frame, below which a factor is real. (Of modes that grow nearly alike, one
// after the other comes to the fore.)
constexpr double turned = 1, turned_beside_alternating = 0.1;

// Of the logarithms of norms.
double largest(const Eigen::VectorXd& values, Index begin, Index end) {
  return values.segment(begin, end - begin).maxCoeff();
}

// Those of this order in which differences rise.
void add_windows(const Frames& frames, int order, std::vector<GrowthWindow>& all) {
  const Index count = frames.cols() - order;
  Eigen::VectorXd log_norm(std::max<Index>(count, 0));
  for (Index n = 0; n < count; ++n)
    log_norm[n] = std::log(std::max(difference(frames, order, n).norm(), std::numeric_limits<double>::min()));
  for (Index length = shortest_window; length <= count; length += (length + 2) / 3)
    for (Index end = length; end <= count; end += std::max<Index>(1, length / 4)) {
      const Index begin = end - length, quarter = length / 4;
      if (largest(log_norm, end - quarter, end) - largest(log_norm, begin, begin + quarter) > rises)
        all.push_back({order, begin, end, std::max<Index>(1, length / 16)});
    }
}

// b_n ≈ exp(intercept) factorⁿ for first <= n <= last.
struct Law {
  Complex factor, intercept;
  Index first, last;

  double steps() const { return static_cast<double>(last - first); }
  double e_foldings() const { return std::log(std::abs(factor)) * steps(); }
  Complex deviation(const Eigen::VectorXcd& b, Index n) const {
    return b[n] / std::exp(intercept + std::log(factor) * static_cast<double>(n - last)) - 1.0;
  }
};

// Least squares over log b_n, unwrapped beside a factor that is nearly right.
std::optional<Law> fitted_law(const Eigen::VectorXcd& b, Index first, Index last) {
  const Index count = last - first + 1;
  if (count < 3) return std::nullopt;
  Complex factor = 0;
  for (Index n = first; n < last; ++n) factor += b[n + 1] / b[n];
  factor /= static_cast<double>(count - 1);
  if (!(std::abs(factor) > 0) || !std::isfinite(std::abs(factor))) return std::nullopt;
  Eigen::VectorXcd log_ratio(count);  // log(b_n / factorⁿ), from the last one back
  log_ratio[count - 1] = 0;
  for (Index i = count - 1; i > 0; --i)
    log_ratio[i - 1] = log_ratio[i] - std::log(b[first + i] / (b[first + i - 1] * factor));
  const Eigen::VectorXd n = Eigen::VectorXd::LinSpaced(count, -static_cast<double>(count - 1), 0);
  const Eigen::VectorXd centred = n.array() - n.mean();
  const Complex slope = centred.cast<Complex>().dot(log_ratio) / centred.squaredNorm();
  const Complex at_last = log_ratio.mean() - slope * n.mean();
  return Law{factor * std::exp(slope), at_last + std::log(b[last]), first, last};
}

// The numbers around first ... last that follow the law, to `coherent`.
std::pair<Index, Index> followers(const Law& law, const Eigen::VectorXcd& b) {
  Index first = law.first, last = law.last;
  while (first > 0 && std::abs(law.deviation(b, first - 1)) < coherent) --first;
  while (last + 1 < b.size() && std::abs(law.deviation(b, last + 1)) < coherent) ++last;
  return {first, last};
}

double worst_deviation(const Law& law, const Eigen::VectorXcd& b) {
  double worst = 0;
  for (Index n = law.first; n <= law.last; ++n) worst = std::max(worst, std::abs(law.deviation(b, n)));
  return std::isnan(worst) ? infinity : worst;
}

// The law of those in the second half of a window, and that of all around that follow.
struct FollowedLaw {
  Law near, far;
};

std::optional<FollowedLaw> followed_law(const Eigen::VectorXcd& b, Index begin, Index end) {
  const std::optional<Law> near = fitted_law(b, (begin + end) / 2, end - 1);
  std::optional<Law> far = near;
  for (int round = 0; far && round < most_rounds; ++round) {
    const auto [first, last] = followers(*far, b);
    if (first == far->first && last == far->last) break;
    far = fitted_law(b, first, last);
  }
  if (!far || !(worst_deviation(*near, b) < coherent) || !(worst_deviation(*far, b) < coherent))
    return std::nullopt;
  return FollowedLaw{*near, *far};
}

// Smooth motion, as that which begins at rest, passes for exponential over some e-foldings: more are wanted
// of what turns slowly, and most of what does not turn. Nothing smooth alternates from frame to frame.
bool is_significant(const Law& law, const Eigen::VectorXcd& b) {
  if (law.last - law.first + 1 < fewest) return false;
  const double angle = std::abs(std::arg(law.factor));
  if (angle > std::numbers::pi / 2) return law.e_foldings() > enough;
  const bool turns = angle * law.steps() > 2 * std::numbers::pi;
  return law.e_foldings() > (turns ? enough_of_slow : enough_of_one_sign) &&
         worst_deviation(law, b) < coherent_of_smooth;
}

Eigen::VectorXcd amplitudes(const Frames& frames, const GrowthWindow& window, const GrowingComponent& part,
                            Index begin, Index end) {
  Eigen::VectorXcd b(end - begin);
  for (Index n = begin; n < end; ++n)
    b[n - begin] = (part.now.transpose() * difference(frames, window.order, n))(0) +
                   (part.late.transpose() * difference(frames, window.order, n + window.lag))(0);
  return b;
}

// The law of the window alone, and what it is the law of.
struct Local {
  GrowingComponent part;
  FollowedLaw laws;
};

std::optional<Local> local_growth(const Frames& frames, const GrowthWindow& window) {
  std::optional<GrowingComponent> part = growing_component(frames, window);
  if (!part || part->share < dominant) return std::nullopt;
  const Index count = window.end - window.begin - window.lag;
  const Eigen::VectorXcd b = amplitudes(frames, window, *part, window.begin, window.begin + count);
  const auto laws = followed_law(b, 0, count);
  if (!laws || !(std::abs(laws->near.factor) > 1)) return std::nullopt;
  return Local{std::move(*part), *laws};
}

bool differ(Complex factor, Complex other) {
  const double turn = std::abs(std::abs(std::arg(factor)) - std::abs(std::arg(other)));
  return std::hypot(std::log(std::abs(factor / other)), turn) > like_it;
}

bool is_real(const Law& law) {
  const double angle = std::abs(std::arg(law.factor)), short_of_pi = std::numbers::pi - angle;
  return std::min(angle, short_of_pi) * law.steps() < turned || short_of_pi < turned_beside_alternating;
}

// What a window says of the growth that was found.
void take(const GrowthWindow& window, Local local, bool real, Growth& growth) {
  const Law& law = local.laws.near;
  growth.factor = real ? std::copysign(std::abs(law.factor), law.factor.real()) : law.factor;
  growth.pattern = std::move(local.part.pattern);
  if (growth.factor.imag() < 0) {
    growth.factor = std::conj(growth.factor);
    growth.pattern = growth.pattern.conjugate().eval();
  }
  growth.first = window.begin;
  growth.last = window.begin + law.last + window.lag + window.order;
  growth.residual = local.part.residual;
}

// The law as far as it is followed, where that is far enough: first beside the window, then in all frames.
std::optional<Law> significant_law(const Frames& frames, const GrowthWindow& window, const Local& local) {
  if (local.part.residual > most_residual) return std::nullopt;
  const Index all = frames.cols() - window.order - window.lag, length = window.end - window.begin;
  for (const Index margin : {2 * length, all}) {
    const Index begin = std::max<Index>(0, window.begin - margin), end = std::min(all, window.end + margin);
    const Eigen::VectorXcd b = amplitudes(frames, window, local.part, begin, end);
    const auto laws = followed_law(b, window.begin - begin, window.end - window.lag - begin);
    if (!laws) return std::nullopt;
    Law law = laws->far;
    const bool goes_on = (law.first == 0 && begin > 0) || (law.last + 1 == b.size() && end < all);
    if (goes_on) continue;
    if (!is_significant(law, b)) return std::nullopt;
    law.first += begin, law.last += begin;
    return law;
  }
  return std::nullopt;
}

}  // namespace

Index usable_frames(const Frames& frames) {
  for (Index n = 0; n < frames.cols(); ++n)
    if (!(frames.col(n).cwiseAbs().maxCoeff() < largest_position) || !frames.col(n).allFinite()) return n;
  return frames.cols();
}

std::optional<Growth> find_growth(const Frames& frames) {
  std::vector<GrowthWindow> windows;
  for (const int order : orders) add_windows(frames, order, windows);
  std::ranges::stable_sort(windows, {}, [](const GrowthWindow& w) { return w.end + w.order; });
  std::optional<Growth> found;
  bool real = false;
  Index search_to = 0;
  for (const GrowthWindow& window : windows) {
    if (found && window.end > search_to) break;
    std::optional<Local> local = local_growth(frames, window);
    if (!local) continue;
    if (!found) {
      const std::optional<Law> law = significant_law(frames, window, *local);
      if (!law) continue;
      real = is_real(*law);
      const double back = at_most_back * std::min(law->e_foldings(), enough + enough);
      search_to =
          std::max(window.end, law->last - static_cast<Index>(back / std::log(std::abs(law->factor))));
      search_to = std::min(search_to, window.end + searched * (window.end - window.begin));
      found.emplace();
      found->from = law->first;
      found->to = law->last + window.order;
      found->e_foldings = law->e_foldings();
    } else if (local->part.residual > found->residual || differ(local->laws.near.factor, found->factor)) {
      continue;
    }
    take(window, std::move(*local), real, *found);
  }
  return found;
}

}  // namespace springstab::diagnosis
