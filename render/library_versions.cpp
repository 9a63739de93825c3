#include "render/library_versions.hpp"

#include <fmt/format.h>
#include <png.h>

#include "render/libav.hpp"

namespace deforma {

std::vector<std::pair<std::string, std::string>> render_library_versions() {
  const auto text = [](unsigned version) {
    return fmt::format("{}.{}.{}", AV_VERSION_MAJOR(version), AV_VERSION_MINOR(version),
                       AV_VERSION_MICRO(version));
  };
  return {{"libpng", png_get_libpng_ver(nullptr)},
          {"libavcodec", text(avcodec_version())},
          {"libavformat", text(avformat_version())},
          {"libavutil", text(avutil_version())},
          {"libswscale", text(swscale_version())}};
}

}  // namespace deforma
