#include "hal/tracker/liberty_protocol.h"

namespace sonoband::liberty {
namespace {

struct ErrorEntry {
  std::uint8_t code;
  ErrorKind kind;
  const char* text;
};

constexpr ErrorEntry errors[] = {
    {0x00, ErrorKind::none, "no error"},
    {0x20, ErrorKind::none, "no error"},  // documented for ASCII only, seen in binary
    {0x01, ErrorKind::configuration, "invalid command"},
    {0x02, ErrorKind::configuration, "invalid station"},
    {0x03, ErrorKind::configuration, "invalid parameter"},
    {0x04, ErrorKind::configuration, "too few parameters"},
    {0x05, ErrorKind::configuration, "too many parameters"},
    {0x06, ErrorKind::configuration, "parameter below its limit"},
    {0x07, ErrorKind::configuration, "parameter above its limit"},
    {0x08, ErrorKind::hardware, "no communication with a sensor processor"},
    {0x09, ErrorKind::hardware, "sensor processor 1 did not start"},
    {0x0a, ErrorKind::hardware, "sensor processor 2 did not start"},
    {0x0b, ErrorKind::hardware, "sensor processor 3 did not start"},
    {0x0c, ErrorKind::hardware, "sensor processor 4 did not start"},
    {0x0d, ErrorKind::hardware, "no sensor processor"},
    {0x0e, ErrorKind::hardware, "the source processor did not start"},
    {0x0f, ErrorKind::hardware, "memory"},
    {0x10, ErrorKind::configuration, "too many characters in a command"},
    {0x11, ErrorKind::configuration, "the unit is in test mode"},
    {0x12, ErrorKind::notice, "the source's memory is unreadable, defaults are used"},
    {0x13, ErrorKind::configuration, "read-only"},
    {0x14, ErrorKind::notice, "text"},
    {0x15, ErrorKind::hardware, "the compensation map did not load"},
    {0x16, ErrorKind::hardware, "sensor synchronisation"},
    {0x17, ErrorKind::notice, "incompatible firmware: an upgrade is required"},
    {0x18, ErrorKind::notice, "outdated firmware: an upgrade is advised"},
    {'a', ErrorKind::source_fault, "source failure on X"},
    {'b', ErrorKind::source_fault, "source failure on Y"},
    {'c', ErrorKind::source_fault, "source failure on X and Y"},
    {'d', ErrorKind::source_fault, "source failure on Z"},
    {'e', ErrorKind::source_fault, "source failure on X and Z"},
    {'f', ErrorKind::source_fault, "source failure on Y and Z"},
    {'g', ErrorKind::source_fault, "source failure on X, Y and Z"},
    {'A', ErrorKind::source_fault, "source failure on X, and self-test errors"},
    {'B', ErrorKind::source_fault, "source failure on Y, and self-test errors"},
    {'C', ErrorKind::source_fault, "source failure on X and Y, and self-test errors"},
    {'D', ErrorKind::source_fault, "source failure on Z, and self-test errors"},
    {'E', ErrorKind::source_fault, "source failure on X and Z, and self-test errors"},
    {'F', ErrorKind::source_fault, "source failure on Y and Z, and self-test errors"},
    {'G', ErrorKind::source_fault, "source failure on X, Y and Z, and self-test errors"},
    {'I', ErrorKind::self_test, "self-test errors"},
    {'u', ErrorKind::outside_map, "position outside the mapped area"},
};

constexpr ErrorEntry unknown_error{0, ErrorKind::unknown, "unknown error"};

const ErrorEntry& entry(std::uint8_t error) {
  for (const ErrorEntry& e : errors)
    if (e.code == error) return e;
  return unknown_error;
}

}  // namespace

ErrorKind classify(std::uint8_t error) {
  return entry(error).kind;
}

const char* error_text(std::uint8_t error) {
  return entry(error).text;
}

}  // namespace sonoband::liberty
