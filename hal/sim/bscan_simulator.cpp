#include "hal/sim/bscan_simulator.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <cstring>
#include <numbers>

#include "hal/sim/random.h"
#include "hal/sim/screen.h"

namespace sonoband::sim {

using Eigen::Vector3d;
using Eigen::Vector3f;

namespace {

// The beam's elevation: three slices, 1.2 sigma apart, as a Gaussian weighs them.
struct Slice {
  float offset_sigmas;
  float weight;
};
constexpr std::array<Slice, 3> slices{{{0, 0.5066F}, {-1.2F, 0.2467F}, {1.2F, 0.2467F}}};

// Across the beams: a Gaussian of 0.9 beams, its power 1 for echoes that do not correlate.
constexpr std::array<float, 3> lateral{0.0656F, 0.4173F, 0.7736F};  // two beams off, one off, itself

// Amplitude that is lost in the receiver's noise: -62 dB.
constexpr float clear = 8e-4F;

constexpr int power_shift = 17;  // leaves 8 bits of exponent and 6 of mantissa: 0.07 dB

float decibels(double db) {
  return static_cast<float>(std::pow(10.0, db / 20));
}

std::vector<std::uint8_t> grey_table(double dynamic_range_db) {
  std::vector<std::uint8_t> table(std::size_t{1} << (32 - power_shift - 1));
  for (std::size_t i = 0; i < table.size(); ++i) {
    const auto power = std::bit_cast<float>(static_cast<std::uint32_t>(i << power_shift));
    if (!(power > 0)) continue;
    const double grey = 255 * (1 + 10 * std::log10(static_cast<double>(power)) / dynamic_range_db);
    table[i] = static_cast<std::uint8_t>(std::lround(std::clamp(grey, 0.0, 255.0)));
  }
  return table;
}

}  // namespace

BscanSimulator::BscanSimulator(std::shared_ptr<const Phantom> phantom,
                               const WorldFromPhantom& world_from_phantom, const ScannerSettings& settings,
                               std::uint64_t seed)
    : phantom_(std::move(phantom)),
      phantom_from_world_(world_from_phantom.inverse()),
      settings_(settings),
      seed_(seed),
      speckle_(seed),
      lines_(make_scan_lines(settings)),
      grey_of_(grey_table(settings.dynamic_range_db)) {
  const auto* body = std::get_if<Anatomy>(phantom_.get());
  if (body == nullptr) return;
  for (const Shape& s : body->shapes()) {
    const Material& m = s.material;
    responses_.push_back({decibels(m.echo_db), decibels(-m.loss_db_mm * lines_.sample_mm), m.specular, m.bone,
                          m.specular == 0 && !m.bone, s.flow.peak_mm_s != 0});
  }
  for (int i = 0; i < lines_.samples; ++i) {
    depth_gain_.push_back(decibels(-settings.depth_loss_db_mm * lines_.sample_mm * i));
  }
  const std::size_t echoes = static_cast<std::size_t>(lines_.samples) * lines_.beams;
  re_.resize(echoes);
  im_.resize(echoes);
  grey_.resize(echoes);
  level_.resize(echoes);
  noise_.resize(16384);
  const double deviation = settings.noise_db > -200 ? decibels(settings.noise_db) * std::sqrt(0.5) : 0;
  for (std::size_t i = 0; i < noise_.size(); ++i) {
    noise_[i] = static_cast<float>(gaussian(hash(seed, 2), i) * deviation);
  }
}

void BscanSimulator::paint(const WorldFromImage& world_from_image, Stamp t, std::uint8_t* out,
                           std::ptrdiff_t stride_bytes) {
  const auto phantom_from_image = phantom_from_world_ * world_from_image;
  if (const auto* field = std::get_if<GreyField>(phantom_.get())) {
    copy_field(*field, phantom_from_image, out, stride_bytes);
    return;
  }
  const int pixel_bytes = settings_.format == PixelFormat::rgb24 ? 3 : 1;
  for (int y = 0; y < settings_.height_px; ++y) {
    std::memset(out + y * stride_bytes, 0, static_cast<std::size_t>(settings_.width_px) * pixel_bytes);
  }
  gather_echoes(std::get<Anatomy>(*phantom_), phantom_from_image, t);
  compress();
  convert(out, stride_bytes);
  draw_screen(settings_, bar_, out, stride_bytes);
}

void BscanSimulator::gather_echoes(const Anatomy& body,
                                   const Affine<frame::Phantom, frame::Image>& phantom_from_image, Stamp t) {
  const Vector3d right = phantom_from_image.linear.col(0);
  const Vector3d down = phantom_from_image.linear.col(1);
  const Vector3f elevation = right.cross(down).normalized().cast<float>();
  const double phase = std::cos(2 * std::numbers::pi * settings_.heart_hz * seconds(t));
  const auto beat = static_cast<float>(std::max(0.0, phase) * std::max(0.0, phase));

  std::vector<float> width(static_cast<std::size_t>(lines_.samples));
  for (int i = 0; i < lines_.samples; ++i) {
    const double off_focus = std::abs(i * lines_.sample_mm - settings_.focus_mm) / settings_.focus_mm;
    width[static_cast<std::size_t>(i)] = static_cast<float>(settings_.elevation_sigma_mm * (1 + off_focus));
  }

  const auto grain = static_cast<float>(SpeckleField::sigma_mm / settings_.speckle_mm);
  for (int beam = 0; beam < lines_.beams; ++beam) {
    const ScanLine& line = lines_.lines[static_cast<std::size_t>(beam)];
    const Vector3f start =
        (phantom_from_image.translation + line.start.x() * right + line.start.y() * down).cast<float>();
    const Vector3f step = (line.step.x() * right + line.step.y() * down).cast<float>();
    const Vector3f along = step.normalized();
    float through = 1;  // what is left of the pulse, there and back
    float patch = 1;
    for (int i = 0; i < lines_.samples; ++i) {
      const auto s = static_cast<std::size_t>(i);
      const Vector3f middle = start + static_cast<float>(i) * step;
      // Tissue is uneven on the scale of millimetres.
      if (i % 4 == 0) patch = 1 + 0.3F * speckle_.at(middle * 0.09F).re;
      const std::size_t at = s * static_cast<std::size_t>(lines_.beams) + static_cast<std::size_t>(beam);
      const float level = through * depth_gain_[s] * patch;
      re_[at] = im_[at] = 0;
      level_[at] = 0;

      // Far from any surface the slices see the same tissue, and clear fluid has nothing to see.
      const Anatomy::ShapeId* calm = width[s] * 1.2F < body.cell_mm() ? body.calm_at(middle) : nullptr;
      if (calm != nullptr && responses_[*calm].diffuse) {
        const Response& r = responses_[*calm];
        through *= r.gain_per_sample;
        if (r.amplitude < clear) continue;
        for (const Slice& slice : slices) {
          const Echo e = speckle_.at((middle + slice.offset_sigmas * width[s] * elevation) * grain);
          re_[at] += slice.weight * e.re;
          im_[at] += slice.weight * e.im;
        }
        re_[at] *= level * r.amplitude;
        im_[at] *= level * r.amplitude;
        if (r.flows) level_[at] = colour_level(body.shape(*calm).velocity(middle, beat));
        continue;
      }

      float gain = 0;
      for (const Slice& slice : slices) {
        const Vector3f p = middle + slice.offset_sigmas * width[s] * elevation;
        const Anatomy::ShapeId id = body.at(p);
        const Response& r = responses_[id];
        const Echo e = speckle_.at(p * grain);
        float amplitude = slice.weight * level * r.amplitude;
        gain += slice.weight * r.gain_per_sample;
        if (r.specular > 0) {
          const float square_on = std::abs(body.shape(id).normal(p).dot(along));
          amplitude *= 1 - r.specular + r.specular * square_on;
        }
        // A bone's surface is one big reflector: most of its echo is in step, little is speckle.
        re_[at] += amplitude * (r.bone ? 0.8F + 0.3F * e.re : e.re);
        im_[at] += amplitude * (r.bone ? 0.3F * e.im : e.im);
        if (r.flows && slice.offset_sigmas == 0) {
          level_[at] = colour_level(body.shape(id).velocity(p, beat));
        }
      }
      through *= gain;
    }
  }

  // Receiver noise, another stretch of it in every frame.
  const std::uint64_t offset = hash(seed_ + 3, static_cast<std::uint64_t>(t.time_since_epoch().count()));
  for (std::size_t row = 0; row < static_cast<std::size_t>(lines_.samples); ++row) {
    const std::uint64_t h = hash(offset, row);
    const std::size_t room = noise_.size() - static_cast<std::size_t>(lines_.beams);
    const float* noise_re = noise_.data() + h % room;
    const float* noise_im = noise_.data() + (h >> 32) % room;
    const std::size_t at = row * static_cast<std::size_t>(lines_.beams);
    for (std::size_t b = 0; b < static_cast<std::size_t>(lines_.beams); ++b) {
      re_[at + b] += noise_re[b];
      im_[at + b] += noise_im[b];
    }
  }
}

std::int8_t BscanSimulator::colour_level(float velocity_mm_s) const {
  if (!settings_.colour || std::abs(velocity_mm_s) < settings_.colour->wall_filter_mm_s) return 0;
  const double level = std::round(std::abs(velocity_mm_s) / settings_.colour->full_scale_mm_s * 63);
  const int shown = std::clamp(static_cast<int>(level), 1, 63);
  return static_cast<std::int8_t>(velocity_mm_s > 0 ? shown : -shown);
}

void BscanSimulator::compress() {
  const auto beams = static_cast<std::size_t>(lines_.beams);
  // Powers of three neighbouring samples are averaged, as scanners do over frequencies, or the zeros of the
  // interference show as black worms.
  std::array<std::vector<float>, 3> power;
  for (auto& row : power) row.assign(beams, 0);
  const auto envelope = [&](std::size_t row, std::vector<float>& out) {
    const float* re = re_.data() + row * beams;
    const float* im = im_.data() + row * beams;
    // Two beams at each edge keep their own echo.
    for (std::size_t b = 0; b < beams; ++b) out[b] = re[b] * re[b] + im[b] * im[b];
    for (std::size_t b = 2; b + 2 < beams; ++b) {
      const float r =
          lateral[0] * (re[b - 2] + re[b + 2]) + lateral[1] * (re[b - 1] + re[b + 1]) + lateral[2] * re[b];
      const float i =
          lateral[0] * (im[b - 2] + im[b + 2]) + lateral[1] * (im[b - 1] + im[b + 1]) + lateral[2] * im[b];
      out[b] = r * r + i * i;
    }
  };
  const auto rows = static_cast<std::size_t>(lines_.samples);
  envelope(0, power[1]);
  for (std::size_t row = 0; row < rows; ++row) {
    if (row + 1 < rows) envelope(row + 1, power[2]);
    for (std::size_t b = 0; b < beams; ++b) {
      const float mean = 0.25F * (power[0][b] + power[2][b]) + 0.5F * power[1][b];
      grey_[row * beams + b] = grey_of_[std::bit_cast<std::uint32_t>(mean) >> power_shift];
    }
    std::swap(power[0], power[1]);
    std::swap(power[1], power[2]);
  }
}

void BscanSimulator::convert(std::uint8_t* out, std::ptrdiff_t stride_bytes) const {
  const bool rgb = settings_.format == PixelFormat::rgb24;
  const ColourBox box = settings_.colour.value_or(ColourBox{});
  for (const ScanLines::Run& run : lines_.runs) {
    std::uint8_t* row = out + run.y * stride_bytes;
    const ScanLines::Tap* tap = lines_.taps.data() + run.first_tap;
    const bool colour_row = rgb && run.y >= box.y && run.y < box.y + box.height;
    for (int x = run.x_begin; x < run.x_end; ++x, ++tap) {
      const std::uint8_t* g = grey_.data() + tap->echo;
      const unsigned near = g[0] * (256U - tap->beam_256) + g[1] * tap->beam_256;
      const std::uint8_t* below = g + lines_.beams;
      const unsigned far = below[0] * (256U - tap->beam_256) + below[1] * tap->beam_256;
      const auto grey = static_cast<std::uint8_t>(
          (near * (256U - tap->sample_256) + far * tap->sample_256 + (1U << 15)) >> 16);
      if (!rgb) {
        row[x] = grey;
        continue;
      }
      std::uint8_t* pixel = row + 3 * x;
      pixel[0] = pixel[1] = pixel[2] = grey;
      if (!colour_row || x < box.x || x >= box.x + box.width) continue;
      const std::size_t nearest = tap->echo + (tap->beam_256 >= 128 ? 1 : 0) +
                                  (tap->sample_256 >= 128 ? static_cast<std::size_t>(lines_.beams) : 0);
      if (level_[nearest] == 0) continue;
      const doppler::Rgb c = flow_colour(bar_, level_[nearest]);
      pixel[0] = c.r;
      pixel[1] = c.g;
      pixel[2] = c.b;
    }
  }
}

void BscanSimulator::copy_field(const GreyField& field,
                                const Affine<frame::Phantom, frame::Image>& phantom_from_image,
                                std::uint8_t* out, std::ptrdiff_t stride_bytes) const {
  const int pixel_bytes = settings_.format == PixelFormat::rgb24 ? 3 : 1;
  for (int y = 0; y < settings_.height_px; ++y) {
    std::uint8_t* row = out + y * stride_bytes;
    for (int x = 0; x < settings_.width_px; ++x) {
      const Vector3d p = (phantom_from_image * Point<frame::Image>{Vector3d(x, y, 0)}).v;
      const auto grey = static_cast<std::uint8_t>(std::clamp(std::floor(field.grey(p) + 0.5), 0.0, 255.0));
      for (int c = 0; c < pixel_bytes; ++c) row[x * pixel_bytes + c] = grey;
    }
  }
}

}  // namespace sonoband::sim
