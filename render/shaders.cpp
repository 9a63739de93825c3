#include "render/shaders.hpp"

#include "render/shaders_common.hpp"

namespace deforma {
namespace {

const char* const mesh_vertex = R"(
layout(location = 0) in vec3 position;
layout(location = 1) in vec3 normal;
layout(location = 2) in float place;
// At the outline a value must not reach beyond the triangle's, hence centroid; Mesa 22's software driver then takes the wrong
// point's w, which noperspective goes without. Triangles are small beside their distance, so it is as good.
noperspective centroid out float value;
out vec3 p;
out vec3 smooth_normal;
out vec3 from_floor;
void main() {
  from_floor = floor_light(position);
  value = place;
  p = position;
  smooth_normal = normal;
  gl_Position = clip * vec4(position, 1.0);
}
)";

const char* const mesh_surface = R"(
uniform vec4 color;  // linear; opacity
uniform vec3 finish;  // roughness; 1 for one normal per triangle; metallic
noperspective centroid in float value;
in vec3 p;
in vec3 smooth_normal;
in vec3 from_floor;
layout(location = 0, index = 0) out vec4 result;

// What the surface scatters or, of metal, mirrors of white light.
vec3 own_color() { return base_color(color.rgb, value); }

vec3 surface_normal() {
  vec3 n = finish.y != 0.0 ? cross(dFdx(p), dFdy(p)) : (gl_FrontFacing ? smooth_normal : -smooth_normal);
  return normalize(n);
}
)";

const char* const mesh_fragment = R"(
void main() {
  vec3 shade = body_color(own_color(), finish.x, finish.z, p, surface_normal(), from_floor);
  result = vec4(dither(tone_map(shade)), 1.0);
}
)";

// A thin wall: the way through it grows as 1 / cos, so that it thickens and reflects towards its outline. Half of what it
// stops is scattered in its colour, the other half passes through tinted.
const char* const glass_fragment = R"(
layout(location = 0, index = 1) out vec4 passed;  // share of what lies behind

// Two upright lamps to the left and right of the camera: their mirror images are what a curved glass is seen by.
float lamps(vec3 d) {
  vec2 ahead = normalize(eye.xy + vec2(1e-6 * length(eye.xyz), 0.0));
  vec2 way = normalize(d.xy + vec2(1e-6, 0.0));
  float left = dot(way, vec2(0.17 * ahead.x + 0.985 * ahead.y, 0.17 * ahead.y - 0.985 * ahead.x));
  float right = dot(way, vec2(-0.26 * ahead.x - 0.966 * ahead.y, -0.26 * ahead.y + 0.966 * ahead.x));
  float upright = smoothstep(-0.65, -0.45, d.z) * (1.0 - smoothstep(0.5, 0.75, d.z));
  return upright * (smoothstep(0.955, 0.985, left) + 0.5 * smoothstep(0.98, 0.995, right));
}

void main() {
  vec3 base = own_color();
  vec3 n = surface_normal();
  vec3 v = to_eye(p);
  float nv = clamp(dot(n, v), 0.05, 1.0);
  float mirror = 0.04 + 0.96 * fresnel(nv);
  float body = 1.0 - pow(1.0 - color.a, 1.0 / max(nv, 0.1));
  vec3 light = mix(from_floor, vec3(key.w), 0.5 + 0.5 * n.z) + key.rgb * (0.25 * inverse_pi * (1.0 + dot(n, key_to.xyz)));
  float alpha = max(finish.x * finish.x, 0.01);
  vec3 r = reflect(-v, n);
  vec3 shade = base * light * (0.5 * body * (1.0 - mirror))
             + mirror * (studio(r, finish.x, from_floor) + key.w * 7.0 * (1.0 - finish.x) * lamps(r))
             + directional(vec3(0.0), vec3(0.04), alpha, n, v, nv, key_to.xyz, key.rgb)
             + directional(vec3(0.0), vec3(0.04), alpha, n, v, nv, rim_to.xyz, rim.rgb);
  vec3 share = (1.0 - mirror) * (1.0 - body + 0.5 * body * base);
  float covered = 1.0 - share.g;
  passed = vec4(share, share.g);
  result = vec4(tone_map(shade / covered) * covered, covered);
}
)";

