// The cart at work: owns devices, memory and threads, and is the one place where they start and stop.
//
//     tracker thread ──SpscQueue──▶ ┐
//     pedal thread ────SpscQueue──▶ ├─ capture thread: Cart ──▶ frame ring ──▶ latest(), Sweeps   (any
//     thread) owner ──────────commands────▶ ┘                      └──▶ status, sweeps (owner), exams (disk)
//
// "Owner" is the one thread that calls command, status and take_sweep: the screen's, or main's.
#pragma once

#include <atomic>
#include <cstdint>
#include <functional>
#include <memory>
#include <optional>
#include <vector>

#include "app/cart/cart.h"
#include "app/cart/locked_memory.h"
#include "app/exam/cart_exams.h"
#include "core/concurrency/latest.h"
#include "core/concurrency/spsc_queue.h"
#include "core/sweep/frame_ring.h"
#include "hal/clock.h"
#include "hal/devices.h"

namespace sonoband::cart {

// What a board makes. None may be null.
struct Devices {
  // Of the machine, or simulated. A thread that waits for this appliance by sleeping on a simulated clock is
  // a ClockMember.
  std::shared_ptr<Clock> clock;
  // Whatever the devices refer to (ports, a simulated scene): lives longer than they do.
  std::vector<std::shared_ptr<void>> belongings;
  std::unique_ptr<Tracker> tracker;
  std::unique_ptr<FrameSource> frames;
  std::unique_ptr<Footswitch> pedal;
  // Called on the capture thread when a recording starts and ends; takes no heap and no time. May be empty.
  // For trackers that must not restart themselves meanwhile.
  std::function<void(bool recording)> on_recording;
};

struct ApplianceSettings {
  RingSettings ring;
  CartSettings cart;
  bool lock_memory = true;  // a warning, no error, where the system's limit forbids it
  int priority = 0;         // real-time, of the three threads (see BeforeOthers); likewise a warning
  // The longest sleep of each thread, so also how late a command or a stop is heard. The capture thread's
  // adds to the age of a frame that waits for its pose. Usual: 5 ms and 20 ms.
  Duration capture_wait = std::chrono::milliseconds(5);
  Duration device_wait = std::chrono::milliseconds(20);
  Duration status_every = std::chrono::milliseconds(50);  // and at once when the state changes
};

// The lamp of one device.
struct SourceStatus {
  DeviceHealth health;
  double hz = 0;                // readings or pictures a second; 0 for the pedal
  std::optional<Duration> age;  // since the last; empty before the first
  bool ended = false;           // a replay is over
};

// A value: everything a screen shows that is not a picture.
struct ApplianceStatus {
  Stamp at{};
  CartStatus cart;
  SourceStatus tracker;
  SourceStatus frames;
  SourceStatus pedal;
  // What is saved and what is not, for the operator. Empty: nothing is to be saved.
  std::optional<exam::RecorderStatus> saving;
  bool frozen = false;               // frames come, but have shown the same picture for a second
  std::uint64_t sweeps_handed = 0;   // to take_sweep
  std::uint64_t sweeps_refused = 0;  // that nobody took in time
};

class Appliance {
 public:
  // Takes and touches all memory; no thread, no device is started yet. `mask` is copied (see FrameRing).
  // `exams` saves every sweep; null: none are saved.
  Appliance(Devices devices, const ApplianceSettings& settings, MaskView mask = {},
            std::unique_ptr<exam::CartExams> exams = nullptr);
  ~Appliance();  // stops; every Sweep and lease must be gone
  Appliance(const Appliance&) = delete;
  Appliance& operator=(const Appliance&) = delete;

  // Once each, by the owner. Devices are started and stopped by the thread that reads them. A recording that
  // runs at stop ends there, and its sweep can still be taken. Stop waits until the sweeps are saved, or
  // cannot be.
  void start();
  void stop();

  // Owner. False: too many wait already (16).
  [[nodiscard]] bool command(Command command) { return commands_.try_emplace(command); }
  // Owner. The newest status; valid until the next call.
  const ApplianceStatus& status();
  // One other thread, always the same: the newest status, `saving` aside; valid until the next call. Null:
  // none since the last call.
  const ApplianceStatus* watch() { return watched_.take(); }
  // Owner. Sweeps as they start, oldest first; each grows until its release. Drop it to give its memory back.
  std::optional<Sweep> take_sweep();

  FrameLease latest() const { return ring_.latest(); }     // any thread
  exam::CartExams* exams() const { return exams_.get(); }  // null: nothing is saved
  Clock& clock() { return *devices_.clock; }
  const FrameRing& ring() const { return ring_; }
  const std::string& memory_warning() const;  // empty: locked, or not asked for
  // After start. Empty: the threads have it, or it was not asked for.
  const std::string& priority_warning() const { return priority_warning_; }
  // Any thread. Rounds of the capture thread so far: while acquisition lives it grows at least once every
  // `capture_wait`.
  std::uint64_t beats() const { return beats_.load(std::memory_order_relaxed); }

 private:
  struct PedalNews {
    PedalEdge edge;
    bool lost = false;  // the pedal is gone; `edge` means nothing
  };

  void read_tracker();
  void read_pedal();
  void capture();
  void take_news(Stamp now);
  void hand_over();
  void publish_status(Stamp now);

  Devices devices_;
  ApplianceSettings settings_;
  FrameRing ring_;
  std::unique_ptr<exam::CartExams> exams_;  // holds sweeps of the ring
  std::optional<LockedMemory> locked_;
  Cart cart_;  // the capture thread's

  SpscQueue<PoseSample> poses_{1024};     // 4 s at 240 Hz
  SpscQueue<PedalNews> pedal_news_{256};  // many presses with all their bounces
  SpscQueue<Command> commands_{16};
  SpscQueue<Sweep> sweeps_{16};
  Latest<ApplianceStatus> statuses_;
  Latest<ApplianceStatus> watched_;
  ApplianceStatus status_;  // the owner's

  std::string priority_warning_;
  std::atomic<std::uint64_t> beats_{0};
  std::atomic<bool> stop_devices_{false};
  std::atomic<bool> stop_capture_{false};
  std::atomic<bool> tracker_ended_{false};
  std::atomic<std::uint64_t> poses_overrun_{0};
  std::atomic<std::uint64_t> pedal_overrun_{0};

  // Of the capture thread.
  std::uint64_t poses_overrun_told_ = 0;
  std::uint64_t pedal_overrun_told_ = 0;
  std::optional<Stamp> last_edge_;
  std::optional<Stamp> next_status_;
  State told_ = State::idle;
  bool frames_ended_ = false;
  bool grew_ = false;  // a sweep did
  std::uint64_t sweeps_handed_ = 0;
  std::uint64_t sweeps_refused_ = 0;

  bool started_ = false;
  // Last, so that a thread ends before anything it uses.
  ClockThread tracker_thread_;
  ClockThread pedal_thread_;
  ClockThread capture_thread_;
};

}  // namespace sonoband::cart
