#pragma once

#include <filesystem>
#include <memory>

#include "render/encoding.hpp"
#include "render/image.hpp"

namespace deforma {

struct VideoSettings {
  int width = 1280;
  int height = 720;
  double fps = 25.0;
  EncodingRequest encoding = {};
};

/// Encodes frames to a file whose container follows from its extension (mp4, mkv, mov, webm, gif). BT.709 tagged, mp4 and
/// mov with the index at the front. Odd sizes are padded by one row or column, unless red, green and blue are kept as
/// they are. Written under a temporary name and renamed by `close`.
class VideoWriter {
 public:
  /// @throws std::invalid_argument for settings out of range or an unknown extension (the message lists
  /// them), EncodingError for an encoding that cannot be had;
  ///         std::runtime_error naming the file when it cannot be opened or no encoder is there.
  VideoWriter(const std::filesystem::path& file, const VideoSettings& settings);
  ~VideoWriter();  ///< without `close`, removes what was written
  VideoWriter(VideoWriter&&) noexcept;
  VideoWriter& operator=(VideoWriter&&) noexcept;

  const Encoding& encoding() const;  ///< what was chosen

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
