// Obstacles as faces for a picture, small ones: gnuplot draws what is behind first, face by face, so that a
// large one would come before what it hides in part, or after what hides it.
#pragma once

#include <Eigen/Geometry>
#include <vector>

#include "experiments/inputs/mesh_input.h"
#include "solvers/contact/contact.h"

namespace springstab {

struct PlacedFaces {
  std::vector<Eigen::Vector3d> places;  // [m]
  Faces faces;                          // numbers of places
};

/// At the time t [s], as far as they are in sight: squares, and of meshes triangles, that fit into one of
/// `size` [m], or nearly.
PlacedFaces obstacle_faces(const Contact& contact, double t, const Eigen::AlignedBox3d& sight, double size);

/// Around balls and meshes at the time t; empty where there are none.
Eigen::AlignedBox3d box_of_obstacles(const Contact& contact, double t);

}  // namespace springstab
