#include "hal/footswitch/contact_footswitch.h"

#include <algorithm>
#include <cassert>
#include <utility>

namespace sonoband {
namespace {

constexpr Duration look_again = std::chrono::seconds(1);
constexpr Duration travel = std::chrono::milliseconds(50);  // of a changeover contact; longer is a fault
constexpr Duration between_looks = std::chrono::milliseconds(250);  // at the levels while no edge comes
constexpr Duration believable_age = std::chrono::seconds(1);
constexpr std::size_t most_pedals = 4;

const char* sentence(ContactStatus why) {
  switch (why) {
    case ContactStatus::no_such_line:
      return "The pedal is not there: plug it in, or correct the line or key that pedal.pins names.";
    case ContactStatus::access_denied:
      return "The pedal may not be read: install the udev rules of board/ and plug it in again.";
    case ContactStatus::busy:
      return "Another program holds the pedal: close it.";
    case ContactStatus::no_bias:
      return "This board cannot pull the pedal's line: leave pedal.bias out and fit a resistor.";
    default:
      return "The pedal is gone: plug it in again.";
  }
}

}  // namespace

std::vector<ContactRequest> contact_requests(std::span<const PedalWiring> pedals) {
  std::vector<ContactRequest> requests;
  for (const PedalWiring& pedal : pedals) {
    requests.push_back(pedal.closes);
    if (pedal.opens) requests.push_back(*pedal.opens);
  }
  return requests;
}

ContactFootswitch::ContactFootswitch(std::unique_ptr<ContactSource> contacts, Clock& clock,
                                     std::vector<PedalWiring> pedals)
    : source_(std::move(contacts)),
      clock_(clock),
      wiring_(std::move(pedals)),
      requests_(contact_requests(wiring_)) {
  assert(!wiring_.empty() && wiring_.size() <= most_pedals);
  for (std::size_t p = 0; p < wiring_.size(); ++p) {
    contacts_.push_back({.pedal = p, .opens = false, .active = false, .sequence = {}});
    if (!wiring_[p].opens) continue;
    contacts_.push_back({.pedal = p, .opens = true, .active = false, .sequence = {}});
  }
  pedals_.resize(wiring_.size());
}

ContactFootswitch::~ContactFootswitch() {
  ContactFootswitch::stop();
}

void ContactFootswitch::start() {
  if (started_) return;
  started_ = true;
  first_ = count_ = 0;
  health_.delivered = 0;
  next_open_ = clock_.now();
  health_.say(DeviceState::starting, "");
}

void ContactFootswitch::stop() {
  started_ = false;
  source_->close();
  open_ = false;
  health_.say(DeviceState::absent, "");
}

void ContactFootswitch::put(const PedalEdge& edge) {
  // More than fit is a contact that chatters faster than anyone reads: the next level read tells.
  if (count_ == pending_.size()) {
    health_.lost.fetch_add(1, std::memory_order_relaxed);
    return;
  }
  pending_[(first_ + count_++) % pending_.size()] = edge;
}

bool ContactFootswitch::level_of(std::size_t pedal) const {
  bool closed = false;
  for (const Contact& c : contacts_) {
    if (c.pedal != pedal) continue;
    if (!c.opens)
      closed = c.active;
    else
      closed = closed && !c.active;
  }
  return closed;
}

bool ContactFootswitch::connect() {
  const ContactStatus status = source_->open(requests_);
  next_open_ = clock_.now() + look_again;
  if (status != ContactStatus::ok) {
    const bool missing = status == ContactStatus::no_such_line || status == ContactStatus::gone;
    health_.say(missing ? DeviceState::absent : DeviceState::fault, sentence(status));
    return false;
  }
  open_ = true;
  unsettled_ = false;
  differs_since_.reset();
  for (std::size_t i = 0; i < contacts_.size(); ++i) {
    contacts_[i].sequence.reset();
    if (!reread(contacts_[i], static_cast<int>(i))) return false;
  }
  const Stamp now = clock_.now();
  for (std::size_t p = 0; p < pedals_.size(); ++p) {
    pedals_[p] = {.closed = level_of(p), .sequence = 0, .agree_since = {}};
    put({.time = now, .closed = pedals_[p].closed, .pedal = static_cast<std::uint8_t>(p), .sequence = 0});
  }
  health_.say(DeviceState::running, "");
  watch_pairs(now);
  return true;
}

bool ContactFootswitch::reread(Contact& contact, int index) {
  const auto level = source_->level(index);
  if (!level) {
    lose(ContactStatus::gone);
    return false;
  }
  contact.active = *level;
  return true;
}

void ContactFootswitch::lose(ContactStatus why) {
  source_->close();
  if (open_) health_.recoveries.fetch_add(1, std::memory_order_relaxed);
  open_ = false;
  next_open_ = clock_.now() + look_again;
  health_.say(DeviceState::absent, sentence(why));
  // Whoever holds a pedal that is gone has let go: nothing may record because a cable fell out.
  for (std::size_t p = 0; p < pedals_.size(); ++p)
    if (std::exchange(pedals_[p].closed, false))
      put({.time = clock_.now(),
           .closed = false,
           .pedal = static_cast<std::uint8_t>(p),
           .sequence = ++pedals_[p].sequence});
}

void ContactFootswitch::give(std::size_t p, Stamp t) {
  Pedal& pedal = pedals_[p];
  const bool closed = level_of(p);
  if (closed == pedal.closed) return;
  pedal.closed = closed;
  put({.time = t, .closed = closed, .pedal = static_cast<std::uint8_t>(p), .sequence = ++pedal.sequence});
}

void ContactFootswitch::take(const ContactEdge& edge) {
  if (edge.contact < 0 || edge.contact >= static_cast<int>(contacts_.size())) return;
  Contact& contact = contacts_[static_cast<std::size_t>(edge.contact)];
  std::uint32_t missed = 0;
  if (edge.sequence != 0) {
    if (contact.sequence) missed = edge.sequence - *contact.sequence - 1;
    contact.sequence = edge.sequence;
  } else if (edge.active == contact.active) {
    missed = 1;
  }
  const Stamp now = clock_.now();
  Stamp t{std::chrono::nanoseconds(edge.stamp_ns)};
  if (t > now || now - t > believable_age) t = now;
  contact.active = edge.active;
  unsettled_ = true;
  differs_since_.reset();
  if (missed > 0) {
    if (reread(contact, edge.contact)) resume(static_cast<std::size_t>(edge.contact), t, missed);
    return;
  }
  give(contact.pedal, t);
}

// After lost edges: said even if the level is the same, because the jump of the sequence is the news.
void ContactFootswitch::resume(std::size_t contact, Stamp t, std::uint32_t missed) {
  health_.lost.fetch_add(missed, std::memory_order_relaxed);
  const std::size_t p = contacts_[contact].pedal;
  pedals_[p].sequence += missed;
  pedals_[p].closed = level_of(p);
  put({.time = t,
       .closed = pedals_[p].closed,
       .pedal = static_cast<std::uint8_t>(p),
       .sequence = ++pedals_[p].sequence});
}

// When the last edges of a burst are the lost ones, none behind them tells: the kernel keeps 16 of a line and
// drops the newest. So once all is quiet the levels are compared, and now and then from then on: a lone edge
// may be lost long after the last, and a sweep would go on until somebody presses again. An edge on its way
// is no lost one: only a difference that stays is.
void ContactFootswitch::settle(Stamp now) {
  if (!unsettled_ && now < next_look_) return;
  std::array<bool, 2 * most_pedals> level{};
  bool differs = false;
  for (std::size_t i = 0; i < contacts_.size(); ++i) {
    const auto read = source_->level(static_cast<int>(i));
    if (!read) return lose(ContactStatus::gone);
    level[i] = *read;
    differs = differs || *read != contacts_[i].active;
  }
  if (differs && !differs_since_) differs_since_ = now;
  unsettled_ = differs && now - *differs_since_ < travel;
  if (unsettled_) return;
  next_look_ = now + between_looks;
  differs_since_.reset();
  for (std::size_t i = 0; i < contacts_.size(); ++i) {
    if (std::exchange(contacts_[i].active, level[i]) != level[i]) resume(i, now, 1);
  }
}

void ContactFootswitch::watch_pairs(Stamp now) {
  bool faulty = false;
  for (std::size_t p = 0; p < pedals_.size(); ++p) {
    if (!wiring_[p].opens) continue;
    bool closes = false;
    bool opens = false;
    for (const Contact& c : contacts_)
      if (c.pedal == p) (c.opens ? opens : closes) = c.active;
    if (closes != opens) {
      pedals_[p].agree_since.reset();
      continue;
    }
    if (!pedals_[p].agree_since) pedals_[p].agree_since = now;
    faulty = faulty || now - *pedals_[p].agree_since > travel;
  }
  if (faulty)
    health_.say(DeviceState::fault,
                "The pedal's two contacts contradict each other: check its cable for a cut wire.");
  else
    health_.say(DeviceState::running, "");
}

ReadStatus ContactFootswitch::read(PedalEdge& out, Duration timeout) {
  if (!started_) return ReadStatus::ended;
  const Stamp until = clock_.now() + timeout;
  do {
    if (count_ > 0) {
      out = pending_[first_];
      first_ = (first_ + 1) % pending_.size();
      --count_;
      health_.delivered.fetch_add(1, std::memory_order_relaxed);
      return ReadStatus::ok;
    }
    const Stamp now = clock_.now();
    if (!open_) {
      if (now < next_open_)
        clock_.sleep_until(std::min(until, next_open_));
      else
        connect();
      continue;
    }
    ContactEdge edge;
    const Duration patience = std::clamp<Duration>(until - now, Duration(0), travel);
    switch (const ContactStatus status = source_->wait(edge, patience)) {
      case ContactStatus::ok:
        take(edge);
        break;
      case ContactStatus::nothing_yet:
        settle(clock_.now());
        break;
      case ContactStatus::overflow:
        health_.lost.fetch_add(1, std::memory_order_relaxed);
        for (std::size_t i = 0; i < contacts_.size() && open_; ++i) reread(contacts_[i], static_cast<int>(i));
        for (std::size_t p = 0; p < pedals_.size() && open_; ++p) {
          pedals_[p].closed = level_of(p);
          pedals_[p].sequence += 2;
          put({.time = clock_.now(),
               .closed = pedals_[p].closed,
               .pedal = static_cast<std::uint8_t>(p),
               .sequence = pedals_[p].sequence});
        }
        break;
      default:
        lose(status);
        break;
    }
    if (open_) watch_pairs(clock_.now());
  } while (clock_.now() < until || count_ > 0);
  return ReadStatus::nothing_yet;
}

DeviceHealth ContactFootswitch::health() const {
  return health_.read();
}

}  // namespace sonoband
