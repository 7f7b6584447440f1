// The udev rules against what the drivers look for: a device that a driver knows and no rule opens would be
// found by root alone.
#include <gtest/gtest.h>

#include <array>
#include <cstdio>
#include <fstream>
#include <string>
#include <vector>

#include "hal/footswitch/key_contacts.h"
#include "hal/tracker/usb_port.h"

namespace sonoband {
namespace {

std::vector<std::string> rules() {
  std::ifstream in(std::string(SONOBAND_SOURCE_DIR) + "/board/udev/70-sonoband.rules");
  std::vector<std::string> lines;
  for (std::string line; std::getline(in, line);)
    if (!line.empty() && line[0] != '#') lines.push_back(line);
  return lines;
}

std::string four_digits(int id) {
  std::array<char, 8> text{};
  std::snprintf(text.data(), text.size(), "%04x", id);
  return text.data();
}

// The rules that have all of `words`.
std::vector<std::string> with(const std::vector<std::string>& words) {
  std::vector<std::string> found;
  for (const std::string& line : rules()) {
    bool all = true;
    for (const std::string& word : words) all = all && line.find(word) != std::string::npos;
    if (all) found.push_back(line);
  }
  return found;
}

const std::string open_to_the_cart = "MODE=\"0660\", GROUP=\"sonoband\"";

TEST(UdevRules, OpenEveryPedalThatIsKnownAndKeepItsKeysFromTheScreen) {
  for (const PedalUsbId& id : known_pedals()) {
    const auto of_vendor =
        with({"SUBSYSTEM==\"input\"", "ATTRS{idVendor}==\"" + four_digits(id.vendor) + "\"", open_to_the_cart,
              "ENV{LIBINPUT_IGNORE_DEVICE}=\"1\""});
    ASSERT_EQ(of_vendor.size(), 1u) << four_digits(id.vendor);
    const std::string begin = "ATTRS{idProduct}==\"";
    const std::size_t at = of_vendor[0].find(begin) + begin.size();
    const std::string products = of_vendor[0].substr(at, of_vendor[0].find('"', at) - at);
    EXPECT_NE(("|" + products + "|").find("|" + four_digits(id.product) + "|"), std::string::npos)
        << four_digits(id.vendor) << ":" << four_digits(id.product);
  }
}

TEST(UdevRules, OpenTheTrackersAndLoadTheFirmwareOfThoseThatWaitForIt) {
  EXPECT_EQ(with({"SUBSYSTEM==\"usb\"", "ATTR{idVendor}==\"" + four_digits(polhemus_vendor) + "\"",
                  open_to_the_cart})
                .size(),
            1u);
  struct Loader {
    std::uint16_t id;
    const char* chip;
  };
  for (const Loader& loader : {Loader{0xff21, "fx2"}, {0xef21, "fx2"}, {0xff11, "fx"}, {0xef11, "fx"}}) {
    const UsbProduct* product = find_product(loader.id);
    ASSERT_TRUE(product != nullptr && product->loader);
    EXPECT_EQ(with({four_digits(loader.id), std::string("fxload -t ") + loader.chip + " ",
                    "TEST==\"/etc/sonoband/firmware.hex\""})
                  .size(),
              1u)
        << four_digits(loader.id);
  }
}

TEST(UdevRules, OpenGrabbersLinesAndTouchscreens) {
  for (const char* what :
       {"SUBSYSTEM==\"video4linux\"", "KERNEL==\"gpiochip*\"", "ENV{ID_INPUT_TOUCHSCREEN}==\"1\""})
    EXPECT_EQ(with({what, open_to_the_cart}).size(), 1u) << what;
}

}  // namespace
}  // namespace sonoband
