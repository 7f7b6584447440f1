// Which sound a change of the cart asks for.
#pragma once

#include <optional>

#include "app/cart/state_machine.h"
#include "hal/sound/cue.h"

namespace sonoband {

// `news`: what the cart has noted since it was `before`; none: nothing.
std::optional<Cue> cue_of(cart::State before, cart::State now, cart::Note news);

}  // namespace sonoband
