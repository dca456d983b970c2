// The key `contact` of a scene file.
#pragma once

#include <string>

#include "experiments/inputs/json_with_lines.h"
#include "experiments/inputs/scene_description.h"

namespace springstab {

/// {"obstacles": [{"plane": {"point", "normal"}}, {"sphere": {"center", "radius"}} or {"mesh": path}, with
/// "velocity"], "self", "thickness", "friction", "model": "impulses", "inelastic" or {"penalty":
/// {"stiffness", "damping"}}}. Throws InputError(source, line, ...).
ContactDescription read_contact(const std::string& source, const JsonValue& json);

}  // namespace springstab
