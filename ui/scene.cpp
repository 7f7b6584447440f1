#include "ui/scene.h"

#include <GLES3/gl3.h>

#include <cstring>
#include <utility>

#include "ui/gl.h"

namespace sonoband::ui {
namespace {

// Each instance is one line; its four corners are spread in pixels, so that lines keep their width.
constexpr const char* line_vertex = R"(#version 300 es
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
constexpr const char* face_vertex = R"(#version 300 es
layout(location = 0) in vec3 a;
layout(location = 2) in vec4 rgba;
uniform mat4 clip_from_world;
out vec4 tint;
void main() {
  gl_Position = clip_from_world * vec4(a, 1.0);
  tint = rgba;
}
)";
constexpr const char* tint_fragment = R"(#version 300 es
precision mediump float;
in vec4 tint;
out vec4 colour;
void main() { colour = tint; }
)";
// The band on its plane: where it has no data the plane stays open.
constexpr const char* band_vertex = R"(#version 300 es
uniform mat4 clip_from_world;
uniform vec3 origin;
uniform vec3 right;
uniform vec3 down;
out vec2 uv;
void main() {
  uv = vec2(gl_VertexID & 1, gl_VertexID >> 1);
  gl_Position = clip_from_world * vec4(origin + uv.x * right + uv.y * down, 1.0);
}
)";
constexpr const char* band_fragment = R"(#version 300 es
precision highp float;
uniform sampler2D picture;
uniform sampler2D palette;
uniform vec4 window;  // gain, contrast, least level, 1 if covered
uniform int mode;     // as in pictures.cpp
in vec2 uv;
out vec4 colour;
void main() {
  vec2 texel = texture(picture, uv).rg;
  if (window.w > 0.5 && texel.g < 0.5) discard;
  float key = floor(texel.r * 255.0 + 0.5);
  float grey = mode == 0 ? texel.r : min(key, 127.0) / 127.0;
  vec3 light = vec3(clamp((grey - 0.5) * window.y + 0.5 + window.x, 0.0, 1.0));
  if (mode == 1 && key >= 128.0) {
    light = floor((key - 128.0) / 2.0) < window.z ? vec3(0.0) : texelFetch(palette, ivec2(int(key), 0), 0).rgb;
  }
  colour = vec4(light, 0.92);
}
)";

constexpr int samples_wanted = 4;

void mix(std::uint64_t& hash, const double* values, int count) {
  for (int i = 0; i < count; ++i) {
    std::uint64_t bits = 0;
    std::memcpy(&bits, &values[i], sizeof bits);
    hash = (hash ^ bits) * 1099511628211u;
  }
}

std::uint64_t hash_of(const SceneInput& in) {
  std::uint64_t hash = 14695981039346656037u;
  const auto plane = [&](const ReslicePlane& p) {
    mix(hash, p.origin.v.data(), 3);
    mix(hash, p.right.v.data(), 3);
    mix(hash, p.down.v.data(), 3);
    const std::array<double, 3> rest = {static_cast<double>(p.width), static_cast<double>(p.height),
                                        p.pixel_mm};
    mix(hash, rest.data(), 3);
  };
  if (in.plane) plane(*in.plane);
  if (in.band_on_plane) plane(in.band_plane);
  if (in.probe) {
    for (const Eigen::Vector3d& c : *in.probe) mix(hash, c.data(), 3);
  }
  for (const Eigen::Vector2d& v : in.curve_mm) mix(hash, v.data(), 2);
  const std::array<double, 3> rest = {in.thickness_mm, in.reach_mm, in.plane ? 1.0 : 0.0};
  mix(hash, rest.data(), 3);
  return hash;
}

void set_colour(std::uint8_t* out, Colour c) {
  for (int i = 0; i < 4; ++i) out[i] = static_cast<std::uint8_t>(c.rgba >> (24 - 8 * i) & 255);
}

}  // namespace

Scene::Scene(Pictures& pictures) : pictures_(pictures) {
  line_program_ = gl::make_program(line_vertex, tint_fragment);
  face_program_ = gl::make_program(face_vertex, tint_fragment);
  band_program_ = gl::make_program(band_vertex, band_fragment);
  glUseProgram(band_program_);
  glUniform1i(glGetUniformLocation(band_program_, "picture"), 0);
  glUniform1i(glGetUniformLocation(band_program_, "palette"), 1);
  glGenVertexArrays(1, &line_vertices_);
  glGenVertexArrays(1, &face_vertices_);
  glGenVertexArrays(1, &no_vertices_);
  glGenBuffers(1, &frame_buffer_);
  glGenBuffers(1, &mark_buffer_);
  glGenBuffers(1, &face_buffer_);
}

