// The frames of a run of any simulator, from files: positions, and nothing else of them.
#pragma once

#include <Eigen/Core>
#include <string>
#include <vector>

namespace springstab {

/// A run, a column for each frame; in it the `components` numbers of each vertex stand together.
struct RunFrames {
  Eigen::MatrixXd positions;
  int components = 1;                // of a vertex; 1 where there are but numbers
  std::vector<std::string> files{};  // of each frame; empty where they are in one file
};

/// Reads a folder of .obj, .ply, .vtk or .npy files, one a frame, in the order of the numbers in their names,
/// or one .npy file of all: (frames, vertices, 3) or (frames, numbers). What is not finite is kept as it is.
/// Of meshes only the vertices are read, so that a blown-up one can be. Throws InputError where there are
/// fewer than two frames, frames of different sizes or of more than one kind, and for what is no position.
RunFrames read_frames(const std::string& path);

}  // namespace springstab
