#include "render/encoding.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <array>
#include <span>
#include <string_view>

#include "render/libav.hpp"

namespace deforma {
namespace {

constexpr std::array<std::string_view, 10> x26_presets = {"ultrafast", "superfast", "veryfast", "faster",
                                                          "fast",      "medium",    "slow",     "slower",
                                                          "veryslow",  "placebo"};

/// What is to be known of an encoder beyond what libavcodec tells.
struct Encoder {
  std::string_view name;
  std::string_view pixel_format;  // unasked
  std::string_view alpha_format;  // unasked when transparent; empty: carries none
  std::span<const std::string_view> presets;
  std::string_view preset;  // unasked
  int worst_crf;            // 0: has no crf
  int crf;                  // unasked
};

// Measured on frames of cylinder_in_cylinder at 1280 x 720, CPU time and size per frame, signal-to-noise ratio of the
// luma. libx264 at crf 18: ultrafast 3.8 ms 8.6 KiB, superfast 6.7 ms 8.4 KiB 56.6 dB, veryfast 7.7 ms 2.1 KiB 53.7 dB,
// faster 13.5 ms 2.7 KiB 54.4 dB, medium 21.8 ms 2.4 KiB 54.5 dB, slow 30.7 ms 2.3 KiB. libx265 at crf 20: ultrafast 19 ms
// 1.2 KiB, veryfast 31 ms 1.5 KiB. So the presets are those beyond which time grows and nothing else does.
constexpr std::array encoders = {
    Encoder{"libx264", "yuv420p", "", x26_presets, "veryfast", 51, 18},
    Encoder{"libx264rgb", "rgb24", "", x26_presets, "veryfast", 51, 18},
    Encoder{"libx265", "yuv420p", "", x26_presets, "ultrafast", 51, 20},
    Encoder{"libvpx-vp9", "yuv420p", "yuva420p", {}, "", 63, 24},
    Encoder{"ffv1", "bgr0", "bgra", {}, "", 0, 0},
    Encoder{"prores_ks", "yuv422p10le", "yuva444p10le", {}, "", 0, 0},
    Encoder{"png", "rgb24", "rgba", {}, "", 0, 0},
    Encoder{"qtrle", "rgb24", "argb", {}, "", 0, 0},
    Encoder{"mpeg4", "yuv420p", "", {}, "", 51, 18},
    Encoder{"gif", "pal8", "", {}, "", 0, 0},
};

struct Container {
  std::string_view name;
  std::vector<std::string_view> codecs;  // the first that is there is taken
};

const std::array<Container, 5>& containers() {
  static const std::array<Container, 5> all = {
      Container{"mp4", {"libx264", "libx265", "mpeg4"}},
      Container{"mov", {"libx264", "libx265", "prores_ks", "qtrle", "png", "mpeg4"}},
      Container{"mkv", {"libx264", "libx264rgb", "libx265", "ffv1", "libvpx-vp9", "png", "mpeg4"}},
      Container{"webm", {"libvpx-vp9"}},
      Container{"gif", {"gif"}},
  };
  return all;
}

const Encoder& encoder_named(std::string_view name) {
  return *std::find_if(encoders.begin(), encoders.end(), [&](const Encoder& e) { return e.name == name; });
}

std::vector<std::string> with_alpha(const std::vector<std::string>& codecs) {
  std::vector<std::string> carrying;
  for (const std::string& name : codecs)
    if (!encoder_named(name).alpha_format.empty()) carrying.push_back(name);
  return carrying;
}

[[noreturn]] void refuse(std::string_view key, const std::string& found, const std::string& why,
                         std::vector<std::string> allowed) {
  const std::string message =
      allowed.empty() ? why : fmt::format("{} (allowed: {})", why, fmt::join(allowed, ", "));
  throw EncodingError(message, std::string(key), found, std::move(allowed));
}

const Encoder& choose_encoder(const std::string& container, const EncodingRequest& request) {
  const std::vector<std::string> all = video_codecs(container);
  const std::vector<std::string> codecs = request.transparent ? with_alpha(all) : all;
  if (request.transparent && codecs.empty()) {
    std::vector<std::string> carrying;
    for (const Container& other : containers())
      if (!with_alpha(video_codecs(std::string(other.name))).empty()) carrying.emplace_back(other.name);
    refuse("video", container, fmt::format("'{}' carries no transparency", container), carrying);
  }
  if (codecs.empty())
    throw std::runtime_error(fmt::format("this libavcodec has no encoder for {}", container));
  if (request.codec.empty()) return encoder_named(codecs.front());
  if (std::find(codecs.begin(), codecs.end(), request.codec) == codecs.end())
    refuse("codec", request.codec,
           fmt::format("'{}' {} in {}", request.codec,
                       std::find(all.begin(), all.end(), request.codec) != all.end()
                           ? "carries no transparency"
                           : "is no encoder for a video",
                       container),
           codecs);
  return encoder_named(request.codec);
}

/// Those the encoder takes and that pictures can be converted to.
std::vector<std::string> pixel_formats(const Encoder& encoder, bool transparent) {
  std::vector<std::string> names;
  const AVCodec* codec = avcodec_find_encoder_by_name(std::string(encoder.name).c_str());
  for (const AVPixelFormat* format = codec->pix_fmts; format && *format != AV_PIX_FMT_NONE; ++format) {
    const std::string name = av_get_pix_fmt_name(*format);
    const bool indexed = name == "pal8";
    const bool alpha = av_pix_fmt_desc_get(*format)->flags & AV_PIX_FMT_FLAG_ALPHA;
    // The formats named yuvj are deprecated, and would be tagged as full range.
    if (indexed != (encoder.name == "gif") || (transparent && !alpha) || name.starts_with("yuvj")) continue;
    if (indexed || sws_isSupportedOutput(*format)) names.push_back(name);
  }
  return names;
}

std::string choose_preset(const Encoder& encoder, const std::string& wanted) {
  if (wanted.empty()) return std::string(encoder.preset);
  if (encoder.presets.empty())
    refuse("preset", wanted, fmt::format("the codec {} has no presets; leave it out", encoder.name), {});
  if (std::find(encoder.presets.begin(), encoder.presets.end(), wanted) == encoder.presets.end())
    refuse("preset", wanted, fmt::format("'{}' is no preset of {}", wanted, encoder.name),
           {encoder.presets.begin(), encoder.presets.end()});
  return wanted;
}

std::string choose_pixel_format(const Encoder& encoder, const EncodingRequest& request) {
  const std::string& wanted = request.pixel_format;
  if (wanted.empty()) return std::string(request.transparent ? encoder.alpha_format : encoder.pixel_format);
  std::vector<std::string> formats = pixel_formats(encoder, request.transparent);
  if (std::find(formats.begin(), formats.end(), wanted) == formats.end())
    refuse("pix_fmt", wanted,
           fmt::format("'{}' is no pixel format {}of {}", wanted,
                       request.transparent ? "with transparency " : "", encoder.name),
           std::move(formats));
  return wanted;
}

std::optional<int> choose_crf(const Encoder& encoder, std::optional<int> wanted) {
  if (encoder.worst_crf == 0) {
    if (wanted)
      refuse("crf", std::to_string(*wanted),
             fmt::format("the codec {} has no crf; leave it out", encoder.name), {});
    return std::nullopt;
  }
  const int crf = wanted.value_or(encoder.crf);
  if (crf < 0 || crf > encoder.worst_crf)
    refuse("crf", std::to_string(crf),
           fmt::format("the crf of {} is from 0 to {}, not {}", encoder.name, encoder.worst_crf, crf), {});
  return crf;
}

}  // namespace

const std::vector<std::string>& video_containers() {
  static const std::vector<std::string> names = [] {
    std::vector<std::string> all;
    for (const Container& container : containers()) all.emplace_back(container.name);
    return all;
  }();
  return names;
}

std::vector<std::string> video_codecs(const std::string& container) {
  for (const Container& known : containers()) {
    if (known.name != container) continue;
    std::vector<std::string> codecs;
    for (const std::string_view name : known.codecs)
      if (avcodec_find_encoder_by_name(std::string(name).c_str())) codecs.emplace_back(name);
    return codecs;
  }
  refuse("video", container, fmt::format("'{}' is no kind of video file", container), video_containers());
}

Encoding choose_encoding(const std::string& container, const EncodingRequest& request) {
  const Encoder& encoder = choose_encoder(container, request);
  Encoding encoding;
  encoding.codec = encoder.name;
  encoding.preset = choose_preset(encoder, request.preset);
  encoding.pixel_format = choose_pixel_format(encoder, request);
  encoding.crf = choose_crf(encoder, request.crf);
  return encoding;
}

}  // namespace deforma
