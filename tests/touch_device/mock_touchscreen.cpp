#include "tests/touch_device/mock_touchscreen.h"

#include <fcntl.h>
#include <linux/input.h>
#include <umockdev.h>
#include <unistd.h>

#include <algorithm>
#include <atomic>
#include <cerrno>
#include <cstring>
#include <ctime>
#include <stdexcept>

namespace sonoband::test {

struct MockTouchscreen::State {
  MockSettings settings;
  UMockdevTestbed* bed = nullptr;
  UMockdevIoctlBase* ioctls = nullptr;
  int fd = -1;  // the kernel's end
  std::atomic<bool> grabbed{false};
  std::atomic<bool> clock_set{false};
};

namespace {

constexpr std::array<int, 4> places = {ABS_MT_POSITION_X, ABS_MT_POSITION_Y, ABS_MT_TRACKING_ID,
                                       ABS_MT_TOUCH_MAJOR};

constexpr const char* mouse_path = "/dev/input/event4";

using Bytes = std::vector<std::uint8_t>;

void set_bit(Bytes& bits, int bit) {
  if (static_cast<std::size_t>(bit / 8) < bits.size())
    bits[static_cast<std::size_t>(bit / 8)] |= static_cast<std::uint8_t>(1 << (bit % 8));
}

template <class T>
Bytes bytes_of(const T& value, std::size_t size) {
  Bytes bytes(size);
  std::memcpy(bytes.data(), &value, std::min(size, sizeof value));
  return bytes;
}

Bytes capabilities(const MockSettings& settings, unsigned type, std::size_t size) {
  Bytes bits(size);
  if (type == 0)
    for (const int t : {EV_SYN, EV_KEY, EV_ABS}) set_bit(bits, t);
  if (type == EV_KEY) set_bit(bits, BTN_TOUCH);
  if (type == EV_KEY && settings.key) set_bit(bits, *settings.key);
  if (type == EV_ABS) {
    for (const int code : places) set_bit(bits, code);
    for (const int code : {ABS_X, ABS_Y}) set_bit(bits, code);
    if (settings.slots) set_bit(bits, ABS_MT_SLOT);
  }
  return bits;
}

input_absinfo axis(const MockSettings& settings, unsigned code) {
  switch (code) {
    case ABS_MT_SLOT:
      return {settings.slot, 0, static_cast<int>(settings.at_start.size()) - 1, 0, 0, 0};
    case ABS_MT_TRACKING_ID:
      return {0, 0, 65535, 0, 0, 0};
    case ABS_MT_TOUCH_MAJOR:
      return {0, 0, 4095, 0, 0, 0};
    case ABS_X:
    case ABS_MT_POSITION_X:
      return {0, 0, 4095, 0, 0, 20};
    default:
      return {0, 0, 2559, 0, 0, 20};
  }
}

// The first word names the axis; the values of the slots follow.
void tell_slots(const MockSettings& settings, Bytes& words) {
  std::int32_t code = 0;
  std::memcpy(&code, words.data(), sizeof code);
  for (std::size_t s = 0; s < settings.at_start.size() && (s + 2) * 4 <= words.size(); ++s) {
    const MockSlot& slot = settings.at_start[s];
    const std::int32_t value = code == ABS_MT_TRACKING_ID  ? slot.id
                               : code == ABS_MT_POSITION_X ? slot.x
                               : code == ABS_MT_POSITION_Y ? slot.y
                                                           : 0;
    std::memcpy(words.data() + 4 * (s + 1), &value, sizeof value);
  }
}

// As drivers/input/evdev.c of the kernel answers. Returns the call's result, or minus errno.
int answer(MockTouchscreen::State& state, unsigned long request, Bytes& data) {
  const MockSettings& settings = state.settings;
  const unsigned nr = _IOC_NR(request);
  if (_IOC_TYPE(request) != 'E') return -ENOTTY;
  if (request == EVIOCGVERSION) data = bytes_of(EV_VERSION, data.size());
  if (request == EVIOCGID)
    data = bytes_of(input_id{BUS_USB, settings.vendor, settings.product, 0x110}, data.size());
  if (nr == _IOC_NR(EVIOCGNAME(0))) {
    constexpr char name[] = "Mock panel";
    data = bytes_of(name, data.size());
    return sizeof name;
  }
  if (nr == _IOC_NR(EVIOCGPHYS(0)) || nr == _IOC_NR(EVIOCGUNIQ(0))) return -ENOENT;
  if (nr == _IOC_NR(EVIOCGPROP(0)) && settings.direct) set_bit(data, INPUT_PROP_DIRECT);
  if (nr >= 0x20 && nr < 0x20 + EV_CNT) data = capabilities(settings, nr - 0x20, data.size());
  if (nr >= 0x40 && nr < 0x40 + ABS_CNT && _IOC_DIR(request) == _IOC_READ)
    data = bytes_of(axis(settings, nr - 0x40), data.size());
  if (nr == _IOC_NR(EVIOCGMTSLOTS(0)) && _IOC_DIR(request) == _IOC_READ) tell_slots(settings, data);
  if (nr == _IOC_NR(EVIOCSCLOCKID)) state.clock_set = true;
  if (nr >= 0x18 && nr < 0x20) return static_cast<int>(data.size());  // keys and lights, all off
  return 0;
}

gboolean on_ioctl(UMockdevIoctlBase*, UMockdevIoctlClient* client, gpointer user) {
  auto& state = *static_cast<MockTouchscreen::State*>(user);
  const unsigned long request = umockdev_ioctl_client_get_request(client);
  UMockdevIoctlData* arg = umockdev_ioctl_client_get_arg(client);
  if (request == EVIOCGRAB) {
    if (!state.settings.grabbed) state.grabbed = true;
    umockdev_ioctl_client_complete(client, state.settings.grabbed ? -1 : 0,
                                   state.settings.grabbed ? EBUSY : 0);
    return TRUE;
  }
  GError* error = nullptr;
  UMockdevIoctlData* data = umockdev_ioctl_data_resolve(arg, 0, _IOC_SIZE(request), &error);
  if (data == nullptr) {
    g_clear_error(&error);
    umockdev_ioctl_client_complete(client, -1, EFAULT);
    return TRUE;
  }
  // What is asked for comes with zeros; slots are asked for by their axis, a clock by its number.
  gint size = 0;
  guint8* before = nullptr;
  umockdev_ioctl_data_retrieve(data, &before, &size);
  Bytes bytes(before, before + size);
  g_free(before);
  const int result = answer(state, request, bytes);
  if (result >= 0 && (_IOC_DIR(request) & _IOC_READ) != 0)
    umockdev_ioctl_data_update(data, 0, bytes.data(), static_cast<gint>(bytes.size()));
  umockdev_ioctl_client_complete(client, result < 0 ? -1 : result, result < 0 ? -result : 0);
  umockdev_ioctl_data_unref(data);
  return TRUE;
}

}  // namespace

MockTouchscreen::MockTouchscreen(const MockSettings& settings) : state_(std::make_unique<State>()) {
  state_->settings = settings;
  state_->bed = umockdev_testbed_new();
  GError* error = nullptr;
  constexpr char description[] =
      "P: /devices/event5\nN: input/event5\nE: DEVNAME=/dev/input/event5\nE: SUBSYSTEM=input\n"
      "E: ID_INPUT_TOUCHSCREEN=1\nA: dev=13:69\n\n";
  if (umockdev_testbed_add_from_string(state_->bed, description, &error) == FALSE)
    throw std::runtime_error(std::string("umockdev makes no device: ") + error->message);
  state_->ioctls = umockdev_ioctl_base_new();
  g_signal_connect(state_->ioctls, "handle-ioctl", G_CALLBACK(on_ioctl), state_.get());
  if (umockdev_testbed_attach_ioctl(state_->bed, path, state_->ioctls, &error) == FALSE)
    throw std::runtime_error(std::string("umockdev attaches no ioctls: ") + error->message);
  state_->fd = umockdev_testbed_get_dev_fd(state_->bed, path);
  if (!settings.with_mouse) return;
  constexpr char mouse[] =
      "P: /devices/event4\nN: input/event4\nE: DEVNAME=/dev/input/event4\nE: SUBSYSTEM=input\nA: "
      "dev=13:68\n\n";
  if (umockdev_testbed_add_from_string(state_->bed, mouse, &error) == FALSE)
    throw std::runtime_error(std::string("umockdev makes no mouse: ") + error->message);
  mouse_ = std::make_unique<State>();
  mouse_->settings = settings;
  mouse_->settings.key.reset();
  mouse_->ioctls = umockdev_ioctl_base_new();
  g_signal_connect(mouse_->ioctls, "handle-ioctl", G_CALLBACK(on_ioctl), mouse_.get());
  if (umockdev_testbed_attach_ioctl(state_->bed, mouse_path, mouse_->ioctls, &error) == FALSE)
    throw std::runtime_error(std::string("umockdev attaches no ioctls: ") + error->message);
}

MockTouchscreen::~MockTouchscreen() {
  if (mouse_) {
    umockdev_testbed_detach_ioctl(state_->bed, mouse_path, nullptr);
    g_object_unref(mouse_->ioctls);
  }
  umockdev_testbed_detach_ioctl(state_->bed, path, nullptr);
  g_object_unref(state_->ioctls);
  g_object_unref(state_->bed);
}

void MockTouchscreen::write(const std::vector<RawTouch>& events) {
  timespec now{};
  clock_gettime(CLOCK_MONOTONIC, &now);
  for (const RawTouch& raw : events) {
    input_event event{};
    event.input_event_sec = now.tv_sec;
    event.input_event_usec = now.tv_nsec / 1000;
    event.type = raw.type;
    event.code = raw.code;
    event.value = raw.value;
    if (::write(state_->fd, &event, sizeof event) != static_cast<ssize_t>(sizeof event))
      throw std::runtime_error("the mock device takes no event");
  }
}

// umockdev keeps its end open when a device goes; with that end elsewhere, the driver's hangs up.
void MockTouchscreen::unplug() {
  const int nowhere = ::open("/dev/null", O_RDWR | O_CLOEXEC);
  dup2(nowhere, state_->fd);
  ::close(nowhere);
}

bool MockTouchscreen::was_grabbed() const {
  return state_->grabbed;
}

bool MockTouchscreen::mouse_was_grabbed() const {
  return mouse_ && mouse_->grabbed;
}

bool MockTouchscreen::clock_was_set() const {
  return state_->clock_set;
}

}  // namespace sonoband::test
