// Contact as it was described, made ready: its meshes read, and seen to be apart from the cloth.
#pragma once

#include <functional>
#include <string>
#include <vector>

#include "experiments/inputs/scene_description.h"
#include "solvers/system.h"

namespace springstab {

/// The contact with its meshes. What is to be known of them is added to `notes`, each with its file's name
/// before it. Throws InputError for meshes that cannot be used, and where surfaces cannot be paired.
Contact contact_of(const ContactDescription& description, std::vector<std::string>& notes);

/// How a cloth's surface is named in messages.
struct SurfaceNames {
  std::function<std::string(int node)> particle;
  std::vector<int> face;  // of each triangle
};

/// Throws InputError where the cloth has none that surfaces could meet.
void expect_faces(const ContactDescription& description, const ClothSurface& surface);

/// Throws InputError where the cloth, of free particles at x, cuts itself or a mesh, or is nearer than the
/// thickness.
void expect_surfaces_apart(const ContactDescription& description, const Contact& contact,
                           const ClothSurface& surface, const Vector& x, const SurfaceNames& names);

}  // namespace springstab
