// Every word on the screen, in one table. A translation is another value of Texts; {0}, {1} are the numbers.
#pragma once

#include <array>
#include <string_view>

namespace sonoband::ui {

struct Texts {
  using Words = std::string_view;

  Words research_only = "Research use only";

  // Pages
  Words live = "Live";
  Words review = "Review";
  Words exams = "Exams";
  Words set_up = "Set-up";
  Words help = "Help";

  // Status bar
  Words scanner = "Scanner";
  Words tracker = "Tracker";
  Words pedal = "Pedal";
  Words touchscreen = "Touchscreen";
  Words works = "works";
  Words storage = "Storage";
  Words ring = "Memory";
  Words lost = "Lost";
  Words stream = "OpenIGTLink";
  Words stream_here = "port {0} · {1}";
  Words stream_network = "network {0} · {1}";
  Words scanner_rate = "{0} fps · {1} ms";
  Words frozen = "frozen";
  Words tracker_rate = "{0} Hz · {1}";
  Words clean = "clean";
  Words some_distortion = "some distortion";
  Words distorted = "distorted";
  Words out_of_range = "out of range";
  Words hold_to_record = "hold to record";
  Words press_to_record = "press to record";
  Words pressed = "pressed";
  Words minutes_left = "{0} min";
  Words seconds_free = "{0} s free";
  Words lost_of = "{0} of {1}";
  Words none_lost = "none";
  Words starting = "starting";
  Words degraded = "check";
  Words silent = "no signal";
  Words absent = "not connected";
  Words fault = "fault";
  Words full = "full";

  // Live
  Words recording = "Recording {0}";
  Words ready = "Ready";
  Words not_ready = "Not ready";
  Words frames_and_left = "{0} frames · {1} s left";
  Words room_for = "room for {0} s";
  Words band_so_far = "Band so far";
  Words band_detail = "{0} mm {1}";
  Words maximum = "maximum";
  Words minimum = "minimum";
  Words mean = "mean";
  Words outline = "Outline";
  Words sweep_speed = "Sweep speed";
  Words speed_and_gap = "{0} mm/s · gaps {1} mm";
  Words too_fast_above = "too fast above {0} mm/s";
  Words too_fast = "Too fast: slow down";
  Words no_speed = "starts with the sweep";
  Words not_scanned = "not scanned yet";
  Words record = "Record";
  Words stop = "Stop";
  Words first_time_hold =
      "Hold the pedal (or the space bar) and move the probe slowly. Let go to see the band.";
  Words first_time_toggle =
      "Press the pedal (or the space bar) and move the probe slowly. Press again to see the band.";

  // Review
  Words reslice = "Reslice";
  Words manifold = "Manifold";
  Words bscan_of = "B-scan {0} of {1}";
  Words reslice_detail = "{0} mm · {1}";
  Words coarse = "coarse while moving";
  Words left_out = "{0} dense B-scans left out while moving";
  Words manifold_detail = "{0} mm · r {1} mm · {2} layers";
  Words tap_outline = "tap an outline to go there";
  Words no_sweep = "No sweep yet";
  Words no_sweep_cure = "Record one on the Live page, or open an exam.";
  Words no_curve = "No curve yet";
  Words no_curve_cure = "Choose Curve and draw along the anatomy in the Reslice window.";
  Words no_band = "No band yet";
  Words no_band_cure = "It shows as soon as the first B-scans of a sweep are in.";
  Words smeared = "smeared";
  Words maximum_button = "Maximum";
  Words minimum_button = "Minimum";
  Words mean_button = "Mean";
  Words nearest = "Nearest";
  Words linear = "Linear";
  Words thickness = "Thickness";
  Words millimetres = "{0} mm";
  Words thin = "thin";
  Words picture = "Picture";
  Words tool_move = "Move";
  Words tool_curve = "Curve";
  Words tool_landmark = "Mark";
  Words tool_measure = "Measure";
  Words tool_contour = "Contour";
  Words hint_move = "Drag, pinch or twist Reslice · the ball tilts it, the strip goes through it";
  Words hint_curve = "Draw along the anatomy in Reslice · drag a ring to bend it";
  Words hint_landmark = "Tap in Review or Reslice to set a mark · hold one to take it away";
  Words hint_measure = "Tap points in Review, Reslice or both";
  Words hint_contour = "Draw round it in Review or Reslice · hold one to take it away";
  Words hint_uncalibrated = "No calibration for this depth: nothing here can be measured";
  Words undo = "Undo";
  Words redo = "Redo";
  Words clear = "Clear";
  Words reset = "Reset";
  Words done = "Done";
  Words distance = "Distance";
  Words angle = "Angle";
  Words area = "Area";
  Words square_millimetres = "{0} mm²";
  Words degrees = "{0}°";
  Words snapshot = "Snapshot";

