#include "ui/picture_programs.h"

#include <GLES3/gl3.h>

#include <string>

#include "ui/gl.h"

namespace sonoband::ui {
namespace {

constexpr const char* head = "#version 300 es\nprecision highp float;\n";

constexpr const char* light_source = R"(
uniform sampler2D picture;
uniform vec2 window;  // light = window.x value + window.y
float windowed(float grey) { return clamp(window.x * grey + window.y, 0.0, 1.0); }
#ifdef DOPPLER
uniform sampler2D palette;
uniform bool in_colour;
uniform float least_level;
vec3 light_of(float value) {
  float key = floor(value * 255.0 + 0.5);
  if (key < 128.0) return vec3(windowed(key / 127.0));
  float level = floor((key - 128.0) / 2.0);
  if (!in_colour) return vec3(windowed(level / 63.0));
  return level < least_level ? vec3(0.0) : texelFetch(palette, ivec2(int(key), 0), 0).rgb;
}
#else
vec3 light_of(float value) { return vec3(windowed(value)); }
#endif
vec4 light(vec2 at) {
#ifdef COVERED
  vec2 texel = texture(picture, at).rg;
  return vec4(light_of(texel.r), step(0.5, texel.g));
#else
  return vec4(light_of(texture(picture, at).r), 1.0);
#endif
}
)";

}  // namespace

PicturePrograms::PicturePrograms(const char* vertex, const char* fragment) {
  for (std::size_t i = 0; i < programs_.size(); ++i) {
    std::string source = head;
    if (i / 2 == 1) source += "#define DOPPLER\n";
    if (i % 2 == 1) source += "#define COVERED\n";
    source += light_source;
    source += fragment;
    Program& p = programs_[i];
    p.number = gl::make_program(vertex, source.c_str());
    p.at_window = glGetUniformLocation(p.number, "window");
    p.at_colour = glGetUniformLocation(p.number, "in_colour");
    p.at_least_level = glGetUniformLocation(p.number, "least_level");
    glUseProgram(p.number);
    glUniform1i(glGetUniformLocation(p.number, "picture"), 0);
    glUniform1i(glGetUniformLocation(p.number, "palette"), 1);
  }
}

PicturePrograms::~PicturePrograms() {
  for (const Program& p : programs_) glDeleteProgram(p.number);
}

unsigned PicturePrograms::use(PixelKind kind, bool covered, const Look& look) const {
  const Program& p = programs_[(kind == PixelKind::doppler ? 2U : 0U) + (covered ? 1U : 0U)];
  glUseProgram(p.number);
  glUniform2f(p.at_window, look.contrast, 0.5f + look.gain - 0.5f * look.contrast);
  glUniform1i(p.at_colour, look.colour ? 1 : 0);
  glUniform1f(p.at_least_level, static_cast<float>(look.least_level));
  return p.number;
}

}  // namespace sonoband::ui
