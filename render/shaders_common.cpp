#include "render/shaders_common.hpp"

#include <fmt/format.h>

namespace deforma {

std::string shader_head(bool sample_mask, const Detail& detail) {
  const std::string version =
      sample_mask ? "#version 400 core\n#define SAMPLE_MASK\n" : "#version 330 core\n";
  const std::string taps = fmt::format(
      "#define BODY_TAPS {}\n#define BLOCKER_TAPS {}\n#define GROUND_TAPS {}\n#define SKY_TAPS {}\n",
      detail.body_taps, detail.blocker_taps, detail.ground_taps, detail.sky_taps);
  return version + taps + R"(
layout(std140) uniform Frame {
  mat4 clip;
  mat4 shadow;
  vec4 eye;
  vec4 back;
  vec4 key_to;
  vec4 key;
  vec4 rim_to;
  vec4 rim;
  vec4 bounce;
  vec4 background;
  vec4 viewport;
  vec4 ground;
  vec4 region;
  vec4 blur;
  vec4 plane;
  vec4 samples[8];
};
const float inverse_pi = 0.31830989;

// From p to the eye, unit.
vec3 to_eye(vec3 p) { return back.w == 0.0 ? normalize(eye.xyz - p) : back.xyz; }
)";
}

std::string shader_color() {
  return R"(
// Keeps colours as they were chosen up to 0.76, presses what is brighter below 1 and lets it lose its colour there.
// Source: Khronos PBR neutral tone mapper, specification 1.0 (2024).
vec3 tone_map(vec3 color) {
  const float start = 0.76;
  float least = min(color.r, min(color.g, color.b));
  color -= least < 0.08 ? least - 6.25 * least * least : 0.04;
  float peak = max(color.r, max(color.g, color.b));
  if (peak < start) return color;
  float room = 1.0 - start;
  float pressed = 1.0 - room * room / (peak + room - start);
  float white = 1.0 - 1.0 / (0.15 * (peak - pressed) + 1.0);
  return mix(color * (pressed / peak), vec3(pressed), white);
}

// In pixels of the picture, however many times as fine it is drawn.
vec2 picture_place() { return gl_FragCoord.xy * background.w; }

// A fixed 4 x 4 pattern of half a step of the 8-bit output keeps slow gradients from showing bands, and compresses
// better than noise. The slope of the sRGB curve, taken as a power of 2, turns the step into linear light.
vec3 dither(vec3 color) {
  ivec2 p = ivec2(picture_place());
  int x = p.x ^ p.y;
  int order = ((x & 1) << 3) | ((p.y & 1) << 2) | (x & 2) | ((p.y & 2) >> 1);
  return color + sqrt(max(color, 0.0)) * ((float(order) - 7.5) * (2.0 / 16.0 / 255.0));
}

// The given background in the middle, a little darker towards the corners.
vec3 backdrop_color() {
  vec2 q = picture_place() / viewport.xy - vec2(0.5, 0.55);
  float corner = dot(q, q);
  return background.rgb * (1.0 - 0.22 * smoothstep(0.04, 0.75, corner));
}
)";
}

std::string shader_base_color() {
  return R"(
uniform sampler2D color_map;  // 256 colours of the range, then those of below, above and not a number
uniform int by_value;

// Values are looked up at every pixel: colours mixed between vertices would not be the map's. A loop of length zero costs
// nothing where there are none: see key_share.
vec3 base_color(vec3 own, float value) {
  const float tolerance = 0.5 / 255.0;
  vec3 base = own;
  for (int i = 0; i < by_value; ++i) {
    float texel = 255.0 * clamp(value, 0.0, 1.0);
    texel = value < -tolerance ? 256.0 : value > 1.0 + tolerance ? 257.0 : texel;
    texel = isnan(value) ? 258.0 : texel;
    base = textureLod(color_map, vec2((texel + 0.5) / 259.0, 0.5), 0.0).rgb;
  }
  return base;
}
)";
}

std::string shader_floor_light() {
  return R"(
uniform sampler2D ground_light;

// Light that comes up from the floor at p: what was baked there, averaged over a patch as wide as p is high. It
// changes so slowly that it is asked for at vertices only.
vec3 floor_light(vec3 p) {
  float level = log2(1.0 + max(p.z - ground.x, 0.0) / eye.w) + 2.0;
  vec2 share = textureLod(ground_light, (p.xy - region.xy) * region.zw, level).rg;
  share = bounce.w == 0.0 ? vec2(1.0) : share;
  return bounce.rgb * (key.rgb * (max(key_to.z, 0.0) * share.r * inverse_pi) + key.w * share.g);
}
)";
}

