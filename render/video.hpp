#pragma once

#include <filesystem>
#include <memory>

#include "render/image.hpp"

namespace deforma {

struct VideoSettings {
  int width = 1280;
  int height = 720;
  double fps = 25.0;
  int crf = 18;  ///< constant rate factor, lower is better
};

/// Encodes frames to a file whose container follows from its extension (mp4, mkv, mov, webm, gif). H.264
/// yuv420p where the container takes it, BT.709 tagged, index at the front. Odd sizes are padded by one row
/// or column. Written under a temporary name and renamed by `close`.
class VideoWriter {
 public:
  /// @throws std::invalid_argument for settings out of range or an unknown extension (the message lists
  /// them);
  ///         std::runtime_error naming the file when it cannot be opened or no encoder is there.
  VideoWriter(const std::filesystem::path& file, const VideoSettings& settings);
  ~VideoWriter();  ///< without `close`, removes what was written
  VideoWriter(VideoWriter&&) noexcept;
  VideoWriter& operator=(VideoWriter&&) noexcept;

  void add(const Image& frame);  ///< @throws std::invalid_argument for another size, std::runtime_error
  void close();                  ///< flushes, finishes the container and renames; @throws std::runtime_error

 private:
  struct Data;
  std::unique_ptr<Data> data_;
};

/// What a video file holds, read back from it.
struct VideoFacts {
  int width = 0;
  int height = 0;
  double fps = 0.0;
  double duration = 0.0;   ///< [s]
  std::size_t frames = 0;  ///< decoded
  std::string codec;
  std::string pixel_format;
};

/// @throws std::runtime_error naming the file when it is no video.
VideoFacts inspect_video(const std::filesystem::path& file);

}  // namespace deforma