// A rim: the polished end of a wall, bright against what is dark and coloured against what is bright.
const char* const glass_edge_fragment = R"(
layout(location = 0, index = 1) out vec4 passed;
void main() {
  vec3 base = own_color();
  passed = 0.45 * vec4(base, base.g);
  result = vec4(tone_map(base * (key.w + 0.5 * inverse_pi * key.rgb)) * 0.35, 1.0 - passed.a);
}
)";

// A square around the cone that touches the sphere from the eye, across the way to its center.
const char* const sphere_vertex = R"(
layout(location = 0) in vec3 position;
layout(location = 2) in float place;
uniform float radius;
flat out float value;
out vec3 way;          // from the eye
flat out vec3 center;  // from the eye
flat out vec3 from_floor;
void main() {
  value = place;
  from_floor = floor_light(position);
  vec2 corner = vec2(gl_VertexID & 1, gl_VertexID >> 1) * 2.0 - 1.0;
  center = position - eye.xyz;
  float distance = length(center);
  vec3 axis = back.w == 0.0 ? center / distance : -back.xyz;
  vec3 u = normalize(cross(axis, abs(axis.z) < 0.9 ? vec3(0.0, 0.0, 1.0) : vec3(1.0, 0.0, 0.0)));
  float slant = back.w == 0.0 ? radius * radius / (distance * distance) : 0.0;
  float size = radius / sqrt(max(1.0 - slant, 1e-3));
  way = center + size * (corner.x * u + corner.y * cross(axis, u));
  gl_Position = clip * vec4(eye.xyz + way, 1.0);
}
)";

// The outline is decided at each sample of the pixel, from the slope of (r^2 - distance^2) of ray and center.
const char* const sphere_fragment = R"(
uniform vec4 color;
uniform vec3 finish;
uniform float radius;
flat in float value;
in vec3 way;
flat in vec3 center;
flat in vec3 from_floor;
out vec4 result;
void main() {
  vec3 ray = back.w == 0.0 ? normalize(way) : -back.xyz;
  vec3 start = back.w == 0.0 ? vec3(0.0) : way;  // of the ray, from the eye
  float along = dot(ray, center - start);
  vec3 miss = start + along * ray - center;
  float inside = radius * radius - dot(miss, miss);
#ifdef SAMPLE_MASK
  vec2 slope = vec2(dFdx(inside), dFdy(inside));
  int mask = 0;
  for (int i = 0; i < int(viewport.w); ++i)
    if (inside + dot(slope, samples[i].xy) >= 0.0) mask |= 1 << i;
  if (mask == 0) discard;
  gl_SampleMask[0] = mask;
#else
  if (inside < 0.0) discard;
#endif
  vec3 hit = start + ray * (along - sqrt(max(inside, 0.0)));
  vec3 p = eye.xyz + hit;
  vec4 c = clip * vec4(p, 1.0);
  gl_FragDepth = 0.5 + 0.5 * c.z / c.w;
  vec3 shade = body_color(base_color(color.rgb, value), finish.x, finish.z, p, normalize(hit - center), from_floor);
  result = vec4(dither(tone_map(shade)) * color.a, color.a);  // premultiplied
}
)";

const char* const wire_vertex = R"(
layout(location = 0) in vec3 position;
void main() { gl_Position = clip * vec4(position, 1.0); }
)";

const char* const wire_fragment = R"(
uniform vec3 color;
out vec4 result;
void main() { result = vec4(color, 1.0); }
)";

const char* const ground_vertex = R"(
uniform float drop;  // below its true height, so that what stands on it wins [m]
out vec2 spot;
void main() {
  vec2 corner = vec2(gl_VertexID & 1, gl_VertexID >> 1) * 2.0 - 1.0;
  spot = ground.yz + corner * ground.w;
  gl_Position = clip * vec4(spot, ground.x - drop, 1.0);
}
)";

const char* const ground_fragment = R"(
uniform sampler2D ground_light;
in vec2 spot;
out vec4 result;
void main() {
  vec2 place = (spot - region.xy) * region.zw;
  // Most of the floor lies beyond what is baked: a loop of length zero is skipped, see key_share of the bodies.
  vec2 share = vec2(1.0);
  int baked = bounce.w == 0.0 || place != clamp(place, 0.0, 1.0) ? 0 : 1;
  for (int i = 0; i < baked; ++i) share = textureLod(ground_light, place, 0.0).rg;
  vec3 shade = bounce.rgb * (key.rgb * (max(key_to.z, 0.0) * share.r * inverse_pi) + key.w * share.g);
  float away = distance(spot, ground.yz) / ground.w;
  float fade = smoothstep(0.12, 1.0, away);
  fade = 1.0 - (1.0 - fade) * (1.0 - fade);
  vec3 shown = mix(tone_map(shade), backdrop_color(), fade);
  result = vec4(dither(shown), 1.0);
}
)";

