// The appliance that a board's devices and profile make.
#pragma once

#include <filesystem>
#include <memory>

#include "app/cart/appliance.h"
#include "board/devices.h"
#include "core/image/colour_bar.h"

namespace sonoband {

// Takes the devices out of `board`; its views and foot stay. Crop, orientation, ring, pairing and pedal are
// the profile's; the crop moves calibration and mask with it. Throws BadInput where the crop does not fit the
// board's picture.
//
// Sweeps are saved into the folder `exams`; empty: none are. Throws exam::StoreError where that cannot be
// used.
std::unique_ptr<cart::Appliance> make_appliance(BoardDevices& board, const Profile& profile,
                                                std::shared_ptr<Clock> clock,
                                                const std::filesystem::path& exams = {});

// The scanner's: of the profile, and red to yellow, blue to cyan where that says nothing.
doppler::ColourBar colour_bar_of(const Profile& profile);

}  // namespace sonoband
