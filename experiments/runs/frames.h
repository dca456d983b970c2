// Frames of a run, one file each: a mesh as OBJ, PLY, or VTK of either family.
#pragma once

#include <Eigen/Core>
#include <string>
#include <vector>

#include "solvers/scene/mesh.h"

namespace springstab {

/// DIR/frame_00012.obj, .ply or .vtk, of the format pvd .vtp, of gltf .bin: positions of all particles and
/// the faces of the mesh; as OBJ with what the mesh's own file `source` said of its faces. Throws InputError
/// if it cannot be written.
void write_frame(const std::string& folder, const std::string& format, int frame,
                 const std::vector<Eigen::Vector3d>& positions, const std::vector<std::vector<int>>& faces,
                 const FaceAttributes& attributes = {}, const std::string& source = {});

/// What makes one animation of the frames of the format pvd (DIR/frames.pvd) or gltf (DIR/frames.gltf), with
/// the time [s] of each; nothing of other formats. Throws InputError if it cannot be written.
void write_series(const std::string& folder, const std::string& format, const std::vector<double>& times,
                  const std::vector<std::vector<int>>& faces);

/// Throws InputError unless such a file is there.
void expect_frame(const std::string& folder, const std::string& format, int frame);

/// Where it is.
std::string frame_path(const std::string& folder, const std::string& format, int frame);

/// Deletes such a file if it is there.
void remove_frame(const std::string& folder, const std::string& format, int frame);

}  // namespace springstab
