#include "pipeline/encoding_keys.hpp"

#include "pipeline/table_reader.hpp"

namespace deforma {

EncodingRequest encoding_request(const OutputSpec& output) {
  return {output.codec.value_or(""), output.preset.value_or(""), output.pixel_format.value_or(""), output.crf,
          output.transparent};
}

void resolve_encoding(const toml::table& scene, OutputSpec& output) {
  if (output.transparent && !scene.at_path("output.video")) output.video = "mov";
  if (output.video == "none") return;
  try {
    const Encoding encoding = choose_encoding(output.video, encoding_request(output));
    output.codec = encoding.codec;
    if (!encoding.preset.empty()) output.preset = encoding.preset;
    output.pixel_format = encoding.pixel_format;
    output.crf = encoding.crf;
  } catch (const EncodingError& error) {
    const toml::node* given = scene.at_path("output." + error.key).node();
    const std::string message = error.what() + did_you_mean(error.found, error.allowed);
    fail(given ? *given : scene, "output." + error.key, message);
  }
}

}  // namespace deforma
