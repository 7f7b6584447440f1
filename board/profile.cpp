#include "board/profile.h"

#include <algorithm>
#include <charconv>
#include <filesystem>
#include <fstream>
#include <functional>
#include <iterator>
#include <sstream>
#include <vector>

#include <toml++/toml.h>

namespace sonoband {
namespace {

// One key: where it goes, and a sentence about what it must be when the value does not fit.
struct Key {
  std::string table;
  std::string name;
  std::string must_be;
  std::function<bool(const toml::node&, Profile&)> take;  // false: the value does not fit
};

std::string number(double value) {
  std::ostringstream out;
  out << value;
  return out.str();
}

Key real(std::string table, std::string name, double least, double most,
         const std::function<double&(Profile&)>& field) {
  return {std::move(table), std::move(name), "a number from " + number(least) + " to " + number(most),
          [=](const toml::node& node, Profile& profile) {
            const auto value = node.value<double>();
            if (!value || !(*value >= least && *value <= most)) return false;
            field(profile) = *value;
            return true;
          }};
}

template <class Integer>
Key whole(std::string table, std::string name, std::int64_t least, std::int64_t most,
          const std::function<Integer&(Profile&)>& field) {
  return {std::move(table), std::move(name),
          "a whole number from " + std::to_string(least) + " to " + std::to_string(most),
          [=](const toml::node& node, Profile& profile) {
            if (!node.is_integer()) return false;
            const std::int64_t value = **node.as_integer();
            if (value < least || value > most) return false;
            field(profile) = static_cast<Integer>(value);
            return true;
          }};
}

Key choice(std::string table, std::string name, std::vector<std::string> words,
           std::function<void(Profile&, const std::string&)> set) {
  std::string must_be = "one of";
  for (const std::string& word : words) must_be += " \"" + word + "\"";
  return {std::move(table), std::move(name), must_be,
          [words = std::move(words), set = std::move(set)](const toml::node& node, Profile& profile) {
            const auto value = node.value<std::string>();
            if (!value || std::find(words.begin(), words.end(), *value) == words.end()) return false;
            set(profile, *value);
            return true;
          }};
}

Key text(std::string table, std::string name, const std::function<std::string&(Profile&)>& field) {
  return {std::move(table), std::move(name), "a text of at most 200 characters",
          [=](const toml::node& node, Profile& profile) {
            if (!node.is_string() || node.as_string()->get().size() > 200) return false;
            field(profile) = node.as_string()->get();
            return true;
          }};
}

// "#rrggbb".
bool take_colour(const std::string& word, std::array<std::uint8_t, 3>& into) {
  if (word.size() != 7 || word[0] != '#') return false;
  for (std::size_t i = 0; i < into.size(); ++i) {
    const char* digits = word.data() + 1 + 2 * i;
    const auto [end, error] = std::from_chars(digits, digits + 2, into[i], 16);
    if (error != std::errc() || end != digits + 2) return false;
  }
  return true;
}

Key colours(std::string table, std::string name,
            const std::function<std::vector<std::array<std::uint8_t, 3>>&(Profile&)>& field) {
  return {std::move(table), std::move(name),
          R"(2 to 16 colours, dark to bright, such as ["#400000", "#ff0000"])",
          [=](const toml::node& node, Profile& profile) {
            const toml::array* array = node.as_array();
            if (array == nullptr || array->size() < 2 || array->size() > 16) return false;
            std::vector<std::array<std::uint8_t, 3>> taken(array->size());
            for (std::size_t i = 0; i < taken.size(); ++i) {
              const auto word = array->get(i)->value<std::string>();
              if (!word || !take_colour(*word, taken[i])) return false;
            }
            field(profile) = std::move(taken);
            return true;
          }};
}

// An array of exactly as many numbers as there is room for, all within the bounds.
template <class Number, class Numbers>
bool take_numbers(const toml::node& node, Number least, Number most, Numbers& into) {
  const toml::array* array = node.as_array();
  if (array == nullptr || array->size() != into.size()) return false;
  for (std::size_t i = 0; i < into.size(); ++i) {
    const auto value = array->get(i)->value<Number>();
    if (!value || !(*value >= least && *value <= most)) return false;
    into[i] = static_cast<typename Numbers::value_type>(*value);
  }
  return true;
}

bool take_crop(const toml::node& node, Profile& profile) {
  const toml::array* array = node.as_array();
  if (array == nullptr || array->size() != 4) return false;
  for (std::size_t i = 0; i < 4; ++i) {
    const toml::node& entry = *array->get(i);
    if (!entry.is_integer()) return false;
    const std::int64_t value = **entry.as_integer();
    if (value < 0 || value > 16384) return false;
    profile.capture.crop_px[i] = static_cast<int>(value);
  }
  return true;
}

std::vector<Key> all_keys() {
  using P = Profile;
  return {
      real("capture", "rate-hz", 1, 240, [](P& p) -> double& { return p.capture.rate_hz; }),
      {"capture", "crop-px", "four whole numbers [x, y, width, height] from 0 to 16384", take_crop},
      choice("capture", "orientation", {"MF", "MN", "UF", "UN"},
             [](P& p, const std::string& word) { p.capture.orientation = word; }),
      choice("capture", "colour", {"grey", "doppler"},
             [](P& p, const std::string& word) { p.capture.colour = word; }),
      colours("capture", "towards",
              [](P& p) -> std::vector<std::array<std::uint8_t, 3>>& { return p.capture.towards; }),
      colours("capture", "away",
              [](P& p) -> std::vector<std::array<std::uint8_t, 3>>& { return p.capture.away; }),
      whole<int>("capture", "chroma", 1, 255, [](P& p) -> int& { return p.capture.chroma; }),
      real("capture", "latency-ms", -1000, 1000,
           [](P& p) -> double& { return p.capture.latency_ms.emplace(); }),
      choice("capture", "driver", {"v4l2", "libcamera"},
             [](P& p, const std::string& word) { p.capture.driver = word; }),
      text("capture", "device", [](P& p) -> std::string& { return p.capture.device; }),
      {"capture", "size-px", "two whole numbers [width, height] from 16 to 8192",
       [](const toml::node& node, P& p) {
         return take_numbers<std::int64_t>(node, 16, 8192, p.capture.size_px);
       }},
      whole<int>("tracking", "station", 1, 16, [](P& p) -> int& { return p.tracking.station; }),
      real("capture", "silent-ms", 100, 10'000, [](P& p) -> double& { return p.capture.silent_ms; }),
      real("tracking", "silent-ms", 50, 10'000, [](P& p) -> double& { return p.tracking.silent_ms; }),
      {"tracking", "rate-hz", "120 or 240",
       [](const toml::node& node, P& p) {
         const auto value = node.value<std::int64_t>();
         if (value != 120 && value != 240) return false;
         p.tracking.rate_hz = static_cast<int>(*value);
         return true;
       }},
      {"tracking", "hemisphere", "three numbers [x, y, z] from -1 to 1, not all 0",
       [](const toml::node& node, P& p) {
         return take_numbers<double>(node, -1, 1, p.tracking.hemisphere) &&
                p.tracking.hemisphere != std::array<double, 3>{};
       }},
      choice("pedal", "wired", {"gpio", "usb"}, [](P& p, const std::string& word) { p.pedal.wired = word; }),
      text("pedal", "device", [](P& p) -> std::string& { return p.pedal.device; }),
      text("pedal", "pin", [](P& p) -> std::string& { return p.pedal.pin; }),
      text("pedal", "opening-pin", [](P& p) -> std::string& { return p.pedal.opening_pin; }),
      text("pedal", "second-pin", [](P& p) -> std::string& { return p.pedal.second_pin; }),
      {"pedal", "active-low", "true or false",
       [](const toml::node& node, P& p) {
         const auto value = node.value<bool>();
         if (value) p.pedal.active_low = *value;
         return value.has_value() && node.is_boolean();
       }},
      choice("pedal", "bias", {"as-is", "pull-up", "pull-down", "off"},
             [](P& p, const std::string& word) { p.pedal.bias = word; }),
      real("tracking", "gap-ms", 1, 1000, [](P& p) -> double& { return p.tracking.gap_ms; }),
      real("tracking", "wait-ms", 1, 2000, [](P& p) -> double& { return p.tracking.wait_ms; }),
      choice("pedal", "mode", {"hold", "toggle"},
             [](P& p, const std::string& word) {
               p.pedal.mode = word == "hold" ? PedalMode::hold : PedalMode::toggle;
             }),
      real("pedal", "debounce-ms", 1, 200, [](P& p) -> double& { return p.pedal.debounce_ms; }),
      real("pedal", "stuck-s", 1, 3600, [](P& p) -> double& { return p.pedal.stuck_s; }),
      real("screen", "width-mm", 0, 2000, [](P& p) -> double& { return p.screen.width_mm; }),
      text("touch", "device", [](P& p) -> std::string& { return p.touch.device; }),
      {"touch", "rotation-deg", "0, 90, 180 or 270",
       [](const toml::node& node, P& p) {
         const auto value = node.is_integer() ? node.value<std::int64_t>() : std::nullopt;
         if (!value || *value < 0 || *value > 270 || *value % 90 != 0) return false;
         p.touch.rotation_deg = static_cast<int>(*value);
         return true;
       }},
      {"touch", "calibration", "six numbers from -10 to 10, the rows of libinput's calibration matrix",
       [](const toml::node& node, P& p) { return take_numbers<double>(node, -10, 10, p.touch.calibration); }},
      whole<int>("ring", "frames", 16, 100000, [](P& p) -> int& { return p.ring.frames; }),
      real("ring", "pre-roll-s", 0, 60, [](P& p) -> double& { return p.ring.pre_roll_s; }),
      whole<int>("exams", "reserve-mb", 0, 1000000, [](P& p) -> int& { return p.exams.reserve_mb; }),
      text("exams", "export-to", [](P& p) -> std::string& { return p.exams.export_to; }),
      choice("simulation", "scene", {"foetus", "vessels", "wires", "spheres", "ramp", "constant"},
             [](P& p, const std::string& word) { p.simulation.scene = word; }),
      choice("simulation", "sweep", {"linear", "fan", "reversed", "overlapping"},
             [](P& p, const std::string& word) { p.simulation.sweep = word; }),
      whole<std::int64_t>("simulation", "seed", 0, 1'000'000'000,
                          [](P& p) -> std::int64_t& { return p.simulation.seed; }),
  };
}

std::string place(const std::string& file, const toml::source_region& region) {
  return file + ":" + std::to_string(region.begin.line);
}

std::string names(const std::vector<Key>& keys, const std::string& table) {
  std::string list;
  for (const Key& key : keys) {
    if (key.table == table) list += (list.empty() ? "" : ", ") + key.name;
  }
  return list;
}

}  // namespace

Profile parse_profile(std::string_view toml_text, const std::string& file, const Profile& defaults) {
  toml::table root;
  try {
    root = toml::parse(toml_text, file);
  } catch (const toml::parse_error& e) {
    throw ProfileError(place(file, e.source()) + ": this is no TOML: " + std::string(e.description()) +
                       "; write `key = value` lines below [table] headings");
  }
  const std::vector<Key> keys = all_keys();
  Profile profile = defaults;
  for (auto&& [table_key, table_node] : root) {
    const std::string table{table_key.str()};
    const std::string known = names(keys, table);
    if (known.empty() || !table_node.is_table()) {
      throw ProfileError(
          place(file, table_node.source()) + ": there is no table [" + table +
          "]; the tables are [capture], [tracking], [pedal], [screen], [touch], [ring], [exams] and "
          "[simulation]");
    }
    for (auto&& [name_key, node] : *table_node.as_table()) {
      const std::string name{name_key.str()};
      const auto key = std::find_if(keys.begin(), keys.end(),
                                    [&](const Key& k) { return k.table == table && k.name == name; });
      if (key == keys.end()) {
        throw ProfileError(place(file, node.source()) + ": [" + table + "] has no key " + name + "; it has " +
                           known);
      }
      if (!key->take(node, profile)) {
        throw ProfileError(place(file, node.source()) + ": " + table + "." + name + " must be " +
                           key->must_be);
      }
    }
  }
  return profile;
}

Profile read_profile(const std::string& file, const Profile& defaults) {
  std::ifstream in;
  if (std::filesystem::is_regular_file(file)) in.open(file, std::ios::binary);
  if (!in.is_open()) {
    throw ProfileError(
        file + ": this configuration file cannot be read; name one that exists, or leave --config out");
  }
  const std::string text{std::istreambuf_iterator<char>(in), {}};
  return parse_profile(text, file, defaults);
}

}  // namespace sonoband
