#include "app/exam/sweep_loader.h"

#include <unistd.h>

#include <algorithm>

namespace sonoband::exam {
namespace {

// What set_pose asks for.
bool is_placeable(const Affine<frame::World, frame::Image>& t) {
  const Eigen::Vector3d normal = t.linear.col(0).cross(t.linear.col(1));
  return t.linear.leftCols<2>().allFinite() && t.translation.allFinite() && normal.allFinite() &&
         normal.norm() > 0;
}

}  // namespace

std::uint64_t default_memory_limit() {
  return static_cast<std::uint64_t>(::sysconf(_SC_PHYS_PAGES)) *
         static_cast<std::uint64_t>(::sysconf(_SC_PAGESIZE)) / 4 * 3;
}

SweepLoader::SweepLoader(const std::filesystem::path& exam, std::int64_t sweep, std::int64_t first,
                         std::uint64_t memory_limit)
    : reader_(exam), sweep_(sweep), setup_(reader_.setup(sweep)) {
  StoredFrames found = reader_.frames(sweep);
  stored_ = std::move(found.frames);
  damage_ = std::move(found.damage);
  const std::uint64_t slot =
      static_cast<std::uint64_t>(setup_.width) * static_cast<std::uint64_t>(setup_.height);
  if (slot > 0 && stored_.size() > memory_limit / slot)
    throw StoreError(StoreError::Kind::refused,
                     exam.filename().string() + ", sweep " + std::to_string(sweep) + ": its " +
                         std::to_string(stored_.size()) + " pictures need " +
                         std::to_string(slot * stored_.size() >> 20) + " MiB of memory, more than the " +
                         std::to_string(memory_limit >> 20) + " MiB it may have here");
  pixels_ = std::make_unique_for_overwrite<std::uint8_t[]>(slot * stored_.size());
  frames_.resize(stored_.size());
  ready_ = std::make_unique<std::atomic<bool>[]>(stored_.size());
  for (std::size_t i = 0; i < stored_.size(); ++i) {
    const FrameRecord& record = stored_[i].record;
    TrackedFrame& f = frames_[i];
    f.bscan = {{pixels_.get() + slot * i, setup_.width, setup_.height, setup_.width}, record.kind};
    // A matrix that cannot be turned round was stored by a broken program, but the checksum is right.
    if (record.pose_status == PoseStatus::ok && is_placeable(record.world_from_image)) {
      set_pose(f, record.world_from_image);
    } else {
      f.pose_status = record.pose_status == PoseStatus::ok ? PoseStatus::poor : record.pose_status;
    }
    f.sweep_id = static_cast<std::int32_t>(sweep);
    f.sequence = record.number;
    f.captured = record.captured;
  }
  if (stored_.empty()) return;
  first = std::clamp<std::int64_t>(first, 0, total() - 1);
  load(first);
  thread_ = std::thread([this, first] {
    for (std::int64_t i = 0; i < total() && !stop_.load(std::memory_order_relaxed); ++i)
      if (i != first) load(i);
  });
}

SweepLoader::~SweepLoader() {
  stop_.store(true, std::memory_order_relaxed);
  if (thread_.joinable()) thread_.join();
}

void SweepLoader::wait() {
  if (thread_.joinable()) thread_.join();
}

void SweepLoader::load(std::int64_t i) {
  const std::size_t slot = static_cast<std::size_t>(setup_.width) * setup_.height;
  const ImageView<std::uint8_t> out{pixels_.get() + slot * static_cast<std::size_t>(i), setup_.width,
                                    setup_.height, setup_.width};
  std::string wrong;
  try {
    wrong = reader_.pixels(sweep_, stored_[i], out);
  } catch (const StoreError& e) {
    wrong = e.what();
  }
  if (wrong.empty()) {
    ready_[i].store(true, std::memory_order_release);
  } else {
    const std::lock_guard lock(mutex_);
    damage_.push_back(std::move(wrong));
  }
  visited_.fetch_add(1, std::memory_order_release);
}

std::vector<const TrackedFrame*> SweepLoader::renderable() const {
  std::vector<const TrackedFrame*> frames;
  frames.reserve(frames_.size());
  for (std::int64_t i = 0; i < total(); ++i)
    if (ready(i) && frames_[i].pose_status == PoseStatus::ok) frames.push_back(&frames_[i]);
  return frames;
}

std::vector<std::string> SweepLoader::damage() const {
  const std::lock_guard lock(mutex_);
  return damage_;
}

}  // namespace sonoband::exam
