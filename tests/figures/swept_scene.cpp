#include "tests/figures/swept_scene.h"

#include <algorithm>
#include <utility>

#include "core/image/colour_bar.h"
#include "core/image/overlay.h"

namespace sonoband::figures {
namespace {

// The luma of what is not coloured; coloured pixels move too much to be a drawing.
Pixels keys_of(const std::vector<std::uint8_t>& rgb, int width, int height) {
  static const doppler::ColourClassifier classifier(doppler::red_blue_bar(), {});
  Pixels keys(width, height);
  classifier.classify(rgb.data(), std::ptrdiff_t{3} * width, {}, keys.view(), {});
  return keys;
}

}  // namespace

SweptScene sweep(const std::string& preset, int frames, bool mask_overlay) {
  sim::SceneSettings settings;
  settings.preset = preset;
  SweptScene swept;
  swept.scene = sim::make_scene(settings);
  const sim::SimulatedScene& scene = swept.scene;
  const int width = scene.scanner.width_px;
  const int height = scene.scanner.height_px;
  const bool colour = scene.scanner.format == PixelFormat::rgb24;
  const sim::PaintFrame paint = scene.painter();
  const Stamp start{};
  scene.hand->begin(start);
  const sim::SweepTime time = scene.hand->path().sweeps().front();

  OverlayDetector overlay(width, height);
  std::vector<std::uint8_t> screen(static_cast<std::size_t>(width) * height * (colour ? 3 : 1));
  for (int i = 0; i < frames; ++i) {
    const Stamp captured = start + time.begin + (time.end - time.begin) * i / frames + scene.scanner_latency;
    paint(captured, screen.data(), static_cast<std::ptrdiff_t>(screen.size()) / height);
    Pixels picture(width, height);
    if (colour) {
      picture = keys_of(screen, width, height);
    } else {
      std::copy(screen.begin(), screen.end(), picture.view().data);
    }
    overlay.add(std::as_const(picture).view());
    TrackedFrame frame;
    frame.captured = captured;
    frame.sequence = i;
    set_pose(frame, scene.world_from_image(captured));
    swept.frames.push_back(frame);
    swept.pictures.push_back(std::move(picture));
  }
  for (int i = 0; i < frames; ++i) {
    swept.frames[i].bscan = {std::as_const(swept.pictures[i]).view(),
                             colour ? PixelKind::doppler : PixelKind::grey};
    swept.pointers.push_back(&swept.frames[i]);
  }
  OverlayRule rule;
  if (colour) rule.brightness = 55;  // of 127: a Doppler picture's grey has 7 bits
  const Pixels body = sim::body_mask(scene.scanner);
  swept.mask = both(body.view(), mask_overlay ? overlay.mask(rule, true).view() : ConstPixels{});
  return swept;
}

}  // namespace sonoband::figures
