#pragma once

#include <sstream>
#include <string>

#include "assets/mesh.hpp"

namespace deforma {

/// A mesh as the text of an OBJ file.
inline std::string obj_text(const Mesh& mesh) {
  std::ostringstream text;
  text.precision(9);
  for (const auto& p : mesh.points) text << "v " << p.x() << " " << p.y() << " " << p.z() << "\n";
  for (const auto& t : mesh.triangles) text << "f " << t[0] + 1 << " " << t[1] + 1 << " " << t[2] + 1 << "\n";
  return text.str();
}

}  // namespace deforma