  // Picture sheet
  Words picture_settings = "Picture";
  Words gain = "Gain";
  Words contrast = "Contrast";
  Words percent = "{0} %";
  Words signed_percent = "{0} %";
  Words smooth_pixels = "Smooth pixels";
  Words colour_flow = "Colour flow";
  Words hide_slow = "Hide slow flow";
  Words of_levels = "{0} of 63";
  Words usual = "Usual settings";
  Words on = "On";
  Words off = "Off";

  // Exams
  Words new_exam = "New exam";
  Words open = "Open";
  Words export_exam = "Export";
  Words remove = "Delete";
  Words undo_delete = "Undo delete";
  Words cancel = "Cancel";
  Words close = "Close";
  Words start_exam = "Start exam";
  Words patient_label = "Patient label (any text, or none)";
  Words no_label = "no label";
  Words no_exams = "No exams yet";
  Words no_exams_cure = "What you record is listed here.";
  Words exam_detail = "{0} · {1} sweeps · {2} B-scans · {3} s";
  Words exam_one_sweep = "{0} · 1 sweep · {1} B-scans · {2} s";
  Words exam_chosen_sweep = "{0} · sweep {1} of {2} · {3} B-scans · {4} s";
  Words damaged = "damaged";
  Words being_recorded = "being recorded";
  Words recovered = "recovered";
  Words deleted = "deleted";
  Words is_open = "open";
  Words format = "Format";
  Words place = "Place";
  std::array<Words, 9> formats = {
      "MetaImage (.mha)", "NRRD (.nrrd)", "Stradx (.sx)", "Stradwin (.sw)", "DICOM",
      "Pictures",         "Movie",        "Turn-table",   "Marks (JSON)"};
  std::array<Words, 9> format_words = {
      "B-scans with their places, for PLUS and 3D Slicer",
      "B-scans with their places, for 3D Slicer",
      "B-scans with their places, for Stradx",
      "B-scans with their places, for Stradwin and StradView",
      "B-scans as Ultrasound Multi-frame and snapshots, for archives; without places",
      "A PNG for each B-scan, for looking at",
      "The B-scans as a WebM movie, for looking at",
      "The band, made as set in Review, on a plane that turns once: a WebM movie",
      "Landmarks, contours and measurements of the whole exam, also for 3D Slicer (.mrk.json)"};
  Words no_place = "No stick or card yet: put one in";
  Words one_sweep = "Sweep {0}";
  Words all_sweeps = "All {0} sweeps";
  Words with_label = "With the patient label";
  Words without_label = "Without the patient label";
  Words label_stays = "The patient label stays here: only DICOM has a place for it";
  Words label_goes = "The patient label goes along as name and id";
  Words label_is_left_out = "The patient label is left out";
  Words exporting = "Exporting: {0} %";
  Words writing_out = "Writing the last of it to {0}: do not pull it yet";
  Words removing = "Writing out to {0}: do not pull it yet";
  Words exported = "{0} files are in {1}";
  Words exported_one = "1 file is in {0}";
  Words not_exported = "The export did not succeed";
  Words export_cancelled = "Cancelled: files that are there are whole";
  Words can_be_pulled = "{0} can be pulled now";
  Words remove_safely = "Remove safely";
  Words saved_as_it_happens = "Everything is saved as it happens";
  Words kept_in_memory = "Sweeps of this run, in memory: they go when the cart stops";

