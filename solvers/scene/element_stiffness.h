// The stiffness matrix of every single element, of which K is the sum. They are the blocks of K of a cloth
// whose elements share no particle, each with copies of its own corners: no energy is written a second time.
#pragma once

#include <Eigen/Core>
#include <functional>
#include <span>
#include <string_view>
#include <vector>

namespace springstab {

struct SpringNet;
struct TriangleCloth;
struct TetSolid;

/// kind: spring, triangle (stretch and shear), hinge (bending) or altitude; index: its number among the
/// cloth's own of that kind; particles: its corners; stiffness: 3 numbers a corner, exact [N/m].
using ElementVisitor = std::function<void(std::string_view kind, long index, std::span<const int> particles,
                                          const Eigen::MatrixXd& stiffness)>;

/// Of all elements that have stiffness, the particles being at these places [m].
void visit_elements(const SpringNet& net, const std::vector<Eigen::Vector3d>& at,
                    const ElementVisitor& visit);
void visit_elements(const TriangleCloth& cloth, const std::vector<Eigen::Vector3d>& at,
                    const ElementVisitor& visit);
void visit_elements(const TetSolid& solid, const std::vector<Eigen::Vector3d>& at,
                    const ElementVisitor& visit);

}  // namespace springstab
