// A force term of one's own, from the energy of one element and its two derivatives:
//
//     // A tether: 5 N/m towards the place where the particle was at rest.
//     const auto tether = [rest = net.rest[12]](int, const Eigen::Vector3d& at) {
//       const Eigen::Vector3d pull = 5 * (at - rest);
//       return ElementEnergy<1>{pull.dot(at - rest) / 2, pull, 5 * Eigen::Matrix3d::Identity()};
//     };
//     scene.add(element_term<1>("tethers", {{12}}, tether));
//
// Every evaluation asks for all three. Where that is too slow, derive from ElasticTerm (terms.h) with the
// loops of elements.h.
#pragma once

#include <Eigen/Core>
#include <array>
#include <functional>
#include <string>
#include <vector>

#include "solvers/linear/dense_solvers.h"
#include "solvers/scene/terms.h"

namespace springstab {

/// At the places of an element's corners: 3 numbers for each corner, one corner after another.
template <int corners>
struct ElementEnergy {
  double energy = 0;                                        // E [J]
  Eigen::Vector<double, 3 * corners> gradient;              // ∂E/∂x [N]
  Eigen::Matrix<double, 3 * corners, 3 * corners> hessian;  // ∂²E/∂x² [N/m], symmetric
};

/// Of element number e with its corners at these places [m], a column for each.
template <int corners>
using ElementLaw =
    std::function<ElementEnergy<corners>(int element, const Eigen::Matrix<double, 3, corners>& at)>;

template <int corners>
class ElementTerm final : public ElasticTerm {
 public:
  using Particles = std::array<int, corners>;

  /// `elements` in a scene's numbers, the first `free_count` of which can move.
  ElementTerm(std::string name, std::vector<Particles> elements, int free_count, ElementLaw<corners> law)
      : name_(std::move(name)),
        elements_(std::move(elements)),
        free_count_(free_count),
        law_(std::move(law)) {}

  std::string_view name() const override { return name_; }
  int size() const override { return static_cast<int>(elements_.size()); }
  double energy(const ParticleField& x) const override {
    double sum = 0;
    for (int e = 0; e < size(); ++e) sum += at(x, e).energy;
    return sum;
  }
  void add_force(const ParticleField& x, double* force) const override {
    for (int e = 0; e < size(); ++e) scatter(-at(x, e).gradient, e, force);
  }
  void add_stiffness_times(const ParticleField& x, const double* u, double scale,
                           double* out) const override {
    for (int e = 0; e < size(); ++e) {
      Eigen::Vector<double, 3 * corners> moved = Eigen::Vector<double, 3 * corners>::Zero();
      for (int c = 0; c < corners; ++c)
        if (is_free(e, c)) moved.template segment<3>(3 * c) = Eigen::Vector3d::Map(u + offset(e, c));
      scatter(scale * (at(x, e).hessian * moved), e, out);
    }
  }
  Couplings couplings() const override {
    Couplings pairs;
    for (int e = 0; e < size(); ++e)
      for (int c = 0; c < corners; ++c)
        for (int d = c + 1; d < corners; ++d)
          if (is_free(e, c) && is_free(e, d)) pairs.emplace_back(elements_[e][c], elements_[e][d]);
    return pairs;
  }
  void add_stiffness(const ParticleField& x, BlockSparseMatrix& stiffness) const override {
    for (int e = 0; e < size(); ++e) add_blocks(at(x, e).hessian, e, stiffness);
  }
  /// Without the parts of each element's Hessian along its negative eigenvalues.
  void add_projected_stiffness(const ParticleField& x, BlockSparseMatrix& stiffness) const override {
    for (int e = 0; e < size(); ++e) {
      const Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd> modes(Eigen::MatrixXd(at(x, e).hessian));
      add_blocks(modes.eigenvectors() * modes.eigenvalues().cwiseMax(0).asDiagonal() *
                     modes.eigenvectors().transpose(),
                 e, stiffness);
    }
  }

 private:
  using Hessian = Eigen::Matrix<double, 3 * corners, 3 * corners>;

  bool is_free(int e, int corner) const { return elements_[e][corner] < free_count_; }
  long offset(int e, int corner) const { return 3 * static_cast<long>(elements_[e][corner]); }

  ElementEnergy<corners> at(const ParticleField& x, int e) const {
    Eigen::Matrix<double, 3, corners> places;
    for (int c = 0; c < corners; ++c) places.col(c) = Eigen::Vector3d::Map(x[elements_[e][c]]);
    return law_(e, places);
  }
  void scatter(const Eigen::Vector<double, 3 * corners>& vectors, int e, double* out) const {
    for (int c = 0; c < corners; ++c)
      if (is_free(e, c)) Eigen::Vector3d::Map(out + offset(e, c)) += vectors.template segment<3>(3 * c);
  }
  void add_blocks(const Hessian& hessian, int e, BlockSparseMatrix& matrix) const {
    for (int c = 0; c < corners; ++c)
      for (int d = 0; d < corners; ++d) {
        const int i = elements_[e][c], j = elements_[e][d];
        if (j > i || !is_free(e, c) || !is_free(e, d)) continue;
        const long place = i == j ? matrix.diagonal(i) : matrix.find(i, j);
        Eigen::Map<Block3>(matrix.block(place)) += hessian.template block<3, 3>(3 * c, 3 * d);
      }
  }

  std::string name_;
  std::vector<Particles> elements_;
  int free_count_;
  ElementLaw<corners> law_;
};

/// For Scene::add, of elements by the particles' original numbers. `name` says what they are, in the plural.
template <int corners>
TermMaker element_term(std::string name, std::vector<std::array<int, corners>> elements,
                       ElementLaw<corners> law) {
  return [=](const std::vector<int>& number, int free_count) {
    std::vector<std::array<int, corners>> numbered = elements;
    for (auto& element : numbered)
      for (int& particle : element) particle = number.at(static_cast<std::size_t>(particle));
    SceneTerms terms;
    terms.elastic.push_back(
        std::make_unique<ElementTerm<corners>>(name, std::move(numbered), free_count, law));
    return terms;
  };
}

}  // namespace springstab