Scene::~Scene() {
  glDeleteProgram(line_program_);
  glDeleteProgram(face_program_);
  glDeleteProgram(band_program_);
  glDeleteVertexArrays(1, &line_vertices_);
  glDeleteVertexArrays(1, &face_vertices_);
  glDeleteVertexArrays(1, &no_vertices_);
  glDeleteBuffers(1, &frame_buffer_);
  glDeleteBuffers(1, &mark_buffer_);
  glDeleteBuffers(1, &face_buffer_);
  glDeleteFramebuffers(1, &target_);
  glDeleteFramebuffers(1, &resolved_);
  glDeleteRenderbuffers(1, &colour_samples_);
  glDeleteRenderbuffers(1, &depth_samples_);
  glDeleteTextures(1, &texture_);
}

void Scene::make_target(int width, int height) {
  if (texture_ != 0 && width == width_ && height == height_) return;
  if (texture_ == 0) {
    glGenFramebuffers(1, &target_);
    glGenFramebuffers(1, &resolved_);
    glGenRenderbuffers(1, &colour_samples_);
    glGenRenderbuffers(1, &depth_samples_);
  } else {
    glDeleteTextures(1, &texture_);
  }
  GLint most = 0;
  glGetIntegerv(GL_MAX_SAMPLES, &most);
  const GLint samples = std::min(most, samples_wanted);
  glBindRenderbuffer(GL_RENDERBUFFER, colour_samples_);
  glRenderbufferStorageMultisample(GL_RENDERBUFFER, samples, GL_RGBA8, width, height);
  glBindRenderbuffer(GL_RENDERBUFFER, depth_samples_);
  glRenderbufferStorageMultisample(GL_RENDERBUFFER, samples, GL_DEPTH_COMPONENT24, width, height);
  glBindFramebuffer(GL_FRAMEBUFFER, target_);
  glFramebufferRenderbuffer(GL_FRAMEBUFFER, GL_COLOR_ATTACHMENT0, GL_RENDERBUFFER, colour_samples_);
  glFramebufferRenderbuffer(GL_FRAMEBUFFER, GL_DEPTH_ATTACHMENT, GL_RENDERBUFFER, depth_samples_);
  glGenTextures(1, &texture_);
  glActiveTexture(GL_TEXTURE0);
  glBindTexture(GL_TEXTURE_2D, texture_);
  glTexStorage2D(GL_TEXTURE_2D, 1, GL_RGBA8, width, height);
  glTexParameteri(GL_TEXTURE_2D, GL_TEXTURE_MIN_FILTER, GL_LINEAR);
  glTexParameteri(GL_TEXTURE_2D, GL_TEXTURE_MAG_FILTER, GL_LINEAR);
  glBindFramebuffer(GL_FRAMEBUFFER, resolved_);
  glFramebufferTexture2D(GL_FRAMEBUFFER, GL_COLOR_ATTACHMENT0, GL_TEXTURE_2D, texture_, 0);
  width_ = width;
  height_ = height;
}

OutlineView Scene::view(const SceneInput& input, const Rect& window) {
  if (sweep_version_ != input.frames_version) {
    sweep_ = frame_of(input.frames);
    sweep_version_ = input.frames_version;
    send_frames(input);
  }
  if (input.frames.empty() && input.probe) sweep_ = frame_of(*input.probe);
  return {sweep_, input.orbit, window};
}

void Scene::send_frames(const SceneInput& input) {
  lines_.clear();
  for (const TrackedFrame* f : input.frames) {
    const auto c = corners_of(*f);
    const Colour tint = colour::ink.with_alpha(0.5f);
    add_line(c[3], c[0], tint, 1);
    add_line(c[0], c[1], tint, 1);
    add_line(c[1], c[2], tint, 1);
  }
  glBindVertexArray(0);
  glBindBuffer(GL_ARRAY_BUFFER, frame_buffer_);
  glBufferData(GL_ARRAY_BUFFER, static_cast<GLsizeiptr>(lines_.size() * sizeof(Line)), lines_.data(),
               GL_DYNAMIC_DRAW);
  frame_lines_ = static_cast<int>(lines_.size());
}

void Scene::add_line(const Eigen::Vector3d& a, const Eigen::Vector3d& b, Colour c, float width_px) {
  Line line{};
  // Relative to the middle of the sweep: floats keep a micrometre there.
  for (int i = 0; i < 3; ++i) {
    line.a[i] = static_cast<float>(a[i] - sweep_.centre[i]);
    line.b[i] = static_cast<float>(b[i] - sweep_.centre[i]);
  }
  set_colour(line.rgba, c);
  line.width_px = width_px;
  lines_.push_back(line);
}

