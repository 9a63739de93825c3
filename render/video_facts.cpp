#include <fmt/format.h>

#include <stdexcept>

#include "render/libav.hpp"
#include "render/video.hpp"

namespace deforma {

std::string libav::reason(int error) {
  char text[AV_ERROR_MAX_STRING_SIZE] = {};
  av_strerror(error, text, sizeof text);
  return text;
}

namespace {

libav::Input open_input(const std::filesystem::path& file) {
  AVFormatContext* opened = nullptr;
  const int result = avformat_open_input(&opened, file.c_str(), nullptr, nullptr);
  if (result < 0)
    throw std::runtime_error(
        fmt::format("cannot read the video '{}': {}", file.string(), libav::reason(result)));
  return libav::Input(opened);
}

std::size_t receive_all(AVCodecContext* codec, AVFrame* frame) {
  std::size_t count = 0;
  while (avcodec_receive_frame(codec, frame) >= 0) ++count;
  return count;
}

}  // namespace

VideoFacts inspect_video(const std::filesystem::path& file) {
  av_log_set_level(AV_LOG_FATAL);
  const libav::Input input = open_input(file);
  const auto refuse = [&](const std::string& why) {
    throw std::runtime_error(fmt::format("cannot read the video '{}': {}", file.string(), why));
  };
  if (const int found = avformat_find_stream_info(input.get(), nullptr); found < 0)
    refuse(libav::reason(found));
  const AVCodec* decoder = nullptr;
  const int number = av_find_best_stream(input.get(), AVMEDIA_TYPE_VIDEO, -1, -1, &decoder, 0);
  if (number < 0 || !decoder) refuse("it holds no video stream that can be decoded");
  const AVStream* stream = input->streams[number];
  const libav::Codec codec(avcodec_alloc_context3(decoder));
  avcodec_parameters_to_context(codec.get(), stream->codecpar);
  if (const int opened = avcodec_open2(codec.get(), decoder, nullptr); opened < 0)
    refuse(libav::reason(opened));

  VideoFacts facts;
  const libav::Packet packet(av_packet_alloc());
  const libav::Frame frame(av_frame_alloc());
  while (av_read_frame(input.get(), packet.get()) >= 0) {
    if (packet->stream_index == number) {
      if (const int sent = avcodec_send_packet(codec.get(), packet.get()); sent < 0)
        refuse(libav::reason(sent));
      facts.frames += receive_all(codec.get(), frame.get());
    }
    av_packet_unref(packet.get());
  }
  avcodec_send_packet(codec.get(), nullptr);
  facts.frames += receive_all(codec.get(), frame.get());

  facts.width = codec->width;
  facts.height = codec->height;
  facts.fps = av_q2d(stream->avg_frame_rate.num > 0 ? stream->avg_frame_rate : stream->r_frame_rate);
  facts.codec = avcodec_get_name(codec->codec_id);
  const char* pixel_format = av_get_pix_fmt_name(codec->pix_fmt);
  facts.pixel_format = pixel_format ? pixel_format : "";
  if (stream->duration != AV_NOPTS_VALUE)
    facts.duration = static_cast<double>(stream->duration) * av_q2d(stream->time_base);
  else if (input->duration != AV_NOPTS_VALUE)
    facts.duration = static_cast<double>(input->duration) / AV_TIME_BASE;
  else if (facts.fps > 0.0)
    facts.duration = static_cast<double>(facts.frames) / facts.fps;
  return facts;
}

}  // namespace deforma
