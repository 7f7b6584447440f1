// Pixels: a borrowed view with a stride, and storage that owns them.
#pragma once

#include <algorithm>
#include <cassert>
#include <cstddef>
#include <cstdint>
#include <memory>
#include <type_traits>

namespace sonoband {

// What one byte of a B-scan or of a result means.
enum class PixelKind : std::uint8_t {
  grey,     // 0 black to 255 white
  doppler,  // ordered key of core/image/doppler.h: grey 0..127, then 128 + 2*level + red
};

// Borrowed rows. The stride is in elements and may exceed the width; rows never overlap.
template <class T>
struct ImageView {
  T* data = nullptr;
  int width = 0;
  int height = 0;
  std::ptrdiff_t stride = 0;

  T* row(int y) const {
    assert(y >= 0 && y < height);
    return data + y * stride;
  }
  T& operator()(int x, int y) const {
    assert(x >= 0 && x < width);
    return row(y)[x];
  }
  bool empty() const { return data == nullptr || width <= 0 || height <= 0; }
  operator ImageView<const T>() const requires(!std::is_const_v<T>) { return {data, width, height, stride}; }
};

using ConstPixels = ImageView<const std::uint8_t>;

// Storage for one picture, rows packed, zero at first unless asked for `unset`. Copying a picture is asked
// for by name.
template <class T>
class ImageBuffer {
 public:
  ImageBuffer() = default;
  ImageBuffer(int width, int height)
      : width_(width),
        height_(height),
        pixels_(std::make_unique<T[]>(static_cast<std::size_t>(width) * height)) {}
  // For one who writes all pixels: a megabyte of zeros takes a thread 60 us.
  static ImageBuffer unset(int width, int height) {
    ImageBuffer image;
    image.width_ = width;
    image.height_ = height;
    image.pixels_ = std::make_unique_for_overwrite<T[]>(static_cast<std::size_t>(width) * height);
    return image;
  }
  ImageBuffer(ImageBuffer&&) noexcept = default;
  ImageBuffer& operator=(ImageBuffer&&) noexcept = default;
  ImageBuffer(const ImageBuffer&) = delete;
  ImageBuffer& operator=(const ImageBuffer&) = delete;

  ImageBuffer copy() const {
    ImageBuffer twin = unset(width_, height_);
    std::copy_n(pixels_.get(), static_cast<std::size_t>(width_) * height_, twin.pixels_.get());
    return twin;
  }

  ImageView<T> view() { return {pixels_.get(), width_, height_, width_}; }
  ImageView<const T> view() const { return {pixels_.get(), width_, height_, width_}; }
  int width() const { return width_; }
  int height() const { return height_; }

 private:
  int width_ = 0;
  int height_ = 0;
  std::unique_ptr<T[]> pixels_;
};

using Pixels = ImageBuffer<std::uint8_t>;

}  // namespace sonoband