// One triangle over the picture, behind everything.
const char* const backdrop_vertex = R"(
void main() {
  vec2 corner = vec2(gl_VertexID & 1, gl_VertexID >> 1) * 4.0 - 1.0;
  gl_Position = vec4(corner, 1.0, 1.0);
}
)";

const char* const backdrop_fragment = R"(
out vec4 result;
void main() { result = vec4(dither(backdrop_color()), 1.0); }
)";

const char* const mesh_depth_vertex = R"(
layout(location = 0) in vec3 position;
uniform mat4 projection;
void main() { gl_Position = projection * vec4(position, 1.0); }
)";

const char* const empty_fragment = R"(
void main() {}
)";

// across, up: the projection's axes; the third looks back along it.
const char* const sphere_depth_vertex = R"(
layout(location = 0) in vec3 position;
uniform mat4 projection;
uniform mat3 axes;
uniform float radius;
out vec2 spot;
flat out float rise;
void main() {
  spot = vec2(gl_VertexID & 1, gl_VertexID >> 1) * 2.0 - 1.0;
  vec4 front = projection * vec4(axes[2] * radius, 0.0);
  rise = 0.5 * front.z;
  gl_Position = projection * vec4(position + radius * (axes[0] * spot.x + axes[1] * spot.y), 1.0);
}
)";

const char* const sphere_depth_fragment = R"(
in vec2 spot;
flat in float rise;
void main() {
  float inside = 1.0 - dot(spot, spot);
  if (inside < 0.0) discard;
  gl_FragDepth = gl_FragCoord.z + rise * sqrt(inside);
}
)";

const char* const texels_vertex = R"(
out vec2 place;
void main() {
  vec2 corner = vec2(gl_VertexID & 1, gl_VertexID >> 1) * 4.0 - 1.0;
  place = 0.5 + 0.5 * corner;
  gl_Position = vec4(corner, 0.0, 1.0);
}
)";

// Percentage-closer soft shadows (Fernando 2005): the penumbra is as wide as the blockers are far, times the light's width.
// The receiver is a plane, so its depth under every tap is known and no bias is needed. Each texel of a 4 x 4 block turns the
// taps by another sixteenth; the mean over a block, taken later, has all of them.
const char* const ground_key_fragment = R"(
uniform sampler2DShadow shadow_map;
uniform sampler2D shadow_depths;
in vec2 place;
out vec4 result;
const mat2 golden = mat2(-0.73736888, 0.67549029, -0.67549029, -0.73736888);
void main() {
  ivec2 texel = ivec2(gl_FragCoord.xy);
  int x = texel.x ^ texel.y;
  float turn = float(((x & 1) << 3) | ((texel.y & 1) << 2) | (x & 2) | ((texel.y & 2) >> 1)) / 16.0;
  vec2 spot = region.xy + place / region.zw;
  vec3 s = (shadow * vec4(spot, ground.x, 1.0)).xyz;
  float reach = blur.w * clamp(s.z, 0.0, 2.0) + 2.0 * plane.z;
  float blockers = 0.0, height = 0.0;
  vec2 first = vec2(cos(6.2831853 * turn), sin(6.2831853 * turn));
  vec2 way = first;
  for (int i = 0; i < BLOCKER_TAPS; ++i) {
    way = golden * way;
    vec2 tap = way * (reach * sqrt((float(i) + turn) / float(BLOCKER_TAPS)));
    float gap = s.z + dot(plane.xy, tap) - textureLod(shadow_depths, s.xy + tap, 0.0).r;
    blockers += gap > 0.0 ? 1.0 : 0.0;
    height += max(gap, 0.0);
  }
  float radius = max(blur.w * height / max(blockers, 1.0), 1.5 * plane.z);
  // A loop of length zero is skipped, a branch not taken is not: see key_share of the bodies.
  int taps = blockers == 0.0 ? 0 : GROUND_TAPS;
  float lit = 0.0;
  way = first;
  for (int i = 0; i < taps; ++i) {
    way = golden * way;
    vec2 tap = way * (radius * sqrt((float(i) + turn) / float(GROUND_TAPS)));
    lit += textureLod(shadow_map, vec3(s.xy + tap, min(s.z + dot(plane.xy, tap), 1.0)), 0.0);
  }
  result = vec4(taps == 0 ? 1.0 : lit / float(taps), 0.0, 0.0, 1.0);
}
)";

