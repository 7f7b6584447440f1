#include "ui/gl.h"

#include <GLES3/gl3.h>

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

}  // namespace sonoband::ui::gl
