#include "ui/warm_up.h"

#include <array>
#include <cstdint>

namespace sonoband::ui {
namespace {

constexpr int side = 6;     // of the pictures, pixels
constexpr int place = 32;   // where they are drawn, pixels of the screen
constexpr int large = 200;  // a shape that is cleared
constexpr std::array<std::uint8_t, side * side> values{};
constexpr std::array<std::uint16_t, side * side> coverage{};
// No picture and no sweep comes to be the 2^63rd.
constexpr std::uint64_t first_version = std::uint64_t{1} << 63;

}  // namespace

WarmUp::WarmUp(Pictures& pictures, Scene& scene) : pictures_(pictures), scene_(scene) {
  bscan_.bscan.pixels = {values.data(), side, side, side};
  set_pose(bscan_, {});
  // Lines of a crowd are drawn in one way, the marks among them in the other.
  crowd_.assign(Scene::crowd, &bscan_);
}

WarmUp::~WarmUp() {
  pictures_.show(Slot::reslice, {});
}

void WarmUp::draw(int i, Draw& draw) {
  const std::uint64_t version = first_version + static_cast<std::uint64_t>(i);
  Picture band;
  band.pixels = {values.data(), side, side, side};
  if (i % 2 == 0) band.coverage = {coverage.data(), side, side, side};
  band.kind = i < 4 ? PixelKind::grey : PixelKind::doppler;
  Look look;
  look.smooth = i < 2;
  band.version = version;
  pictures_.show(Slot::reslice, band);

  SceneInput input;
  input.frames = crowd_;
  input.frames_version = version;
  input.current = 0;
  input.band_plane.width = input.band_plane.height = side;
  input.plane = input.band_plane;
  input.band_on_plane = true;
  input.band_version = version;

  const Rect r{0, 0, place, place};
  draw.fill({0, 0, large, large}, colour::ground);
  draw.text({0, 0}, Type::body, colour::ink, "0");
  draw.picture(Slot::reslice, r, look);
  draw.scene(scene_.render(input, place - 1, place - 1, 1), r);
}

}  // namespace sonoband::ui
