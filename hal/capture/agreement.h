// Which of the formats that a video device offers is taken.
#pragma once

#include "hal/capture/video_device.h"

namespace sonoband {

struct VideoWish {
  int width = 0;  // of the whole captured picture; another size is refused, since it changes the scale
  int height = 0;
  double rate_hz = 0;
  bool colour = false;  // in a format that FlowKeys takes colour from
};

struct Agreement {
  VideoStatus status = VideoStatus::not_video;
  VideoMode mode;     // of the device now; otherwise its last answer, whose size says what is wrong
  bool slow = false;  // taken, for want of a better one, though it gives fewer pictures than wished
};

// Of an open device. The best format first: what costs least and spoils nothing; but one of fewer pictures
// than nine tenths of the wish only if no other gives more. That is what a grabber does that is plugged into
// a port too slow for it: 5 whole pictures a second, or 60 compressed ones.
Agreement agree(VideoDevice& device, const VideoWish& wish);

}  // namespace sonoband
