// A footswitch of real contacts: raw edges with the kernel's stamps, bounce included.
//
// A pedal has one contact that closes when it is pressed (NO), and may have a second one that opens (NC).
// With both, a cut wire or a short shows: the two agree, which they do in a sound pedal only for the few
// milliseconds of its travel. Such a pedal counts as released.
//
// Edges that were lost (the kernel's count jumps, the same level comes twice, the queue overflowed) move the
// sequence on, and the level is read again. It is looked at four times a second as well, so that a lone edge
// that was lost is found.
#pragma once

#include <array>
#include <atomic>
#include <cstdint>
#include <optional>
#include <vector>

#include "hal/clock.h"
#include "hal/devices.h"
#include "hal/footswitch/contact_source.h"
#include "hal/shared_health.h"

namespace sonoband {

struct PedalWiring {
  ContactRequest closes;                // NO
  std::optional<ContactRequest> opens;  // NC
};

// In the order that ContactFootswitch opens them: pedal by pedal, NO before NC.
std::vector<ContactRequest> contact_requests(std::span<const PedalWiring> pedals);

class ContactFootswitch final : public Footswitch {
 public:
  // At most four pedals. `clock` outlives it.
  ContactFootswitch(std::unique_ptr<ContactSource> contacts, Clock& clock, std::vector<PedalWiring> pedals);
  ~ContactFootswitch() override;

  void start() override;
  ReadStatus read(PedalEdge& out, Duration timeout) override;
  DeviceHealth health() const override;
  void stop() override;

 private:
  struct Contact {
    std::size_t pedal = 0;
    bool opens = false;
    bool active = false;
    std::optional<std::uint32_t> sequence;
  };
  struct Pedal {
    bool closed = false;
    std::uint64_t sequence = 0;
    std::optional<Stamp> agree_since;  // of a pair whose contacts say the same
  };

  bool connect();
  void lose(ContactStatus why);
  void take(const ContactEdge& edge);
  void settle(Stamp now);
  void resume(std::size_t contact, Stamp t, std::uint32_t missed);
  bool reread(Contact& contact, int index);
  void give(std::size_t pedal, Stamp t);
  void watch_pairs(Stamp now);
  bool level_of(std::size_t pedal) const;
  void put(const PedalEdge& edge);

  std::unique_ptr<ContactSource> source_;
  Clock& clock_;
  std::vector<PedalWiring> wiring_;
  std::vector<ContactRequest> requests_;
  std::vector<Contact> contacts_;
  std::vector<Pedal> pedals_;
  bool started_ = false;
  bool open_ = false;
  Stamp next_open_{};
  bool unsettled_ = false;              // edges came since the levels were last compared, or they differ
  std::optional<Stamp> differs_since_;  // a level from what the edges said
  Stamp next_look_{};                   // at the levels, though no edge came

  std::array<PedalEdge, 16> pending_{};  // circular
  std::size_t first_ = 0;
  std::size_t count_ = 0;

  SharedHealth health_;
};

}  // namespace sonoband
