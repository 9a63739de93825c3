#include "render/sha256.hpp"

#include <fmt/format.h>

extern "C" {
#include <libavutil/mem.h>
#include <libavutil/sha.h>
}

#include <array>
#include <cstdint>
#include <memory>
#include <new>

namespace deforma {

std::string sha256(std::string_view text) {
  const std::unique_ptr<AVSHA, decltype(&av_free)> hash(av_sha_alloc(), &av_free);
  if (!hash) throw std::bad_alloc();
  av_sha_init(hash.get(), 256);
  av_sha_update(hash.get(), reinterpret_cast<const std::uint8_t*>(text.data()), text.size());
  std::array<std::uint8_t, 32> digest;
  av_sha_final(hash.get(), digest.data());
  std::string hex;
  for (std::uint8_t byte : digest) hex += fmt::format("{:02x}", byte);
  return hex;
}

}  // namespace deforma
