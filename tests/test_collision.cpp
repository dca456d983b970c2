// What touches what, against brute force: a subdivision of time and place in long double that proves two
// parts apart and knows neither cubics nor closest places. All that it cannot prove apart is found, and what
// is found is as near as is said; the side is that before the contact; kept pairs are all pairs.
#include <boost/test/unit_test.hpp>
#include <cmath>
#include <map>
#include <random>
#include <set>
#include <vector>

#include "solvers/contact/surface_pairs.h"
#include "tests/allocation_counter.h"
#include "tests/instruments.h"
#include "tests/intersections.h"

BOOST_AUTO_TEST_SUITE(collision)

using namespace springstab;
using Eigen::Vector3d;

namespace {

using Wide = Eigen::Matrix<long double, 3, 1>;
using Places = std::vector<Vector3d>;

class Random {
 public:
  explicit Random(std::uint64_t seed) : engine_(seed) {}
  double uniform(double a, double b) { return std::uniform_real_distribution<double>(a, b)(engine_); }
  int integer(int a, int b) { return std::uniform_int_distribution<int>(a, b)(engine_); }
  Vector3d in_cube(double half) { return {uniform(-half, half), uniform(-half, half), uniform(-half, half)}; }
  Vector3d direction() {
    Vector3d d = in_cube(1);
    while (d.norm() > 1 || d.norm() < 0.1) d = in_cube(1);
    return d.normalized();
  }
  std::mt19937_64& engine() { return engine_; }

 private:
  std::mt19937_64 engine_;
};

/// Σ w x(t) as a function of t and two coordinates of places in the parts, each in [0, 1]: affine in each.
struct Difference {
  PairKind kind;
  std::array<Wide, 4> from, way;

