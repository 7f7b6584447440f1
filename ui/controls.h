// Buttons and sliders for fingers. Each registers itself by name, draws itself and says what was done to it.
#pragma once

#include <initializer_list>
#include <string_view>

#include "ui/ui.h"

namespace sonoband::ui {

enum class Role : std::uint8_t {
  plain,
  primary,  // the accent: what most will want to do
  danger,   // red: takes something away
  quiet,    // no ground until touched
};

struct ButtonLook {
  Icon icon = Icon::none;
  Role role = Role::plain;
  bool chosen = false;
  bool enabled = true;
  bool stacked = false;  // the icon over the label
};

// True in the frame in which a finger that landed on it leaves it.
bool button(Ui& ui, std::string_view name, const Rect& r, std::string_view label,
            const ButtonLook& look = {});

struct Choice {
  std::string_view name;
  std::string_view label;
  Icon icon = Icon::none;
};

// Buttons side by side of which one is chosen. Returns the one just tapped, or -1.
int choices(Ui& ui, const Rect& r, std::initializer_list<Choice> all, int chosen, bool enabled = true);

// The value under the finger, between `least` and `greatest`; empty while untouched. A tap on the groove
// jumps there. Vertical ones have `least` at the top.
struct Slide {
  bool changed = false;
  bool done = false;  // the finger has left
  double value = 0;
};
Slide slider(Ui& ui, std::string_view name, const Rect& r, double value, double least, double greatest,
             bool vertical = false, bool enabled = true);

// The ground of a panel with its title bar; returns what is left inside.
Rect panel(Ui& ui, const Rect& r, std::string_view title, std::string_view detail, Icon corner = Icon::none);

// What a driver or a state has to say, in the middle of an empty panel.
void empty_note(Ui& ui, const Rect& r, Icon icon, Colour c, std::string_view title, std::string_view cure);

}  // namespace sonoband::ui
