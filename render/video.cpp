#include "render/video.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <cctype>
#include <cmath>
#include <cstring>
#include <stdexcept>
#include <vector>

#include "render/libav.hpp"
#include "render/palette.hpp"
#include "render/temporary_file.hpp"

namespace deforma {
namespace {

// Encoders may answer with other bytes on another number of threads, so it does not follow the machine.
constexpr int encoder_threads = 4;

std::string container_of(const std::filesystem::path& file) {
  std::string extension = file.extension().string();
  std::transform(extension.begin(), extension.end(), extension.begin(),
                 [](unsigned char c) { return static_cast<char>(std::tolower(c)); });
  for (const std::string& container : video_containers())
    if (extension == "." + container) return container;
  throw std::invalid_argument(
      fmt::format("cannot write the video '{}': unknown extension '{}'; allowed are .{}", file.string(),
                  extension, fmt::join(video_containers(), ", .")));
}

void check_settings(const VideoSettings& settings) {
  if (settings.width <= 0 || settings.height <= 0 || settings.width > 16384 || settings.height > 16384)
    throw std::invalid_argument(fmt::format("a video's width and height must be from 1 to 16384, not {} x {}",
                                            settings.width, settings.height));
  if (!(settings.fps > 0.0 && settings.fps <= 1000.0))
    throw std::invalid_argument(
        fmt::format("a video's fps must be above 0 and at most 1000, not {}", settings.fps));
}

}  // namespace

struct VideoWriter::Data {
  Data(const std::filesystem::path& target, const VideoSettings& wanted)
      : file(target), settings(wanted), container(container_of(target)), temporary(target) {
    check_settings(settings);
    encoding = choose_encoding(container, settings.encoding);
    if (indexed() && settings.fps > 100.0)
      throw std::invalid_argument(fmt::format(
          "a gif counts time in hundredths of a second: its fps must be at most 100, not {}", settings.fps));
    // libav speaks of its own progress on the error stream; errors come back as codes.
    av_log_set_level(AV_LOG_FATAL);
    open_codec();
    open_file();
  }

  ~Data() {
    // The gif muxer keeps the last packet until the trailer is written, and forgets it otherwise.
    if (indexed() && next > 0 && !finished) av_write_trailer(format.get());
  }
  Data(const Data&) = delete;
  Data& operator=(const Data&) = delete;

  bool indexed() const { return container == "gif"; }

  /// Red, green and blue as they are, or luma and chroma.
  bool rgb() const { return (av_pix_fmt_desc_get(codec->pix_fmt)->flags & AV_PIX_FMT_FLAG_RGB) != 0; }
  bool has_chroma() const { return !rgb() && !indexed(); }

  [[noreturn]] void fail(const std::string& step, int error) const {
    throw std::runtime_error(
        fmt::format("cannot write the video '{}': {}: {}", file.string(), step, libav::reason(error)));
  }

  void check(int result, const char* step) const {
    if (result < 0) fail(step, result);
  }

  void open_codec() {
    AVFormatContext* made = nullptr;
    check(avformat_alloc_output_context2(&made, nullptr, container == "mkv" ? "matroska" : container.c_str(),
                                         temporary.path().c_str()),
          "making the container");
    format.reset(made);
    const AVCodec* encoder = avcodec_find_encoder_by_name(encoding.codec.c_str());
    codec.reset(avcodec_alloc_context3(encoder));
    codec->pix_fmt = av_get_pix_fmt(encoding.pixel_format.c_str());
    // A chroma plane of half the size needs an even size, and players want one also where chroma is whole.
    codec->width = has_chroma() ? (settings.width + 1) / 2 * 2 : settings.width;
    codec->height = has_chroma() ? (settings.height + 1) / 2 * 2 : settings.height;
    const AVRational rate = av_d2q(settings.fps, 100000);
    codec->time_base = av_inv_q(rate);
    codec->framerate = rate;
    codec->thread_count = encoder_threads;
    codec->flags |= AV_CODEC_FLAG_BITEXACT;
    format->flags |= AVFMT_FLAG_BITEXACT;
    if (format->oformat->flags & AVFMT_GLOBALHEADER) codec->flags |= AV_CODEC_FLAG_GLOBAL_HEADER;
    if (!indexed()) tag_colors();
    set_quality();
    check(avcodec_open2(codec.get(), encoder, nullptr), "opening the encoder");
  }

