#include "solvers/scene/element_stiffness.h"

#include <algorithm>
#include <numeric>

#include "solvers/scene/springs.h"
#include "solvers/scene/tet_solid.h"
#include "solvers/scene/triangle_cloth.h"

namespace springstab {
namespace {

constexpr std::size_t elements_at_once = 4096;

// The corners of an element, to be read and set.
template <class Element>
auto corners_of(const Element& element) {
  if constexpr (requires { element.particles; })
    return element.particles;
  else
    return std::array<int, 2>{element.i, element.j};
}

template <class Element, class Corners>
void set_corners(Element& element, const Corners& corners) {
  if constexpr (requires { element.particles; })
    element.particles = corners;
  else
    element.i = corners[0], element.j = corners[1];
}

// The diagonal block of one element whose corners have the numbers from `first` on.
Eigen::MatrixXd element_block(const BlockSparseMatrix& k, int first, int corners) {
  Eigen::MatrixXd block(3 * corners, 3 * corners);
  for (int c = 0; c < corners; ++c)
    for (int d = 0; d <= c; ++d) {
      const auto part = Eigen::Map<const Block3>(k.block(k.find(first + c, first + d)));
      block.block<3, 3>(3 * c, 3 * d) = part;
      block.block<3, 3>(3 * d, 3 * c) = part.transpose();
    }
  return block;
}

// `make` makes the terms of elements that share no particle.
template <class Element, class Make>
void visit_all(std::string_view kind, const std::vector<Element>& elements,
               const std::vector<Eigen::Vector3d>& at, Make make, const ElementVisitor& visit) {
  constexpr int corners = static_cast<int>(std::tuple_size_v<decltype(corners_of(Element{}))>);
  for (std::size_t begin = 0; begin < elements.size(); begin += elements_at_once) {
    const std::size_t count = std::min(elements_at_once, elements.size() - begin);
    std::vector<Element> apart(elements.begin() + static_cast<long>(begin),
                               elements.begin() + static_cast<long>(begin + count));
    std::vector<double> x;
    for (std::size_t e = 0; e < count; ++e) {
      auto own = corners_of(apart[e]);
      for (const int particle : own) x.insert(x.end(), at[particle].begin(), at[particle].end());
      std::iota(own.begin(), own.end(), corners * static_cast<int>(e));
      set_corners(apart[e], own);
    }
    const int particles = corners * static_cast<int>(count);
    std::vector<int> number(static_cast<std::size_t>(particles));
    std::iota(number.begin(), number.end(), 0);
    const SceneTerms terms = make(apart, number, particles);
    if (terms.elastic.empty()) continue;
    BlockSparseMatrix k(particles, terms.elastic.front()->couplings());
    terms.elastic.front()->add_stiffness({x.data(), nullptr, particles}, k);
    for (std::size_t e = 0; e < count; ++e) {
      const auto own = corners_of(elements[begin + e]);
      visit(kind, static_cast<long>(begin + e), own,
            element_block(k, corners * static_cast<int>(e), corners));
    }
  }
}

// A spring without stiffness is in no term: it gets one that does not count.
void visit_springs(const std::vector<Spring>& springs, const std::vector<Eigen::Vector3d>& at,
                   const ElementVisitor& visit) {
  std::vector<Spring> stiff = springs;
  for (Spring& spring : stiff)
    if (!(spring.stiffness > 0)) spring.stiffness = 1;
  visit_all(
      "spring", stiff, at,
      [](const std::vector<Spring>& apart, const std::vector<int>& number, int count) {
        return make_terms(SpringNet{{}, {}, apart}, number, count);
      },
      [&](std::string_view kind, long index, std::span<const int> particles, const Eigen::MatrixXd& k) {
        if (springs[static_cast<std::size_t>(index)].stiffness > 0) visit(kind, index, particles, k);
      });
}

}  // namespace

void visit_elements(const SpringNet& net, const std::vector<Eigen::Vector3d>& at,
                    const ElementVisitor& visit) {
  visit_springs(net.springs, at, visit);
}

void visit_elements(const TriangleCloth& cloth, const std::vector<Eigen::Vector3d>& at,
                    const ElementVisitor& visit) {
  TriangleCloth part;
  part.material = cloth.material;
  visit_all(
      "triangle", cloth.triangles, at,
      [part](const std::vector<RestTriangle>& apart, const std::vector<int>& number, int count) mutable {
        part.triangles = apart;
        return make_terms(part, number, count);
      },
      visit);
  visit_all(
      "hinge", cloth.hinges, at,
      [part](const std::vector<Hinge>& apart, const std::vector<int>& number, int count) mutable {
        part.hinges = apart;
        return make_terms(part, number, count);
      },
      visit);
}

void visit_elements(const TetSolid& solid, const std::vector<Eigen::Vector3d>& at,
                    const ElementVisitor& visit) {
  visit_springs(solid.edges, at, visit);
  visit_all(
      "altitude", solid.altitudes, at,
      [&](const std::vector<Altitude>& apart, const std::vector<int>& number, int count) {
        TetSolid part;
        part.material = solid.material;
        part.altitudes = apart;
        return make_terms(part, number, count);
      },
      visit);
}

}  // namespace springstab
