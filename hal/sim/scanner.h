// The simulated ultrasound machine: its picture's geometry and its knobs.
#pragma once

#include <cstdint>
#include <optional>

#include "core/image/image.h"
#include "hal/devices.h"
#include "hal/sim/frames.h"

namespace sonoband::sim {

// Where the scanner shows flow in colour; pixels. It draws a white box round it, as real ones do.
struct ColourBox {
  int x = 0;
  int y = 0;
  int width = 0;
  int height = 0;
  bool outline = true;
  double full_scale_mm_s = 400;  // the brightest colour
  double wall_filter_mm_s = 12;  // slower flow stays grey
};

struct ScannerSettings {
  int width_px = 640;
  int height_px = 480;
  double pixel_mm = 0.2;

  enum class Array : std::uint8_t { convex, linear } array = Array::convex;
  double face_radius_mm = 50;  // convex: of the transducer's face
  double half_angle_deg = 26;  // convex
  double face_width_mm = 38;   // linear
  double face_row_px = 10;     // row of the face in the middle column
  double depth_mm = 92;
  int beams = 192;

  double dynamic_range_db = 60;
  double depth_loss_db_mm = 0.05;    // what the depth gain leaves over
  double elevation_sigma_mm = 0.55;  // of the beam, at its focus
  double focus_mm = 55;
  double speckle_mm = 0.35;  // grain, sigma; finer at higher frequency
  double noise_db = -57;     // of the receiver, against bone; new in every frame
  double heart_hz = 1.2;

  PixelFormat format = PixelFormat::grey8;  // or rgb24
  std::optional<ColourBox> colour;          // needs rgb24
  bool decorations = true;                  // ticks, letters, bars outside the picture of the body
};

// A convex abdominal probe and a linear one for vessels.
ScannerSettings abdominal();
ScannerSettings vascular();

// Middle of the face, pixel to mm; the rigid remainder of a calibration is probe_from_face.
Affine<frame::Face, frame::Image> face_from_image(const ScannerSettings& s);

// Non-zero where the picture shows the body.
Pixels body_mask(const ScannerSettings& s);

}  // namespace sonoband::sim