void Scene::add_dashed(const Eigen::Vector3d& a, const Eigen::Vector3d& b, Colour c, float width_px,
                       double dash_mm) {
  const double all = (b - a).norm();
  if (!(all > 0) || !(dash_mm > 0)) return;
  const int count = std::clamp(static_cast<int>(std::round(all / (2 * dash_mm))), 1, 200);
  for (int i = 0; i < count; ++i) {
    add_line(a + (i + 0.25) / count * (b - a), a + (i + 0.75) / count * (b - a), c, width_px);
  }
}

void Scene::add_quad(const std::array<Eigen::Vector3d, 4>& quad, Colour c) {
  constexpr std::array<int, 6> order = {0, 1, 2, 0, 2, 3};
  for (const int i : order) {
    Corner corner{};
    for (int k = 0; k < 3; ++k) corner.at[k] = static_cast<float>(quad[i][k] - sweep_.centre[k]);
    set_colour(corner.rgba, c);
    corners_.push_back(corner);
  }
}

void Scene::add_marks(const SceneInput& input, float line_px) {
  lines_.clear();
  corners_.clear();
  const auto arch = [&](const std::array<Eigen::Vector3d, 4>& c) {
    add_line(c[3], c[0], colour::current, 2.4f * line_px);
    add_line(c[0], c[1], colour::current, 2.4f * line_px);
    add_line(c[1], c[2], colour::current, 2.4f * line_px);
  };
  if (input.current >= 0 && input.current < static_cast<int>(input.frames.size())) {
    arch(corners_of(*input.frames[input.current]));
  }
  if (input.probe) arch(*input.probe);
  if (!input.plane || input.plane->width < 1 || input.plane->height < 1) return;

  const ReslicePlane& p = *input.plane;
  const Eigen::Vector3d right = p.right.v * (p.width * p.pixel_mm);
  const Eigen::Vector3d down = p.down.v * (p.height * p.pixel_mm);
  const Eigen::Vector3d corner = p.origin.v - 0.5 * p.pixel_mm * (p.right.v + p.down.v);
  const Eigen::Vector3d normal = p.normal().v;
  const std::array<Eigen::Vector3d, 4> quad = {corner, corner + right, corner + right + down, corner + down};
  const auto edge = [&](const Eigen::Vector3d& off, bool dashed) {
    for (int i = 0; i < 4; ++i) {
      const Eigen::Vector3d a = quad[i] + off;
      const Eigen::Vector3d b = quad[(i + 1) % 4] + off;
      if (dashed) {
        add_dashed(a, b, colour::plane, line_px, 0.03 * sweep_.radius_mm);
      } else {
        add_line(a, b, colour::plane, 1.4f * line_px);
      }
    }
  };
  edge(Eigen::Vector3d::Zero(), false);
  if (input.thickness_mm > 0) {
    edge(0.5 * input.thickness_mm * normal, true);
    edge(-0.5 * input.thickness_mm * normal, true);
  }
  add_quad(quad, colour::plane.with_alpha(input.band_on_plane ? 0.10f : 0.30f));

  const auto on_plane = [&](const Eigen::Vector2d& mm) {
    return Eigen::Vector3d(p.origin.v + mm.x() * p.right.v + mm.y() * p.down.v);
  };
  const Eigen::Vector3d reach = input.reach_mm * normal;
  for (std::size_t i = 0; i + 1 < input.curve_mm.size(); ++i) {
    const Eigen::Vector3d a = on_plane(input.curve_mm[i]);
    const Eigen::Vector3d b = on_plane(input.curve_mm[i + 1]);
    add_line(a, b, colour::accent, 2 * line_px);
    add_line(a + reach, b + reach, colour::accent, line_px);
    add_line(a - reach, b - reach, colour::accent, line_px);
    add_quad({a - reach, b - reach, b + reach, a + reach}, colour::accent.with_alpha(0.22f));
  }
}

