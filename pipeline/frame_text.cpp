#include "pipeline/frame_text.hpp"

#include <fmt/core.h>

#include "pipeline/report.hpp"

namespace deforma {

std::vector<std::pair<std::string, std::string>> frame_text(const Scene& scene, const std::string& scene_hash,
                                                            int frame) {
  return {{"Title", scene.name},
          {"Software", version_text()},
          {"Scene-SHA256", scene_hash},
          {"Frame", std::to_string(frame)},
          {"Time", fmt::format("{:.6g} s", (frame - 1) / scene.fps)}};
}

}  // namespace deforma
