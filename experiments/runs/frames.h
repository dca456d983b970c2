// Frames of a run, one file each: a mesh as OBJ or legacy VTK, or a row of a CSV file for matrices.
#pragma once

#include <Eigen/Core>
#include <string>
#include <vector>

#include "solvers/scene/mesh.h"

namespace springstab {

/// DIR/frame_00012.obj or .vtk: positions of all particles and the faces of the mesh; as OBJ with what the
/// mesh's own file `source` said of its faces. Throws InputError if it cannot be written.
void write_frame(const std::string& folder, const std::string& format, int frame,
                 const std::vector<Eigen::Vector3d>& positions, const std::vector<std::vector<int>>& faces,
                 const FaceAttributes& attributes = {}, const std::string& source = {});

/// Throws InputError unless such a file is there.
void expect_frame(const std::string& folder, const std::string& format, int frame);

/// Where it is.
std::string frame_path(const std::string& folder, const std::string& format, int frame);

/// Deletes such a file if it is there.
void remove_frame(const std::string& folder, const std::string& format, int frame);

}  // namespace springstab
