// Tissues of the phantoms. Echo in dB against a bone met squarely; the picture spans 60 dB (255 grey levels),
// so 4 levels a dB.
#pragma once

#include "hal/sim/shapes.h"

namespace sonoband::sim::tissue {

constexpr Material bone{.echo_db = 6, .loss_db_mm = 4, .specular = 0.5F, .bone = true};
constexpr Material thin_bone{.echo_db = 5, .loss_db_mm = 2.5F, .specular = 0.4F, .bone = true};
constexpr Material skull{.echo_db = 5, .loss_db_mm = 3, .specular = 0.85F, .bone = true};
constexpr Material fluid{.echo_db = -66, .loss_db_mm = -0.04F};  // negative: brighter behind
constexpr Material air{.echo_db = -25, .loss_db_mm = 40};
constexpr Material gel = fluid;  // between skin and probe
constexpr Material blood{.echo_db = -56, .loss_db_mm = 0};
constexpr Material vessel_wall{.echo_db = -18, .loss_db_mm = 0.1F, .specular = 0.6F};
constexpr Material skin{.echo_db = -14, .loss_db_mm = 0.15F};
constexpr Material fat{.echo_db = -27, .loss_db_mm = 0.05F};
constexpr Material fascia{.echo_db = -12, .loss_db_mm = 0.3F};
constexpr Material muscle{.echo_db = -31, .loss_db_mm = 0.05F};
constexpr Material dark_muscle{.echo_db = -38, .loss_db_mm = 0.05F};
constexpr Material gland{.echo_db = -25, .loss_db_mm = 0.05F};
constexpr Material flesh{.echo_db = -32, .loss_db_mm = 0.06F};
constexpr Material gristle{.echo_db = -40, .loss_db_mm = 0.06F};  // cartilage: joints and bone ends
constexpr Material lung{.echo_db = -26, .loss_db_mm = 0.06F};
constexpr Material liver{.echo_db = -33, .loss_db_mm = 0.05F};
constexpr Material heart{.echo_db = -29, .loss_db_mm = 0.05F};
constexpr Material kidney{.echo_db = -37, .loss_db_mm = 0.05F};
constexpr Material brain{.echo_db = -43, .loss_db_mm = 0.03F};
constexpr Material cerebellum{.echo_db = -35, .loss_db_mm = 0.03F};
constexpr Material choroid{.echo_db = -20, .loss_db_mm = 0.05F};
constexpr Material falx{.echo_db = -21, .loss_db_mm = 0.1F};
constexpr Material placenta{.echo_db = -25, .loss_db_mm = 0.04F};
constexpr Material belly{.echo_db = -28, .loss_db_mm = 0.06F};
constexpr Material scalp{.echo_db = -30, .loss_db_mm = 0.05F};
constexpr Material uterus{.echo_db = -34, .loss_db_mm = 0.05F};
constexpr Material jelly{.echo_db = -24, .loss_db_mm = 0.02F};  // of the cord

}  // namespace sonoband::sim::tissue
