#include "render/video.hpp"

#include <gmock/gmock.h>

#include <cmath>
#include <fstream>
#include <iterator>
#include <stdexcept>

#include "picture.hpp"
#include "render/libav.hpp"
#include "render/palette.hpp"

namespace deforma {
namespace {

using testing::AllOf;
using testing::ElementsAre;
using testing::HasSubstr;
using testing::IsEmpty;
using testing::ThrowsMessage;

/// A bright block that moves over an even colour.
Image frame_of(int width, int height, int number) {
  Image image{width, height, {}};
  for (int y = 0; y < height; ++y)
    for (int x = 0; x < width; ++x) {
      const bool block = x >= 4 * number && x < 4 * number + 20 && y < 20;
      const std::array<std::uint8_t, 4> color = block ? std::array<std::uint8_t, 4>{240, 240, 230, 255}
                                                      : std::array<std::uint8_t, 4>{200, 60, 30, 255};
      image.rgba.insert(image.rgba.end(), color.begin(), color.end());
    }
  return image;
}

void write_video(const std::filesystem::path& file, const VideoSettings& settings, int frames) {
  VideoWriter writer(file, settings);
  for (int i = 0; i < frames; ++i) writer.add(frame_of(settings.width, settings.height, i));
  writer.close();
}

/// The first picture of a file, decoded by libav as a player would.
/// @param name of the decoder; the usual one when empty
libav::Frame first_picture(const std::filesystem::path& file, const std::string& name = "") {
  AVFormatContext* opened = nullptr;
  EXPECT_EQ(avformat_open_input(&opened, file.c_str(), nullptr, nullptr), 0);
  const libav::Input input(opened);
  EXPECT_GE(avformat_find_stream_info(input.get(), nullptr), 0);
  const AVCodec* decoder = nullptr;
  const int stream = av_find_best_stream(input.get(), AVMEDIA_TYPE_VIDEO, -1, -1, &decoder, 0);
  if (!name.empty()) decoder = avcodec_find_decoder_by_name(name.c_str());
  const libav::Codec codec(avcodec_alloc_context3(decoder));
  avcodec_parameters_to_context(codec.get(), input->streams[stream]->codecpar);
  EXPECT_EQ(avcodec_open2(codec.get(), decoder, nullptr), 0);
  const libav::Packet packet(av_packet_alloc());
  libav::Frame frame(av_frame_alloc());
  while (av_read_frame(input.get(), packet.get()) >= 0) {
    avcodec_send_packet(codec.get(), packet.get());
    av_packet_unref(packet.get());
    if (avcodec_receive_frame(codec.get(), frame.get()) >= 0) return frame;
  }
  avcodec_send_packet(codec.get(), nullptr);
  EXPECT_GE(avcodec_receive_frame(codec.get(), frame.get()), 0);
  return frame;
}

/// A decoded picture as a player would show it, without the tags that only swscale needs to be told.
Image rgba_of(const AVFrame& frame) {
  Image image{frame.width, frame.height,
              std::vector<std::uint8_t>(4 * static_cast<std::size_t>(frame.width * frame.height))};
  const libav::Scaler scaler(sws_getContext(
      frame.width, frame.height, static_cast<AVPixelFormat>(frame.format), frame.width, frame.height,
      AV_PIX_FMT_RGBA, SWS_BICUBIC | SWS_ACCURATE_RND | SWS_BITEXACT, nullptr, nullptr, nullptr));
  std::uint8_t* rows[] = {image.rgba.data()};
  const int stride[] = {4 * frame.width};
  sws_scale(scaler.get(), frame.data, frame.linesize, 0, frame.height, rows, stride);
  return image;
}

std::string bytes_of(const std::filesystem::path& file) {
  std::ifstream input(file, std::ios::binary);
  return {std::istreambuf_iterator<char>(input), {}};
}

struct Kind {
  const char* extension;
  const char* codec;
  const char* pixel_format;
};

class VideoKinds : public testing::TestWithParam<Kind> {};

TEST_P(VideoKinds, ComeBackWithEveryFrame) {
  const Folder folder("video");
  const auto file = folder / (std::string("a") + GetParam().extension);
  VideoSettings settings;
  settings.width = 96;
  settings.height = 64;
  settings.fps = 25.0;
  write_video(file, settings, 20);
  const VideoFacts facts = inspect_video(file);
  EXPECT_EQ(facts.frames, 20u);
  EXPECT_EQ(facts.width, 96);
  EXPECT_EQ(facts.height, 64);
  EXPECT_NEAR(facts.fps, 25.0, 0.01);
  EXPECT_NEAR(facts.duration, 0.8, 0.011);
  EXPECT_EQ(facts.codec, GetParam().codec);
  EXPECT_EQ(facts.pixel_format, GetParam().pixel_format);
  EXPECT_EQ(folder.files().size(), 1u) << "no temporary file is left";
}

INSTANTIATE_TEST_SUITE_P(All, VideoKinds,
                         testing::Values(Kind{".mp4", "h264", "yuv420p"}, Kind{".mov", "h264", "yuv420p"},
                                         Kind{".mkv", "h264", "yuv420p"}, Kind{".webm", "vp9", "yuv420p"},
                                         Kind{".gif", "gif", "bgra"}),
                         [](const auto& kind) { return std::string(kind.param.extension + 1); });

TEST(Video, PadsOddSizes) {
  const Folder folder("video_odd");
  VideoSettings settings;
  settings.width = 97;
  settings.height = 63;
  write_video(folder / "a.mp4", settings, 5);
  const VideoFacts facts = inspect_video(folder / "a.mp4");
  EXPECT_EQ(facts.width, 98);
  EXPECT_EQ(facts.height, 64);
  EXPECT_EQ(facts.frames, 5u);
  const libav::Frame picture = first_picture(folder / "a.mp4");
  const auto luma = [&](int x, int y) {
    return static_cast<int>(picture->data[0][y * picture->linesize[0] + x]);
  };
  EXPECT_NEAR(luma(97, 40), luma(96, 40), 2) << "the last column once more";
  EXPECT_NEAR(luma(50, 63), luma(50, 62), 2);
}

TEST(Video, KeepsFractionalRates) {
  const Folder folder("video_rate");
  VideoSettings settings;
  settings.width = settings.height = 64;
  for (const double fps : {29.97, 12.5, 60.0, 0.5}) {
    settings.fps = fps;
    write_video(folder / "a.mp4", settings, 10);
    const VideoFacts facts = inspect_video(folder / "a.mp4");
    EXPECT_NEAR(facts.fps, fps, 1e-3 * fps);
    EXPECT_NEAR(facts.duration, 10.0 / fps, 0.011 + 1e-3 * 10.0 / fps);
    EXPECT_EQ(facts.frames, 10u);
  }
}

TEST(Video, OneFrameIsAVideo) {
  const Folder folder("video_one");
  VideoSettings settings;
  settings.width = settings.height = 64;
  write_video(folder / "a.mp4", settings, 1);
  EXPECT_EQ(inspect_video(folder / "a.mp4").frames, 1u);
}

TEST(Video, ConvertsByBt709AndSaysSo) {
  const Folder folder("video_color");
  VideoSettings settings;
  settings.width = 96;
  settings.height = 64;
  write_video(folder / "a.mp4", settings, 3);
  const libav::Frame picture = first_picture(folder / "a.mp4");
  EXPECT_EQ(picture->colorspace, AVCOL_SPC_BT709);
  EXPECT_EQ(picture->color_primaries, AVCOL_PRI_BT709);
  EXPECT_EQ(picture->color_trc, AVCOL_TRC_BT709);
  EXPECT_EQ(picture->color_range, AVCOL_RANGE_MPEG);
  // ITU-R BT.709, 8 bits: Y = 16 + 219 (0.2126 R + 0.7152 G + 0.0722 B), Cb and Cr of 224 steps.
  const double r = 200.0 / 255, g = 60.0 / 255, b = 30.0 / 255;
  const double y = 0.2126 * r + 0.7152 * g + 0.0722 * b;
  EXPECT_NEAR(picture->data[0][50 * picture->linesize[0] + 60], 16 + 219 * y, 2);
  EXPECT_NEAR(picture->data[1][25 * picture->linesize[1] + 30], 128 + 224 * (b - y) / 1.8556, 2);
  EXPECT_NEAR(picture->data[2][25 * picture->linesize[2] + 30], 128 + 224 * (r - y) / 1.5748, 2);
}

TEST(Video, PutsTheIndexAtTheFrontAndWritesTheSameBytes) {
  const Folder folder("video_bytes");
  VideoSettings settings;
  settings.width = 96;
  settings.height = 64;
  write_video(folder / "a.mp4", settings, 12);
  write_video(folder / "b.mp4", settings, 12);
  const std::string bytes = bytes_of(folder / "a.mp4");
  EXPECT_EQ(bytes, bytes_of(folder / "b.mp4"));
  EXPECT_LT(bytes.find("moov"), bytes.find("mdat"));
}

TEST(Video, LeavesNothingBehindWhenItIsNotClosed) {
  const Folder folder("video_killed");
  for (const char* name : {"a.mp4", "a.mkv", "a.gif"}) {
    VideoSettings settings;
    settings.width = settings.height = 64;
    VideoWriter writer(folder / name, settings);
    writer.add(frame_of(64, 64, 0));
    EXPECT_FALSE(std::filesystem::exists(folder / name)) << "not under its name before it is whole";
  }
  EXPECT_THAT(folder.files(), IsEmpty());
}

TEST(Video, CanBeMoved) {
  const Folder folder("video_moved");
  VideoSettings settings;
  settings.width = settings.height = 64;
  VideoWriter first(folder / "a.mp4", settings);
  first.add(frame_of(64, 64, 0));
  VideoWriter second(std::move(first));
  second.add(frame_of(64, 64, 1));
  second.close();
  EXPECT_EQ(inspect_video(folder / "a.mp4").frames, 2u);
}

TEST(Video, RefusesByMessage) {
  const Folder folder("video_refused");
  const auto refuses = [&](const char* name, const VideoSettings& settings, const char* found) {
    EXPECT_THAT([&] { VideoWriter writer(folder / name, settings); },
                ThrowsMessage<std::invalid_argument>(HasSubstr(found)));
  };
  VideoSettings settings;
  EXPECT_THAT([&] { VideoWriter writer(folder / "a.avi", settings); },
              ThrowsMessage<std::invalid_argument>(
                  AllOf(HasSubstr("'.avi'"), HasSubstr(".mp4, .mov, .mkv, .webm, .gif"))));
  settings.fps = 0.0;
  refuses("a.mp4", settings, "fps");
  settings.fps = std::nan("");
  refuses("a.mp4", settings, "fps");
  settings.fps = 200.0;
  refuses("a.gif", settings, "at most 100, not 200");
  settings = {};
  settings.width = 0;
  refuses("a.mp4", settings, "0 x 720");
  settings = {};
  settings.encoding.crf = 52;
  refuses("a.mp4", settings, "the crf of libx264 is from 0 to 51, not 52");
  settings = {};
  EXPECT_THAT(
      [&] { VideoWriter writer(folder / "no/such/a.mp4", settings); },
      ThrowsMessage<std::runtime_error>(AllOf(HasSubstr("no/such/a.mp4"), HasSubstr("No such file"))));
  VideoWriter writer(folder / "a.mp4", settings);
  EXPECT_THAT([&] { writer.add(frame_of(64, 64, 0)); },
              ThrowsMessage<std::invalid_argument>(AllOf(HasSubstr("1280 x 720"), HasSubstr("64 x 64"))));
  EXPECT_THAT([&] { writer.close(); }, ThrowsMessage<std::runtime_error>(HasSubstr("no frame")));
}

TEST(Video, InspectRefusesWhatIsNoVideo) {
  const Folder folder("video_none");
  EXPECT_THAT([&] { inspect_video(folder / "missing.mp4"); },
              ThrowsMessage<std::runtime_error>(AllOf(HasSubstr("missing.mp4"), HasSubstr("No such file"))));
  std::ofstream(folder / "text.mp4") << "not a video at all";
  EXPECT_THAT([&] { inspect_video(folder / "text.mp4"); },
              ThrowsMessage<std::runtime_error>(HasSubstr("text.mp4")));
}

struct Wish {
  const char* extension;
  const char* codec;
  const char* pixel_format;  // empty: the encoder's own
  const char* kind;          // of the codec
  const char* found;         // pixel format in the file
};

class VideoCodecs : public testing::TestWithParam<Wish> {};

TEST_P(VideoCodecs, AreWrittenAndReadBack) {
  const Folder folder(std::string("video_codec_") + GetParam().codec + (GetParam().extension + 1));
  const auto file = folder / (std::string("a") + GetParam().extension);
  VideoSettings settings;
  settings.width = 97;
  settings.height = 63;
  settings.encoding.codec = GetParam().codec;
  settings.encoding.pixel_format = GetParam().pixel_format;
  write_video(file, settings, 12);
  const VideoFacts facts = inspect_video(file);
  EXPECT_EQ(facts.frames, 12u);
  EXPECT_EQ(facts.codec, GetParam().kind);
  EXPECT_EQ(facts.pixel_format, GetParam().found);
  EXPECT_NEAR(facts.duration, 12 / 25.0, 0.011);
  const bool rgb = (av_pix_fmt_desc_get(av_get_pix_fmt(GetParam().found))->flags & AV_PIX_FMT_FLAG_RGB) != 0;
  EXPECT_EQ(facts.width, rgb ? 97 : 98);
  EXPECT_EQ(facts.height, rgb ? 63 : 64);
}

INSTANTIATE_TEST_SUITE_P(All, VideoCodecs,
                         testing::Values(Wish{".mp4", "libx265", "", "hevc", "yuv420p"},
                                         Wish{".mp4", "libx264", "yuv444p", "h264", "yuv444p"},
                                         Wish{".mkv", "libx264rgb", "", "h264", "gbrp"},
                                         Wish{".mkv", "ffv1", "", "ffv1", "bgr0"},
                                         Wish{".mkv", "libvpx-vp9", "", "vp9", "yuv420p"},
                                         Wish{".mkv", "png", "", "png", "rgb24"},
                                         Wish{".mov", "prores_ks", "", "prores", "yuv422p10le"},
                                         Wish{".mov", "qtrle", "", "qtrle", "rgb24"},
                                         Wish{".mov", "libx265", "yuv420p10le", "hevc", "yuv420p10le"},
                                         Wish{".mp4", "mpeg4", "", "mpeg4", "yuv420p"}),
                         [](const auto& wish) {
                           std::string name = std::string(wish.param.extension + 1) + "_" + wish.param.codec +
                                              wish.param.pixel_format;
                           std::replace(name.begin(), name.end(), '-', '_');
                           return name;
                         });

TEST(VideoCodec, LosslessOnesKeepEveryPixel) {
  const Folder folder("video_lossless");
  VideoSettings settings;
  settings.width = 97;
  settings.height = 63;
  const Image source = frame_of(97, 63, 0);
  for (const auto& [name, codec, crf] : {std::tuple{"a.mkv", "ffv1", std::optional<int>()},
                                         {"b.mkv", "libx264rgb", std::optional<int>(0)},
                                         {"c.mov", "qtrle", std::optional<int>()},
                                         {"d.mov", "png", std::optional<int>()}}) {
    settings.encoding = {codec, "", "", crf};
    write_video(folder / name, settings, 3);
    const libav::Frame picture = first_picture(folder / name);
    EXPECT_EQ(rgba_of(*picture).rgba, source.rgba) << codec;
    EXPECT_EQ(picture->color_range == AVCOL_RANGE_MPEG, false) << codec;
  }
}

/// Half covered on the left, opaque in the middle, nothing on the right.
Image half_covered(int width, int height) {
  Image image{width, height, {}};
  for (int y = 0; y < height; ++y)
    for (int x = 0; x < width; ++x)
      for (const int level : {200, 60, 30, x < 32 ? 128 : x < 64 ? 255 : 0})
        image.rgba.push_back(static_cast<std::uint8_t>(level));
  return image;
}

TEST(VideoCodec, CarriesStraightAlpha) {
  const Folder folder("video_alpha");
  VideoSettings settings;
  settings.width = 96;
  settings.height = 64;
  for (const auto& [name, codec, decoder] : {std::tuple{"a.mov", "", ""},
                                             {"b.mov", "qtrle", ""},
                                             {"c.mov", "png", ""},
                                             {"d.mkv", "", ""},
                                             {"e.webm", "", "libvpx-vp9"}}) {
    settings.encoding = {codec, "", "", std::nullopt, true};
    VideoWriter writer(folder / name, settings);
    for (int i = 0; i < 4; ++i) writer.add(half_covered(96, 64));
    writer.close();
    const libav::Frame picture = first_picture(folder / name, decoder);
    const Image back = rgba_of(*picture);
    for (const int x : {16, 48, 80}) {
      const auto p = pixel(back, x, 32);
      EXPECT_NEAR(p[3], x < 32 ? 128 : x < 64 ? 255 : 0, 6) << name << " at " << x;
      if (p[3] > 6) {
        EXPECT_NEAR(p[0], 200, 25) << name << " at " << x << ": not times its alpha";
      }
    }
  }
}

TEST(VideoCodec, PresetsAndRateFactorsReachTheEncoder) {
  const Folder folder("video_effort");
  VideoSettings settings;
  settings.width = 320;
  settings.height = 240;
  const auto size = [&](const std::string& preset, int crf) {
    settings.encoding = {"libx264", preset, "", crf};
    const auto file = folder / "a.mkv";
    write_video(file, settings, 20);
    return bytes_of(file);
  };
  EXPECT_GT(size("veryfast", 0).size(), 1.2 * size("veryfast", 51).size());
  EXPECT_NE(size("ultrafast", 18), size("slow", 18));
}

TEST(VideoCodec, TheDefaultsAreThoseOfTheContainer) {
  const auto chosen = [](const char* container, EncodingRequest request = {}) {
    const Encoding encoding = choose_encoding(container, request);
    return std::tuple(encoding.codec, encoding.preset, encoding.pixel_format, encoding.crf);
  };
  using Chosen = std::tuple<std::string, std::string, std::string, std::optional<int>>;
  EXPECT_EQ(chosen("mp4"), Chosen("libx264", "veryfast", "yuv420p", 18));
  EXPECT_EQ(chosen("webm"), Chosen("libvpx-vp9", "", "yuv420p", 24));
  EXPECT_EQ(chosen("gif"), Chosen("gif", "", "pal8", std::nullopt));
  EXPECT_EQ(chosen("mkv", {"ffv1", "", "", std::nullopt}), Chosen("ffv1", "", "bgr0", std::nullopt));
}

TEST(VideoCodec, WishesAreRefusedWithWhatIsAllowed) {
  const auto refuses = [](const char* container, const EncodingRequest& request, const std::string& key,
                          const std::string& message, const std::string& allowed) {
    try {
      choose_encoding(container, request);
      ADD_FAILURE() << message;
    } catch (const EncodingError& error) {
      EXPECT_EQ(error.key, key);
      EXPECT_THAT(error.what(), HasSubstr(message));
      EXPECT_TRUE(allowed.empty() || std::count(error.allowed.begin(), error.allowed.end(), allowed) == 1);
    }
  };
  refuses("avi", {}, "video", "'avi' is no kind of video file", "mp4");
  refuses("mp4", {"x264"}, "codec", "'x264' is no encoder for a video in mp4", "libx264");
  refuses("webm", {"libx264"}, "codec", "'libx264' is no encoder for a video in webm", "libvpx-vp9");
  refuses("mp4", {"", "quick"}, "preset", "'quick' is no preset of libx264", "veryfast");
  refuses("webm", {"", "fast"}, "preset", "libvpx-vp9 has no presets", "");
  refuses("mp4", {"", "", "yuv420"}, "pix_fmt", "'yuv420' is no pixel format of libx264", "yuv420p");
  refuses("gif", {"", "", "rgb8"}, "pix_fmt", "'rgb8' is no pixel format of gif", "pal8");
  refuses("mkv", {"ffv1", "", "", 18}, "crf", "ffv1 has no crf", "");
  refuses("webm", {"", "", "", 64}, "crf", "the crf of libvpx-vp9 is from 0 to 63, not 64", "");
  EncodingRequest transparent;
  transparent.transparent = true;
  refuses("mp4", transparent, "video", "'mp4' carries no transparency", "mov");
  refuses("gif", transparent, "video", "'gif' carries no transparency", "webm");
  transparent.codec = "libx264";
  refuses("mov", transparent, "codec", "'libx264' carries no transparency in mov", "prores_ks");
  transparent = {"ffv1", "", "yuv420p", std::nullopt, true};
  refuses("mkv", transparent, "pix_fmt", "'yuv420p' is no pixel format with transparency of ffv1", "bgra");
}

TEST(Palette, KeepsFewColoursAsTheyAre) {
  const IndexedImage indexed = index_colors(frame_of(96, 64, 2));
  for (const auto& [x, y, color] : {std::tuple{15, 10, 0xfff0f0e6u}, {60, 50, 0xffc83c1eu}})
    EXPECT_EQ(indexed.palette[indexed.indices[static_cast<std::size_t>(y * 96 + x)]], color);
}

TEST(Palette, FollowsAGradient) {
  Image image{256, 64, {}};
  for (int y = 0; y < 64; ++y)
    for (int x = 0; x < 256; ++x)
      for (const int level : {x, 255 - x, 2 * y + 64, 255})
        image.rgba.push_back(static_cast<std::uint8_t>(level));
  const IndexedImage indexed = index_colors(image);
  double error = 0.0;
  for (std::size_t i = 0; i < indexed.indices.size(); ++i) {
    const std::uint32_t color = indexed.palette[indexed.indices[i]];
    for (std::size_t channel = 0; channel < 3; ++channel)
      error += std::abs(static_cast<int>(color >> (16 - 8 * channel) & 0xff) - image.rgba[4 * i + channel]);
  }
  EXPECT_LT(error / static_cast<double>(3 * indexed.indices.size()), 8.0);
}

}  // namespace
}  // namespace deforma