  Difference(PairKind of, const FourPlaces& x0, const FourPlaces& x1) : kind(of) {
    for (int i = 0; i < 4; ++i) {
      from[i] = x0[i].cast<long double>();
      way[i] = x1[i].cast<long double>() - from[i];
    }
  }
  Wide at(long double t, long double a, long double b) const {
    std::array<Wide, 4> x;
    for (int i = 0; i < 4; ++i) x[i] = from[i] + t * way[i];
    if (kind == PairKind::vertex_face) return (x[0] - x[1]) - a * (x[2] - x[1]) - b * (x[3] - x[1]);
    return (x[0] - x[2]) + a * (x[1] - x[0]) - b * (x[3] - x[2]);
  }
  long double extent() const {
    long double all = 0;
    for (int i = 0; i < 4; ++i)
      for (int j = 0; j < i; ++j)
        all = std::max({all, (from[i] - from[j]).norm(), (from[i] + way[i] - from[j] - way[j]).norm()});
    return all;
  }
};

struct Cell {
  std::array<long double, 3> low, high;  // of t and the two coordinates
};

/// Whether all of the cell is proved further from zero than `distance`: as the values are in the convex hull
/// of those at its corners, a plane proves it.
bool is_away(const Difference& f, const Cell& cell, long double distance, long double rounding,
             int& longest) {
  std::array<Wide, 8> corner;
  Wide mean = Wide::Zero();
  for (int k = 0; k < 8; ++k) {
    corner[k] = f.at(k & 1 ? cell.high[0] : cell.low[0], k & 2 ? cell.high[1] : cell.low[1],
                     k & 4 ? cell.high[2] : cell.low[2]);
    mean += corner[k] / 8;
  }
  const auto all_beyond = [&](const Wide& n) {
    return std::all_of(corner.begin(), corner.end(),
                       [&](const Wide& c) { return n.dot(c) > distance + rounding; });
  };
  if (mean.norm() > 0 && all_beyond(mean.normalized())) return true;
  for (int d = 0; d < 3; ++d)
    if (all_beyond(Wide::Unit(d)) || all_beyond(-Wide::Unit(d))) return true;
  long double widest = -1;
  for (int d = 0; d < 3; ++d) {
    long double width = 0;
    for (int k = 0; k < 8; ++k) width = std::max(width, (corner[k] - corner[k ^ (1 << d)]).norm());
    if (width > widest) widest = width, longest = d;
  }
  return false;
}

/// Whether the two are proved to be more than `distance` apart all the time in [0, end]. False where they are
/// not, or not found to be with cells down to 1e-13 of the extent.
bool proved_apart(const Difference& f, long double end, long double distance) {
  const long double extent = f.extent(), rounding = 1e-17L * extent;
  std::vector<Cell> open{{{0, 0, 0}, {end, 1, 1}}};
  for (long cells = 0; !open.empty(); ++cells) {
    const Cell cell = open.back();
    open.pop_back();
    int longest = 0;
    if (f.kind == PairKind::vertex_face && cell.low[1] + cell.low[2] > 1) continue;
    if (is_away(f, cell, distance, rounding, longest)) continue;
    const long double width = cell.high[longest] - cell.low[longest];
    if (width < 1e-13L || cells > 100'000) return false;
    Cell lower = cell, upper = cell;
    lower.high[longest] = upper.low[longest] = cell.low[longest] + width / 2;
    open.push_back(upper);
    open.push_back(lower);
  }
  return true;
}

/// Triangles apart from each other, and where they go.
struct Soup {
  Surface surface;
  Places x0, x1;
};

/// Places(i) is called once for each corner, in order.
template <class From, class To>
Soup make_soup(int triangles, const From& from, const To& to) {
  Soup soup;
  std::vector<std::array<int, 3>> list;
  for (int t = 0; t < triangles; ++t) {
    list.push_back({3 * t, 3 * t + 1, 3 * t + 2});
    const Vector3d x = from(-1);
    for (int k = 0; k < 3; ++k) soup.x0.push_back(x + from(k));
    const Vector3d way = to(-1);
    for (int k = 0; k < 3; ++k) soup.x1.push_back(soup.x0[3 * t + k] + way + to(k));
  }
  soup.surface = make_surface(std::move(list));
  return soup;
}

Soup random_soup(Random& random, int triangles, double scale) {
  return make_soup(
      triangles, [&](int k) { return random.in_cube((k < 0 ? 0.7 : 0.5) * scale); },
      [&](int k) { return random.in_cube((k < 0 ? 0.7 : 0.3) * scale); });
}

/// On a lattice: with many exact touches, common planes, parallel edges and triangles without area.
Soup lattice_soup(Random& random, int triangles, double spacing) {
  const auto point = [&](int most) -> Vector3d {
    return Vector3d(random.integer(-most, most), random.integer(-most, most), random.integer(-most, most)) *
           spacing;
  };
  return make_soup(
      triangles, [&](int k) { return point(k < 0 ? 4 : 2); }, [&](int k) { return point(k < 0 ? 2 : 1); });
}

/// In one oblique plane, before and after.
Soup flat_soup(Random& random, int triangles, double scale) {
  const Vector3d u = random.direction(), v = random.direction().cross(u).normalized();
  const auto in_plane = [&](double most) -> Vector3d {
    return random.uniform(-most, most) * u + random.uniform(-most, most) * v;
  };
  return make_soup(
      triangles, [&](int k) { return in_plane((k < 0 ? 1 : 0.2) * scale); },
      [&](int k) { return in_plane((k < 0 ? 0.2 : 0.05) * scale); });
}

/// Slivers, of which some are segments and points.
Soup sliver_soup(Random& random, int triangles, double scale) {
  Vector3d along;
  return make_soup(
      triangles,
      [&](int k) -> Vector3d {
        if (k < 0) return along = random.direction(), random.in_cube(0.6 * scale);
        const double width = random.integer(0, 2) == 0 ? 0 : std::pow(10, random.uniform(-12, -1));
        return random.integer(0, 9) == 0
                   ? Vector3d::Zero()
                   : Vector3d(scale * (random.uniform(-0.5, 0.5) * along + random.in_cube(width)));
      },
      [&](int k) -> Vector3d {
        return random.in_cube(k < 0 ? 0.5 * scale : 0.05 * scale * random.integer(0, 1));
      });
}

/// Calls visit(kind, particles) for every pair that has no particle in common.
template <class Visit>
void for_each_pair(const Surface& surface, const Visit& visit) {
  const auto are_different = [](std::array<int, 4> p) {
    return p[0] != p[2] && p[0] != p[3] && p[1] != p[2] && p[1] != p[3];
  };
  for (const int v : surface.vertices)
    for (const auto& f : surface.triangles)
      if (v != f[0] && v != f[1] && v != f[2])
        visit(PairKind::vertex_face, std::array<int, 4>{v, f[0], f[1], f[2]});
  for (std::size_t i = 0; i < surface.edges.size(); ++i)
    for (std::size_t j = i + 1; j < surface.edges.size(); ++j) {
      const std::array<int, 4> p{surface.edges[i][0], surface.edges[i][1], surface.edges[j][0],
                                 surface.edges[j][1]};
      if (are_different(p)) visit(PairKind::edge_edge, p);
    }
}

FourPlaces at(const std::array<int, 4>& p, const Places& x) { return {x[p[0]], x[p[1]], x[p[2]], x[p[3]]}; }

/// The places' coordinates as Difference takes them, from weights.
Wide weighted(const Difference& f, const std::array<double, 4>& w, long double t) {
  Wide sum = Wide::Zero();
  for (int i = 0; i < 4; ++i) sum += static_cast<long double>(w[i]) * (f.from[i] + t * f.way[i]);
  return sum;
}

bool are_weights(PairKind kind, const std::array<double, 4>& w) {
  const double rounding = 1e-15, sum = kind == PairKind::vertex_face ? w[0] : w[0] + w[1];
  return std::abs(sum - 1) < rounding && std::abs(w[0] + w[1] + w[2] + w[3]) < 2 * rounding && w[0] >= 0 &&
         (kind == PairKind::vertex_face ? w[1] <= rounding : w[1] >= 0) && w[2] <= rounding &&
         w[3] <= rounding;
}

struct Tally {
  long pairs = 0, found = 0, near = 0;
};

/// Everything that can meet is found, and what is found is near.
Tally check_all_pairs(const Soup& soup) {
  Tally tally;
  long missed = 0, far = 0, wrong_weights = 0, wrong_normals = 0, late = 0;
  for_each_pair(soup.surface, [&](PairKind kind, const std::array<int, 4>& p) {
    const FourPlaces x0 = at(p, soup.x0), x1 = at(p, soup.x1);
    const Difference f(kind, x0, x1);
    const auto impact = first_impact(kind, x0, x1);
    ++tally.pairs;
    if (!impact) {
      missed += !proved_apart(f, 1, 0);
      return;
    }
    ++tally.found;
    const Wide gap = weighted(f, impact->places.weights, impact->time);
    far += !(gap.norm() <= collision_tolerance * f.extent() * (1 + 1e-6L));
    wrong_weights += !are_weights(kind, impact->places.weights);
    wrong_normals += !(std::abs(impact->normal.norm() - 1) < 1e-14);
    if (gap.norm() > 1e-12L * f.extent()) ++tally.near;
    // Not before.
    if (tally.found % 8 == 0 && impact->time > 1e-3) late += !proved_apart(f, impact->time - 1e-3L, 0);
  });
  BOOST_TEST(missed == 0);
  BOOST_TEST(far == 0);
  BOOST_TEST(wrong_weights == 0);
  BOOST_TEST(wrong_normals == 0);
  BOOST_TEST(late == 0);
  return tally;
}

}  // namespace

BOOST_AUTO_TEST_CASE(of_a_million_pairs_of_moving_triangles_every_collision_is_found,
                     *boost::unit_test::label("slow")) {
  Random random(1);
  Tally all;
  for (int scale = -3; scale <= 3; ++scale) {
    const Tally tally = check_all_pairs(random_soup(random, 142, std::pow(10, scale)));
    BOOST_TEST(tally.found > tally.pairs / 100);
    all.pairs += tally.pairs;
    all.found += tally.found;
  }
  BOOST_TEST_MESSAGE(all.pairs << " pairs, " << all.found << " collisions");
  BOOST_TEST(all.pairs > 1'000'000);
}

BOOST_AUTO_TEST_CASE(the_normal_is_on_the_side_that_they_come_from) {
  Random random(3);
  const Soup soup = random_soup(random, 100, 1);
  long checked = 0, wrong = 0;
  for_each_pair(soup.surface, [&](PairKind kind, const std::array<int, 4>& p) {
    const FourPlaces x0 = at(p, soup.x0), x1 = at(p, soup.x1);
    const auto impact = first_impact(kind, x0, x1);
    if (!impact || impact->time < 1e-3) return;
    // The volume of the four just before, and the normal of their plane then.
    const Difference f(kind, x0, x1);
    const auto places = [&](long double t) {
      std::array<Wide, 4> x;
      for (int i = 0; i < 4; ++i) x[i] = f.from[i] + t * f.way[i];
      return x;
    };
    const auto before = places(impact->time - 1e-5L), now = places(impact->time);
    const int corner = kind == PairKind::vertex_face ? 1 : 0, other = kind == PairKind::vertex_face ? 1 : 2;
    const auto across = [&](const std::array<Wide, 4>& x) -> Wide {
      return (x[corner + 1] - x[corner]).cross(x[3] - x[other]);
    };
    const auto volume = across(before).dot(before[0] - before[other]);
    if (std::abs(volume) < 1e-7L * across(before).norm()) return;  // they hardly move towards each other
    ++checked;
    const Wide normal = impact->normal.cast<long double>();
    wrong += !(normal.dot(across(now)) * volume > 0) ||
             !(normal.cross(across(now)).norm() < 1e-6L * across(now).norm());
  });
  BOOST_TEST(checked > 1000);
  BOOST_TEST(wrong == 0);
}

BOOST_AUTO_TEST_CASE(degenerate_cases_are_decided_for_the_collision) {
  Random random(2);
  for (int k = 0; k < 4; ++k) {
    BOOST_TEST(check_all_pairs(lattice_soup(random, 40, k < 2 ? 1 : 0.1)).found > 100);
    BOOST_TEST(check_all_pairs(flat_soup(random, 40, std::pow(10, k - 2))).found > 100);
    BOOST_TEST(check_all_pairs(sliver_soup(random, 40, std::pow(10, k - 2))).found > 10);
  }
}

namespace {

bool equal(const SurfaceContact& a, const SurfaceContact& b) {
  return a.particles == b.particles && a.weights == b.weights && a.normal == b.normal && a.gap == b.gap &&
         a.time == b.time;
}

bool equal(std::span<const SurfaceContact> a, std::span<const SurfaceContact> b) {
  return std::equal(a.begin(), a.end(), b.begin(), b.end(),
                    [](const SurfaceContact& c, const SurfaceContact& d) { return equal(c, d); });
}

std::vector<SurfaceContact> all_impacts(const Surface& surface, const Places& x0, const Places& x1) {
  std::vector<SurfaceContact> all;
  for_each_pair(surface, [&](PairKind kind, const std::array<int, 4>& p) {
    if (const auto impact = first_impact(kind, at(p, x0), at(p, x1)))
      all.push_back({p, impact->places.weights, impact->normal, impact->normal.dot(impact->places.difference),
                     impact->time});
  });
  return all;
}

/// A sheet of n × n particles in the plane y = height, whose diagonals alternate, with numbers from `first`
/// on.
std::vector<std::array<int, 3>> sheet(int n, int first) {
  std::vector<std::array<int, 3>> triangles;
  for (int i = 0; i + 1 < n; ++i)
    for (int j = 0; j + 1 < n; ++j) {
      const int a = first + i * n + j, b = a + 1, c = a + n, d = c + 1;
      if ((i + j) % 2 == 0)
        triangles.insert(triangles.end(), {{a, b, d}, {a, d, c}});
      else
        triangles.insert(triangles.end(), {{a, b, c}, {b, d, c}});
    }
  return triangles;
}

void place_sheet(Places& x, int n, double spacing, double height) {
  for (int i = 0; i < n; ++i)
    for (int j = 0; j < n; ++j) x.emplace_back(i * spacing, height, j * spacing);
}

constexpr int compared = test::times(1, 10);  // each how many steps with all pairs there are

/// Two wavy sheets over each other, which drift and shake.
struct TwoSheets {
  static constexpr int n = 12;
  Surface surface;
  Places x;
  Random random{4};

