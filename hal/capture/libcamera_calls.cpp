// libcamera 0.0.3 (Debian 12) and 0.4 (Debian 13). Its own thread completes requests; they reach ours through
// a queue and an eventfd, without a lock. The library itself allocates when a request is queued.
#include <libcamera/camera.h>
#include <libcamera/camera_manager.h>
#include <libcamera/control_ids.h>
#include <libcamera/framebuffer_allocator.h>
#include <libcamera/property_ids.h>
#include <libcamera/request.h>
#include <linux/dma-buf.h>
#include <poll.h>
#include <sys/eventfd.h>
#include <sys/ioctl.h>
#include <sys/mman.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <atomic>
#include <cerrno>
#include <chrono>
#include <cmath>
#include <map>
#include <optional>
#include <utility>

#include "core/concurrency/spsc_queue.h"
#include "hal/capture/camera_calls.h"

namespace sonoband {
namespace {

// A process may have one manager only. It looks for cameras as they come and go while anyone holds it.
std::shared_ptr<libcamera::CameraManager> camera_manager() {
  static std::weak_ptr<libcamera::CameraManager> the_one;
  std::shared_ptr<libcamera::CameraManager> manager = the_one.lock();
  if (manager) return manager;
  manager = std::make_shared<libcamera::CameraManager>();
  if (manager->start() != 0) return nullptr;
  the_one = manager;
  return manager;
}

CameraError error_of(int result) {
  switch (result) {
    case 0:
      return CameraError::none;
    case -ENODEV:
    case -ENOENT:
      return CameraError::absent;
    case -EBUSY:
      return CameraError::busy;
    case -EINVAL:
      return CameraError::refused;
    default:
      return CameraError::failed;
  }
}

// One buffer as memory: its planes' files, each mapped whole and once.
class MappedBuffer {
 public:
  explicit MappedBuffer(const libcamera::FrameBuffer& buffer) {
    for (const auto& plane : buffer.planes()) {
      const auto [at, fresh] = files_.try_emplace(plane.fd.get());
      if (!fresh) continue;
      const off_t bytes = lseek(plane.fd.get(), 0, SEEK_END);
      void* start = bytes <= 0 ? MAP_FAILED
                               : mmap(nullptr, static_cast<std::size_t>(bytes), PROT_READ, MAP_SHARED,
                                      plane.fd.get(), 0);
      if (start != MAP_FAILED)
        at->second = {static_cast<const std::uint8_t*>(start), static_cast<std::size_t>(bytes)};
    }
    for (const auto& plane : buffer.planes())
      if (!extend(files_[plane.fd.get()], plane.offset, plane.length)) break;
  }
  ~MappedBuffer() {
    for (const auto& [fd, bytes] : files_)
      if (!bytes.empty()) munmap(const_cast<std::uint8_t*>(bytes.data()), bytes.size());
  }
  MappedBuffer(const MappedBuffer&) = delete;
  MappedBuffer& operator=(const MappedBuffer&) = delete;

  std::span<const std::uint8_t> picture() const { return picture_; }
  // Around reading: memory that a device wrote past the processor's caches. Others do not know the call.
  void reading(bool begins) const {
    dma_buf_sync sync{};
    sync.flags = DMA_BUF_SYNC_READ | (begins ? DMA_BUF_SYNC_START : DMA_BUF_SYNC_END);
    for (const auto& [fd, bytes] : files_) ioctl(fd, DMA_BUF_IOCTL_SYNC, &sync);
  }

 private:
  // False: this plane does not follow the last one in memory.
  bool extend(std::span<const std::uint8_t> file, std::size_t offset, std::size_t length) {
    if (offset > file.size() || length > file.size() - offset) return false;
    const auto plane = file.subspan(offset, length);
    if (picture_.empty()) return picture_ = plane, true;
    if (plane.data() != picture_.data() + picture_.size()) return false;
    picture_ = {picture_.data(), picture_.size() + plane.size()};
    return true;
  }

  std::map<int, std::span<const std::uint8_t>> files_;
  std::span<const std::uint8_t> picture_;
};

class LibcameraCalls final : public CameraCalls {
 public:
  LibcameraCalls() : bell_(eventfd(0, EFD_NONBLOCK | EFD_CLOEXEC)) {}
  ~LibcameraCalls() override {
    LibcameraCalls::stop();
    LibcameraCalls::close();
    ::close(bell_);
  }

  CameraError open(const std::string& id) override {
    if (!manager_) manager_ = camera_manager();
    if (!manager_) return CameraError::failed;
    std::shared_ptr<libcamera::Camera> found;
    for (const auto& camera : manager_->cameras())
      if (!found && (id == "auto" || camera->id() == id)) found = camera;
    if (!found) return CameraError::absent;
    if (const int result = found->acquire(); result != 0) return error_of(result);
    camera_ = std::move(found);
    gone_ = false;
    camera_->disconnected.connect(this, &LibcameraCalls::disconnected);
    camera_->requestCompleted.connect(this, &LibcameraCalls::completed);
    return CameraError::none;
  }

  std::string name() const override {
    const auto model = camera_->properties().get(libcamera::properties::Model);
    return model ? std::string(*model) : camera_->id();
  }

  std::vector<std::uint32_t> formats() override {
    std::vector<std::uint32_t> offered;
    configuration_ = camera_->generateConfiguration({libcamera::StreamRole::VideoRecording});
    if (!configuration_ || configuration_->empty()) return offered;
    for (const auto& format : configuration_->at(0).formats().pixelformats())
      if (format.modifier() == 0) offered.push_back(format.fourcc());
    return offered;
  }

