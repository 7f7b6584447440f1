#include "ui/pictures.h"

#include <GLES3/gl3.h>

#include <algorithm>

#include "ui/gl.h"
#include "ui/theme.h"

namespace sonoband::ui {
namespace {

// The four corners come from the vertex's number; no vertex buffer is needed.
constexpr const char* vertex_source = R"(#version 300 es
uniform vec4 target;  // left, top, right, bottom in clip space
uniform vec2 part;    // of the texture
out vec2 at;
void main() {
  vec2 corner = vec2(gl_VertexID & 1, gl_VertexID >> 1);
  at = part * corner;
  gl_Position = vec4(mix(target.xy, target.zw, corner), 0.0, 1.0);
}
)";

constexpr const char* fragment_source = R"(
uniform vec3 no_data;
in vec2 at;
out vec4 colour;
void main() {
  vec4 seen = light(at);
  colour = vec4(mix(no_data, seen.rgb, seen.a), 1.0);
}
)";

// ES 3.0 promises 2048, every board of the last ten years has 4096, of which one is kept for the edge.
constexpr int largest_side = 4095;

}  // namespace

Pictures::Pictures(DrawKinds& kinds, const doppler::ColourBar& bar)
    : kinds_(kinds), programs_(vertex_source, fragment_source) {
  glGenVertexArrays(1, &vertices_);

  std::array<std::uint8_t, 256 * 4> colours{};
  for (int key = 0; key < 256; ++key) {
    const doppler::Rgb c = doppler::to_rgb(static_cast<std::uint8_t>(key), bar);
    const std::array<std::uint8_t, 4> rgba = {c.r, c.g, c.b, 255};
    std::copy(rgba.begin(), rgba.end(), colours.begin() + key * 4);
  }
  glGenTextures(1, &palette_);
  glBindTexture(GL_TEXTURE_2D, palette_);
  glTexImage2D(GL_TEXTURE_2D, 0, GL_RGBA8, 256, 1, 0, GL_RGBA, GL_UNSIGNED_BYTE, colours.data());
  glTexParameteri(GL_TEXTURE_2D, GL_TEXTURE_MIN_FILTER, GL_NEAREST);
  glTexParameteri(GL_TEXTURE_2D, GL_TEXTURE_MAG_FILTER, GL_NEAREST);
}

Pictures::~Pictures() {
  for (const Held& h : held_) {
    if (h.texture != 0) glDeleteTextures(1, &h.texture);
  }
  glDeleteTextures(1, &palette_);
  glDeleteVertexArrays(1, &vertices_);
}

void Pictures::show(Slot slot, const Picture& picture) {
  Held& held = held_[static_cast<std::size_t>(slot)];
  if (picture.version == 0 || picture.pixels.empty()) {
    held.version = 0;
    held.to_send = {};
    return;
  }
  const bool covered = !picture.coverage.empty() && picture.coverage.width == picture.pixels.width &&
                       picture.coverage.height == picture.pixels.height;
  if (picture.version == held.version) return;
  const int width = std::min(picture.pixels.width, largest_side);
  const int height = std::min(picture.pixels.height, largest_side);

  held.has_room =
      held.has_room && held.width == width && held.height == height && held.has_coverage == covered;
  held.width = width;
  held.height = height;
  held.kind = picture.kind;
  held.has_coverage = covered;
  held.version = picture.version;
  held.to_send = picture;
}

void Pictures::send() {
  for (Held& held : held_) {
    if (held.to_send.version != 0) send(held);
    held.to_send = {};
  }
}

// Value and, where there is any, coverage side by side, packed; beyond the picture its edge once more.
void Pictures::stage(const Held& held) {
  const Picture& picture = held.to_send;
  const std::size_t channels = held.has_coverage ? 2 : 1;
  const std::size_t row_bytes = channels * static_cast<std::size_t>(held.texture_width());
  staging_.resize(row_bytes * static_cast<std::size_t>(held.texture_height()));
  for (int y = 0; y < held.texture_height(); ++y) {
    const int from = std::min(y, held.height - 1);
    const std::uint8_t* value = picture.pixels.row(from);
    std::uint8_t* out = staging_.data() + static_cast<std::size_t>(y) * row_bytes;
    if (held.has_coverage) {
      const std::uint16_t* cover = picture.coverage.row(from);
      for (int x = 0; x < held.width; ++x) {
        out[2 * x] = value[x];
        out[2 * x + 1] = cover[x] != 0 ? 255 : 0;
      }
    } else {
      std::copy_n(value, held.width, out);
    }
    std::uint8_t* beyond = out + channels * static_cast<std::size_t>(held.width);
    if (beyond != out + row_bytes) std::copy_n(beyond - channels, channels, beyond);
  }
}