  TwoSheets() {
    auto triangles = sheet(n, 0);
    const auto upper = sheet(n, n * n);
    triangles.insert(triangles.end(), upper.begin(), upper.end());
    surface = make_surface(std::move(triangles));
    place_sheet(x, n, 0.025, 0);
    place_sheet(x, n, 0.024, 0.006);
    for (Vector3d& p : x) p += random.in_cube(0.001);
  }
  Places next(int step) {
    Places to = x;
    for (std::size_t i = 0; i < to.size(); ++i) {
      const double side = i < to.size() / 2 ? 1 : -1;
      to[i] += random.in_cube(2e-4) + side * Vector3d(1e-4, 8e-4 * std::cos(0.2 * step), -2e-4);
    }
    return to;
  }
};

struct NeedsEmbree {
  boost::test_tools::assertion_result operator()(boost::unit_test::test_unit_id) const {
    return has_embree();
  }
};
const auto with_embree = boost::unit_test::precondition(NeedsEmbree{});

}  // namespace

BOOST_AUTO_TEST_CASE(what_boxes_find_is_what_all_pairs_give, *with_embree) {
  Random random(5);
  for (const double scale : {1e-3, 1., 1e3}) {
    const Soup soup = random_soup(random, 80, scale);
    const int all = static_cast<int>(soup.x0.size());
    SurfacePairs pairs(soup.surface, all, {1e-3 * scale, 1e-2 * scale});
    BOOST_TEST(equal(pairs.collisions(soup.x0, soup.x1), all_impacts(soup.surface, soup.x0, soup.x1)));
    // Far away, where single precision could not tell them apart, they are the same, but for rounding there.
    Places y0 = soup.x0, y1 = soup.x1;
    for (std::size_t i = 0; i < y0.size(); ++i) {
      y0[i] += Vector3d(3e6, -1e6, 2e6) * scale;
      y1[i] += Vector3d(3e6, -1e6, 2e6) * scale;
    }
    BOOST_TEST(equal(pairs.collisions(y0, y1), all_impacts(soup.surface, y0, y1)));
    BOOST_TEST(!pairs.collisions(y0, y1).empty());

    // With a second surface: none of those within one; and none of those that are not free.
    const auto half = soup.surface.triangles.begin() + 40;
    const Surface first = make_surface({soup.surface.triangles.begin(), half}),
                  second = make_surface({half, soup.surface.triangles.end()});
    for (const int free : {120, 60}) {
      SurfacePairs between(first, second, free, {1e-3 * scale, 1e-2 * scale});
      std::set<std::array<int, 4>> expected, found;
      for (const SurfaceContact& c : all_impacts(soup.surface, soup.x0, soup.x1)) {
        const int is_of_first =
            static_cast<int>(c.particles[0] < 120) + static_cast<int>(c.particles[3] < 120);
        if (is_of_first == 1 && *std::min_element(c.particles.begin(), c.particles.end()) < free)
          expected.insert(c.particles);
      }
      const auto list = between.collisions(soup.x0, soup.x1);
      for (const SurfaceContact& c : list) found.insert(c.particles);
      BOOST_TEST(found.size() == list.size());
      BOOST_TEST((found == expected));
      BOOST_TEST(!found.empty());
    }
  }
}

BOOST_AUTO_TEST_CASE(proximities_are_all_that_is_near_and_closest, *with_embree) {
  Random random(6);
  const Soup soup = random_soup(random, 60, 1);
  const double distance = 0.05;
  SurfacePairs pairs(soup.surface, 180, {distance, 0.1});
  std::map<std::array<int, 4>, SurfaceContact> found;
  for (const SurfaceContact& c : pairs.proximities(soup.x0, distance)) found.emplace(c.particles, c);
  BOOST_TEST(found.size() > 100);
  long missed = 0, wrong = 0;
  for_each_pair(soup.surface, [&](PairKind kind, const std::array<int, 4>& p) {
    const FourPlaces x = at(p, soup.x0);
    const Difference f(kind, x, x);
    const auto it = found.find(p);
    if (it == found.end()) {
      missed += !proved_apart(f, 1, distance * (1 - 1e-9L));
      return;
    }
    const SurfaceContact& c = it->second;
    const Wide difference = weighted(f, c.weights, 0), n = c.normal.cast<long double>();
    const bool reproduces = (difference - static_cast<long double>(c.gap) * n).norm() < 1e-14L;
    wrong += !(are_weights(kind, c.weights) && c.time == 0 && c.gap >= 0 && c.gap <= distance * (1 + 1e-12) &&
               std::abs(c.normal.norm() - 1) < 1e-14 && reproduces &&
               (c.gap < 1e-9 || proved_apart(f, 1, c.gap * (1 - 1e-6L))));
  });
  BOOST_TEST(missed == 0);
  BOOST_TEST(wrong == 0);
}

BOOST_AUTO_TEST_CASE(kept_pairs_are_those_of_the_moment_and_take_no_memory, *with_embree) {
  TwoSheets sheets;
  const int all = static_cast<int>(sheets.x.size());
  const PairDistances distances{0.004, 0.004};
  SurfacePairs kept(sheets.surface, all, distances);
  long proximities = 0, collisions = 0, taken = 0;
  for (int step = 0; step < 60; ++step) {
    const Places next = sheets.next(step);
    SurfacePairs fresh(sheets.surface, all, distances);
    BOOST_TEST(equal(kept.proximities(sheets.x, 0.004), fresh.proximities(sheets.x, 0.004)));
    const long before = allocations(), rebuilt = kept.counts().rebuilds + kept.counts().strays;
    proximities += static_cast<long>(kept.proximities(sheets.x, 0.004).size());
    const auto met = kept.collisions(sheets.x, next);
    collisions += static_cast<long>(met.size());
    if (step > 0 && kept.counts().rebuilds + kept.counts().strays == rebuilt)
      taken += allocations() - before;  // lists may grow
    if (step % compared == 0) BOOST_TEST(equal(met, all_impacts(sheets.surface, sheets.x, next)));
    sheets.x = next;
  }
  BOOST_TEST(proximities > 1000);
  BOOST_TEST(collisions > 1000);
  BOOST_TEST(taken == 0);
  BOOST_TEST(kept.counts().rebuilds > 2);
  BOOST_TEST(kept.counts().rebuilds < 40);
  BOOST_TEST(kept.counts().tested > 0);
  BOOST_TEST(kept.counts().tested < kept.counts().kept / 2);
}

// Two sheets that fall fast, together, and slowly through each other: found once for many steps, also as one
// particle goes another way from then on.
BOOST_AUTO_TEST_CASE(ways_that_go_on_as_they_went_are_foreseen, *with_embree) {
  TwoSheets sheets;
  Random random(11);
  Places way;
  for (std::size_t i = 0; i < sheets.x.size(); ++i)
    way.push_back(Vector3d(0.003, -0.02, 0.001) + random.in_cube(2e-5) +
                  (i < sheets.x.size() / 2 ? 1 : -1) * Vector3d(0, 2e-4, 1e-4));
  SurfacePairs kept(sheets.surface, static_cast<int>(sheets.x.size()), {0.004, 0.004});
  long collisions = 0;
  for (int step = 0; step < 50; ++step) {
    Places next = sheets.x;
    if (step == 20) way[30] += Vector3d(1e-4, 3e-4, -1e-4);
    for (std::size_t i = 0; i < next.size(); ++i) next[i] += way[i];
    const auto met = kept.collisions(sheets.x, next);
    collisions += static_cast<long>(met.size());
    if (step % compared == 0) BOOST_TEST(equal(met, all_impacts(sheets.surface, sheets.x, next)));
    SurfacePairs fresh(sheets.surface, static_cast<int>(sheets.x.size()), {0.004, 0.004});
    BOOST_TEST(equal(kept.proximities(next, 0.004), fresh.proximities(next, 0.004)));
    sheets.x = next;
  }
  BOOST_TEST(collisions > 100);
  BOOST_TEST(kept.counts().rebuilds == 1);
  BOOST_TEST(kept.counts().strays > 0);
}

namespace {

std::vector<SurfaceContact> all_near(const Surface& surface, const Places& x, double distance) {
  std::vector<SurfaceContact> all;
  for_each_pair(surface, [&](PairKind kind, const std::array<int, 4>& p) {
    const ClosestPlaces closest = closest_places(kind, at(p, x));
    if (closest.difference.squaredNorm() > distance * distance) return;
    const Vector3d n = direction_between(kind, at(p, x), closest);
    all.push_back({p, closest.weights, n, n.dot(closest.difference), 0});
  });
  return all;
}

}  // namespace

// Faces that share a particle are kept for good, but those around one that is shared by many: a crumpled
// sheet beside a crumpled fan, that shake and drift, now and then so far that all is found anew.
BOOST_AUTO_TEST_CASE(faces_that_share_a_particle_meet_with_their_other_ones, *with_embree) {
  Random random(12);
  auto triangles = sheet(5, 0);
  for (int k = 0; k < 24; ++k) triangles.push_back({25, 26 + k, 26 + (k + 1) % 24});
  const Surface surface = make_surface(std::move(triangles));
  Places x;
  for (int i = 0; i < 50; ++i) x.push_back(random.in_cube(0.1));
  SurfacePairs pairs(surface, 50, {0.004, 0.004});
  long met = 0, near = 0;
  for (int step = 0; step < 60; ++step) {
    Places next = x;
    for (Vector3d& p : next) p += random.in_cube(step % 20 == 19 ? 0.02 : 2e-4) + Vector3d(0.01, 0, -0.02);
    const auto [collisions, proximities] = pairs.step(x, next, 0.004);
    met += static_cast<long>(collisions.size());
    near += static_cast<long>(proximities.size());
    BOOST_TEST(equal(collisions, all_impacts(surface, x, next)));
    BOOST_TEST(equal(proximities, all_near(surface, next, 0.004)));
    BOOST_TEST(equal(pairs.proximities(next, 0.002), all_near(surface, next, 0.002)));
    x = next;
  }
  BOOST_TEST(met > 300);
  BOOST_TEST(near > 1000);
  BOOST_TEST(pairs.counts().rebuilds < 20);
}

BOOST_AUTO_TEST_CASE(mirrored_and_renumbered_places_give_the_same_pairs, *with_embree) {
  Random random(7);
  const Soup soup = random_soup(random, 60, 1);
  const auto mirror = [](Places x) {
    for (Vector3d& p : x) p[0] = -p[0];
    return x;
  };
  const auto list = all_impacts(soup.surface, soup.x0, soup.x1);
  BOOST_REQUIRE(list.size() > 100);
  SurfacePairs pairs(soup.surface, 180, {0.01, 0.1});
  std::vector<SurfaceContact> mirrored;
  for (SurfaceContact c : pairs.collisions(mirror(soup.x0), mirror(soup.x1))) {
    c.normal[0] = -c.normal[0];
    mirrored.push_back(c);
  }
  BOOST_TEST(equal(mirrored, list));

  // Other numbers, triangles in another order, and corners, too.
  std::vector<int> number(180);
  for (int i = 0; i < 180; ++i) number[i] = i;
  std::shuffle(number.begin(), number.end(), random.engine());
  Places y0(180), y1(180);
  for (int i = 0; i < 180; ++i) y0[number[i]] = soup.x0[i], y1[number[i]] = soup.x1[i];
  std::vector<std::array<int, 3>> triangles;
  for (const auto& t : soup.surface.triangles)
    triangles.push_back({number[t[2]], number[t[0]], number[t[1]]});
  std::shuffle(triangles.begin(), triangles.end(), random.engine());
  SurfacePairs renumbered(make_surface(triangles), 180, {0.01, 0.1});
  const auto as_set = [](PairKind kind, std::array<int, 4> p) {
    if (kind == PairKind::vertex_face) {
      std::sort(p.begin() + 1, p.end());
    } else {
      if (p[0] > p[1]) std::swap(p[0], p[1]);
      if (p[2] > p[3]) std::swap(p[2], p[3]);
      if (p[0] > p[2]) p = {p[2], p[3], p[0], p[1]};
    }
    return std::pair(kind, p);
  };
  // What random triangles meet with is inside both parts.
  const auto kind_of = [](const SurfaceContact& c) {
    return c.weights[1] < 0 ? PairKind::vertex_face : PairKind::edge_edge;
  };
  std::map<std::pair<PairKind, std::array<int, 4>>, double> expected;
  for (const SurfaceContact& c : list) {
    std::array<int, 4> p;
    for (int i = 0; i < 4; ++i) p[i] = number[c.particles[i]];
    expected[as_set(kind_of(c), p)] = c.time;
  }
  const auto found = renumbered.collisions(y0, y1);
  BOOST_TEST(found.size() == list.size());
  for (const SurfaceContact& c : found) {
    const auto it = expected.find(as_set(kind_of(c), c.particles));
    BOOST_REQUIRE((it != expected.end()));
    BOOST_TEST(std::abs(it->second - c.time) < 1e-6);
  }
}

BOOST_AUTO_TEST_CASE(a_mesh_that_collides_is_one_that_then_cuts_itself, *with_embree) {
  // Detection and the checker of meshes agree: a step after which the mesh cuts itself, where it did not
  // before, has collisions.
  long cuts = 0;
  Random random(8);
  for (int k = 0; k < 40; ++k) {
    TwoSheets sheets;
    sheets.random = Random(100 + k);
    Places next = sheets.x;
    for (Vector3d& p : next) p += random.in_cube(0.004);
    BOOST_TEST(test::intersecting_triangles(sheets.surface.triangles, sheets.x).empty());
    SurfacePairs pairs(sheets.surface, static_cast<int>(next.size()), {0.001, 0.004});
    const bool cut = !test::intersecting_triangles(sheets.surface.triangles, next).empty();
    cuts += cut;
    BOOST_TEST((!cut || !pairs.collisions(sheets.x, next).empty()));
  }
  BOOST_TEST(cuts > 10);
}

BOOST_AUTO_TEST_CASE(what_cannot_be_paired_is_refused) {
  BOOST_CHECK_THROW(make_surface({{0, 1, 1}}), std::invalid_argument);
  BOOST_CHECK_THROW(make_surface({{0, -1, 1}}), std::invalid_argument);
  const Surface one = make_surface({{0, 1, 2}});
  BOOST_CHECK_THROW(SurfacePairs({}, 3, {0.1, 0.1}), std::invalid_argument);
  if (!has_embree()) {
    BOOST_CHECK_EXCEPTION(
        SurfacePairs(one, 3, {0.1, 0.1}), std::runtime_error,
        [](const std::runtime_error& e) { return std::string(e.what()) == embree_is_missing; });
    return;
  }
  BOOST_CHECK_THROW(SurfacePairs(one, 3, {0, 0.1}), std::invalid_argument);
  BOOST_CHECK_THROW(SurfacePairs(one, 3, {0.1, 0}), std::invalid_argument);
  SurfacePairs pairs(one, 3, {0.1, 0.1});
  const Places x{{0, 0, 0}, {1, 0, 0}, {0, 0, 1}};
  BOOST_TEST(pairs.proximities(x, 0.1).empty());
  BOOST_CHECK_THROW(pairs.proximities(x, 0.2), std::invalid_argument);
  BOOST_CHECK_THROW(pairs.proximities(std::span(x).first(2), 0.1), std::invalid_argument);
  BOOST_CHECK_THROW(pairs.collisions(x, Places{{0, 0, 0}, {NAN, 0, 0}, {0, 0, 1}}), std::invalid_argument);
}

BOOST_AUTO_TEST_SUITE_END()
