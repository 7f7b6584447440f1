// Whole numbers from JSON that may be damaged: nlohmann's own conversion to an integer wraps a longer one and
// is undefined for 1e99.
#pragma once

#include <cstdint>
#include <limits>
#include <stdexcept>

namespace sonoband::exam {

// Throws std::runtime_error, or nlohmann's exceptions, for what is no whole number from `least` to `most`.
template <class Json>
std::int64_t whole_number(const Json& json, std::int64_t least = std::numeric_limits<std::int64_t>::min(),
                          std::int64_t most = std::numeric_limits<std::int64_t>::max()) {
  if (!json.is_number_integer()) throw std::runtime_error("a number is not whole");
  const auto value = json.template get<std::int64_t>();
  const bool wrapped = json.is_number_unsigned() && value < 0;
  if (wrapped || value < least || value > most) throw std::runtime_error("a number is out of range");
  return value;
}

template <class Json>
int whole_int(const Json& json, int least = std::numeric_limits<int>::min(),
              int most = std::numeric_limits<int>::max()) {
  return static_cast<int>(whole_number(json, least, most));
}

}  // namespace sonoband::exam
