// A frame in memory: EGL without a window system, drawing into a framebuffer object. Runs on Mesa's software
// rasteriser on any machine; same input, same pixels on one machine.
#pragma once

#include <cstdint>
#include <memory>
#include <vector>

#include "ui/host/surface.h"

namespace sonoband::ui {

class HeadlessSurface final : public Surface {
 public:
  // Throws std::runtime_error with one sentence when EGL or OpenGL ES 3 is not to be had.
  HeadlessSurface(int width, int height);
  ~HeadlessSurface() override;
  HeadlessSurface(const HeadlessSurface&) = delete;
  HeadlessSurface& operator=(const HeadlessSurface&) = delete;

  Vec2 size_px() const override;
  void poll(Input& input, Stamp now, Duration wait) override;  // hands out what was injected; never waits
  void begin_frame() override;
  void end_frame() override;
  Rgba read() override;  // also after end_frame

  void resize(int width, int height);
  // Without pixels all is drawn as ever, but nothing rasterised and what read() gives is undefined: on a
  // software rasteriser that is most of the work. Asked for before the first frame, for whoever never looks.
  void without_pixels() { rasterised_ = false; }
  void finish();  // waits until all is drawn that was asked for: for timings
  Input& inject() { return injected_; }

 private:
  struct Egl;
  std::unique_ptr<Egl> egl_;
  Input injected_;
  bool rasterised_ = true;
};

}  // namespace sonoband::ui
