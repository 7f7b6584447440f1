// What the graphics processor runs for the Outline; only scene.cpp includes this.
#pragma once

namespace sonoband::ui {

// Each instance is one line; its four corners are spread in pixels, so that lines keep their width.
inline constexpr const char* line_vertex = R"(#version 300 es
layout(location = 0) in vec3 a;
layout(location = 1) in vec3 b;
layout(location = 2) in vec4 rgba;
layout(location = 3) in float width_px;
uniform mat4 clip_from_world;
uniform vec2 window_px;
uniform float fade;
out vec4 tint;
void main() {
  vec4 p = clip_from_world * vec4(a, 1.0);
  vec4 q = clip_from_world * vec4(b, 1.0);
  vec2 along = (q.xy - p.xy) * window_px;
  float len = length(along);
  vec2 unit = len > 1e-4 ? along / len : vec2(1.0, 0.0);
  vec2 aside = vec2(-unit.y, unit.x);
  vec4 end = (gl_VertexID & 1) == 0 ? p : q;
  float forth = (gl_VertexID & 1) == 0 ? -1.0 : 1.0;
  float side = (gl_VertexID >> 1) == 0 ? -1.0 : 1.0;
  vec2 spread = (side * aside + 0.3 * forth * unit) * width_px / window_px;
  gl_Position = vec4(end.xy + spread, end.z, 1.0);
  tint = vec4(rgba.rgb, rgba.a * fade);
}
)";
inline constexpr const char* face_vertex = R"(#version 300 es
layout(location = 0) in vec3 a;
layout(location = 2) in vec4 rgba;
uniform mat4 clip_from_world;
out vec4 tint;
void main() {
  gl_Position = clip_from_world * vec4(a, 1.0);
  tint = rgba;
}
)";
inline constexpr const char* tint_fragment = R"(#version 300 es
precision mediump float;
in vec4 tint;
out vec4 colour;
void main() { colour = tint; }
)";
// The band on its plane: where it has no data the plane stays open.
inline constexpr const char* band_vertex = R"(#version 300 es
uniform mat4 clip_from_world;
uniform vec3 origin;
uniform vec3 right;
uniform vec3 down;
uniform vec2 part;  // of the texture
out vec2 at;
void main() {
  vec2 uv = vec2(gl_VertexID & 1, gl_VertexID >> 1);
  at = part * uv;
  gl_Position = clip_from_world * vec4(origin + uv.x * right + uv.y * down, 1.0);
}
)";
inline constexpr const char* band_fragment = R"(
in vec2 at;
out vec4 colour;
void main() {
  vec4 seen = light(at);
  if (seen.a < 0.5) discard;
  colour = vec4(seen.rgb, 0.92);
}
)";

}  // namespace sonoband::ui
