// A frame in memory: EGL without a window system, drawing into a framebuffer object. Runs on Mesa's software
// rasteriser on any machine; same input, same pixels on one machine.
#pragma once

#include <cstdint>
#include <memory>
#include <vector>

#include "ui/host/surface.h"

namespace sonoband::ui {

// 4 bytes a pixel (red, green, blue, 255), rows from the top, packed.
struct Rgba {
  int width = 0;
  int height = 0;
  std::vector<std::uint8_t> bytes;
};

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

  void resize(int width, int height);
  Input& inject() { return injected_; }
  Rgba read() const;  // the last frame

 private:
  struct Egl;
  std::unique_ptr<Egl> egl_;
  Input injected_;
};

}  // namespace sonoband::ui
