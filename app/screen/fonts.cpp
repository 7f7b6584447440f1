#include "app/screen/fonts.h"

#include <fstream>
#include <iterator>

#include "app/bad_input.h"

namespace sonoband {
namespace {

std::vector<std::uint8_t> read(const std::filesystem::path& path, const char* package) {
  std::ifstream in(path, std::ios::binary);
  std::vector<std::uint8_t> bytes{std::istreambuf_iterator<char>(in), {}};
  if (!in.good() && bytes.empty()) {
    throw BadInput("the screen's font " + path.string() + " cannot be read: install " + package);
  }
  return bytes;
}

}  // namespace

ui::FontFiles load_fonts(const std::filesystem::path& root) {
  const std::filesystem::path inter = root / "opentype" / "inter";
  return {read(inter / "Inter-Medium.otf", "fonts-inter"), read(inter / "Inter-SemiBold.otf", "fonts-inter"),
          read(root / "truetype" / "font-awesome" / "fontawesome-webfont.ttf", "fonts-font-awesome")};
}

}  // namespace sonoband
