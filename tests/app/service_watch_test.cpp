// A made-up service manager on a socket: what it hears of a cart whose capture runs, stands still, goes on.
#include "app/service_watch.h"

#include <gtest/gtest.h>
#include <sys/socket.h>
#include <sys/time.h>
#include <sys/un.h>
#include <unistd.h>

#include <array>
#include <atomic>
#include <cstdlib>
#include <cstring>
#include <filesystem>
#include <memory>
#include <string>

#include "app/cart/appliance.h"
#include "hal/sim/sim_footswitch.h"
#include "tests/app/cart/cart_support.h"

namespace sonoband {
namespace {

using Notice = ServiceNotice;

TEST(Heartbeat, SaysReadyAtTheFirstBeatAndStandsStillOnce) {
  Heartbeat h;
  const std::pair<std::uint64_t, Notice> looks[] = {
      {0, Notice::none},   {0, Notice::none},          {7, Notice::ready}, {8, Notice::alive},
      {90, Notice::alive}, {90, Notice::stands_still}, {90, Notice::none}, {90, Notice::none},
      {91, Notice::alive}, {91, Notice::stands_still}};
  int n = 0;
  for (const auto& [beats, said] : looks) EXPECT_EQ(h.look(beats), said) << "look " << n++;
}

TEST(Heartbeat, IsLookedAtFourTimesWithinTheManagersPatience) {
  EXPECT_EQ(look_every("10000000"), std::chrono::milliseconds(2500));
  EXPECT_EQ(look_every("4"), std::chrono::microseconds(1));
  for (const char* nonsense : {"", "0", "3", "-5", "10s", "1e7", "99999999999999999999", "3600000001"})
    EXPECT_EQ(look_every(nonsense), std::chrono::seconds(1)) << nonsense;
  EXPECT_EQ(look_every(std::nullopt), std::chrono::seconds(1));
}

class Manager {
 public:
  explicit Manager(const char* watchdog_usec) {
    folder_ = std::filesystem::temp_directory_path() / ("sonoband-manager-" + std::to_string(getpid()));
    std::filesystem::create_directories(folder_);
    const std::string path = folder_ / "notify";
    sockaddr_un address{};
    address.sun_family = AF_UNIX;
    std::strncpy(address.sun_path, path.c_str(), sizeof(address.sun_path) - 1);
    socket_ = socket(AF_UNIX, SOCK_DGRAM | SOCK_CLOEXEC, 0);
    EXPECT_EQ(bind(socket_, reinterpret_cast<const sockaddr*>(&address), sizeof(address)), 0);
    setenv("NOTIFY_SOCKET", path.c_str(), 1);
    setenv("WATCHDOG_USEC", watchdog_usec, 1);
    setenv("WATCHDOG_PID", "1", 1);  // xinit's, never the cart's own
  }
  ~Manager() {
    for (const char* name : {"NOTIFY_SOCKET", "WATCHDOG_USEC", "WATCHDOG_PID"}) unsetenv(name);
    close(socket_);
    std::filesystem::remove_all(folder_);
  }
  Manager(const Manager&) = delete;
  Manager& operator=(const Manager&) = delete;

  // The next thing said; empty when nothing is within the time.
  std::string hear(int at_most_ms) const {
    const timeval patience{at_most_ms / 1000, 1000L * (at_most_ms % 1000)};
    setsockopt(socket_, SOL_SOCKET, SO_RCVTIMEO, &patience, sizeof(patience));
    std::array<char, 512> text{};
    const ssize_t n = recv(socket_, text.data(), text.size(), 0);
    return n > 0 ? std::string(text.data(), static_cast<std::size_t>(n)) : std::string();
  }
  // True when this comes among the next hundred; a busy machine may say that acquisition stands still before.
  bool hears(const std::string& words) const {
    for (int i = 0; i < 100; ++i) {
      const std::string said = hear(10'000);
      if (said.find(words) != std::string::npos) return true;
      if (said.empty()) return false;
    }
    return false;
  }

 private:
  std::filesystem::path folder_;
  int socket_ = -1;
};

class NoTracker final : public Tracker {
 public:
  explicit NoTracker(Clock& clock) : clock_(clock) {}
  void start() override {}
  ReadStatus read(std::span<PoseSample> /*out*/, std::size_t& count, Duration timeout) override {
    count = 0;
    clock_.sleep_until(clock_.now() + timeout);
    return ReadStatus::nothing_yet;
  }
  DeviceHealth health() const override { return {}; }
  void stop() override {}

 private:
  Clock& clock_;
};

// Sends nothing, and while it is blocked does not even come back from a read: a driver that hangs.
class HangingSource final : public FrameSource {
 public:
  HangingSource(Clock& clock, const std::atomic<bool>& blocked) : clock_(clock), blocked_(blocked) {}
  void start() override {}
  ReadStatus read(Frame& /*out*/, Duration timeout) override {
    clock_.sleep_until(clock_.now() + timeout);
    blocked_.wait(true);
    return ReadStatus::nothing_yet;
  }
  DeviceHealth health() const override { return {}; }
  void stop() override {}

 private:
  Clock& clock_;
  const std::atomic<bool>& blocked_;
};

TEST(ServiceWatch, ABlockedAcquisitionGetsNoSignOfLifeAlthoughTheInterfaceRuns) {
  const Manager manager("100000");
  std::atomic<bool> blocked{false};
  cart::Devices devices;
  devices.clock = std::make_shared<SystemClock>();
  devices.tracker = std::make_unique<NoTracker>(*devices.clock);
  devices.frames = std::make_unique<HangingSource>(*devices.clock, blocked);
  devices.pedal = std::make_unique<sim::SimFootswitch>(*devices.clock, sim::FootswitchSettings{});
  cart::Appliance appliance(
      std::move(devices),
      {.ring = cart::test::small_ring(32), .cart = cart::test::small_cart(), .lock_memory = false});
  std::optional<ServiceWatch> watch(std::in_place, [&] { return appliance.beats(); });
  appliance.start();
  EXPECT_TRUE(manager.hears("READY=1"));
  for (int i = 0; i < 3; ++i) EXPECT_TRUE(manager.hears("WATCHDOG=1"));

  blocked = true;
  EXPECT_TRUE(manager.hears("stands still"));
  // The interface goes on asking all the while; ten looks pass without a sign of life.
  for (int i = 0; i < 25; ++i) {
    static_cast<void>(appliance.status());
    EXPECT_EQ(manager.hear(10), "");
  }
  blocked = false;
  blocked.notify_all();
  EXPECT_TRUE(manager.hears("WATCHDOG=1"));
  watch.reset();
  EXPECT_TRUE(manager.hears("STOPPING=1"));
  appliance.stop();
}

TEST(ServiceWatch, WithoutAManagerNobodyIsTold) {
  unsetenv("NOTIFY_SOCKET");
  bool asked = false;
  {
    const ServiceWatch watch([&] {
      asked = true;
      return std::uint64_t{1};
    });
  }
  EXPECT_FALSE(asked);
}

}  // namespace
}  // namespace sonoband
