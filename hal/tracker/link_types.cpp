#include "hal/tracker/link_types.h"

namespace sonoband {

const char* operator_sentence(LinkReason reason) {
  switch (reason) {
    case LinkReason::none:
      return "";
    case LinkReason::no_device:
      return "No tracker on USB: switch it on and check its USB cable.";
    case LinkReason::loader:
      return "The tracker waits for its firmware: name the firmware file for the loader (see "
             "board/README.md), "
             "then switch the tracker off and on.";
    case LinkReason::access_denied:
      return "The tracker may not be opened: install the udev rule of board/, then plug its USB cable in "
             "again.";
    case LinkReason::busy:
      return "Another program holds the tracker: close it.";
    case LinkReason::stranger:
      return "The Polhemus device on USB is no tracker known here: plug in a LIBERTY, PATRIOT or VIPER.";
    case LinkReason::waking:
      return "The tracker does not answer yet: it tests itself for up to 15 seconds after it is switched on.";
    case LinkReason::no_quiet:
      return "The tracker does not stop sending: switch it off and on.";
    case LinkReason::no_answer:
      return "The tracker does not answer: switch it off and on.";
    case LinkReason::refused:
      return "The tracker refuses a setting: switch it off and on; if that does not help, its firmware does "
             "not "
             "fit this program.";
    case LinkReason::mismatch:
      return "The tracker does not keep its settings: switch it off and on.";
    case LinkReason::no_records:
      return "The tracker does not start sending poses: switch it off and on.";
    case LinkReason::silent:
      return "The tracker stopped sending poses; trying to start it again.";
    case LinkReason::probe_silent:
      return "The probe's position sensor sends nothing: check its plug at the tracker.";
    case LinkReason::wrong_format:
      return "The tracker's data are damaged: check its USB cable; starting it again.";
    case LinkReason::stalled:
      return "The tracker's USB connection stalls: check its USB cable.";
    case LinkReason::io_error:
      return "The tracker's USB connection fails: check its USB cable, and use no hub.";
    case LinkReason::hardware:
      return "The tracker reports a failure of its electronics: switch it off and on; if it stays, have it "
             "serviced.";
    case LinkReason::reinitialising:
      return "The tracker restarts itself: wait up to 20 seconds.";
    case LinkReason::source_fault:
      return "The tracker's source fails: switch the tracker off, check the source's plug, switch it on.";
    case LinkReason::self_test:
      return "The tracker's self-test found errors: poses may be worse than usual; have it serviced.";
    case LinkReason::outside_map:
      return "The probe is outside the tracker's mapped volume: bring it nearer to the source.";
    case LinkReason::some_distortion:
      return "Something metal disturbs the tracker: poses may be off; move it away.";
    case LinkReason::high_distortion:
      return "Metal disturbs the tracker too much: move it away from probe and source.";
    case LinkReason::mirrored:
      return "The probe crossed the plane of the source: bring it back to the couch's side.";
  }
  return "";
}

}  // namespace sonoband
