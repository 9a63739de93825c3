#pragma once

#include <string>
#include <string_view>

namespace deforma {

/// SHA-256 in hexadecimal digits, as `sha256sum` prints it. Source: FIPS 180-4, by libavutil.
std::string sha256(std::string_view text);

}  // namespace deforma
