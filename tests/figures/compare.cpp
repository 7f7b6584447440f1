#include "tests/figures/compare.h"

#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <iterator>

#include "app/exchange/png.h"

namespace sonoband::figures {
namespace {

namespace fs = std::filesystem;

std::string text_of(const fs::path& file) {
  std::ifstream in(file, std::ios::binary);
  return {std::istreambuf_iterator<char>(in), {}};
}

bool same_picture(const fs::path& a, const fs::path& b) {
  const exchange::PngPicture one = exchange::read_png(a), other = exchange::read_png(b);
  if (one.width != other.width || one.height != other.height || one.channels != other.channels) return false;
  std::size_t away = 0;
  for (std::size_t i = 0; i < one.bytes.size(); ++i)
    if (std::abs(int{one.bytes[i]} - int{other.bytes[i]}) > 2) ++away;
  return away <= one.bytes.size() / 1000;
}

}  // namespace

std::vector<std::string> outdated(const std::string& painted, const std::string& kept) {
  std::vector<std::string> sentences;
  for (const fs::directory_entry& entry : fs::directory_iterator(painted)) {
    const fs::path there = fs::path(kept) / entry.path().filename();
    const bool current =
        fs::exists(there) && (entry.path().extension() == ".svg" ? text_of(entry.path()) == text_of(there)
                                                                 : same_picture(entry.path(), there));
    if (!current) sentences.push_back(there.string() + " is not what is painted now; run tools/figures");
  }
  return sentences;
}

}  // namespace sonoband::figures
