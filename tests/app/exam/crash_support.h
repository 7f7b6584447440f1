// What the tests of the store's promise share: how often they try, a row of the README's table, a scripted
// recording with what was acknowledged of it, and children that are killed.
#pragma once

#include <signal.h>
#include <sys/mman.h>

#include <cstdint>
#include <filesystem>
#include <functional>
#include <memory>
#include <new>
#include <stdexcept>
#include <string>
#include <vector>

#include "app/cart/appliance.h"
#include "app/cart_on_board.h"
#include "app/exam/records.h"
#include "tests/app/exam/exam_support.h"

namespace sonoband::exam::test {

// SONOBAND_CRASH_MOMENTS, or `by_default` where it is not set.
int moments(int by_default);
// How many changes of the disk to step on; the whole table takes every one.
int stride();
// A line that tools/crash-tests makes a row of the README's table of.
void table_row(const std::string& fault, std::int64_t times, const std::string& found);

// What was acknowledged by the time of the crash.
struct Acknowledged {
  bool sweep = false;
  std::int64_t frames = 0;
  std::int64_t reviews = 0;
  bool ended = false;
};

constexpr int script_width = 48;
constexpr int script_height = 32;
constexpr std::int64_t script_frames = 18;

ReviewObject note(std::int64_t number);

// One sweep in six batches with review between them; goes on from what is in the file, as the recorder does.
// Throws StoreError; `done` is then what was acknowledged before.
void record_script(const std::filesystem::path& file, const std::string& vfs, const MadeSweep& sweep,
                   Acknowledged& done);
// Sentences about what was acknowledged and is not there.
std::vector<std::string> broken_promises(const std::filesystem::path& file, const Acknowledged& done);

// A `Diary` in memory that a child shares with its parent.
template <class Diary>
class SharedDiary {
 public:
  SharedDiary()
      : page_(::mmap(nullptr, sizeof(Diary), PROT_READ | PROT_WRITE, MAP_SHARED | MAP_ANONYMOUS, -1, 0)) {
    if (page_ == MAP_FAILED) throw std::runtime_error("no memory to share with a child");
  }
  ~SharedDiary() { ::munmap(page_, sizeof(Diary)); }
  SharedDiary(const SharedDiary&) = delete;
  SharedDiary& operator=(const SharedDiary&) = delete;
  Diary& blank() { return *::new (page_) Diary; }

 private:
  void* page_;
};

// Starts a child that runs `body`, which never returns; it dies with us.
::pid_t start_child(const std::function<void()>& body);
// Kills it; fails the test when it has ended by itself. Returns the moment on the steady clock.
std::int64_t kill_child(::pid_t child);

// A simulated cart on the machine's own clock: 160 x 120 pixels, 60 frames a second, exams in `place`.
struct SmallCart {
  SmallCart(const std::filesystem::path& place, int ring_frames);
  BoardDevices board;
  std::unique_ptr<cart::Appliance> cart;  // started
};

}  // namespace sonoband::exam::test