void Pictures::send(Held& held) {
  const Picture& picture = held.to_send;
  const bool covered = held.has_coverage;
  const bool fresh = held.texture == 0;
  if (fresh) glGenTextures(1, &held.texture);
  glActiveTexture(GL_TEXTURE0);
  glBindTexture(GL_TEXTURE_2D, held.texture);
  if (fresh) {
    glTexParameteri(GL_TEXTURE_2D, GL_TEXTURE_WRAP_S, GL_CLAMP_TO_EDGE);
    glTexParameteri(GL_TEXTURE_2D, GL_TEXTURE_WRAP_T, GL_CLAMP_TO_EDGE);
  }
  const GLenum format = covered ? GL_RG : GL_RED;
  const int width = held.texture_width();
  const int height = held.texture_height();
  const void* bytes = picture.pixels.data;
  if (covered || width != held.width || height != held.height) {
    stage(held);
    bytes = staging_.data();
  } else {
    glPixelStorei(GL_UNPACK_ROW_LENGTH, static_cast<GLint>(picture.pixels.stride));
  }
  glPixelStorei(GL_UNPACK_ALIGNMENT, 1);
  if (held.has_room) {
    glTexSubImage2D(GL_TEXTURE_2D, 0, 0, 0, width, height, format, GL_UNSIGNED_BYTE, bytes);
  } else {
    glTexImage2D(GL_TEXTURE_2D, 0, covered ? GL_RG8 : GL_R8, width, height, 0, format, GL_UNSIGNED_BYTE,
                 bytes);
  }
  glPixelStorei(GL_UNPACK_ROW_LENGTH, 0);
  glPixelStorei(GL_UNPACK_ALIGNMENT, 4);
  ++uploads_;
  held.has_room = true;
}

TextureKind Pictures::texture_kind(Slot slot, bool smooth) const {
  const Held& held = at(slot);
  const bool between = smooth && held.kind == PixelKind::grey;
  return ui::texture_kind(held.has_coverage ? GL_RG8 : GL_R8, between ? GL_LINEAR : GL_NEAREST,
                          held.texture_width(), held.texture_height());
}

void Pictures::paint(Slot slot, const Rect& target, const Look& look, float screen_width,
                     float screen_height) {
  const Held& held = at(slot);
  if (held.version == 0) return;
  const unsigned program = programs_.use(held.kind, held.has_coverage, look);
  const auto place = [program](const char* name) { return glGetUniformLocation(program, name); };
  glBindVertexArray(vertices_);
  glActiveTexture(GL_TEXTURE1);
  glBindTexture(GL_TEXTURE_2D, palette_);
  glActiveTexture(GL_TEXTURE0);
  glBindTexture(GL_TEXTURE_2D, held.texture);
  const TextureKind read = texture_kind(slot, look.smooth);
  glTexParameteri(GL_TEXTURE_2D, GL_TEXTURE_MIN_FILTER, static_cast<GLint>(read.filter));
  glTexParameteri(GL_TEXTURE_2D, GL_TEXTURE_MAG_FILTER, static_cast<GLint>(read.filter));
  glUniform4f(place("target"), 2 * target.x / screen_width - 1, 1 - 2 * target.y / screen_height,
              2 * target.right() / screen_width - 1, 1 - 2 * target.bottom() / screen_height);
  glUniform2f(place("part"), held.part().x, held.part().y);
  const std::uint32_t none = colour::no_data.rgba;
  glUniform3f(place("no_data"), static_cast<float>(none >> 24) / 255,
              static_cast<float>(none >> 16 & 255) / 255, static_cast<float>(none >> 8 & 255) / 255);
  glDrawArrays(GL_TRIANGLE_STRIP, 0, 4);
  kinds_.note(read);
}

}  // namespace sonoband::ui
