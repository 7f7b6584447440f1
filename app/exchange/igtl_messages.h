// OpenIGTLink messages as bytes: what we send, and what a client may ask. The library packs; nothing here
// touches a socket.
//
// Protocol version 1 bodies, which every client reads. Source: openigtlink.org, protocol v3.1.
#pragma once

#include <array>
#include <cstdint>
#include <memory>
#include <span>
#include <string>
#include <vector>

#include "app/exchange/png.h"
#include "core/geometry/transforms.h"
#include "core/image/image.h"
#include "core/time.h"

namespace sonoband::exchange {

using IgtlBytes = std::shared_ptr<const std::vector<std::uint8_t>>;

// Device names are cut at 20 characters. `utc_ns` is since 1970.

// IMAGE: one byte a pixel, and where it lies. The protocol's origin is the picture's middle; columns that are
// not at right angles go along as they are.
IgtlBytes igtl_image(const std::string& name, std::int64_t utc_ns, ConstPixels pixels,
                     const Affine<frame::World, frame::Image>& world_from_image);
// The same of a picture as people see it; colours as three bytes a pixel.
IgtlBytes igtl_image(const std::string& name, std::int64_t utc_ns, const PngPicture& picture,
                     const Affine<frame::World, frame::Image>& world_from_image);
IgtlBytes igtl_transform(const std::string& name, std::int64_t utc_ns, const Eigen::Matrix3d& linear,
                         const Eigen::Vector3d& translation);
// One instrument of type 6D; an unusable pose is left out, as the protocol has no word for it.
IgtlBytes igtl_tracking(
    const std::string& name, std::int64_t utc_ns,
    const std::vector<std::pair<std::string, Rigid<frame::Tracker, frame::Probe>>>& tools);
// `good`: STATUS_OK, else STATUS_NOT_READY.
IgtlBytes igtl_status(const std::string& name, std::int64_t utc_ns, bool good, const std::string& sentence);

struct IgtlRequest {
  enum class Kind : std::uint8_t {
    start_tracking,  // STT_TDATA
    stop_tracking,   // STP_TDATA
    get_status,      // GET_STATUS
    other,           // anything else, skipped
  } kind = Kind::other;
  Duration interval{};  // of start_tracking; 0: every reading
};

// Takes what a client sends, in pieces of any size. Memory is bounded by the largest body that is taken.
class IgtlRequests {
 public:
  // The requests that are whole now. False in `good`: these are no messages, or larger than any request; the
  // connection is to be closed.
  std::vector<IgtlRequest> feed(std::span<const std::uint8_t> bytes, bool& good);

 private:
  std::vector<std::uint8_t> waiting_;
  std::uint64_t skip_ = 0;  // bytes of a body that nobody reads
};

}  // namespace sonoband::exchange