void Scene::draw_lines(unsigned buffer, int count, float fade) const {
  if (count == 0) return;
  glUseProgram(line_program_);
  glUniformMatrix4fv(glGetUniformLocation(line_program_, "clip_from_world"), 1, GL_FALSE,
                     clip_from_world_.data());
  glUniform2f(glGetUniformLocation(line_program_, "window_px"), static_cast<float>(width_),
              static_cast<float>(height_));
  glUniform1f(glGetUniformLocation(line_program_, "fade"), fade);
  glBindVertexArray(line_vertices_);
  glBindBuffer(GL_ARRAY_BUFFER, buffer);
  const auto attribute = [](GLuint at, GLint size, GLenum type, GLboolean normalised, std::size_t offset) {
    glEnableVertexAttribArray(at);
    glVertexAttribPointer(at, size, type, normalised, sizeof(Line), reinterpret_cast<const void*>(offset));
    glVertexAttribDivisor(at, 1);
  };
  attribute(0, 3, GL_FLOAT, GL_FALSE, offsetof(Line, a));
  attribute(1, 3, GL_FLOAT, GL_FALSE, offsetof(Line, b));
  attribute(2, 4, GL_UNSIGNED_BYTE, GL_TRUE, offsetof(Line, rgba));
  attribute(3, 1, GL_FLOAT, GL_FALSE, offsetof(Line, width_px));
  glDrawArraysInstanced(GL_TRIANGLE_STRIP, 0, 4, count);
}

unsigned Scene::render(const SceneInput& input, int width, int height, float line_px) {
  width = std::clamp(width, 1, 4096);
  height = std::clamp(height, 1, 4096);
  const Key key{input.frames_version, input.band_version, hash_of(input), input.current, width, height,
                input.orbit,          input.look};
  if (drawn_once_ && key == drawn_) return texture_;
  drawn_ = key;
  drawn_once_ = true;
  asked_ = input;
  asked_line_px_ = line_px;
  waits_ = true;
  GLint bound = 0;
  glGetIntegerv(GL_FRAMEBUFFER_BINDING, &bound);
  make_target(width, height);
  glBindFramebuffer(GL_FRAMEBUFFER, static_cast<GLuint>(bound));
  return texture_;
}

