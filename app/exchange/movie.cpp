#include "app/exchange/movie.h"

#include <fmt/format.h>
#include <vpx/vp8cx.h>
#include <vpx/vpx_encoder.h>

#include <algorithm>
#include <cmath>

#include "app/bad_input.h"
#include "app/exchange/file_beside.h"
#include "app/exchange/webm.h"

namespace sonoband::exchange {
namespace {

constexpr int max_side_px = 16'384;
// A key picture at least this often: how far a jump within the movie must decode.
constexpr unsigned key_every = 60;
// 0 (best) to 9: of libvpx; 4 encodes 640 x 480 at some 40 pictures a second of one desktop core.
constexpr int haste = 4;

// BT.709, limited range, times 2^16. Source: ITU-R BT.709-6, 3.
std::uint8_t luma(int r, int g, int b) {
  // 0.2126, 0.7152 and 0.0722 of 219 / 255; together 56284, so that white is 235.
  constexpr int kr = 11966, kg = 40254, kb = 4064;
  return static_cast<std::uint8_t>(16 + (kr * r + kg * g + kb * b + 32768) / 65536);
}

std::uint8_t chroma(double difference, double divisor) {
  return static_cast<std::uint8_t>(std::clamp(128 + 224.0 / 255 * difference / divisor + 0.5, 16.0, 240.99));
}

void fill_grey(const PngPicture& p, vpx_image_t& image) {
  for (int y = 0; y < p.height; ++y) {
    const std::uint8_t* from = p.bytes.data() + static_cast<std::size_t>(y) * p.width;
    std::uint8_t* to = image.planes[VPX_PLANE_Y] + std::ptrdiff_t{y} * image.stride[VPX_PLANE_Y];
    for (int x = 0; x < p.width; ++x) to[x] = luma(from[x], from[x], from[x]);
  }
  for (const int plane : {VPX_PLANE_U, VPX_PLANE_V})
    for (int y = 0; y < (p.height + 1) / 2; ++y)
      std::fill_n(image.planes[plane] + std::ptrdiff_t{y} * image.stride[plane], (p.width + 1) / 2, 128);
}

// Colours are the mean of the up to four pixels they stand for.
void fill_colour(const PngPicture& p, vpx_image_t& image) {
  const auto at = [&](int x, int y) {
    return p.bytes.data() + (static_cast<std::size_t>(y) * p.width + x) * 3;
  };
  for (int y = 0; y < p.height; ++y)
    for (int x = 0; x < p.width; ++x) {
      const std::uint8_t* c = at(x, y);
      image.planes[VPX_PLANE_Y][std::ptrdiff_t{y} * image.stride[VPX_PLANE_Y] + x] = luma(c[0], c[1], c[2]);
    }
  for (int y = 0; y < p.height; y += 2)
    for (int x = 0; x < p.width; x += 2) {
      double r = 0;
      double g = 0;
      double b = 0;
      const int right = std::min(x + 1, p.width - 1);
      const int below = std::min(y + 1, p.height - 1);
      for (const std::uint8_t* c : {at(x, y), at(right, y), at(x, below), at(right, below)}) {
        r += c[0];
        g += c[1];
        b += c[2];
      }
      const double brightness = (0.2126 * r + 0.7152 * g + 0.0722 * b) / 4;
      const auto put = [&](int plane, std::uint8_t value) {
        image.planes[plane][std::ptrdiff_t{y / 2} * image.stride[plane] + x / 2] = value;
      };
      put(VPX_PLANE_U, chroma(b / 4 - brightness, 1.8556));
      put(VPX_PLANE_V, chroma(r / 4 - brightness, 1.5748));
    }
}

}  // namespace

struct MovieWriter::State {
  explicit State(const std::filesystem::path& p) : path(p), file(p) {}
  ~State() {
    if (encoding) vpx_codec_destroy(&codec);
    if (image != nullptr) vpx_img_free(image);
  }

  // False: nothing came out. A null picture asks for what the encoder, which looks ahead, still has.
  bool encode(const vpx_image_t* picture, std::int64_t time_ms);
  [[noreturn]] void refuse(const char* what) {
    const char* detail = vpx_codec_error_detail(&codec);
    throw BadInput(fmt::format("{}: the movie cannot be encoded: {} ({}); choose another size", path.string(),
                               what, detail != nullptr ? detail : vpx_codec_error(&codec)));
  }

