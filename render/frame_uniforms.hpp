#pragma once

#include <Eigen/Core>

#include "render/shaders.hpp"

namespace deforma {

/// What all shaders know of a frame: the uniform block `Frame` of shaders_common.cpp, in std140 layout.
/// Lengths are metres relative to the camera's target, colours linear.
struct FrameUniforms {
  Eigen::Matrix4f clip = Eigen::Matrix4f::Identity();    ///< world to clip space
  Eigen::Matrix4f shadow = Eigen::Matrix4f::Identity();  ///< world to the shadow map, [0, 1]^3
  Eigen::Vector4f eye = Eigen::Vector4f::Zero();         ///< and the ground's region per texel [m]
  Eigen::Vector4f back =
      Eigen::Vector4f::UnitZ();  ///< unit, from the target to the eye; 1 when rays are parallel
  Eigen::Vector4f key_to = Eigen::Vector4f::UnitZ();  ///< unit, towards the light; 1 when it throws shadows
  Eigen::Vector4f key = Eigen::Vector4f::Zero();      ///< irradiance; radiance of the sky
  Eigen::Vector4f rim_to =
      Eigen::Vector4f::UnitZ();  ///< unit, towards the light behind the scene; radius of the casters
  Eigen::Vector4f rim = Eigen::Vector4f::Zero();     ///< irradiance; unused
  Eigen::Vector4f bounce = Eigen::Vector4f::Zero();  ///< what the floor reflects of white; 1 when it is baked
  Eigen::Vector4f background = Eigen::Vector4f::Ones();  ///< and pixels of the picture per pixel drawn
  Eigen::Vector4f viewport = Eigen::Vector4f::Ones();  ///< width, height [pixels], aspect; samples per pixel
  Eigen::Vector4f ground =
      Eigen::Vector4f::Zero();  ///< height, center x, center y; radius where it has faded away
  Eigen::Vector4f region =
      Eigen::Vector4f::Ones();  ///< baked part of the ground: min x, min y, 1 / size x, 1 / size y
  Eigen::Vector4f blur =
      Eigen::Vector4f::Zero();  ///< shadow filter on bodies: radius in the map, radius [m]; map texel
                                ///< [m]; penumbra: radius in the map per depth of the map
  Eigen::Vector4f plane =
      Eigen::Vector4f::Zero();  ///< change of map depth along the ground per map length, 2;
                                ///< map texel in the map; height range of the underside map [m]
  Eigen::Matrix<float, 4, max_samples> samples =
      Eigen::Matrix<float, 4, max_samples>::Zero();  ///< offsets [pixels]
};
static_assert(sizeof(FrameUniforms) == (2 * 16 + 13 * 4 + 4 * max_samples) * sizeof(float));

}  // namespace deforma
