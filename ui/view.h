// Everything a frame of the screen shows: values, and pictures and lists borrowed for the length of the
// frame. Whoever fills it knows devices and threads; whoever draws it does not.
#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <span>
#include <string_view>

#include "core/geometry/plane.h"
#include "core/manifold/plane_point.h"
#include "core/reslice/band.h"
#include "core/sweep/pose_sample.h"
#include "core/sweep/tracked_frame.h"
#include "core/time.h"
#include "ui/interact/orbit.h"
#include "ui/pictures.h"

namespace sonoband::ui {

// ---- The status bar ----

// How a source is. Words come from the table of texts; a driver's own reason is shown in full when its lamp
// is tapped.
enum class Health : std::uint8_t {
  good,
  starting,
  degraded,  // works, with something wrong
  silent,    // there, and sends nothing
  absent,    // not connected
  fault,     // needs the operator
};

struct ScannerStatus {
  Health health = Health::absent;
  std::string_view reason;  // one sentence with the cure; empty while all is well
  double frames_per_s = 0;
  double age_ms = 0;    // of the newest frame on the screen, from the scanner's output on
  bool frozen = false;  // the picture has not changed for a while: the scanner's freeze key
};

struct TrackerStatus {
  Health health = Health::absent;
  std::string_view reason;
  double rate_hz = 0;
  PoseQuality quality = PoseQuality::missing;  // of the newest reading
};

enum class PedalMode : std::uint8_t { hold, toggle };

struct PedalStatus {
  Health health = Health::absent;
  std::string_view reason;
  PedalMode mode = PedalMode::hold;
  bool down = false;
};

struct TouchscreenStatus {
  bool expected = false;  // the board has one; else fingers come through the window system
  Health health = Health::absent;
  std::string_view reason;
};

struct StorageStatus {
  Health health = Health::good;
  std::string_view reason;
  double minutes_left = 0;
};

struct RingStatus {
  double seconds_free = 0;
  double seconds_in_all = 0;
};

// One line of the loss ledger.
struct LossLine {
  std::string_view cause;  // a text ready to show
  std::uint64_t count = 0;
};

struct LossStatus {
  std::uint64_t lost = 0;
  std::uint64_t of = 0;  // frames since the start of the sweep, or of the last one
  std::span<const LossLine> by_cause;
};

// What other programs are sent over the network.
struct StreamStatus {
  bool on = false;
  bool beyond_this_machine = false;  // whoever reaches the network can see it
  int port = 0;
  std::uint64_t programs = 0;  // that listen
};

struct StatusView {
  ScannerStatus scanner;
  TrackerStatus tracker;
  PedalStatus pedal;
  TouchscreenStatus touch;
  StorageStatus storage;
  RingStatus ring;
  LossStatus losses;
  StreamStatus stream;
};

// ---- Pages ----

enum class Page : std::uint8_t { live, review, exams, set_up };

// A sheet that lies over the page until it is answered or closed.
enum class Sheet : std::uint8_t {
  none,
  losses,   // the ledger by cause
  source,   // why a lamp is not green: View::sheet_source
  picture,  // grey and Doppler settings
  help,     // keys and gestures
  new_exam,
  export_exam,
  recovering,  // an exam that a power cut left behind is being put together
};

enum class Source : std::uint8_t { scanner, tracker, pedal, storage, ring };

// ---- Live ----

struct LiveView {
  Picture picture;  // the newest B-scan
  bool recording = false;
  Duration recorded{};  // since the press
  std::int64_t frames = 0;
  double seconds_left = 0;  // until the ring is full
  Picture growing;          // the band of the sweep as far as it has come
  double growing_mm = 0;    // its thickness
  Compounding compounding = Compounding::maximum;
  double speed_mm_s = 0;     // of the probe across its picture plane
  double gap_mm = 0;         // between neighbouring B-scans at this speed
  double widest_gap_mm = 0;  // elevational beam width: farther apart, something is missed
  std::optional<Affine<frame::World, frame::Image>> pose;  // of the newest B-scan
  std::uint64_t sweep_version = 0;
  bool first_time = false;  // nobody has recorded yet: say how
};

// ---- Review ----

enum class Tool : std::uint8_t { move, curve, landmark, measure, contour };
enum class Measure : std::uint8_t { distance, angle, area };
enum class Window : std::uint8_t { none, review, reslice, manifold, outline };

// A point the user set; shown in every window.
struct LandmarkView {
  Eigen::Vector3d at_world;
  int number = 0;
};

// A measurement, finished or under way, of points in World. The value is in mm, degrees or mm².
struct MeasureView {
  Measure kind = Measure::distance;
  std::span<const Eigen::Vector3d> points_world;
  double value = 0;
  bool finished = false;
};

// A closed outline drawn in one picture: on a B-scan, or on a plane of the Reslice window.
struct ContourView {
  int number = 0;
  std::int32_t frame = -1;  // its B-scan: index into ReviewView::frames; negative: none
  bool on_plane = false;
  std::span<const Eigen::Vector3d> points_world;
  bool finished = false;
  double area_mm2 = 0;
};

// The non-planar reslice; points in mm of the plane, x right and y down from the centre of pixel (0,0).
struct CurveView {
  std::span<const Eigen::Vector2d> vertices;  // that the user can drag
  std::span<const Eigen::Vector2d> line;      // c(s), smoothed
  std::span<const PlaneLine> up;              // c_u(s): the band's extreme curves, each in unbroken runs
  std::span<const PlaneLine> down;            // c_d(s)
  struct Smear {
    double from_mm = 0;  // arc length along c(s)
    double to_mm = 0;
  };
  std::span<const Smear> smeared;  // stretches where the fronts have run into shocks
  double reach_mm = 0;             // r: half of the height of the surface
  double length_mm = 0;
  int layers = 1;
  bool drawing = false;  // the finger is still down
  bool can_undo = false;
  bool can_redo = false;
};

struct ReviewView {
  std::span<const TrackedFrame* const> frames;  // of the sweep; empty: there is none yet
  std::uint64_t sweep_version = 0;              // changes with `frames`
  std::int32_t current = 0;                     // index of the B-scan in the Review window
  bool playing = false;
  Picture bscan;
  ReslicePlane plane;
  RenderSettings settings;
  Picture band;
  bool band_coarse = false;  // shown at less than full quality while the finger is down
  int band_left_out = 0;     // B-scans denser than pixels, while the finger is down
  double band_ms = 0;        // what the band took to render
  ReslicePlane band_plane;   // the plane `band` was rendered for; lags `plane` by a job
  CurveView curve;
  Picture manifold;
  double manifold_thickness_mm = 0;
  double manifold_pixel_mm = 0;
  bool manifold_coarse = false;
  std::span<const LandmarkView> landmarks;
  std::span<const MeasureView> measures;
  std::span<const ContourView> contours;
  Look look;
  bool has_doppler = false;
  Tool tool = Tool::move;
  Measure measure = Measure::distance;
  Window full = Window::none;  // fills the page
  Orbit orbit;
  bool calibrated = true;  // false: no calibration for this depth; viewing works, measuring does not
};

// ---- Exams ----

enum class ExamState : std::uint8_t { complete, recording, recovered, deleted, damaged };

struct ExamView {
  std::uint64_t id = 0;
  std::string_view label;  // of the patient; may be empty
  std::string_view when;   // local date and time, ready to show
  int sweeps = 0;
  int frames = 0;
  double seconds = 0;
  ExamState state = ExamState::complete;
  Picture picture;
  bool open = false;
  int sweep = 0;                 // the one chosen, from 1: frames, seconds and picture are of it; 0: of all
  std::string_view damage = {};  // one sentence, in place of the numbers
};

// In the order of Texts::formats.
enum class ExportAs : std::uint8_t { mha, nrrd, sx, sw, dicom, png, webm, turn, marks };

struct ExportChoice {
  ExportAs format = ExportAs::mha;
  int place = 0;            // index into ExportView::places
  bool one_sweep = false;   // the one chosen of the exam, else all
  bool with_label = false;  // of the patient, where the format has one
};

enum class ExportPhase : std::uint8_t {
  idle,
  exporting,
  writing_out,  // what the system holds back goes to the disk
  removing,     // the same, and the disk is taken out of use
  done,
  failed,
  cancelled,
  removed,  // the disk can be pulled
};

struct PlaceView {
  std::string_view label;
  bool removable = false;
};

struct ExportView {
  std::span<const PlaceView> places;
  ExportChoice choice;
  ExportPhase phase = ExportPhase::idle;
  double done = 0;            // 0 to 1, of exporting
  int files = 0;              // written, once it is done
  std::string_view where;     // the folder or disk that `phase` speaks of
  std::string_view sentence;  // why it failed; or what is not in the files, or should be known
  bool running() const {
    return phase == ExportPhase::exporting || phase == ExportPhase::writing_out ||
           phase == ExportPhase::removing;
  }
};

struct ExamsView {
  std::span<const ExamView> exams;  // newest first
  std::uint64_t selected = 0;
  int first = 0;               // of the list, scrolled
  std::string_view new_label;  // being typed
  bool can_undo_delete = false;
  bool on_disk = false;  // else they live as long as the cart runs
  ExportView transfer;
};

// ---- Set-up ----

struct ProbeView {
  std::string_view name;
  double depth_mm = 0;
  bool calibrated = false;
  double calibration_days = -1;  // age; negative: not known
};

struct SetUpView {
  std::span<const ProbeView> probes;
  int probe = 0;
  PedalMode pedal_mode = PedalMode::hold;
  bool has_sound = false;      // the machine can make one
  bool sound_missing = false;  // it should, and has no loudspeaker
  bool sound = true;
  Rect crop_px;  // of the capture
  int capture_width = 0;
  int capture_height = 0;
  std::string_view storage_place;
  std::string_view version;
};

// ---- A frame ----

struct View {
  StatusView status;
  Page page = Page::live;
  Sheet sheet = Sheet::none;
  Source sheet_source = Source::scanner;
  LiveView live;
  ReviewView review;
  ExamsView exams;
  SetUpView set_up;
  std::string_view notice;  // one sentence at the foot, for a few seconds
  double recovering = 0;    // 0 to 1, while Sheet::recovering is shown
};

}  // namespace sonoband::ui
