#pragma once

#include <optional>
#include <stdexcept>
#include <string>
#include <vector>

namespace deforma {

/// What is asked of a video's encoder, by the names that ffmpeg has for it; what is empty is chosen.
struct EncodingRequest {
  std::string codec = {};         ///< an encoder's name, such as libx264
  std::string preset = {};        ///< how much time is spent to save bytes
  std::string pixel_format = {};  ///< such as yuv420p
  std::optional<int> crf = {};    ///< constant rate factor, lower is better
  bool transparent = false;       ///< alpha is kept
};

/// How a video is encoded. What the encoder does not have is empty.
struct Encoding {
  std::string codec;
  std::string preset;
  std::string pixel_format;
  std::optional<int> crf;
};

/// One wish that cannot be met.
class EncodingError : public std::invalid_argument {
 public:
  EncodingError(const std::string& message, std::string key, std::string found,
                std::vector<std::string> allowed)
      : std::invalid_argument(message),
        key(std::move(key)),
        found(std::move(found)),
        allowed(std::move(allowed)) {}

  std::string key;                   ///< of the wish: "video", "codec", "preset", "pix_fmt" or "crf"
  std::string found;                 ///< what was wished for
  std::vector<std::string> allowed;  ///< instead; empty when the codec takes no such wish
};

/// The kinds of video file: mp4, mov, mkv, webm, gif.
const std::vector<std::string>& video_containers();

/// The encoders that can be asked for in a container, those first that are taken unasked; only such as this libavcodec has.
/// @throws EncodingError for an unknown container.
std::vector<std::string> video_codecs(const std::string& container);

/// Fills in what is not asked for, and checks the rest against what the encoder itself takes.
/// @throws EncodingError for the first wish that cannot be met; std::runtime_error when libavcodec has no encoder for
///         the container.
Encoding choose_encoding(const std::string& container, const EncodingRequest& request);

}  // namespace deforma
