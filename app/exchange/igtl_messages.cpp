#include "app/exchange/igtl_messages.h"

#include <igtlImageMessage.h>
#include <igtlStatusMessage.h>
#include <igtlTrackingDataMessage.h>
#include <igtlTransformMessage.h>
#include <igtl_util.h>

#include <algorithm>
#include <cstring>

namespace sonoband::exchange {
namespace {

constexpr std::size_t head_bytes = 58;
constexpr std::size_t type_at = 2;
constexpr std::size_t type_bytes = 12;
constexpr std::size_t size_at = 42;
constexpr std::size_t crc_at = 50;
constexpr std::uint64_t largest_request = 4096;     // of those that are read: STT_TDATA has 36 bytes
constexpr std::uint64_t largest_skipped = 1 << 20;  // of those that are not
constexpr std::size_t longest_name = 20;

std::uint64_t big(const std::uint8_t* p, int count) {
  std::uint64_t value = 0;
  for (int i = 0; i < count; ++i) value = value << 8 | p[i];
  return value;
}

template <class Message>
IgtlBytes packed(Message& message, const std::string& name, std::int64_t utc_ns) {
  const auto second = utc_ns / 1'000'000'000;
  const auto fraction = static_cast<std::uint64_t>(utc_ns % 1'000'000'000);
  message.SetDeviceName(name.substr(0, longest_name).c_str());
  // The fraction counts in 2^-32 s.
  message.SetTimeStamp(static_cast<unsigned>(second),
                       static_cast<unsigned>((fraction << 32) / 1'000'000'000));
  message.Pack();
  const auto* bytes = static_cast<const std::uint8_t*>(message.GetPackPointer());
  return std::make_shared<const std::vector<std::uint8_t>>(bytes, bytes + message.GetPackSize());
}

void fill(igtl::Matrix4x4& m, const Eigen::Matrix3d& linear, const Eigen::Vector3d& translation) {
  for (int r = 0; r < 3; ++r) {
    for (int c = 0; c < 3; ++c) m[r][c] = static_cast<float>(linear(r, c));
    m[r][3] = static_cast<float>(translation(r));
    m[3][r] = 0;
  }
  m[3][3] = 1;
}

// All but the pixels and the name.
igtl::ImageMessage::Pointer placed_image(int width, int height, int channels,
                                         const Affine<frame::World, frame::Image>& world_from_image) {
  const auto message = igtl::ImageMessage::New();
  const Eigen::Matrix3d& linear = world_from_image.linear;
  const double x_mm = linear.col(0).norm();
  const double y_mm = linear.col(1).norm();
  Eigen::Matrix3d unit;
  unit << linear.col(0) / x_mm, linear.col(1) / y_mm, linear.col(0).cross(linear.col(1)).normalized();
  const Eigen::Vector3d middle =
      world_from_image.translation + linear.col(0) * (width - 1) / 2 + linear.col(1) * (height - 1) / 2;
  message->SetDimensions(width, height, 1);
  message->SetSpacing(static_cast<float>(x_mm), static_cast<float>(y_mm), static_cast<float>(x_mm));
  message->SetScalarTypeToUint8();
  message->SetNumComponents(channels);
  message->SetCoordinateSystem(igtl::ImageMessage::COORDINATE_RAS);
  igtl::Matrix4x4 m;
  fill(m, unit, middle);
  message->SetMatrix(m);
  message->AllocateScalars();
  return message;
}

}  // namespace

IgtlBytes igtl_image(const std::string& name, std::int64_t utc_ns, ConstPixels pixels,
                     const Affine<frame::World, frame::Image>& world_from_image) {
  const auto message = placed_image(pixels.width, pixels.height, 1, world_from_image);
  auto* to = static_cast<std::uint8_t*>(message->GetScalarPointer());
  for (int y = 0; y < pixels.height; ++y, to += pixels.width) std::memcpy(to, pixels.row(y), pixels.width);
  return packed(*message, name, utc_ns);
}

IgtlBytes igtl_image(const std::string& name, std::int64_t utc_ns, const PngPicture& picture,
                     const Affine<frame::World, frame::Image>& world_from_image) {
  const auto message = placed_image(picture.width, picture.height, picture.channels, world_from_image);
  std::memcpy(message->GetScalarPointer(), picture.bytes.data(), picture.bytes.size());
  return packed(*message, name, utc_ns);
}

IgtlBytes igtl_transform(const std::string& name, std::int64_t utc_ns, const Eigen::Matrix3d& linear,
                         const Eigen::Vector3d& translation) {
  const auto message = igtl::TransformMessage::New();
  igtl::Matrix4x4 m;
  fill(m, linear, translation);
  message->SetMatrix(m);
  return packed(*message, name, utc_ns);
}

IgtlBytes igtl_tracking(
    const std::string& name, std::int64_t utc_ns,
    const std::vector<std::pair<std::string, Rigid<frame::Tracker, frame::Probe>>>& tools) {
  const auto message = igtl::TrackingDataMessage::New();
  for (const auto& [tool, pose] : tools) {
    const auto element = igtl::TrackingDataElement::New();
    element->SetName(tool.substr(0, longest_name).c_str());
    element->SetType(igtl::TrackingDataElement::TYPE_6D);
    igtl::Matrix4x4 m;
    fill(m, pose.rotation, pose.translation);
    element->SetMatrix(m);
    igtl::TrackingDataElement::Pointer pointer = element;
    message->AddTrackingDataElement(pointer);
  }
  return packed(*message, name, utc_ns);
}

IgtlBytes igtl_status(const std::string& name, std::int64_t utc_ns, bool good, const std::string& sentence) {
  const auto message = igtl::StatusMessage::New();
  message->SetCode(good ? igtl::StatusMessage::STATUS_OK : igtl::StatusMessage::STATUS_NOT_READY);
  message->SetSubCode(0);
  message->SetErrorName(good ? "" : "NotReady");
  message->SetStatusString(sentence.c_str());
  return packed(*message, name, utc_ns);
}

std::vector<IgtlRequest> IgtlRequests::feed(std::span<const std::uint8_t> bytes, bool& good) {
  std::vector<IgtlRequest> requests;
  good = true;
  const auto skip = static_cast<std::size_t>(std::min<std::uint64_t>(skip_, bytes.size()));
  skip_ -= skip;
  bytes = bytes.subspan(skip);
  waiting_.insert(waiting_.end(), bytes.begin(), bytes.end());
  while (waiting_.size() >= head_bytes) {
    const std::uint8_t* head = waiting_.data();
    const std::uint64_t version = big(head, 2);
    const std::uint64_t size = big(head + size_at, 8);
    const std::string field(reinterpret_cast<const char*>(head + type_at), type_bytes);
    const std::string type = field.substr(0, field.find('\0'));
    const bool known = type == "STT_TDATA" || type == "STP_TDATA" || type == "GET_STATUS";
    if (version < 1 || version > 3 || type.empty() || size > (known ? largest_request : largest_skipped)) {
      good = false;
      return requests;
    }
    if (!known) {
      const std::uint64_t here = std::min<std::uint64_t>(size, waiting_.size() - head_bytes);
      waiting_.erase(waiting_.begin(), waiting_.begin() + static_cast<std::ptrdiff_t>(head_bytes + here));
      skip_ = size - here;
      requests.push_back({});
      if (skip_ > 0) break;
      continue;
    }
    if (waiting_.size() < head_bytes + size) break;
    std::uint8_t* body = waiting_.data() + head_bytes;
    if (crc64(body, size, 0) != big(head + crc_at, 8)) {
      good = false;
      return requests;
    }
    IgtlRequest request;
    if (type == "STT_TDATA") {
      request.kind = IgtlRequest::Kind::start_tracking;
      // From version 2 on an extended head of its own stated size comes first.
      std::uint64_t at = 0;
      if (version >= 2 && size >= 2) at = big(body, 2);
      if (at + 4 <= size) {
        const auto ms = static_cast<std::int32_t>(big(body + at, 4));
        request.interval = std::chrono::milliseconds(std::max(ms, 0));
      }
    } else {
      request.kind = type == "STP_TDATA" ? IgtlRequest::Kind::stop_tracking : IgtlRequest::Kind::get_status;
    }
    requests.push_back(request);
    waiting_.erase(waiting_.begin(), waiting_.begin() + static_cast<std::ptrdiff_t>(head_bytes + size));
  }
  return requests;
}

}  // namespace sonoband::exchange