  void tag_colors() {
    codec->color_primaries = AVCOL_PRI_BT709;  // those of sRGB
    codec->color_trc = rgb() ? AVCOL_TRC_IEC61966_2_1 : AVCOL_TRC_BT709;
    codec->colorspace = rgb() ? AVCOL_SPC_RGB : AVCOL_SPC_BT709;
    codec->color_range = rgb() ? AVCOL_RANGE_JPEG : AVCOL_RANGE_MPEG;
    if (!rgb()) codec->chroma_sample_location = AVCHROMA_LOC_LEFT;
  }

  void set(const char* option, const std::string& value) {
    check(av_opt_set(codec->priv_data, option, value.c_str(), 0), option);
  }

  void set_quality() {
    if (!encoding.preset.empty()) set("preset", encoding.preset);
    const std::string& name = encoding.codec;
    if (name == "mpeg4") {
      // It knows no rate factor: a generous share of bits per pixel instead, halved for every 6 of it.
      const double bits = 0.2 * std::exp2((18.0 - *encoding.crf) / 6.0);
      codec->bit_rate = static_cast<std::int64_t>(bits * codec->width * codec->height * settings.fps);
    } else if (encoding.crf) {
      set("crf", std::to_string(*encoding.crf));
    }
    if (name == "libx265") {
      // What it decides follows its threads, and it speaks of itself.
      set("x265-params", fmt::format("log-level=error:frame-threads=2:pools={}", encoder_threads));
      codec->codec_tag =
          container == "mkv" ? 0 : MKTAG('h', 'v', 'c', '1');  // the only one that Apple's players take
    } else if (name == "libvpx-vp9") {
      // Measured as in encoding.cpp: 9 ms and 2.2 KiB per frame; "good" and 4 takes 63 ms for 1.8 KiB.
      codec->bit_rate = 0;  // with crf alone: constant quality
      set("deadline", "realtime");
      set("cpu-used", "6");
      set("row-mt", "1");
      if (settings.encoding.transparent) set("auto-alt-ref", "0");  // hidden frames would lose their alpha
    } else if (name == "ffv1") {
      codec->level = 3;  // in slices, each with a checksum, which threads share
      codec->slices = encoder_threads;
    }
  }

  void open_file() {
    stream = avformat_new_stream(format.get(), nullptr);
    if (!stream) fail("making the stream", AVERROR(ENOMEM));
    check(avcodec_parameters_from_context(stream->codecpar, codec.get()), "describing the stream");
    stream->time_base = codec->time_base;
    stream->avg_frame_rate = codec->framerate;
    check(avio_open(&format->pb, temporary.path().c_str(), AVIO_FLAG_WRITE), "opening the file");
    AVDictionary* options = nullptr;
    if (container == "mp4" || container == "mov") av_dict_set(&options, "movflags", "+faststart", 0);
    const int begun = avformat_write_header(format.get(), &options);
    av_dict_free(&options);
    check(begun, "writing the header");

    picture.reset(av_frame_alloc());
    packet.reset(av_packet_alloc());
    if (!picture || !packet) fail("making a frame", AVERROR(ENOMEM));
    picture->format = codec->pix_fmt;
    picture->width = codec->width;
    picture->height = codec->height;
    picture->colorspace = codec->colorspace;
    picture->color_primaries = codec->color_primaries;
    picture->color_trc = codec->color_trc;
    picture->color_range = codec->color_range;
    check(av_frame_get_buffer(picture.get(), 0), "making a frame");
    if (indexed()) return;
    scaler.reset(sws_getContext(
        codec->width, codec->height, AV_PIX_FMT_RGBA, codec->width, codec->height, codec->pix_fmt,
        SWS_BICUBIC | SWS_ACCURATE_RND | SWS_FULL_CHR_H_INP | SWS_BITEXACT, nullptr, nullptr, nullptr));
    if (!scaler) fail("making the colour conversion", AVERROR(EINVAL));
    const int* bt709 = sws_getCoefficients(SWS_CS_ITU709);
    const int full_range = rgb() ? 1 : 0;
    if (sws_setColorspaceDetails(scaler.get(), bt709, 1, bt709, full_range, 0, 1 << 16, 1 << 16) < 0 &&
        !rgb())
      fail("choosing BT.709", AVERROR(EINVAL));
  }