  // Set-up
  Words probe = "Probe and depth";
  Words probe_line = "{0} · {1} mm deep";
  Words calibrated = "calibrated";
  Words calibrated_days = "calibrated {0} days ago";
  Words calibrated_today = "calibrated today";
  Words not_calibrated = "no calibration: nothing can be measured";
  Words pedal_mode = "Pedal";
  Words hold_mode = "Hold";
  Words toggle_mode = "Toggle";
  Words hold_mode_words = "Records while the pedal is down.";
  Words toggle_mode_words = "One press starts, the next one stops.";
  Words devices = "Devices";
  Words pull_reach = "r {0} mm";
  Words sound = "Sound";
  Words sound_words = "A tone when recording starts and stops.";
  Words no_sound = "No loudspeaker was found: recording makes no sound.";
  Words crop = "Picture area";
  Words crop_line = "{0} × {1} px from {2}, {3} of {4} × {5}";
  Words disk_minutes = "{0} min left";
  Words unnamed = "Probe without a name";
  Words about = "About";
  Words about_line = "Sonoband {0}";

  // Sheets
  Words losses_title = "Frames lost, by cause";
  Words no_losses = "None lost since the start of the sweep.";
  Words help_title = "Keys and gestures";
  struct HelpLine {
    Words keys;
    Words words;
  };
  std::array<HelpLine, 16> help_lines = {{
      {"Pedal, space bar", "record; let go to end the sweep (Hold), or press again (Toggle)"},
      {"One finger", "moves what lies under it: the plane, a B-scan, the outline"},
      {"Two fingers", "pinch to zoom, twist to turn, slide to move"},
      {"Strip beside Reslice", "moves the plane along its normal"},
      {"Ball in Reslice", "tilts the plane"},
      {"Tap a title", "the window fills the page, and back"},
      {"Double tap", "the plane or the view goes back to where it began"},
      {"Hold a mark", "takes it away"},
      {"1  2  3  4", "Live, Review, Exams, Set-up"},
      {"Left, right", "one B-scan back, on; page keys ten; Home, End"},
      {"Up, down", "one pixel along the plane's normal"},
      {"P", "play and pause"},
      {"V  C  M  D  O", "Move, Curve, Mark, Measure, Contour"},
      {"+  -", "thicker, thinner by 1 mm"},
      {"Ctrl+Z, Ctrl+Y, Ctrl+S", "undo, redo, snapshot"},
      {"F11, Esc, Ctrl+Q", "full screen, back, quit"},
  }};
  Words recovering_title = "Recovering an exam";
  Words recovering_words =
      "The power went while it was being recorded. What reached the disk is put together again.";

  // Faults: what is wrong, and what to do
  Words no_scanner = "No scanner signal";
  Words no_scanner_cure = "Check the video cable and that the scanner is on.";
  Words scanner_silent = "The scanner has stopped sending";
  Words scanner_silent_cure = "Recording waits until pictures come again.";
  Words scanner_frozen = "The scanner is frozen";
  Words scanner_frozen_cure = "Press its freeze key to go on.";
  Words no_tracker = "No tracker";
  Words no_tracker_cure = "B-scans are shown, but have no place in space: no band can be made.";
  Words tracker_distorted = "The tracker is distorted";
  Words tracker_distorted_cure = "Move metal away from the source, or the source closer.";
  Words tracker_outside = "The probe is out of the tracker's range";
  Words tracker_outside_cure = "Bring the source nearer to the probe.";
  Words no_pedal = "No pedal";
  Words no_pedal_cure = "Use the Record button or the space bar.";
  Words disk_low = "The disk is nearly full";
  Words disk_low_cure = "Export and delete old exams: {0} min are left.";
  Words disk_full = "The disk is full";
  Words disk_full_cure = "Nothing more can be recorded: export and delete old exams.";
  Words ring_full = "The memory for this sweep is full";
  Words ring_full_cure = "Recording has stopped; what was recorded is kept.";
  Words no_calibration = "No calibration for this depth";
  Words no_calibration_cure =
      "Viewing works; measuring and bands do not. Choose a calibrated depth, or calibrate.";
};

}  // namespace sonoband::ui
