#include "app/screen/cues.h"

namespace sonoband {

std::optional<Cue> cue_of(cart::State before, cart::State now, cart::Note news) {
  const bool recorded = before == cart::State::recording;
  const bool records = now == cart::State::recording;
  if (records && !recorded) return Cue::started;
  if (recorded && !records) return Cue::ended;
  const bool refused =
      news == cart::Note::no_frames || news == cart::Note::no_room || news == cart::Note::no_disk;
  if (refused && !records) return Cue::refused;
  return std::nullopt;
}

}  // namespace sonoband
