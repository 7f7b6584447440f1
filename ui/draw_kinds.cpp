#include "ui/draw_kinds.h"

#include <GLES3/gl3.h>

#include <algorithm>
#include <bit>

namespace sonoband::ui {
namespace {

bool is_power_of_two(int side) {
  return side > 1 && std::has_single_bit(static_cast<unsigned>(side));
}

}  // namespace

TextureKind texture_kind(unsigned format, unsigned filter, int width, int height) {
  return {format, filter, is_power_of_two(width), is_power_of_two(height)};
}

int off_power_of_two(int side) {
  return is_power_of_two(side) ? side + 1 : side;
}

void DrawKinds::note(const TextureKind& texture) {
  Kind kind;
  kind.texture = texture;
  glGetIntegerv(GL_CURRENT_PROGRAM, &kind.program);
  glGetIntegerv(GL_SAMPLES, &kind.samples);
  kind.blends = glIsEnabled(GL_BLEND) == GL_TRUE;
  kind.tests_depth = glIsEnabled(GL_DEPTH_TEST) == GL_TRUE;
  GLboolean writes = GL_FALSE;
  glGetBooleanv(GL_DEPTH_WRITEMASK, &writes);
  // Without the test nothing is written either.
  kind.writes_depth = kind.tests_depth && writes == GL_TRUE;
  if (std::find(met_.begin(), met_.end(), kind) != met_.end()) return;
  met_.push_back(kind);
  if (warm_) ++late_;
}

}  // namespace sonoband::ui
