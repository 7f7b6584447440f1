#include "app/exchange/png.h"

#include <fmt/format.h>
#include <png.h>

#include <algorithm>
#include <cmath>
#include <csetjmp>
#include <cstring>
#include <fstream>

#include "app/bad_input.h"
#include "app/exchange/file_beside.h"

namespace sonoband::exchange {

namespace {

constexpr int max_side_px = 65'535;

struct PngTrouble {
  std::string message;
};

// libpng wants its error handler not to return: it jumps back to guarded(), past C frames only.
[[noreturn]] void on_error(png_structp png, png_const_charp message) {
  static_cast<PngTrouble*>(png_get_error_ptr(png))->message = message;
  png_longjmp(png, 1);
}

// False when libpng called on_error. `body` must leave no destructor to be jumped over.
template <class Body>
bool guarded(png_structp png, Body&& body) {
  if (setjmp(png_jmpbuf(png)) != 0) return false;
  body();
  return true;
}

void on_warning(png_structp, png_const_charp) {}

void on_write(png_structp png, png_bytep bytes, png_size_t size) {
  static_cast<std::ostream*>(png_get_io_ptr(png))
      ->write(reinterpret_cast<const char*>(bytes), static_cast<std::streamsize>(size));
}

void on_flush(png_structp) {}

void on_read(png_structp png, png_bytep bytes, png_size_t size) {
  auto* in = static_cast<std::istream*>(png_get_io_ptr(png));
  in->read(reinterpret_cast<char*>(bytes), static_cast<std::streamsize>(size));
  if (static_cast<png_size_t>(in->gcount()) != size) png_error(png, "the file ends too early");
}

struct Writer {
  explicit Writer(PngTrouble& trouble)
      : png(png_create_write_struct(PNG_LIBPNG_VER_STRING, &trouble, on_error, on_warning)),
        info(png_create_info_struct(png)) {}
  ~Writer() { png_destroy_write_struct(&png, &info); }
  Writer(const Writer&) = delete;
  Writer& operator=(const Writer&) = delete;
  png_structp png;
  png_infop info;
};

struct Reader {
  explicit Reader(PngTrouble& trouble)
      : png(png_create_read_struct(PNG_LIBPNG_VER_STRING, &trouble, on_error, on_warning)),
        info(png_create_info_struct(png)) {}
  ~Reader() { png_destroy_read_struct(&png, &info, nullptr); }
  Reader(const Reader&) = delete;
  Reader& operator=(const Reader&) = delete;
  png_structp png;
  png_infop info;
};

}  // namespace

PngPicture grey_png(ConstPixels pixels) {
  PngPicture picture{.width = pixels.width, .height = pixels.height, .bytes = {}, .texts = {}};
  picture.bytes.reserve(static_cast<std::size_t>(pixels.width) * pixels.height);
  for (int y = 0; y < pixels.height; ++y)
    picture.bytes.insert(picture.bytes.end(), pixels.row(y), pixels.row(y) + pixels.width);
  return picture;
}

PngPicture picture_png(ConstPixels pixels, PixelKind kind, const doppler::ColourBar& bar) {
  if (kind == PixelKind::grey) return grey_png(pixels);
  PngPicture picture{.width = pixels.width, .height = pixels.height, .channels = 3, .bytes = {}, .texts = {}};
  picture.bytes.reserve(static_cast<std::size_t>(picture.width) * picture.height * 3);
  for (int y = 0; y < picture.height; ++y)
    for (int x = 0; x < picture.width; ++x) {
      const doppler::Rgb c = doppler::to_rgb(pixels(x, y), bar);
      picture.bytes.insert(picture.bytes.end(), {c.r, c.g, c.b});
    }
  return picture;
}

PngPicture band_png(const BandImage& image, const doppler::ColourBar& bar) {
  return picture_png(image.pixels.view(), image.kind, bar);
}

PngPicture coverage_png(const BandImage& image, int layers) {
  PngPicture picture{
      .width = image.coverage.width(), .height = image.coverage.height(), .bytes = {}, .texts = {}};
  picture.bytes.reserve(static_cast<std::size_t>(picture.width) * picture.height);
  for (int y = 0; y < picture.height; ++y)
    for (int x = 0; x < picture.width; ++x) {
      const int count = image.coverage.view()(x, y);
      const int value = count == 0 ? 0 : std::max(1, (255 * count + layers / 2) / layers);
      picture.bytes.push_back(static_cast<std::uint8_t>(value));
    }
  return picture;
}

void write_png(const PngPicture& picture, const std::filesystem::path& path) {
  FileBeside file(path);
  PngTrouble trouble;
  const Writer w(trouble);
  std::vector<png_text> texts(picture.texts.size());
  for (std::size_t i = 0; i < texts.size(); ++i) {
    texts[i] = {};
    texts[i].compression = PNG_TEXT_COMPRESSION_NONE;
    texts[i].key = const_cast<png_charp>(picture.texts[i].first.c_str());  // libpng copies it
    texts[i].text = const_cast<png_charp>(picture.texts[i].second.c_str());
    texts[i].text_length = picture.texts[i].second.size();
  }
  const std::size_t row = static_cast<std::size_t>(picture.width) * picture.channels;
  png_set_write_fn(w.png, &file.stream(), on_write, on_flush);
  const bool good = guarded(w.png, [&] {
    png_set_IHDR(w.png, w.info, static_cast<png_uint_32>(picture.width),
                 static_cast<png_uint_32>(picture.height), 8,
                 picture.channels == 3 ? PNG_COLOR_TYPE_RGB : PNG_COLOR_TYPE_GRAY, PNG_INTERLACE_NONE,
                 PNG_COMPRESSION_TYPE_DEFAULT, PNG_FILTER_TYPE_DEFAULT);
    if (picture.pixel_mm > 0) {
      const auto per_metre = static_cast<png_uint_32>(std::min(1000 / picture.pixel_mm + 0.5, 2e9));
      png_set_pHYs(w.png, w.info, per_metre, per_metre, PNG_RESOLUTION_METER);
    }
    if (!texts.empty()) png_set_text(w.png, w.info, texts.data(), static_cast<int>(texts.size()));
    png_write_info(w.png, w.info);
    for (int y = 0; y < picture.height; ++y) png_write_row(w.png, picture.bytes.data() + y * row);
    png_write_end(w.png, nullptr);
  });
  if (!good)
    throw BadInput(fmt::format("{}: {}; choose another picture size.", path.string(), trouble.message));
  file.commit();
}

PngPicture read_png(const std::filesystem::path& path) {
  std::ifstream in(path, std::ios::binary);
  if (!in) throw BadInput(fmt::format("{}: cannot be opened; check the name.", path.string()));
  return read_png(in, path.string());
}

PngPicture read_png(std::istream& in, const std::string& name) {
  PngTrouble trouble;
  const Reader r(trouble);
  const auto refuse_damage = [&] {
    throw BadInput(fmt::format("{}: {}; write or export the picture again.", name, trouble.message));
  };
  png_set_user_limits(r.png, max_side_px, max_side_px);
  png_set_read_fn(r.png, &in, on_read);
  if (!guarded(r.png, [&] { png_read_info(r.png, r.info); })) refuse_damage();
  const int colour = png_get_color_type(r.png, r.info);
  if (png_get_bit_depth(r.png, r.info) != 8 ||
      (colour != PNG_COLOR_TYPE_GRAY && colour != PNG_COLOR_TYPE_RGB) ||
      png_get_interlace_type(r.png, r.info) != PNG_INTERLACE_NONE)
    throw BadInput(fmt::format("{}: only plain 8-bit grey and RGB are read; export the picture so.", name));
  PngPicture picture{.width = static_cast<int>(png_get_image_width(r.png, r.info)),
                     .height = static_cast<int>(png_get_image_height(r.png, r.info)),
                     .channels = colour == PNG_COLOR_TYPE_RGB ? 3 : 1,
                     .bytes = {},
                     .texts = {}};
  if (const png_uint_32 per_metre = png_get_pixels_per_meter(r.png, r.info); per_metre > 0)
    picture.pixel_mm = 1000.0 / per_metre;
  const std::size_t row = static_cast<std::size_t>(picture.width) * picture.channels;
  picture.bytes.resize(row * picture.height);
  const bool good = guarded(r.png, [&] {
    for (int y = 0; y < picture.height; ++y) png_read_row(r.png, picture.bytes.data() + y * row, nullptr);
    png_read_end(r.png, r.info);
  });
  if (!good) refuse_damage();
  png_textp texts = nullptr;
  const int count = png_get_text(r.png, r.info, &texts, nullptr);
  for (int i = 0; i < count; ++i) picture.texts.emplace_back(texts[i].key, texts[i].text);
  return picture;
}

}  // namespace sonoband::exchange
