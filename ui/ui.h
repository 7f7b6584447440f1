// What a panel is given besides the View: where to draw, what the fingers did, and where its commands go.
#pragma once

#include <span>

#include "core/time.h"
#include "ui/command.h"
#include "ui/draw.h"
#include "ui/gesture.h"
#include "ui/line.h"
#include "ui/scene.h"
#include "ui/text.h"
#include "ui/theme.h"
#include "ui/widgets.h"

namespace sonoband::ui {

// The finger that is down now.
struct Finger {
  bool down = false;
  std::uint64_t target = 0;  // what it landed on
  Vec2 start;
  Vec2 at;
};

struct Ui {
  Draw& draw;
  Widgets& widgets;
  const Metrics& metrics;
  const Texts& texts;
  std::span<const Gesture> gestures;  // of this frame
  Finger finger;
  Stamp now{};
  Scene& scene;
  Pictures& pictures;
  Commands& commands;

  float px(float units) const { return metrics.px(units); }
  template <class C>
  void send(const C& command) {
    commands.emplace_back(command);
  }
};

}  // namespace sonoband::ui
