#include "ui/gl.h"

#include <GLES3/gl3.h>

#include <algorithm>
#include <array>
#include <stdexcept>
#include <string>

namespace sonoband::ui::gl {
namespace {

GLuint compile(GLenum kind, const char* source) {
  const GLuint shader = glCreateShader(kind);
  glShaderSource(shader, 1, &source, nullptr);
  glCompileShader(shader);
  GLint ok = 0;
  glGetShaderiv(shader, GL_COMPILE_STATUS, &ok);
  if (ok == 0) {
    std::array<char, 1024> log{};
    glGetShaderInfoLog(shader, static_cast<GLsizei>(log.size()), nullptr, log.data());
    throw std::runtime_error(std::string("the graphics driver refuses a shader: ") + log.data());
  }
  return shader;
}

}  // namespace

unsigned make_program(const char* vertex_source, const char* fragment_source) {
  const GLuint vertex = compile(GL_VERTEX_SHADER, vertex_source);
  const GLuint fragment = compile(GL_FRAGMENT_SHADER, fragment_source);
  const GLuint program = glCreateProgram();
  glAttachShader(program, vertex);
  glAttachShader(program, fragment);
  glLinkProgram(program);
  glDeleteShader(vertex);
  glDeleteShader(fragment);
  GLint ok = 0;
  glGetProgramiv(program, GL_LINK_STATUS, &ok);
  if (ok == 0) {
    std::array<char, 1024> log{};
    glGetProgramInfoLog(program, static_cast<GLsizei>(log.size()), nullptr, log.data());
    throw std::runtime_error(std::string("the graphics driver cannot link shaders: ") + log.data());
  }
  return program;
}

int take_errors(unsigned& last) {
  int count = 0;
  constexpr int most = 100;  // a lost context reports for ever
  for (GLenum e = glGetError(); e != GL_NO_ERROR && count < most; e = glGetError()) {
    last = e;
    ++count;
  }
  return count;
}

Rgba read_pixels(int width, int height) {
  Rgba out{width, height, {}};
  const std::size_t row_bytes = static_cast<std::size_t>(width) * 4;
  std::vector<std::uint8_t> upside_down(row_bytes * height);
  glReadPixels(0, 0, width, height, GL_RGBA, GL_UNSIGNED_BYTE, upside_down.data());
  out.bytes.resize(upside_down.size());
  for (int y = 0; y < height; ++y) {
    std::copy_n(upside_down.data() + (height - 1 - y) * row_bytes, row_bytes,
                out.bytes.data() + y * row_bytes);
  }
  for (std::size_t i = 3; i < out.bytes.size(); i += 4) out.bytes[i] = 255;
  return out;
}

}  // namespace sonoband::ui::gl
