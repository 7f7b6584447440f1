// What an exam holds, as plain values. All stamps are CLOCK_MONOTONIC of the machine that recorded; each
// sweep carries one pair of monotonic and UTC time, so that they can be told as dates.
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "core/geometry/transforms.h"
#include "core/image/image.h"
#include "core/sweep/pose_sample.h"
#include "core/sweep/tracked_frame.h"
#include "core/time.h"

namespace sonoband::exam {

constexpr int longest_side_px = 16384;  // of a picture that is believed

// Part of a captured picture, in pixels of the capture.
struct CropRect {
  int x = 0;
  int y = 0;
  int width = 0;
  int height = 0;
  bool operator==(const CropRect&) const = default;
};

struct Counter {
  std::string name;
  std::uint64_t value = 0;
  bool operator==(const Counter&) const = default;
};

// What is known when a sweep starts. One picture size and one kind for all its frames.
struct SweepSetup {
  int width = 0;
  int height = 0;
  PixelKind kind = PixelKind::grey;
  double frames_per_second = 0;  // nominal; only the room left is reckoned from it
  std::optional<Affine<frame::Probe, frame::Image>> probe_from_image;
  double calibration_error_mm = 0;  // as the calibration states it; 0: not stated
  std::string calibration_name;     // which one: its file, its date, or both
  Duration latency_offset{};        // already taken off FrameRecord::captured
  CropRect crop;
  std::string world = "Tracker";  // what World is: the tracker, a reference sensor's name, a phantom
  Pixels mask;                    // non-zero is ultrasound; empty: all of it
  std::vector<std::pair<std::string, std::string>> versions;  // device or program, and its version
  Stamp pressed{};
  std::int64_t pressed_utc_ns = 0;  // since 1970, of the same moment as `pressed`
};

// One frame as the ring has it. Pixels are borrowed.
struct FrameRecord {
  ConstPixels pixels;
  PixelKind kind = PixelKind::grey;
  std::int64_t number = 0;  // order of capture within the sweep, from 0 without holes
  bool pre_roll = false;    // before the press
  PoseStatus pose_status = PoseStatus::not_yet;
  Affine<frame::World, frame::Image> world_from_image;  // means something only with pose_status ok
  std::optional<Rigid<frame::Tracker, frame::Probe>> tracker_from_probe;  // paired, at `captured`
  Stamp captured{};                                                       // after the latency offset
  Stamp stamped{};                                                        // before it
  Stamp arrived{};                                                        // when the host had it
  std::int64_t device_ns = 0;      // raw, on the device's or kernel's own clock
  std::uint64_t device_count = 0;  // the device's own number
};

// A sweep as a list shows it.
struct SweepSummary {
  std::int64_t id = 0;  // 1, 2, 3 ... within the exam
  std::int64_t frames = 0;
  bool ended = false;           // false: still growing, or cut off
  bool interrupted = false;     // the program or the power went away; closed by the next start
  std::vector<Counter> ledger;  // the loss ledger at the end; empty while it grows or when it was cut off
};

// What review made. Each change is a new row; the newest of an object is the one in force.
enum class ReviewKind : std::uint8_t {
  plane,
  band,
  curve,
  landmark,
  contour,
  measurement,
  snapshot,
  note,
};
const char* name_of(ReviewKind kind);
std::optional<ReviewKind> review_kind(const std::string& name);

struct ReviewObject {
  std::string object;  // the same from version to version; unique in the exam
  ReviewKind kind = ReviewKind::note;
  std::int64_t version = 1;       // filled in by the store: 1, 2, 3 ...
  bool removed = false;           // the last word on this object
  std::string json;               // one object, by the maker of the kind
  std::vector<std::uint8_t> png;  // of a snapshot; empty otherwise
  std::int64_t written_utc_ns = 0;
};

struct ExamSummary {
  std::string id;  // "20260102-150405-3fa9": UTC of its start and four random digits
  std::string path;
  std::int64_t created_utc_ns = 0;
  std::string label;  // of the patient; empty unless somebody typed one
  std::int64_t sweeps = 0;
  std::int64_t frames = 0;
  std::int64_t bytes = 0;
  bool closed = false;  // no writer holds it, and it was closed in order
  std::string damage;   // one sentence; empty: none met while listing
};

}  // namespace sonoband::exam
