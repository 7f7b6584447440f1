#include "hal/sim/tracker_bus.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "hal/sim/random.h"

namespace sonoband::sim {
namespace {

// Transfers that a driver keeps queued: records go straight to the host as long as one is free.
constexpr std::size_t host_transfers = 4;
constexpr std::size_t unit_fifo_bytes = 2300;  // with buffering on
constexpr std::size_t chunk_capacity = 256;
constexpr Duration retry_pause = std::chrono::milliseconds(1);  // of a read that failed at once
constexpr Duration piece_gap = std::chrono::microseconds(500);
constexpr Duration loading = std::chrono::seconds(2);
constexpr Duration reenumeration = std::chrono::seconds(1);

std::vector<Fault> by_time(std::vector<Fault> faults) {
  std::stable_sort(faults.begin(), faults.end(), [](const Fault& a, const Fault& b) { return a.at < b.at; });
  return faults;
}

}  // namespace

TrackerBus::TrackerBus(Clock& clock, TrackerFamily family, const TrackerBusConfig& bus,
                       std::vector<Fault> faults, std::uint64_t seed, const MakeUnit& make_unit)
    : clock_(clock),
      family_(family),
      bus_(bus),
      faults_(by_time(std::move(faults))),
      unit_(make_unit(
          [this](Stamp sent, std::span<const std::uint8_t> bytes, int s) { on_sent(sent, bytes, s); },
          clock.now())),
      chunks_(chunk_capacity),
      seed_(hash(seed, 0x75b)) {
  const Stamp now = clock.now();
  last_arrival_ = now;
  next_burst_ =
      now + from_seconds(bus_.bursts_per_minute > 0 ? 60 / bus_.bursts_per_minute * uniform() : 1e9);
}

double TrackerBus::uniform() {
  return sim::uniform(seed_, random_++);
}

void TrackerBus::advance(Stamp now) {
  while (next_fault_ < faults_.size() && faults_[next_fault_].at <= now) {
    const Fault& f = faults_[next_fault_++];
    unit_->advance(f.at);
    inject(f);
  }
  unit_->advance(now);
  if (now < stalls_until_) halted_ = true;
}

void TrackerBus::inject(const Fault& f) {
  switch (f.kind) {
    case FaultKind::late:
      late_until_ = f.at + f.lasts;
      return;
    case FaultKind::stall:
      halted_ = true;
      stalls_until_ = f.at + f.lasts;
      return;
    case FaultKind::io_error:
      io_errors_ = static_cast<int>(f.value);
      return;
    case FaultKind::unplugged:
      plug_.away_until = f.at + f.lasts;
      plug_.left = open_;
      tear_newest();
      return;
    case FaultKind::power_cycle:
      plug_.away_until = f.at + f.lasts;
      plug_.loader_until = plug_.away_until + loading;
      plug_.off_bus_until = plug_.loader_until + reenumeration;
      plug_.left = open_;
      count_ = 0;
      unit_->power_cycle(plug_.off_bus_until);
      return;
    case FaultKind::access_denied:
      plug_.denied_until = f.at + f.lasts;
      return;
    case FaultKind::busy:
      plug_.busy_until = f.at + f.lasts;
      return;
    default:
      unit_->inject(f);
      return;
  }
}

// Pulled out in the middle of a transfer: half of what was on its way last is all that is left.
void TrackerBus::tear_newest() {
  if (count_ > 0) chunk(count_ - 1).bytes.size /= 2;
}

bool TrackerBus::present(Stamp t) const {
  return t >= plug_.away_until && t >= plug_.off_bus_until;
}

PortState TrackerBus::open() {
  const Stamp now = clock_.now();
  advance(now);
  if (now < plug_.away_until) return PortState::absent;
  if (now < plug_.loader_until) return PortState::loader;
  if (now < plug_.off_bus_until) return PortState::absent;
  if (now < plug_.denied_until) return PortState::access_denied;
  if (now < plug_.busy_until) return PortState::busy;
  open_ = true;
  plug_.left = false;
  return PortState::open;
}

void TrackerBus::close(Closing how) {
  advance(clock_.now());
  open_ = false;
  if (how == Closing::reset && present(clock_.now())) {
    unit_->usb_reset();
    halted_ = false;
    count_ = 0;
  }
}

void TrackerBus::clear_halt() {
  halted_ = false;
}

// Called by the unit, in order of time.
void TrackerBus::on_sent(Stamp sent, std::span<const std::uint8_t> bytes, int record_station) {
  if (!present(sent) || halted_) return;

  // Bursts of lateness are the host's: nothing is lost in them.
  if (sent >= next_burst_) {
    late_until_ = std::max(late_until_, sent + from_seconds(0.020 + 0.030 * uniform()));
    next_burst_ = sent + from_seconds(60 / bus_.bursts_per_minute * -std::log(1 - uniform()));
  }
  Stamp arrives = sent + Duration(std::llround(static_cast<double>(bus_.jitter.count()) * uniform()));
  arrives = std::max({arrives, late_until_, last_arrival_});

  // What arrived and was not read sits in the host's transfers first, then in the unit.
  std::size_t waiting = 0;
  std::size_t in_unit_bytes = 0;
  std::size_t newest_in_unit = count_;
  const std::size_t room = open_ ? host_transfers : 0;
  for (std::size_t i = 0; i < count_; ++i) {
    if (chunk(i).arrives > sent) break;
    if (++waiting <= room) continue;
    in_unit_bytes += chunk(i).bytes.size;
    if (chunk(i).record_station == record_station) newest_in_unit = i;
  }
  if (record_station != 0 && waiting >= room) {
    if (unit_->buffering() && in_unit_bytes + bytes.size() > unit_fifo_bytes) return;
    if (!unit_->buffering() && newest_in_unit < count_) {
      Chunk& replaced = chunk(newest_in_unit);
      replaced.taken = 0;
      replaced.bytes.size = bytes.size();
      std::copy(bytes.begin(), bytes.end(), replaced.bytes.data.begin());
      return;
    }
  }
  if (count_ == chunks_.size()) return;
  last_arrival_ = arrives;
  Chunk& c = chunk(count_++);
  c.arrives = arrives;
  c.record_station = record_station;
  c.taken = 0;
  c.bytes.size = bytes.size();
  std::copy(bytes.begin(), bytes.end(), c.bytes.data.begin());
}

Transfer TrackerBus::write(std::span<const std::uint8_t> bytes) {
  const Stamp now = clock_.now();
  advance(now);
  if (!open_ || plug_.left || !present(now)) return {TransferStatus::gone, 0};
  if (io_errors_ > 0) {
    --io_errors_;
    return {TransferStatus::io_error, 0};
  }
  if (halted_) return {TransferStatus::stalled, 0};
  unit_->receive(bytes, now);
  return {TransferStatus::ok, bytes.size()};
}

Transfer TrackerBus::take(std::span<std::uint8_t> into, Stamp now) {
  std::size_t n = 0;
  const std::size_t most = bus_.record_per_transfer ? into.size() : std::min(into.size(), bus_.max_packet);
  while (count_ > 0 && n < most) {
    Chunk& c = chunk(0);
    if (c.arrives > now || (c.taken > 0 && second_piece_ > now)) break;
    std::size_t left = c.bytes.size - c.taken;
    const bool first_piece = c.taken == 0 && bus_.split_at > 0 && bus_.split_at < left;
    if (first_piece) left = bus_.split_at;
    const std::size_t piece = std::min(left, most - n);
    std::copy_n(c.bytes.data.begin() + static_cast<std::ptrdiff_t>(c.taken), piece,
                into.begin() + static_cast<std::ptrdiff_t>(n));
    n += piece;
    c.taken += piece;
    if (c.taken == c.bytes.size) {
      first_ = (first_ + 1) % chunks_.size();
      --count_;
    }
    if (first_piece) {
      second_piece_ = now + piece_gap;
      break;
    }
    if (bus_.record_per_transfer) break;
  }
  return {n > 0 && uniform() < bus_.late_status ? TransferStatus::timed_out : TransferStatus::ok, n};
}

Transfer TrackerBus::read(std::span<std::uint8_t> into, Duration timeout) {
  Stamp now = clock_.now();
  const Stamp until = now + timeout;
  while (true) {
    advance(now);
    if (count_ > 0 && chunk(0).bytes.size == 0) {
      first_ = (first_ + 1) % chunks_.size();
      --count_;
      continue;
    }
    if (open_ && !plug_.left && present(now)) {
      if (io_errors_ > 0) {
        --io_errors_;
        clock_.sleep_until(now + retry_pause);
        return {TransferStatus::io_error, 0};
      }
      if (halted_) {
        clock_.sleep_until(now + retry_pause);
        return {TransferStatus::stalled, 0};
      }
    }
    if (!open_) return {TransferStatus::gone, 0};
    if (bus_.zero_length > 0 && count_ > 0 && chunk(0).arrives <= now && uniform() < bus_.zero_length)
      return {TransferStatus::ok, 0};
    const Transfer got = take(into, now);
    if (got.count > 0) return got;
    if (plug_.left || !present(now)) {
      plug_.left = true;
      return {TransferStatus::gone, 0};
    }
    if (now >= until) return {TransferStatus::timed_out, 0};
    Stamp next = until;
    if (count_ > 0)
      next =
          std::min(next, chunk(0).taken > 0 ? std::max(second_piece_, chunk(0).arrives) : chunk(0).arrives);
    next = std::min(next, unit_->next_send(now));
    if (next_fault_ < faults_.size()) next = std::min(next, faults_[next_fault_].at);
    clock_.sleep_until(std::max(next, now + Duration(1)));
    now = clock_.now();
  }
}

}  // namespace sonoband::sim
