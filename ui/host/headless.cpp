#include "ui/host/headless.h"

#include <EGL/egl.h>
#include <EGL/eglext.h>
#include <GLES3/gl3.h>

#include <algorithm>
#include <array>
#include <stdexcept>
#include <string>

#include "ui/gl.h"

namespace sonoband::ui {

void Input::clear() {
  contacts.clear();
  keys.clear();
  wheels.clear();
  close = false;
}

struct HeadlessSurface::Egl {
  EGLDisplay display = EGL_NO_DISPLAY;
  EGLContext context = EGL_NO_CONTEXT;
  GLuint framebuffer = 0;
  GLuint colour = 0;
  int width = 0;
  int height = 0;

  void make_current() const { eglMakeCurrent(display, EGL_NO_SURFACE, EGL_NO_SURFACE, context); }
  void make_framebuffer(int new_width, int new_height);
};

void HeadlessSurface::Egl::make_framebuffer(int new_width, int new_height) {
  if (framebuffer == 0) glGenFramebuffers(1, &framebuffer);
  if (colour != 0) glDeleteRenderbuffers(1, &colour);
  glGenRenderbuffers(1, &colour);
  glBindRenderbuffer(GL_RENDERBUFFER, colour);
  glRenderbufferStorage(GL_RENDERBUFFER, GL_RGBA8, new_width, new_height);
  glBindFramebuffer(GL_FRAMEBUFFER, framebuffer);
  glFramebufferRenderbuffer(GL_FRAMEBUFFER, GL_COLOR_ATTACHMENT0, GL_RENDERBUFFER, colour);
  if (glCheckFramebufferStatus(GL_FRAMEBUFFER) != GL_FRAMEBUFFER_COMPLETE) {
    throw std::runtime_error("the graphics driver has no framebuffer of " + std::to_string(new_width) +
                             " x " + std::to_string(new_height) + " pixels");
  }
  width = new_width;
  height = new_height;
}

HeadlessSurface::HeadlessSurface(int width, int height) : egl_(std::make_unique<Egl>()) {
  const auto get_display =
      reinterpret_cast<PFNEGLGETPLATFORMDISPLAYEXTPROC>(eglGetProcAddress("eglGetPlatformDisplayEXT"));
  if (get_display != nullptr) {
    egl_->display = get_display(EGL_PLATFORM_SURFACELESS_MESA, EGL_DEFAULT_DISPLAY, nullptr);
  }
  if (egl_->display == EGL_NO_DISPLAY || eglInitialize(egl_->display, nullptr, nullptr) == EGL_FALSE) {
    throw std::runtime_error(
        "no screen in memory: EGL has no surfaceless platform here; install libegl-mesa0 and "
        "libgl1-mesa-dri");
  }
  eglBindAPI(EGL_OPENGL_ES_API);
  const std::array<EGLint, 5> wanted = {EGL_RENDERABLE_TYPE, EGL_OPENGL_ES3_BIT, EGL_SURFACE_TYPE, 0,
                                        EGL_NONE};
  EGLConfig config = nullptr;
  EGLint count = 0;
  const std::array<EGLint, 5> version = {EGL_CONTEXT_MAJOR_VERSION, 3, EGL_CONTEXT_MINOR_VERSION, 0,
                                         EGL_NONE};
  if (eglChooseConfig(egl_->display, wanted.data(), &config, 1, &count) == EGL_TRUE && count > 0) {
    egl_->context = eglCreateContext(egl_->display, config, EGL_NO_CONTEXT, version.data());
  }
  if (egl_->context == EGL_NO_CONTEXT) {
    throw std::runtime_error(
        "no screen in memory: EGL gives no OpenGL ES 3.0 context; install libgl1-mesa-dri");
  }
  egl_->make_current();
  egl_->make_framebuffer(width, height);
}

HeadlessSurface::~HeadlessSurface() {
  egl_->make_current();
  glDeleteFramebuffers(1, &egl_->framebuffer);
  glDeleteRenderbuffers(1, &egl_->colour);
  eglMakeCurrent(egl_->display, EGL_NO_SURFACE, EGL_NO_SURFACE, EGL_NO_CONTEXT);
  eglDestroyContext(egl_->display, egl_->context);
  // The display is shared by all of this process's surfaces and stays open.
}

Vec2 HeadlessSurface::size_px() const {
  return {static_cast<float>(egl_->width), static_cast<float>(egl_->height)};
}

void HeadlessSurface::poll(Input& input, Stamp, Duration) {
  input.contacts.insert(input.contacts.end(), injected_.contacts.begin(), injected_.contacts.end());
  input.keys.insert(input.keys.end(), injected_.keys.begin(), injected_.keys.end());
  input.wheels.insert(input.wheels.end(), injected_.wheels.begin(), injected_.wheels.end());
  input.close = input.close || injected_.close;
  injected_.clear();
}

void HeadlessSurface::begin_frame() {
  egl_->make_current();
  glBindFramebuffer(GL_FRAMEBUFFER, egl_->framebuffer);
  if (!rasterised_) glEnable(GL_RASTERIZER_DISCARD);
}

void HeadlessSurface::end_frame() {
  glFlush();
}

void HeadlessSurface::resize(int width, int height) {
  egl_->make_current();
  egl_->make_framebuffer(width, height);
}

void HeadlessSurface::finish() {
  egl_->make_current();
  glFinish();
}

Rgba HeadlessSurface::read() {
  begin_frame();
  return gl::read_pixels(egl_->width, egl_->height);
}

}  // namespace sonoband::ui
