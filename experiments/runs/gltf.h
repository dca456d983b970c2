// Frames as one animation in glTF 2.0: the first frame is the mesh, every other one
// a morph target, the differences from it, and the weight of each goes to 1 at its time and back to 0.
#pragma once

#include <Eigen/Core>
#include <string>
#include <vector>

namespace springstab {

/// The content of a frame's file: single precision, of the first frame (`first` is empty) the positions, else
/// the differences from what the file `first` has. Throws InputError if that cannot be read.
std::string gltf_frame(const std::string& first, const std::vector<Eigen::Vector3d>& positions);

/// FOLDER/frames.gltf, and beside it frames.bin with triangles, times [s] and weights, over the frames'
/// files, up to the first frame that is not finite. Throws InputError if one cannot be read or written.
void write_gltf(const std::string& folder, const std::vector<std::string>& frames,
                const std::vector<double>& times, const std::vector<std::vector<int>>& faces);

}  // namespace springstab
