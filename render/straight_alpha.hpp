#pragma once

#include "render/image.hpp"

namespace deforma {

/// Turns what blending leaves, sRGB-coded colours that in linear light are already times their alpha, into the straight
/// alpha that PNG and video hold. Light beyond its own alpha, a glint on glass, raises the alpha so that none is lost.
/// Pixels that nothing covers take the mean colour of covered neighbours, so that a viewer which scales colour and
/// alpha apart, or a video that stores chroma for two pixels at once, draws no dark fringe.
void make_straight(Image& image);

}  // namespace deforma
