#include "solvers/contact/kept_pairs.h"

#include <algorithm>
#include <cmath>
#include <stdexcept>
#include <string>

namespace springstab {
namespace {

constexpr double shortened = 1 - 1e-6;        // of a normal: rounding is far less
constexpr double beyond_rounding = 1 + 1e-5;  // of a distance along a normal in single precision
constexpr double least_apart = 1e-3;          // of the reach, by which a plane must be clear
constexpr std::size_t most_around = 16;       // faces of a particle, for their pairs to be kept

void append_own_features(const Surface& surface, int vertex_offset, int edge_offset,
                         std::vector<OwnFeatures>& list) {
  std::vector<bool> vertex_has(surface.vertices.size()), edge_has(surface.edges.size());
  const auto take = [](const auto& sorted, const auto& wanted, std::vector<bool>& has) {
    const auto at = std::lower_bound(sorted.begin(), sorted.end(), wanted) - sorted.begin();
    const bool is_free = !has[at];
    has[at] = true;
    return is_free ? static_cast<int>(at) : -1;
  };
  for (const std::array<int, 3>& t : surface.triangles) {
    OwnFeatures own;
    for (int k = 0; k < 3; ++k) {
      const std::array<int, 2> edge{std::min(t[k], t[(k + 1) % 3]), std::max(t[k], t[(k + 1) % 3])};
      const int v = take(surface.vertices, t[k], vertex_has), e = take(surface.edges, edge, edge_has);
      if (v >= 0) own.vertices[own.vertex_count++] = vertex_offset + v;
      if (e >= 0) own.edges[own.edge_count++] = edge_offset + e;
    }
    list.push_back(own);
  }
}

Eigen::Array4d padded(const Eigen::Vector3d& x) { return {x[0], x[1], x[2], 0}; }

Box around_both(const Box& a, const Box& b) { return {a.low.min(b.low), a.high.max(b.high)}; }
MovingBox around_both(const MovingBox& a, const MovingBox& b) {
  return {around_both(a.start, b.start), around_both(a.end, b.end)};
}

template <std::size_t n>
MovingBox box_around(const std::vector<MovingBox>& of, const std::array<int, n>& particles) {
  MovingBox box = of[particles[0]];
  for (std::size_t k = 1; k < n; ++k) box = around_both(box, of[particles[k]]);
  return box;
}

// The distance of the two parts' projections on n.
double gap_along(const Eigen::Vector3d& n, PairKind kind, const std::array<int, 4>& p,
                 KeptPairs::PlaceList x) {
  const Eigen::Vector3d& origin = x[p[0]];
  const double b = n.dot(x[p[1]] - origin), c = n.dot(x[p[2]] - origin), d = n.dot(x[p[3]] - origin);
  return kind == PairKind::vertex_face ? -std::max({b, c, d}) : std::min(0., b) - std::max(c, d);
}

void expect_positive(const PairDistances& at) {
  if (!(at.reach > 0 && at.skin > 0))
    throw std::invalid_argument("surfaces are paired with a reach of " + std::to_string(at.reach) +
                                " m and a skin of " + std::to_string(at.skin) + " m, expected positive ones");
}

template <class T>
std::vector<T> joined_lists(std::vector<T> first, const std::vector<T>& second) {
  first.insert(first.end(), second.begin(), second.end());
  return first;
}

}  // namespace

KeptPairs::KeptPairs(const Surface& first, const Surface& second, int free_count, PairDistances distances)
    : faces_(joined_lists(first.triangles, second.triangles)),
      edges_(joined_lists(first.edges, second.edges)),
      vertices_(joined_lists(first.vertices, second.vertices)),
      first_faces_(static_cast<int>(first.triangles.size())),
      free_count_(free_count),
      particles_(*std::max_element(vertices_.begin(), vertices_.end()) + 1),
      distances_(distances),
      ways_(vertices_, particles_, distances.skin / 2),
      middle_(particles_),
      face_normal_(faces_.size()),
      along_normal_(faces_.size()),
      of_particle_(particles_),
      of_edge_(edges_.size()),
      of_face_(faces_.size()),
      around_faces_(faces_.size()),
      astray_(particles_),
      of_stray_(particles_),
      boxes_(first_faces_, static_cast<int>(second.triangles.size())),
      ways_from_(particles_, Eigen::Vector3d::Zero()),
      ways_to_(ways_from_),
      last_(ways_from_) {
  expect_positive(distances);
  append_own_features(first, 0, 0, own_);
  append_own_features(second, static_cast<int>(first.vertices.size()), static_cast<int>(first.edges.size()),
                      own_);
  list_adjacent();
}

bool KeptPairs::are_adjacent(int f, int g) const {
  const std::array<int, 3>&a = joints_[f], &b = joints_[g];
  bool shared = false;
  for (int k = 0; k < 3; ++k) shared |= a[0] == b[k] || a[1] == b[k] || a[2] == b[k];
  return shared;
}

// Of faces that share a particle of few.
void KeptPairs::list_adjacent() {
  std::vector<std::vector<int>> around(particles_);
  for (int f = 0; f < std::ssize(faces_); ++f)
    for (const int i : faces_[f]) around[i].push_back(f);
  joints_ = faces_;
  int none = 0;
  for (std::array<int, 3>& joints : joints_)
    for (int& i : joints)
      if (around[i].size() > most_around) i = --none;
  for (int f = 0; f < std::ssize(faces_); ++f) {
    std::vector<int> next;
    for (const int i : joints_[f])
      if (i >= 0)
        std::copy_if(around[i].begin(), around[i].end(), std::back_inserter(next),
                     [&](int g) { return g > f; });
    std::sort(next.begin(), next.end());
    next.erase(std::unique(next.begin(), next.end()), next.end());
    for (const int g : next)
      for_each_own_pair(f, g, [&](PairKind kind, int i, int j) {
        if (is_wanted(kind, particles_of(kind, i, j)))
          adjacent_[number_of(kind)].push_back({{i, j}, Eigen::Vector3f::Zero()});
      });
  }
}

std::array<int, 4> KeptPairs::particles_of(PairKind kind, int i, int j) const {
  if (kind == PairKind::vertex_face) return {vertices_[i], faces_[j][0], faces_[j][1], faces_[j][2]};
  return {edges_[i][0], edges_[i][1], edges_[j][0], edges_[j][1]};
}

bool KeptPairs::is_astray(std::span<const int> particles) const {
  return std::any_of(particles.begin(), particles.end(), [&](int i) { return astray_[i]; });
}

bool KeptPairs::is_wanted(PairKind kind, const std::array<int, 4>& p) const {
  if (*std::min_element(p.begin(), p.end()) >= free_count_) return false;
  if (of_strays_ && !is_astray(p)) return false;
  if (kind == PairKind::vertex_face) return p[0] != p[1] && p[0] != p[2] && p[0] != p[3];
  return p[0] != p[2] && p[0] != p[3] && p[1] != p[2] && p[1] != p[3];
}

void KeptPairs::cover(PlaceList x0, PlaceList x1) {
  for (const PlaceList x : {x0, x1})
    if (std::ssize(x) < particles_)
      throw std::invalid_argument("there are places of " + std::to_string(x.size()) +
                                  " particles, expected " + std::to_string(particles_));
  if (ways_.hold(x0) && (x0.data() == x1.data() || ways_.hold(x1))) return;
  if (ways_.follow(x0, x1))
    find_of_strays();
  else
    find_all(x0, x1);
  const float now = come_nearer(x0, x0);
  for (PairList& list : found_) {
    list.sort(static_cast<int>(std::max({vertices_.size(), edges_.size(), faces_.size()})));
    list.set_back(now);
  }
  nearer_ = 0;
}

void KeptPairs::place_particle(int i) {
  middle_[i] = ways_.middle(i);
  ways_from_[i] = middle_[i] - ways_.half_way(i);
  ways_to_[i] = middle_[i] + ways_.half_way(i);
  const Eigen::Array4d middle = padded(middle_[i]), way = padded(ways_.own_half_way(i)),
                       reach = padded(Eigen::Vector3d::Constant((distances_.reach + distances_.skin) / 2));
  const Eigen::Array4d start = middle - way, end = middle + way;
  of_particle_[i] = {{start - reach, start + reach}, {end - reach, end + reach}};
}

void KeptPairs::place_face(std::size_t f) {
  const std::array<int, 3>& p = faces_[f];
  of_face_[f] = box_around(of_particle_, p);
  face_normal_[f] =
      shortened * (middle_[p[1]] - middle_[p[0]]).cross(middle_[p[2]] - middle_[p[0]]).stableNormalized();
  const auto along = [&](int k) { return face_normal_[f].dot(ways_.half_way(p[k])); };
  along_normal_[f] = {std::min({along(0), along(1), along(2)}), std::max({along(0), along(1), along(2)})};
}

void KeptPairs::find_all(PlaceList x0, PlaceList x1) {
  ++counts_.rebuilds;
  ways_.foresee(x0, x1);
  for (const int i : vertices_) place_particle(i);
  for (std::size_t i = 0; i < edges_.size(); ++i) of_edge_[i] = box_around(of_particle_, edges_[i]);
  for (std::size_t i = 0; i < faces_.size(); ++i) place_face(i);
  for (std::size_t i = 0; i < faces_.size(); ++i) around_faces_[i] = of_face_[i].all();
  for (PairList& list : found_) list.clear();
  boxes_.for_each(around_faces_, [&](int f, int g) {
    if (of_face_[f].meets(of_face_[g]) && !are_adjacent(f, g)) keep_of_faces(f, g);
  });
  keep_adjacent();
}

// All pairs with one of them, and no others.
void KeptPairs::find_of_strays() {
  ++counts_.strays;
  for (const int i : ways_.strays()) {
    astray_[i] = true;
    place_particle(i);
  }
  for (const PairKind kind : {PairKind::vertex_face, PairKind::edge_edge})
    found_[number_of(kind)].remove_if(
        [&](const KeptPair& kept) { return is_astray(particles_of(kind, kept.parts[0], kept.parts[1])); });
  for (std::size_t i = 0; i < edges_.size(); ++i)
    if (is_astray(edges_[i])) of_edge_[i] = box_around(of_particle_, edges_[i]);
  for (std::size_t f = 0; f < faces_.size(); ++f)
    if (is_astray(faces_[f])) place_face(f);
  find_near_strays();
  of_strays_ = true;
  const bool of_two = first_faces_ < std::ssize(faces_);
  for (const int f : near_strays_) {
    if (!is_astray(faces_[f])) continue;
    for (const int g : near_strays_)
      if ((f < g || !is_astray(faces_[g])) && (!of_two || (f < first_faces_) != (g < first_faces_)))
        if (of_face_[f].meets(of_face_[g])) keep_of_faces(f, g);
  }
  of_strays_ = false;
  for (const int i : ways_.strays()) astray_[i] = false;
}

// The faces whose boxes meet that around all faces of a stray.
void KeptPairs::find_near_strays() {
  for (const int i : ways_.strays()) of_stray_[i] = of_particle_[i];
  for (std::size_t f = 0; f < faces_.size(); ++f)
    for (const int i : faces_[f])
      if (astray_[i]) of_stray_[i] = around_both(of_stray_[i], of_face_[f]);
  near_strays_.clear();
  for (int f = 0; f < std::ssize(faces_); ++f)
    if (std::any_of(ways_.strays().begin(), ways_.strays().end(),
                    [&](int i) { return of_stray_[i].meets(of_face_[f]); }))
      near_strays_.push_back(f);
}

// Of vertices and edges for which the two faces stand, with those of the other one.
template <class Visit>
void KeptPairs::for_each_own_pair(int f, int g, const Visit& visit) const {
  const OwnFeatures &a = own_[f], &b = own_[g];
  for (int k = 0; k < a.vertex_count; ++k) visit(PairKind::vertex_face, a.vertices[k], g);
  for (int k = 0; k < b.vertex_count; ++k) visit(PairKind::vertex_face, b.vertices[k], f);
  for (int k = 0; k < a.edge_count; ++k)
    for (int l = 0; l < b.edge_count; ++l)
      visit(PairKind::edge_edge, std::min(a.edges[k], b.edges[l]), std::max(a.edges[k], b.edges[l]));
}

void KeptPairs::keep_of_faces(int f, int g) {
  if (plane_parts(f, g) || plane_parts(g, f)) return;
  for_each_own_pair(f, g, [&](PairKind kind, int i, int j) {
    const bool meet = kind == PairKind::vertex_face ? of_particle_[vertices_[i]].meets(of_face_[j])
                                                    : of_edge_[i].meets(of_edge_[j]);
    const std::array<int, 4> p = particles_of(kind, i, j);
    if (meet && is_wanted(kind, p)) keep_if_near(kind, i, j, p);
  });
}

// Mostly the direction in which they last were apart still tells that they are, on all their ways.
void KeptPairs::keep_adjacent() {
  const double apart = beyond_rounding * (distances_.reach + distances_.skin);
  for (const PairKind kind : {PairKind::vertex_face, PairKind::edge_edge})
    for (KeptPair& pair : adjacent_[number_of(kind)]) {
      const std::array<int, 4> p = particles_of(kind, pair.parts[0], pair.parts[1]);
      const Eigen::Vector3d n = pair.normal.cast<double>();
      if (gap_along(n, kind, p, ways_from_) > apart && gap_along(n, kind, p, ways_to_) > apart) continue;
      pair.normal = keep_if_near(kind, pair.parts[0], pair.parts[1], p).cast<float>();
    }
}

// Whether a face's plane, which goes where the face goes, has the other face further away than what could
// come within reach.
bool KeptPairs::plane_parts(int f, int g) const {
  const std::array<int, 3>&a = faces_[f], &b = faces_[g];
  const Eigen::Vector3d& n = face_normal_[f];
  double low = HUGE_VAL, high = -HUGE_VAL;
  for (int k = 0; k < 3; ++k) {
    const double height = n.dot(middle_[b[k]] - middle_[a[0]]), to_go = n.dot(ways_.half_way(b[k])),
                 spread = std::max(to_go - along_normal_[f][0], along_normal_[f][1] - to_go);
    low = std::min(low, height - spread);
    high = std::max(high, height + spread);
  }
  return std::max(low, -high) > distances_.reach + distances_.skin;
}

// Two parts that come within reach are halfway at most that, the skin, and the furthest that a particle of
// the one goes beside one of the other in half of the time apart. Returns the direction in which they are
// apart then.
Eigen::Vector3d KeptPairs::keep_if_near(PairKind kind, int i, int j, const std::array<int, 4>& p) {
  const int split = kind == PairKind::vertex_face ? 1 : 2;
  double furthest = 0;
  for (int k = 0; k < split; ++k)
    for (int l = split; l < 4; ++l)
      furthest = std::max(furthest, (ways_.half_way(p[k]) - ways_.half_way(p[l])).squaredNorm());
  const double apart = distances_.reach + distances_.skin + std::sqrt(furthest);
  const FourPlaces at{middle_[p[0]], middle_[p[1]], middle_[p[2]], middle_[p[3]]};
  const Eigen::Vector3d difference = closest_places(kind, at).difference, n = difference.stableNormalized();
  if (!(difference.squaredNorm() > apart * apart)) found_[number_of(kind)].add(i, j, n);
  return n;
}

// By how much two places of the surfaces may have come nearer to each other: as far as the box of all ways is
// wide.
double KeptPairs::nearer_on_way(PlaceList x0, PlaceList x1) const {
  Eigen::Array3d low = Eigen::Array3d::Constant(HUGE_VAL), high = -low;
  for (const int i : vertices_) {
    const Eigen::Array3d way = x1[i] - x0[i];
    low = low.min(way);
    high = high.max(way);
  }
  return (high - low).matrix().norm();
}

// Until when a pair must be clear to be so all the way from x0 to x1, which is where the last places are
// then.
float KeptPairs::come_nearer(PlaceList x0, PlaceList x1) {
  const double after = nearer_ + nearer_on_way(last_, x1),
               before = x0.data() == x1.data() ? after : nearer_ + nearer_on_way(last_, x0);
  nearer_ = after;
  std::copy_n(x1.begin(), last_.size(), last_.begin());
  return static_cast<float>(std::max(before, after) * beyond_rounding);
}

// The least gap of a pair along its direction in a step; until when it is clear is known then.
double KeptPairs::gap_in_step(PairKind kind, const std::array<int, 4>& p, KeptPair& kept, PlaceList x0,
                              PlaceList x1) {
  ++counts_.tested;
  const double clear = (beyond_rounding + least_apart) * distances_.reach;
  const Eigen::Vector3d n = kept.normal.cast<double>();
  const double gap = gap_along(n, kind, p, x1);
  if (gap > clear) kept.clear_until = static_cast<float>((nearer_ + gap - clear) / beyond_rounding);
  return x0.data() == x1.data() ? gap : std::min(gap, gap_along(n, kind, p, x0));
}

bool KeptPairs::is_apart(double gap, double distance) const {
  return gap > beyond_rounding * distance + least_apart * distances_.reach;
}

}  // namespace springstab