  std::filesystem::path path;
  FileBeside file;
  std::unique_ptr<WebmWriter> webm;
  MovieSettings settings;
  vpx_codec_ctx_t codec{};
  bool encoding = false;
  vpx_image_t* image = nullptr;
  std::int64_t last_ms = -1;
};

bool MovieWriter::State::encode(const vpx_image_t* picture, std::int64_t time_ms) {
  if (vpx_codec_encode(&codec, picture, time_ms, 1, 0, VPX_DL_GOOD_QUALITY) != VPX_CODEC_OK)
    refuse("a picture");
  bool any = false;
  vpx_codec_iter_t iterator = nullptr;
  while (const vpx_codec_cx_pkt_t* packet = vpx_codec_get_cx_data(&codec, &iterator)) {
    if (packet->kind != VPX_CODEC_CX_FRAME_PKT) continue;
    any = true;
    const auto& frame = packet->data.frame;
    webm->add({static_cast<const std::uint8_t*>(frame.buf), frame.sz}, frame.pts,
              (frame.flags & VPX_FRAME_IS_KEY) != 0);
  }
  return any;
}

MovieWriter::MovieWriter(const std::filesystem::path& path, const MovieSettings& settings) {
  if (settings.width < 1 || settings.height < 1 || settings.width > max_side_px ||
      settings.height > max_side_px)
    throw BadInput(fmt::format("{}: a movie of {} x {} pixels is not to be had; choose sides of 1 to {}",
                               path.string(), settings.width, settings.height, max_side_px));
  state_ = std::make_unique<State>(path);
  State& s = *state_;
  s.settings = settings;

  vpx_codec_enc_cfg_t config;
  vpx_codec_enc_config_default(vpx_codec_vp9_cx(), &config, 0);
  config.g_w = static_cast<unsigned>(settings.width);
  config.g_h = static_cast<unsigned>(settings.height);
  config.g_timebase = {1, 1000};
  config.g_threads = static_cast<unsigned>(std::clamp(settings.threads, 1, 16));
  config.rc_end_usage = VPX_Q;
  config.kf_max_dist = key_every;
  if (vpx_codec_enc_init(&s.codec, vpx_codec_vp9_cx(), &config, 0) != VPX_CODEC_OK) s.refuse("its size");
  s.encoding = true;
  vpx_codec_control(&s.codec, VP8E_SET_CPUUSED, haste);
  vpx_codec_control(&s.codec, VP8E_SET_CQ_LEVEL,
                    static_cast<unsigned>(std::clamp(settings.quantiser, 0, 63)));
  vpx_codec_control(&s.codec, VP9E_SET_ROW_MT, 1U);
  vpx_codec_control(&s.codec, VP9E_SET_COLOR_SPACE, static_cast<int>(VPX_CS_BT_709));
  vpx_codec_control(&s.codec, VP9E_SET_COLOR_RANGE, static_cast<int>(VPX_CR_STUDIO_RANGE));
  s.image = vpx_img_alloc(nullptr, VPX_IMG_FMT_I420, config.g_w, config.g_h, 16);
  if (s.image == nullptr)
    throw BadInput(path.string() + ": no memory for a movie of this size; choose a smaller one");
  s.image->cs = VPX_CS_BT_709;
  s.image->range = VPX_CR_STUDIO_RANGE;

  WebmTrack track;
  track.width = track.shown_width = settings.width;
  track.height = track.shown_height = settings.height;
  track.duration_ms = std::llround(settings.duration_s * 1000);
  track.tags = settings.tags;
  if (settings.x_mm > 0 && settings.y_mm > 0) {
    // The finer direction keeps its pixels.
    const double fine = std::min(settings.x_mm, settings.y_mm);
    track.shown_width = static_cast<int>(std::lround(settings.width * settings.x_mm / fine));
    track.shown_height = static_cast<int>(std::lround(settings.height * settings.y_mm / fine));
    track.tags.emplace_back("PIXEL_SIZE_MM", fmt::format("{:.6g} x {:.6g}", settings.x_mm, settings.y_mm));
  }
  track.tags.emplace_back("DISCLAIMER", "Research use only.");
  s.webm = std::make_unique<WebmWriter>(s.file.stream(), track);
}

MovieWriter::~MovieWriter() = default;

void MovieWriter::add(const PngPicture& picture, double time_s) {
  State& s = *state_;
  if (picture.width != s.settings.width || picture.height != s.settings.height)
    throw BadInput(fmt::format("{}: a picture of {} x {} does not fit a movie of {} x {}", s.path.string(),
                               picture.width, picture.height, s.settings.width, s.settings.height));
  if (picture.channels == 3)
    fill_colour(picture, *s.image);
  else
    fill_grey(picture, *s.image);
  s.last_ms = std::max<std::int64_t>(std::llround(time_s * 1000), s.last_ms + 1);
  s.encode(s.image, s.last_ms);
}

void MovieWriter::finish() {
  State& s = *state_;
  while (s.encode(nullptr, 0)) {
  }
  s.webm->finish();
  s.file.commit();
}

}  // namespace sonoband::exchange
