// What each lamp of the status bar says: a colour and, beside it, words, so that nobody needs to tell red
// from green.
#pragma once

#include "ui/line.h"
#include "ui/text.h"
#include "ui/theme.h"
#include "ui/view.h"

namespace sonoband::ui {

struct Lamp {
  Colour colour = colour::good;
  Line words;
};

Lamp scanner_lamp(const ScannerStatus& s, const Texts& t);
Lamp tracker_lamp(const TrackerStatus& s, const Texts& t);
Lamp pedal_lamp(const PedalStatus& s, const Texts& t);
Lamp touchscreen_lamp(const TouchscreenStatus& s, const Texts& t);
Lamp storage_lamp(const StorageStatus& s, const Texts& t);
Lamp ring_lamp(const RingStatus& s, const Texts& t);
Lamp loss_lamp(const LossStatus& s, const Texts& t);
Lamp stream_lamp(const StreamStatus& s, const Texts& t);

// What is wrong now and matters most: shown across the page, with the cure.
struct Fault {
  Colour colour = colour::warning;
  std::string_view title;
  Line cure;
};
// Empty title: nothing is wrong.
Fault worst_fault(const View& view, const Texts& t);

}  // namespace sonoband::ui
