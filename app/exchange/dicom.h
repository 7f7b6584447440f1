// Results and sweeps as DICOM files for archives: pictures as Secondary Capture, sweeps as Ultrasound
// Multi-frame. There is no common DICOM object for tracked freehand ultrasound, so poses do not go along:
// MetaImage or NRRD carry those.
//
// Explicit VR little endian, uncompressed. Source: DICOM PS3.3 2022, A.6, A.7, A.8, C.8.5.5, C.8.5.6,
// C.8.6.1.
#pragma once

#include <cstdint>
#include <filesystem>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "app/exchange/png.h"
#include "app/exchange/progress.h"

namespace sonoband::exchange {

// "2.25." and a number of 128 bits, the same for the same text: an exam exported twice is the same exam in
// the archive. Source: PS3.5, B.2.
std::string dicom_uid(std::string_view what);

// What all objects of an exam share.
struct DicomStudy {
  std::string exam_id;
  std::int64_t created_utc_ns = 0;
  std::string label;      // of the patient, as name and id; empty: neither is said
  std::string equipment;  // for example the board
};

// A rendered band or a snapshot.
struct DicomPicture {
  std::string object;       // unique in the exam, and the same whenever this picture is written
  int number = 1;           // within its series
  std::string description;  // of the series
  std::string derivation;   // how it was made, for people
  std::int64_t utc_ns = 0;
  PngPicture picture;  // with pixel_mm, if that is known
};

// A sweep, as the scanner's pictures in order.
struct DicomCine {
  std::string object;
  int number = 1;
  std::string description;
  std::int64_t utc_ns = 0;
  int width = 0;
  int height = 0;
  PixelKind kind = PixelKind::grey;      // Doppler keys become colours, as in band_png
  std::span<const std::uint8_t> pixels;  // frames, rows, columns; packed
  std::vector<double> times_s;           // of each frame, rising; as many as frames
  double x_mm = 0;                       // of a pixel; 0: not calibrated
  double y_mm = 0;
  MaskView mask;  // ultrasound lies within its bounds; empty: everywhere
};

// Beside, then renamed. Throws BadInput where the disk refuses, `progress` stops it, or an object is larger
// than DICOM's 4 GiB.
void write_dicom(const DicomStudy& study, const DicomPicture& picture, const std::filesystem::path& path,
                 const Progress& progress = {});
void write_dicom(const DicomStudy& study, const DicomCine& cine, const std::filesystem::path& path,
                 const Progress& progress = {});

}  // namespace sonoband::exchange
