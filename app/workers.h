// A small pool of threads for the render kernels.
#pragma once

#include <atomic>
#include <functional>
#include <thread>
#include <vector>

#include "core/parallel.h"

namespace sonoband {

// `threads` take part in each for_each, the caller among them; they sleep in between (no spinning: it steals
// from acquisition and, on a shared machine, from everyone). One for_each at a time.
class Workers final : public Parallel {
 public:
  explicit Workers(int threads);
  ~Workers() override;
  Workers(const Workers&) = delete;
  Workers& operator=(const Workers&) = delete;

  int width() const override { return static_cast<int>(threads_.size()) + 1; }
  void for_each(int count, const std::function<void(int)>& body) override;

 private:
  void serve();
  bool enter();
  void leave();
  void take_part(const std::function<void(int)>& body, int count);

  std::atomic<std::uint32_t> generation_{0};  // bumped for each job and for the end
  std::atomic<int> next_{0};                  // next index of the job
  static constexpr std::uint32_t open = std::uint32_t{1} << 31;
  std::atomic<std::uint32_t> inside_{0};  // threads in the job, and `open` while it may be entered
  const std::function<void(int)>* body_ = nullptr;
  int count_ = 0;
  std::atomic<bool> ending_{false};  // may be looked at by a thread that wakes late for the last job
  std::vector<std::thread> threads_;
};

}  // namespace sonoband