void Scene::draw() {
  if (!waits_) return;
  waits_ = false;
  ++renders_;
  const SceneInput input = std::exchange(asked_, {});
  const int width = width_;
  const int height = height_;
  const OutlineView eye = view(input, {0, 0, static_cast<float>(width), static_cast<float>(height)});
  GLint bound = 0;
  glGetIntegerv(GL_FRAMEBUFFER_BINDING, &bound);
  glBindFramebuffer(GL_FRAMEBUFFER, target_);
  glViewport(0, 0, width, height);
  glDisable(GL_SCISSOR_TEST);
  glDisable(GL_CULL_FACE);
  glEnable(GL_DEPTH_TEST);
  glDepthFunc(GL_LEQUAL);
  glDepthMask(GL_TRUE);
  glEnable(GL_BLEND);
  glBlendEquation(GL_FUNC_ADD);
  glBlendFuncSeparate(GL_SRC_ALPHA, GL_ONE_MINUS_SRC_ALPHA, GL_ONE, GL_ONE_MINUS_SRC_ALPHA);
  const std::uint32_t ground = colour::panel.rgba;
  glClearColor(static_cast<float>(ground >> 24) / 255, static_cast<float>(ground >> 16 & 255) / 255,
               static_cast<float>(ground >> 8 & 255) / 255, 1);
  glClear(GL_COLOR_BUFFER_BIT | GL_DEPTH_BUFFER_BIT);

  // World (relative to the sweep's middle) to clip space; depth over ten radii, so that nothing is cut off.
  const Eigen::Matrix3d& e = eye.eye_from_world();
  const double sx = 2 * eye.px_per_mm() / width;
  const double sy = -2 * eye.px_per_mm() / height;
  const double sz = 1 / (10 * sweep_.radius_mm);
  for (int column = 0; column < 3; ++column) {
    clip_from_world_[column * 4 + 0] = static_cast<float>(sx * e(0, column));
    clip_from_world_[column * 4 + 1] = static_cast<float>(sy * e(1, column));
    clip_from_world_[column * 4 + 2] = static_cast<float>(sz * e(2, column));
    clip_from_world_[column * 4 + 3] = 0;
  }
  clip_from_world_[12] = 2 * eye.middle().x / static_cast<float>(width) - 1;
  clip_from_world_[13] = 1 - 2 * eye.middle().y / static_cast<float>(height);
  clip_from_world_[14] = 0;
  clip_from_world_[15] = 1;

  if (input.band_on_plane && pictures_.has(Slot::reslice)) {
    const ReslicePlane& p = input.band_plane;
    const Eigen::Vector3d corner = p.origin.v - 0.5 * p.pixel_mm * (p.right.v + p.down.v) - sweep_.centre;
    const Eigen::Vector3f o = corner.cast<float>();
    const Eigen::Vector3f r = (p.right.v * (p.width * p.pixel_mm)).cast<float>();
    const Eigen::Vector3f d = (p.down.v * (p.height * p.pixel_mm)).cast<float>();
    glUseProgram(band_program_);
    glUniformMatrix4fv(glGetUniformLocation(band_program_, "clip_from_world"), 1, GL_FALSE,
                       clip_from_world_.data());
    glUniform3fv(glGetUniformLocation(band_program_, "origin"), 1, o.data());
    glUniform3fv(glGetUniformLocation(band_program_, "right"), 1, r.data());
    glUniform3fv(glGetUniformLocation(band_program_, "down"), 1, d.data());
    glUniform4f(glGetUniformLocation(band_program_, "window"), input.look.gain, input.look.contrast,
                static_cast<float>(input.look.least_level),
                pictures_.has_coverage(Slot::reslice) ? 1.0f : 0.0f);
    const bool grey = pictures_.kind(Slot::reslice) == PixelKind::grey;
    glUniform1i(glGetUniformLocation(band_program_, "mode"), grey ? 0 : (input.look.colour ? 1 : 2));
    glActiveTexture(GL_TEXTURE1);
    glBindTexture(GL_TEXTURE_2D, pictures_.palette());
    glActiveTexture(GL_TEXTURE0);
    glBindTexture(GL_TEXTURE_2D, pictures_.texture(Slot::reslice));
    glTexParameteri(GL_TEXTURE_2D, GL_TEXTURE_MIN_FILTER, grey ? GL_LINEAR : GL_NEAREST);
    glTexParameteri(GL_TEXTURE_2D, GL_TEXTURE_MAG_FILTER, grey ? GL_LINEAR : GL_NEAREST);
    glBindVertexArray(no_vertices_);
    glDrawArrays(GL_TRIANGLE_STRIP, 0, 4);
  }

  // Many outlines lie on one another; each is fainter then, so that what is among them still shows.
  const float fade = std::clamp(7.0f / std::sqrt(static_cast<float>(std::max(1, frame_lines_))), 0.1f, 1.0f);
  glDepthMask(frame_lines_ < 600 ? GL_TRUE : GL_FALSE);
  draw_lines(frame_buffer_, frame_lines_, fade);
  glDepthMask(GL_TRUE);

  add_marks(input, asked_line_px_);
  glBindVertexArray(0);
  glBindBuffer(GL_ARRAY_BUFFER, mark_buffer_);
  glBufferData(GL_ARRAY_BUFFER, static_cast<GLsizeiptr>(lines_.size() * sizeof(Line)), lines_.data(),
               GL_STREAM_DRAW);
  draw_lines(mark_buffer_, static_cast<int>(lines_.size()), 1);

  if (!corners_.empty()) {
    glDepthMask(GL_FALSE);
    glUseProgram(face_program_);
    glUniformMatrix4fv(glGetUniformLocation(face_program_, "clip_from_world"), 1, GL_FALSE,
                       clip_from_world_.data());
    glBindVertexArray(face_vertices_);
    glBindBuffer(GL_ARRAY_BUFFER, face_buffer_);
    glBufferData(GL_ARRAY_BUFFER, static_cast<GLsizeiptr>(corners_.size() * sizeof(Corner)), corners_.data(),
                 GL_STREAM_DRAW);
    glEnableVertexAttribArray(0);
    glVertexAttribPointer(0, 3, GL_FLOAT, GL_FALSE, sizeof(Corner),
                          reinterpret_cast<const void*>(offsetof(Corner, at)));
    glEnableVertexAttribArray(2);
    glVertexAttribPointer(2, 4, GL_UNSIGNED_BYTE, GL_TRUE, sizeof(Corner),
                          reinterpret_cast<const void*>(offsetof(Corner, rgba)));
    glDrawArrays(GL_TRIANGLES, 0, static_cast<GLsizei>(corners_.size()));
    glDepthMask(GL_TRUE);
  }

  glBindVertexArray(0);
  glDisable(GL_DEPTH_TEST);
  glBindFramebuffer(GL_READ_FRAMEBUFFER, target_);
  glBindFramebuffer(GL_DRAW_FRAMEBUFFER, resolved_);
  glBlitFramebuffer(0, 0, width, height, 0, 0, width, height, GL_COLOR_BUFFER_BIT, GL_NEAREST);
  glBindFramebuffer(GL_FRAMEBUFFER, static_cast<GLuint>(bound));
}

}  // namespace sonoband::ui