std::string shader_light() {
  return R"(
uniform sampler2DShadow shadow_map;
uniform sampler2D shadow_depths;

// Share of the key light that arrives: percentage-closer filtering over a disc (Reeves et al. 1987), its taps on a sunflower
// spiral. The outer ones look at single texels, which is cheaper; where they agree the others are skipped: a loop of length zero is the one way to skip work that also the
// software driver takes, which runs both sides of every branch.
float key_share(vec3 p, vec3 n) {
  float cosine = dot(n, key_to.xyz);
  // Raised so far that the disc lies above a plane with this normal.
  vec3 raised = p + n * (blur.y * sqrt(max(1.0 - cosine * cosine, 0.0)) + blur.z);
  vec3 s = (shadow * vec4(raised, 1.0)).xyz;
  s.z = min(s.z, 1.0);
  float sum = 0.0;
  vec2 tap = vec2(0.6, 0.75) * blur.x;
  for (int i = 0; i < 4; ++i) {
    sum += step(s.z, textureLod(shadow_depths, s.xy + tap, 0.0).r);
    tap = vec2(-tap.y, tap.x);
  }
  int more = key_to.w == 0.0 || cosine <= 0.0 || sum == 0.0 || sum == 4.0 ? 0 : BODY_TAPS;
  vec2 way = vec2(1.0, 0.0);
  for (int i = 0; i < more; ++i) {
    way = mat2(-0.73736888, 0.67549029, -0.67549029, -0.73736888) * way;  // the golden angle
    sum += textureLod(shadow_map, vec3(s.xy + way * (blur.x * 0.9 * sqrt((float(i) + 0.5) / float(BODY_TAPS))), s.z), 0.0);
  }
  return key_to.w == 0.0 ? 1.0 : sum / float(4 + more);
}

// Radiance that arrives from direction d, smeared as by a rough mirror: a studio with dim walls, a bright ceiling and a wide
// soft box under it, and the floor.
vec3 studio(vec3 d, float roughness, vec3 from_floor) {
  float smooth_share = 1.0 - roughness;
  float width = mix(0.06, 1.0, roughness);
  float up = smoothstep(-width, width, d.z);
  float high = max(d.z, 0.0);
  float room = mix(0.75 + 0.35 * high, 0.42 + 0.95 * smoothstep(0.05, 0.85, high), smooth_share);
  float box = smoothstep(0.86 - 0.5 * roughness, 0.95, dot(d, normalize(key_to.xyz + vec3(0.0, 0.0, 0.6))));
  return mix(from_floor, vec3(key.w * (room + 1.5 * box * smooth_share)), up);
}

// How far what is mirrored at a slant goes from its share straight on to all of it: Schlick 1994.
float fresnel(float cosine) {
  float c = 1.0 - cosine;
  float c2 = c * c;
  return c2 * c2 * c;
}

// The highlight of a rough surface, but for the share that it mirrors: GGX (Walter et al. 2007) with a height-correlated
// shadowing term (Hammon 2017).
float highlight(float alpha, float nl, float nv, float nh) {
  float a2 = alpha * alpha;
  float d = nh * nh * (a2 - 1.0) + 1.0;
  float shadowing = 0.5 / mix(2.0 * nl * nv, nl + nv, alpha);
  return a2 * inverse_pi / (d * d) * shadowing;
}

// Light of one direction; what the surface mirrors it does not scatter. straight: its share of mirrored light, seen straight on.
vec3 directional(vec3 scattered, vec3 straight, float alpha, vec3 n, vec3 v, float nv, vec3 to, vec3 irradiance) {
  float nl = max(dot(n, to), 1e-4);
  vec3 h = normalize(to + v);
  vec3 mirrored = straight + (1.0 - straight) * fresnel(clamp(dot(to, h), 0.0, 1.0));
  float shine = highlight(alpha, nl, nv, clamp(dot(n, h), 0.0, 1.0));
  return irradiance * nl * (scattered * (inverse_pi * (1.0 - mirrored)) + mirrored * shine);
}

// Radiance that leaves a body at p towards the eye; n looks to the eye's side. Metal mirrors in its own colour and scatters
// nothing.
vec3 body_color(vec3 albedo, float roughness, float metallic, vec3 p, vec3 n, vec3 from_floor) {
  vec3 v = to_eye(p);
  float nv = clamp(dot(n, v), 0.02, 1.0);
  float alpha = max(roughness * roughness, 0.01);
  vec3 scattered = albedo * (1.0 - metallic);
  vec3 straight = mix(vec3(0.04), albedo, metallic);
  vec3 around = mix(from_floor, vec3(key.w), 0.5 + 0.5 * n.z);
  vec3 mirror = straight + (1.0 - straight) * (fresnel(nv) * (1.0 - roughness) * (1.0 - roughness));
  vec3 color = scattered * around * (1.0 - mirror) + mirror * studio(reflect(-v, n), roughness, from_floor);
  color += directional(scattered, straight, alpha, n, v, nv, key_to.xyz, key.rgb) * key_share(p, n);
  color += directional(scattered, straight, alpha, n, v, nv, rim_to.xyz, rim.rgb);
  return color;
}
)";
}

}  // namespace deforma
