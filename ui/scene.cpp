#include "ui/scene.h"

#include <GLES3/gl3.h>

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstring>
#include <utility>

#include "ui/gl.h"
#include "ui/scene_shaders.h"

namespace sonoband::ui {
namespace {

constexpr int samples_wanted = 4;
constexpr int largest_side = 4095;  // as of pictures

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

// GL takes a place in the buffer that is bound for a pointer.
const void* at_byte(std::size_t offset) {
  return reinterpret_cast<const void*>(offset);  // NOLINT(performance-no-int-to-ptr)
}

}  // namespace

Scene::Scene(Pictures& pictures, DrawKinds& kinds)
    : pictures_(pictures), kinds_(kinds), band_programs_(band_vertex, band_fragment) {
  line_program_ = gl::make_program(line_vertex, tint_fragment);
  face_program_ = gl::make_program(face_vertex, tint_fragment);
  glGenTextures(1, &texture_);
  glGenFramebuffers(1, &target_);
  glGenFramebuffers(1, &resolved_);
  glGenRenderbuffers(1, &colour_samples_);
  glGenRenderbuffers(1, &depth_samples_);
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

void Scene::make_target() {
  if (made_width_ == width_ && made_height_ == height_) return;
  GLint most = 0;
  glGetIntegerv(GL_MAX_SAMPLES, &most);
  const GLint samples = std::min(most, samples_wanted);
  glBindRenderbuffer(GL_RENDERBUFFER, colour_samples_);
  glRenderbufferStorageMultisample(GL_RENDERBUFFER, samples, GL_RGBA8, width_, height_);
  glBindRenderbuffer(GL_RENDERBUFFER, depth_samples_);
  glRenderbufferStorageMultisample(GL_RENDERBUFFER, samples, GL_DEPTH_COMPONENT24, width_, height_);
  glBindFramebuffer(GL_FRAMEBUFFER, target_);
  glFramebufferRenderbuffer(GL_FRAMEBUFFER, GL_COLOR_ATTACHMENT0, GL_RENDERBUFFER, colour_samples_);
  glFramebufferRenderbuffer(GL_FRAMEBUFFER, GL_DEPTH_ATTACHMENT, GL_RENDERBUFFER, depth_samples_);
  glActiveTexture(GL_TEXTURE0);
  glBindTexture(GL_TEXTURE_2D, texture_);
  glTexImage2D(GL_TEXTURE_2D, 0, GL_RGBA8, off_power_of_two(width_), off_power_of_two(height_), 0, GL_RGBA,
               GL_UNSIGNED_BYTE, nullptr);
  glTexParameteri(GL_TEXTURE_2D, GL_TEXTURE_MIN_FILTER, GL_LINEAR);
  glTexParameteri(GL_TEXTURE_2D, GL_TEXTURE_MAG_FILTER, GL_LINEAR);
  // What is cut off at one edge must not show at the other.
  glTexParameteri(GL_TEXTURE_2D, GL_TEXTURE_WRAP_S, GL_CLAMP_TO_EDGE);
  glTexParameteri(GL_TEXTURE_2D, GL_TEXTURE_WRAP_T, GL_CLAMP_TO_EDGE);
  glBindFramebuffer(GL_FRAMEBUFFER, resolved_);
  glFramebufferTexture2D(GL_FRAMEBUFFER, GL_COLOR_ATTACHMENT0, GL_TEXTURE_2D, texture_, 0);
  made_width_ = width_;
  made_height_ = height_;
}

OutlineView Scene::view(const SceneInput& input, const Rect& window) {
  if (sweep_version_ != input.frames_version) {
    sweep_ = frame_of(input.frames);
    sweep_version_ = input.frames_version;
  }
  if (input.frames.empty() && input.probe) sweep_ = frame_of(*input.probe);
  return {sweep_, input.orbit, window};
}

void Scene::send_frames(const SceneInput& input, const OutlineView& eye) {
  const Sent wanted{input.frames_version, width_, height_, input.orbit};
  if (wanted == sent_) return;
  sent_ = wanted;
  outlines_apart(input.frames, eye, least_apart_px, shown_);
  geometry_.make_outlines(input, shown_, sweep_);
  const auto lines = geometry_.lines();
  glBindVertexArray(0);
  glBindBuffer(GL_ARRAY_BUFFER, frame_buffer_);
  glBufferData(GL_ARRAY_BUFFER, static_cast<GLsizeiptr>(lines.size_bytes()), lines.data(), GL_DYNAMIC_DRAW);
  frame_lines_ = static_cast<int>(lines.size());
}

SceneTexture Scene::texture() const {
  const int width = off_power_of_two(width_);
  const int height = off_power_of_two(height_);
  return {texture_,
          {static_cast<float>(width_) / static_cast<float>(width),
           static_cast<float>(height_) / static_cast<float>(height)},
          texture_kind(GL_RGBA8, GL_LINEAR, width, height)};
}

void Scene::draw_lines(unsigned buffer, int count, float fade) {
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
    glVertexAttribPointer(at, size, type, normalised, sizeof(SceneLine), at_byte(offset));
    glVertexAttribDivisor(at, 1);
  };
  attribute(0, 3, GL_FLOAT, GL_FALSE, offsetof(SceneLine, a));
  attribute(1, 3, GL_FLOAT, GL_FALSE, offsetof(SceneLine, b));
  attribute(2, 4, GL_UNSIGNED_BYTE, GL_TRUE, offsetof(SceneLine, rgba));
  attribute(3, 1, GL_FLOAT, GL_FALSE, offsetof(SceneLine, width_px));
  glDrawArraysInstanced(GL_TRIANGLE_STRIP, 0, 4, count);
  kinds_.note();
}

SceneTexture Scene::render(const SceneInput& input, int width, int height, float line_px) {
  width = std::clamp(width, 1, largest_side);
  height = std::clamp(height, 1, largest_side);
  const Key key{input.frames_version, input.band_version, hash_of(input), input.current, width, height,
                input.orbit,          input.look};
  if (drawn_once_ && key == drawn_) return texture();
  drawn_ = key;
  drawn_once_ = true;
  asked_ = input;
  asked_line_px_ = line_px;
  waits_ = true;
  width_ = width;
  height_ = height;
  return texture();
}

// World (relative to the sweep's middle) to clip space; depth over ten radii, so that nothing is cut off.
void Scene::look_from(const OutlineView& eye) {
  const Eigen::Matrix3d& e = eye.eye_from_world();
  const double sx = 2 * eye.px_per_mm() / width_;
  const double sy = -2 * eye.px_per_mm() / height_;
  const double sz = 1 / (10 * sweep_.radius_mm);
  for (int column = 0; column < 3; ++column) {
    clip_from_world_[column * 4 + 0] = static_cast<float>(sx * e(0, column));
    clip_from_world_[column * 4 + 1] = static_cast<float>(sy * e(1, column));
    clip_from_world_[column * 4 + 2] = static_cast<float>(sz * e(2, column));
    clip_from_world_[column * 4 + 3] = 0;
  }
  clip_from_world_[12] = 2 * eye.middle().x / static_cast<float>(width_) - 1;
  clip_from_world_[13] = 1 - 2 * eye.middle().y / static_cast<float>(height_);
  clip_from_world_[14] = 0;
  clip_from_world_[15] = 1;
}

void Scene::draw_band(const SceneInput& input) {
  const ReslicePlane& p = input.band_plane;
  const Eigen::Vector3d corner = p.origin.v - 0.5 * p.pixel_mm * (p.right.v + p.down.v) - sweep_.centre;
  const Eigen::Vector3f o = corner.cast<float>();
  const Eigen::Vector3f r = (p.right.v * (p.width * p.pixel_mm)).cast<float>();
  const Eigen::Vector3f d = (p.down.v * (p.height * p.pixel_mm)).cast<float>();
  const Vec2 part = pictures_.part(Slot::reslice);
  const unsigned program =
      band_programs_.use(pictures_.kind(Slot::reslice), pictures_.has_coverage(Slot::reslice), input.look);
  const auto place = [program](const char* name) { return glGetUniformLocation(program, name); };
  glUniformMatrix4fv(place("clip_from_world"), 1, GL_FALSE, clip_from_world_.data());
  glUniform3fv(place("origin"), 1, o.data());
  glUniform3fv(place("right"), 1, r.data());
  glUniform3fv(place("down"), 1, d.data());
  glUniform2f(place("part"), part.x, part.y);
  glActiveTexture(GL_TEXTURE1);
  glBindTexture(GL_TEXTURE_2D, pictures_.palette());
  glActiveTexture(GL_TEXTURE0);
  glBindTexture(GL_TEXTURE_2D, pictures_.texture(Slot::reslice));
  const TextureKind read = pictures_.texture_kind(Slot::reslice, true);
  glTexParameteri(GL_TEXTURE_2D, GL_TEXTURE_MIN_FILTER, static_cast<GLint>(read.filter));
  glTexParameteri(GL_TEXTURE_2D, GL_TEXTURE_MAG_FILTER, static_cast<GLint>(read.filter));
  glBindVertexArray(no_vertices_);
  glDrawArrays(GL_TRIANGLE_STRIP, 0, 4);
  kinds_.note(read);
}

void Scene::draw_marks(const SceneInput& input) {
  geometry_.make_marks(input, sweep_, asked_line_px_);
  const auto lines = geometry_.lines();
  glBindVertexArray(0);
  glBindBuffer(GL_ARRAY_BUFFER, mark_buffer_);
  glBufferData(GL_ARRAY_BUFFER, static_cast<GLsizeiptr>(lines.size_bytes()), lines.data(), GL_STREAM_DRAW);
  draw_lines(mark_buffer_, static_cast<int>(lines.size()), 1);

  const auto corners = geometry_.corners();
  if (corners.empty()) return;
  glDepthMask(GL_FALSE);
  glUseProgram(face_program_);
  glUniformMatrix4fv(glGetUniformLocation(face_program_, "clip_from_world"), 1, GL_FALSE,
                     clip_from_world_.data());
  glBindVertexArray(face_vertices_);
  glBindBuffer(GL_ARRAY_BUFFER, face_buffer_);
  glBufferData(GL_ARRAY_BUFFER, static_cast<GLsizeiptr>(corners.size_bytes()), corners.data(),
               GL_STREAM_DRAW);
  glEnableVertexAttribArray(0);
  glVertexAttribPointer(0, 3, GL_FLOAT, GL_FALSE, sizeof(SceneCorner), at_byte(offsetof(SceneCorner, at)));
  glEnableVertexAttribArray(2);
  glVertexAttribPointer(2, 4, GL_UNSIGNED_BYTE, GL_TRUE, sizeof(SceneCorner),
                        at_byte(offsetof(SceneCorner, rgba)));
  glDrawArrays(GL_TRIANGLES, 0, static_cast<GLsizei>(corners.size()));
  kinds_.note();
  glDepthMask(GL_TRUE);
}

void Scene::draw() {
  if (!waits_) return;
  waits_ = false;
  ++renders_;
  const SceneInput input = std::exchange(asked_, {});
  const OutlineView eye = view(input, {0, 0, static_cast<float>(width_), static_cast<float>(height_)});
  send_frames(input, eye);
  look_from(eye);
  GLint bound = 0;
  glGetIntegerv(GL_FRAMEBUFFER_BINDING, &bound);
  make_target();
  glBindFramebuffer(GL_FRAMEBUFFER, target_);
  glViewport(0, 0, width_, height_);
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

  if (input.band_on_plane && pictures_.has(Slot::reslice)) draw_band(input);
  // Many outlines lie on one another; each is fainter then, so that what is among them still shows.
  const float fade = std::clamp(7.0f / std::sqrt(static_cast<float>(std::max(1, frame_lines_))), 0.1f, 1.0f);
  glDepthMask(static_cast<int>(input.frames.size()) < crowd ? GL_TRUE : GL_FALSE);
  draw_lines(frame_buffer_, frame_lines_, fade);
  glDepthMask(GL_TRUE);
  draw_marks(input);

  glBindVertexArray(0);
  glDisable(GL_DEPTH_TEST);
  glBindFramebuffer(GL_READ_FRAMEBUFFER, target_);
  glBindFramebuffer(GL_DRAW_FRAMEBUFFER, resolved_);
  glBlitFramebuffer(0, 0, width_, height_, 0, 0, width_, height_, GL_COLOR_BUFFER_BIT, GL_NEAREST);
  glBindFramebuffer(GL_FRAMEBUFFER, static_cast<GLuint>(bound));
}

}  // namespace sonoband::ui
