// Paints what the simulated scanner would show of a phantom.
#pragma once

#include <cstdint>
#include <memory>
#include <vector>

#include "core/image/colour_bar.h"
#include "hal/sim/phantom.h"
#include "hal/sim/scan_lines.h"
#include "hal/sim/scanner.h"
#include "hal/sim/speckle.h"

namespace sonoband::sim {

// Echoes of an Anatomy: per beam and depth, the tissue's scatterers (fixed in space, so a still probe sees
// the same speckle) summed over the beam's width and elevation; bones shine where the beam meets them
// squarely and take from what lies behind. Then envelope, logarithm and scan conversion. A GreyField is
// copied as it is.
//
// Keeps buffers: one object per thread. Same seed, pose and time, same bytes.
class BscanSimulator {
 public:
  BscanSimulator(std::shared_ptr<const Phantom> phantom, const WorldFromPhantom& world_from_phantom,
                 const ScannerSettings& settings, std::uint64_t seed);

  // `out` has settings.height_px rows of settings.width_px pixels of 1 byte (grey8) or 3 (rgb24). Every byte
  // is written; outside the body's picture it is black or decoration.
  void paint(const WorldFromImage& world_from_image, Stamp t, std::uint8_t* out, std::ptrdiff_t stride_bytes);

  const ScannerSettings& settings() const { return settings_; }

 private:
  void gather_echoes(const Anatomy& body, const Affine<frame::Phantom, frame::Image>& phantom_from_image,
                     Stamp t);
  void compress();  // echoes to grey
  void convert(std::uint8_t* out, std::ptrdiff_t stride_bytes) const;
  void copy_field(const GreyField& field, const Affine<frame::Phantom, frame::Image>& phantom_from_image,
                  std::uint8_t* out, std::ptrdiff_t stride_bytes) const;
  std::int8_t colour_level(float velocity_mm_s) const;

  struct Response {  // of a shape, ready for the inner loop
    float amplitude;
    float gain_per_sample;
    float specular;
    bool bone;
    bool diffuse;  // the same from all sides
    bool flows;
  };

  std::shared_ptr<const Phantom> phantom_;
  Rigid<frame::Phantom, frame::World> phantom_from_world_;
  ScannerSettings settings_;
  std::uint64_t seed_;
  SpeckleField speckle_;
  ScanLines lines_;
  doppler::ColourBar bar_ = doppler::red_blue_bar();
  std::vector<Response> responses_;    // by shape
  std::vector<float> depth_gain_;      // by sample
  std::vector<float> noise_;           // a stretch of receiver noise, longer than a frame needs
  std::vector<std::uint8_t> grey_of_;  // by the upper bits of a power
  std::vector<float> re_;              // samples x beams
  std::vector<float> im_;
  std::vector<std::uint8_t> grey_;
  std::vector<std::int8_t> level_;  // signed colour level, 0 is grey
};

}  // namespace sonoband::sim
