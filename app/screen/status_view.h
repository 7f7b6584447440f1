// From what the appliance says of itself to the lamps of the screen.
#pragma once

#include <array>

#include "app/cart/appliance.h"
#include "ui/view.h"

namespace sonoband {

// What the view borrows.
using LossLines = std::array<ui::LossLine, ledger_line_count>;

// What was booked between two readings of a ledger.
LossLedger booked_since(const LossLedger& then, const LossLedger& now);

// `sweep`: what became of the frames of the growing or last sweep. `storage_minutes`: of recording that the
// disk still takes. `fps`: that the scanner sends when it does; `ring_slots`: frames the ring holds in all.
void fill_status(const cart::ApplianceStatus& status, const LossLedger& sweep, double storage_minutes,
                 double fps, std::uint32_t ring_slots, LossLines& losses, ui::StatusView& view);

// Of a board that has a touchscreen; what it says is borrowed from static storage.
ui::TouchscreenStatus touch_status(const DeviceHealth& health);

}  // namespace sonoband