  void fill_indexed(const Image& frame) {
    const IndexedImage image = index_colors(frame);
    std::memcpy(picture->data[1], image.palette.data(), sizeof image.palette);
    const auto width = static_cast<std::size_t>(frame.width);
    for (int y = 0; y < frame.height; ++y)
      std::memcpy(picture->data[0] + static_cast<std::ptrdiff_t>(y) * picture->linesize[0],
                  image.indices.data() + static_cast<std::size_t>(y) * width, width);
  }

  void fill_planes(const Image& frame) {
    const std::size_t from = 4 * static_cast<std::size_t>(frame.width);
    const std::size_t to = 4 * static_cast<std::size_t>(codec->width);
    const std::uint8_t* pixels = frame.rgba.data();
    if (codec->width != frame.width || codec->height != frame.height) {
      // The last column and row once more.
      padded.resize(to * static_cast<std::size_t>(codec->height));
      for (int y = 0; y < codec->height; ++y) {
        const std::uint8_t* source =
            frame.rgba.data() + from * static_cast<std::size_t>(std::min(y, frame.height - 1));
        std::uint8_t* row = padded.data() + to * static_cast<std::size_t>(y);
        std::memcpy(row, source, from);
        if (to > from) std::memcpy(row + from, source + from - 4, 4);
      }
      pixels = padded.data();
    }
    const int stride = static_cast<int>(to);
    sws_scale(scaler.get(), &pixels, &stride, 0, codec->height, picture->data, picture->linesize);
  }

  void encode(const AVFrame* frame) {
    check(avcodec_send_frame(codec.get(), frame), "encoding");
    for (;;) {
      const int received = avcodec_receive_packet(codec.get(), packet.get());
      if (received == AVERROR(EAGAIN) || received == AVERROR_EOF) return;
      check(received, "encoding");
      // Without its length the last frame would count for nothing in the file's duration.
      if (packet->duration == 0) packet->duration = 1;
      av_packet_rescale_ts(packet.get(), codec->time_base, stream->time_base);
      packet->stream_index = stream->index;
      check(av_interleaved_write_frame(format.get(), packet.get()), "writing");
    }
  }

  void add(const Image& frame) {
    if (closed) throw std::invalid_argument(fmt::format("the video '{}' is closed already", file.string()));
    if (frame.width != settings.width || frame.height != settings.height ||
        frame.rgba.size() !=
            4 * static_cast<std::size_t>(frame.width) * static_cast<std::size_t>(frame.height))
      throw std::invalid_argument(fmt::format("the video '{}' takes frames of {} x {} pixels, not {} x {}",
                                              file.string(), settings.width, settings.height, frame.width,
                                              frame.height));
    check(av_frame_make_writable(picture.get()), "encoding");  // the encoder may still hold the last one
    if (indexed())
      fill_indexed(frame);
    else
      fill_planes(frame);
    picture->pts = next++;
    encode(picture.get());
  }

  void close() {
    if (closed) return;
    if (next == 0) throw std::runtime_error(fmt::format("the video '{}' has no frame", file.string()));
    encode(nullptr);
    finished = true;
    check(av_write_trailer(format.get()), "finishing");
    check(avio_closep(&format->pb), "closing");
    temporary.rename();
    closed = true;
  }

  std::filesystem::path file;
  VideoSettings settings;
  std::string container;
  Encoding encoding;
  TemporaryFile temporary;  // before the file's owner: removed after it has been closed
  libav::Output format;
  libav::Codec codec;
  libav::Frame picture;
  libav::Packet packet;
  libav::Scaler scaler;
  AVStream* stream = nullptr;
  std::vector<std::uint8_t> padded;
  std::int64_t next = 0;
  bool finished = false;  // the trailer is written, or was tried
  bool closed = false;
};

VideoWriter::VideoWriter(const std::filesystem::path& file, const VideoSettings& settings)
    : data_(std::make_unique<Data>(file, settings)) {}
VideoWriter::~VideoWriter() = default;
VideoWriter::VideoWriter(VideoWriter&&) noexcept = default;
VideoWriter& VideoWriter::operator=(VideoWriter&&) noexcept = default;

const Encoding& VideoWriter::encoding() const { return data_->encoding; }

void VideoWriter::add(const Image& frame) { data_->add(frame); }

void VideoWriter::close() { data_->close(); }

}  // namespace deforma