  CameraError configure(CameraMode& mode) override {
    configuration_ = camera_->generateConfiguration({libcamera::StreamRole::VideoRecording});
    if (!configuration_ || configuration_->empty()) return CameraError::failed;
    libcamera::StreamConfiguration& stream = configuration_->at(0);
    stream.pixelFormat = libcamera::PixelFormat(mode.fourcc, 0);
    stream.size = {mode.width, mode.height};
    stream.bufferCount = wanted_buffers;
    if (configuration_->validate() == libcamera::CameraConfiguration::Invalid) return CameraError::refused;
    if (const int result = camera_->configure(configuration_.get()); result != 0) return error_of(result);
    mode = {stream.pixelFormat.fourcc(), stream.size.width, stream.size.height, stream.stride,
            stream.frameSize};
    return CameraError::none;
  }

  CameraError start(double rate_hz, std::vector<std::span<const std::uint8_t>>& buffers) override {
    buffers.clear();
    while (completions_.front() != nullptr) completions_.pop();
    libcamera::Stream* stream = configuration_->at(0).stream();
    allocator_.emplace(camera_);
    if (const int result = allocator_->allocate(stream); result < 0) return error_of(result);
    for (const auto& buffer : allocator_->buffers(stream)) {
      if (mapped_.size() == most_buffers) break;
      mapped_.push_back(std::make_unique<MappedBuffer>(*buffer));
      buffers.push_back(mapped_.back()->picture());
      requests_.push_back(camera_->createRequest(requests_.size()));
      if (!requests_.back() || requests_.back()->addBuffer(stream, buffer.get()) != 0)
        return CameraError::failed;
    }
    libcamera::ControlList wishes(libcamera::controls::controls);
    const auto& known = camera_->controls();
    if (known.find(&libcamera::controls::FrameDurationLimits) != known.end()) {
      const std::array<std::int64_t, 2> period_us{std::llround(1e6 / rate_hz), std::llround(1e6 / rate_hz)};
      wishes.set(libcamera::controls::FrameDurationLimits, libcamera::Span<const std::int64_t, 2>(period_us));
    }
    if (const int result = camera_->start(&wishes); result != 0) return error_of(result);
    running_ = true;
    for (const auto& request : requests_)
      if (const int result = camera_->queueRequest(request.get()); result != 0) return error_of(result);
    return CameraError::none;
  }

  bool wait(CameraCompletion& out, Duration timeout) override {
    if (completions_.front() == nullptr && !gone_.load(std::memory_order_acquire)) {
      pollfd bell{bell_, POLLIN, 0};
      const auto left = std::chrono::ceil<std::chrono::milliseconds>(timeout).count();
      poll(&bell, 1, static_cast<int>(std::clamp<std::int64_t>(left, 0, 10'000)));
      std::uint64_t rung = 0;
      // Taken before the queue is looked at: what comes afterwards rings again.
      static_cast<void>(!read(bell_, &rung, sizeof(rung)));
    }
    const CameraCompletion* next = completions_.front();
    if (next == nullptr) return false;
    out = *next;
    completions_.pop();
    if (out.slot >= 0 && static_cast<std::size_t>(out.slot) < mapped_.size())
      mapped_[static_cast<std::size_t>(out.slot)]->reading(true);
    return true;
  }

  bool gone() const override { return gone_.load(std::memory_order_acquire); }

  CameraError queue(int slot) override {
    const auto i = static_cast<std::size_t>(slot);
    mapped_[i]->reading(false);
    requests_[i]->reuse(libcamera::Request::ReuseBuffers);
    return error_of(camera_->queueRequest(requests_[i].get()));
  }

  void stop() override {
    if (!camera_) return;
    if (std::exchange(running_, false)) camera_->stop();  // completes what is queued as cancelled
    requests_.clear();
    mapped_.clear();
    allocator_.reset();
  }

  void close() override {
    if (!camera_) return;
    camera_->requestCompleted.disconnect(this);
    camera_->disconnected.disconnect(this);
    camera_->release();
    configuration_.reset();
    camera_.reset();
  }

 private:
  static constexpr unsigned wanted_buffers = 4;
  static constexpr std::size_t most_buffers = 32;

  // Of libcamera's thread.
  void completed(libcamera::Request* request) {
    CameraCompletion done;
    done.slot = static_cast<int>(request->cookie());
    done.whole = request->status() == libcamera::Request::RequestComplete;
    for (const auto& [stream, buffer] : request->buffers()) {
      const libcamera::FrameMetadata& about = buffer->metadata();
      done.whole = done.whole && about.status == libcamera::FrameMetadata::FrameSuccess;
      done.sequence = about.sequence;
      done.stamp_ns = static_cast<std::int64_t>(about.timestamp);
      for (const auto& plane : about.planes()) done.bytes += plane.bytesused;
    }
    // Never full: there are fewer requests than places.
    static_cast<void>(completions_.try_emplace(done));
    ring();
  }
  void disconnected() {
    gone_.store(true, std::memory_order_release);
    ring();
  }
  void ring() const {
    const std::uint64_t once = 1;
    static_cast<void>(!write(bell_, &once, sizeof(once)));
  }

  int bell_;
  std::shared_ptr<libcamera::CameraManager> manager_;
  std::shared_ptr<libcamera::Camera> camera_;
  std::unique_ptr<libcamera::CameraConfiguration> configuration_;
  std::optional<libcamera::FrameBufferAllocator> allocator_;
  std::vector<std::unique_ptr<MappedBuffer>> mapped_;
  std::vector<std::unique_ptr<libcamera::Request>> requests_;
  SpscQueue<CameraCompletion> completions_{2 * most_buffers};
  std::atomic<bool> gone_{false};
  bool running_ = false;
};

}  // namespace

std::unique_ptr<CameraCalls> libcamera_calls() {
  return std::make_unique<LibcameraCalls>();
}

}  // namespace sonoband