// A horizontal patch at height h over a ring from r1 to r2 takes r2^2/(r2^2+h^2) - r1^2/(r1^2+h^2) of the cosine-weighted sky
// (the form factor of a disc); rings of taps find h in the map of undersides.
const char* const ground_sky_fragment = R"(
uniform sampler2D underside;
in vec2 place;
out vec4 result;
const mat2 golden = mat2(-0.73736888, 0.67549029, -0.67549029, -0.73736888);
void main() {
  float covered = 0.0;
  float inner = 0.0;
  float outer = 0.04 * rim_to.w;
  vec2 way = vec2(1.0, 0.0);
  for (int ring = 0; ring < 6; ++ring) {
    for (int i = 0; i < SKY_TAPS; ++i) {
      way = golden * way;
      float r = mix(inner, outer, (float(i) + 0.5) / float(SKY_TAPS));
      float h = textureLod(underside, place + way * r * region.zw, 0.0).r;
      float h2 = h * h * plane.w * plane.w + 1e-6 * rim_to.w * rim_to.w;
      covered += h >= 1.0 ? 0.0 : outer * outer / (outer * outer + h2) - inner * inner / (inner * inner + h2);
    }
    inner = outer;
    outer *= 1.75;
  }
  result = vec4(clamp(1.0 - covered / float(SKY_TAPS), 0.0, 1.0), 0.0, 0.0, 1.0);
}
)";

// Means over 4 x 4 texels, by four taps that each lie between four. Under a body some light still comes by way of other
// surfaces, so nothing is quite black. Towards the edge of what is baked both shares go to 1.
const char* const ground_light_fragment = R"(
uniform sampler2D ground_key;
uniform sampler2D ground_sky;
in vec2 place;
out vec4 result;
float mean(sampler2D map) {
  vec2 texel = 1.0 / vec2(textureSize(map, 0));
  float sum = 0.0;
  for (int i = 0; i < 4; ++i) sum += textureLod(map, place + texel * (vec2(i & 1, i >> 1) * 2.0 - 1.5), 0.0).r;
  return 0.25 * sum;
}
void main() {
  vec2 edge = smoothstep(vec2(0.0), vec2(0.1), min(place, 1.0 - place));
  float inside = edge.x * edge.y;
  float sky = mean(ground_sky);
  sky = 0.16 + sky * (0.70 + 0.14 * sky);
  result = vec4(mix(1.0, mean(ground_key), inside), mix(1.0, sky, inside), 0.0, 1.0);
}
)";

}  // namespace

ShaderSources::ShaderSources(bool sample_mask, const Detail& detail) {
  const std::string head = shader_head(sample_mask, detail);
  const std::string color = head + shader_color();
  const std::string lit_vertex = head + shader_floor_light();
  const std::string light = color + shader_base_color() + shader_light();
  mesh = {lit_vertex + mesh_vertex, light + mesh_surface + mesh_fragment};
  glass = {lit_vertex + mesh_vertex, light + mesh_surface + glass_fragment};
  glass_edge = {lit_vertex + mesh_vertex, light + mesh_surface + glass_edge_fragment};
  sphere = {lit_vertex + sphere_vertex, light + sphere_fragment};
  wire = {head + wire_vertex, head + wire_fragment};
  ground = {head + ground_vertex, color + ground_fragment};
  backdrop = {head + backdrop_vertex, color + backdrop_fragment};
  mesh_depth = {head + mesh_depth_vertex, head + empty_fragment};
  sphere_depth = {head + sphere_depth_vertex, head + sphere_depth_fragment};
  ground_key = {head + texels_vertex, head + ground_key_fragment};
  ground_sky = {head + texels_vertex, head + ground_sky_fragment};
  ground_light = {head + texels_vertex, head + ground_light_fragment};
}

}  // namespace deforma
