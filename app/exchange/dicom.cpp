#include "app/exchange/dicom.h"

#include <dcmtk/config/osconfig.h>
#include <dcmtk/dcmdata/dcfilefo.h>
#include <dcmtk/dcmdata/dcmetinf.h>
#include <dcmtk/dcmdata/dcostrma.h>
#include <dcmtk/dcmdata/dctk.h>
#include <fmt/chrono.h>
#include <fmt/format.h>
#include <xxhash.h>

#include <algorithm>
#include <cmath>
#include <ctime>
#include <limits>

#include "app/bad_input.h"
#include "app/exchange/file_beside.h"
#include "app/exchange/text.h"

namespace sonoband::exchange {
namespace {

constexpr const char* research = "Research use only. Not for diagnosis.";
constexpr std::uint64_t largest_pixels = 0xfffffffeU;
constexpr std::size_t longest_vector_bytes = 60'000;  // of a text value; PS3.5, 7.1.2 allows 65 534

// DCMTK writes into files of its own; this lets it write into ours.
class StreamConsumer : public DcmConsumer {
 public:
  explicit StreamConsumer(std::ostream& out) : out_(out) {}
  OFBool good() const override { return out_.good(); }
  OFCondition status() const override { return good() ? EC_Normal : EC_InvalidStream; }
  OFBool isFlushed() const override { return OFTrue; }
  offile_off_t avail() const override { return std::numeric_limits<std::int32_t>::max(); }
  offile_off_t write(const void* bytes, offile_off_t count) override {
    out_.write(static_cast<const char*>(bytes), count);
    return out_ ? count : 0;
  }
  void flush() override {}

 private:
  std::ostream& out_;
};

struct Consumes {
  StreamConsumer consumer;
};
class StreamOutput : Consumes, public DcmOutputStream {
 public:
  explicit StreamOutput(std::ostream& out) : Consumes{StreamConsumer(out)}, DcmOutputStream(&consumer) {}
};

// Values that a library call refuses are ours to have made right.
class Writer {
 public:
  explicit Writer(std::filesystem::path path) : path_(std::move(path)) {}

  void text(const DcmTagKey& tag, const std::string& value) {
    check(file_.getDataset()->putAndInsertString(tag, value.c_str()));
  }
  void number(const DcmTagKey& tag, std::uint16_t value) {
    check(file_.getDataset()->putAndInsertUint16(tag, value));
  }
  void tag(const DcmTagKey& tag, const DcmTagKey& value) {
    check(file_.getDataset()->putAndInsertTagKey(tag, value));
  }
  void pixels(std::span<const std::uint8_t> bytes) {
    if (bytes.size() > largest_pixels)
      throw BadInput(
          fmt::format("{}: {} bytes of pixels are more than a DICOM object holds (4 GiB); export "
                      "the sweeps one by one, or as mha",
                      path_.string(), bytes.size()));
    check(file_.getDataset()->putAndInsertUint8Array(DCM_PixelData, bytes.data(),
                                                     static_cast<unsigned long>(bytes.size())));
  }
  DcmItem& item(const DcmTagKey& sequence) {
    DcmItem* made = nullptr;
    check(file_.getDataset()->findOrCreateSequenceItem(sequence, made, -2));
    return *made;
  }
  void check(const OFCondition& done) const {
    if (done.bad()) throw BadInput(fmt::format("{}: cannot be written: {}", path_.string(), done.text()));
  }

  void save(const Progress& progress) {
    constexpr E_TransferSyntax syntax = EXS_LittleEndianExplicit;
    const std::uint64_t bytes = file_.calcElementLength(syntax, EET_ExplicitLength);
    FileBeside file(path_, progress, bytes);
    file.only_for_its_owner();
    StreamOutput out(file.stream());
    file_.transferInit();
    const OFCondition saved = file_.write(out, syntax, EET_ExplicitLength, nullptr, EGL_recalcGL);
    file_.transferEnd();
    if (file.stream()) check(saved);  // else the disk's own reason is the better one
    file.commit();
  }

 private:
  std::filesystem::path path_;
  DcmFileFormat file_;
};

struct When {
  std::string date;
  std::string time;
};

When when(std::int64_t utc_ns) {
  const auto seconds = static_cast<std::time_t>(utc_ns / 1'000'000'000);
  const std::tm utc = fmt::gmtime(seconds);
  return {fmt::format("{:%Y%m%d}", utc), fmt::format("{:%H%M%S}.{:06d}", utc, utc_ns % 1'000'000'000 / 1000)};
}

// Decimal strings are at most 16 characters; PS3.5, 6.2.
std::string decimal(double value) {
  for (int digits = 16; digits > 1; --digits) {
    std::string text = fmt::format("{:.{}g}", value, digits);
    if (text.size() <= 16) return text;
  }
  return "0";
}

// Person names and short texts keep no character that separates values or components.
std::string plain(std::string text, std::size_t longest) {
  for (char& c : text)
    if (c == '\\' || c == '^' || c == '=' || static_cast<unsigned char>(c) < 0x20) c = ' ';
  if (text.size() > longest) {
    text.resize(longest);
    // Not in the midst of a character of UTF-8.
    while (!text.empty() && (static_cast<unsigned char>(text.back()) & 0xc0) == 0x80) text.pop_back();
    if (!text.empty() && static_cast<unsigned char>(text.back()) >= 0xc0) text.pop_back();
  }
  return text;
}

struct Object {
  const char* sop_class;
  const char* modality;
  std::string object;
  int number;
  int series;
  std::string description;
  std::int64_t utc_ns;
};

void put_common(Writer& w, const DicomStudy& study, const Object& o) {
  const When created = when(study.created_utc_ns);
  const When made = when(o.utc_ns);
  w.text(DCM_SpecificCharacterSet, "ISO_IR 192");
  w.text(DCM_SOPClassUID, o.sop_class);
  w.text(DCM_SOPInstanceUID, dicom_uid(study.exam_id + "/" + o.object));
  w.text(DCM_TimezoneOffsetFromUTC, "+0000");

  w.text(DCM_PatientName, plain(study.label, 64));
  w.text(DCM_PatientID, plain(study.label, 64));
  w.text(DCM_PatientBirthDate, "");
  w.text(DCM_PatientSex, "");

  w.text(DCM_StudyInstanceUID, dicom_uid(study.exam_id));
  w.text(DCM_StudyID, plain(study.exam_id.substr(0, 15), 16));
  w.text(DCM_StudyDate, created.date);
  w.text(DCM_StudyTime, created.time);
  w.text(DCM_AccessionNumber, "");
  w.text(DCM_ReferringPhysicianName, "");
  w.text(DCM_StudyDescription, "Freehand 3D ultrasound");

  w.text(DCM_Modality, o.modality);
  w.text(DCM_SeriesInstanceUID, dicom_uid(fmt::format("{}/series {}", study.exam_id, o.series)));
  w.text(DCM_SeriesNumber, std::to_string(o.series));
  w.text(DCM_SeriesDescription, plain(o.description, 64));
  w.text(DCM_SeriesDate, made.date);
  w.text(DCM_SeriesTime, made.time);
  // Empty: nobody has said which body part this is.
  w.text(DCM_Laterality, "");

  w.text(DCM_Manufacturer, "Sonoband");
  w.text(DCM_ManufacturerModelName, plain(study.equipment.empty() ? "Sonoband" : study.equipment, 64));
  w.text(DCM_SoftwareVersions, SONOBAND_VERSION);

  w.text(DCM_InstanceNumber, std::to_string(o.number));
  w.text(DCM_ContentDate, made.date);
  w.text(DCM_ContentTime, made.time);
  w.text(DCM_PatientOrientation, "");
  w.text(DCM_ImageComments, research);
  w.text(DCM_LossyImageCompression, "00");
}

void put_pixel_layout(Writer& w, int width, int height, bool colour) {
  w.number(DCM_SamplesPerPixel, colour ? 3 : 1);
  w.text(DCM_PhotometricInterpretation, colour ? "RGB" : "MONOCHROME2");
  if (colour) w.number(DCM_PlanarConfiguration, 0);
  w.number(DCM_Rows, static_cast<std::uint16_t>(height));
  w.number(DCM_Columns, static_cast<std::uint16_t>(width));
  w.number(DCM_BitsAllocated, 8);
  w.number(DCM_BitsStored, 8);
  w.number(DCM_HighBit, 7);
  w.number(DCM_PixelRepresentation, 0);
}

struct Bounds {
  int left = 0;
  int top = 0;
  int right = 0;
  int bottom = 0;
};

Bounds bounds_of(MaskView mask, int width, int height) {
  Bounds b{0, 0, width - 1, height - 1};
  if (mask.empty()) return b;
  Bounds found{width, height, -1, -1};
  for (int y = 0; y < mask.height; ++y)
    for (int x = 0; x < mask.width; ++x)
      if (mask(x, y) != 0)
        found = {std::min(found.left, x), std::min(found.top, y), std::max(found.right, x),
                 std::max(found.bottom, y)};
  return found.right < 0 ? b : found;
}

// Source: PS3.3, C.8.5.5: a two-dimensional region of tissue, in centimetres.
void put_region(Writer& w, const DicomCine& cine) {
  const Bounds b = bounds_of(cine.mask, cine.width, cine.height);
  DcmItem& region = w.item(DCM_SequenceOfUltrasoundRegions);
  w.check(region.putAndInsertUint16(DCM_RegionSpatialFormat, 1));
  w.check(region.putAndInsertUint16(DCM_RegionDataType, cine.kind == PixelKind::doppler ? 2 : 1));
  w.check(region.putAndInsertUint32(DCM_RegionFlags, 0));
  w.check(region.putAndInsertUint32(DCM_RegionLocationMinX0, static_cast<Uint32>(b.left)));
  w.check(region.putAndInsertUint32(DCM_RegionLocationMinY0, static_cast<Uint32>(b.top)));
  w.check(region.putAndInsertUint32(DCM_RegionLocationMaxX1, static_cast<Uint32>(b.right)));
  w.check(region.putAndInsertUint32(DCM_RegionLocationMaxY1, static_cast<Uint32>(b.bottom)));
  w.check(region.putAndInsertUint16(DCM_PhysicalUnitsXDirection, 3));
  w.check(region.putAndInsertUint16(DCM_PhysicalUnitsYDirection, 3));
  w.check(region.putAndInsertFloat64(DCM_PhysicalDeltaX, cine.x_mm / 10));
  w.check(region.putAndInsertFloat64(DCM_PhysicalDeltaY, cine.y_mm / 10));
}

// Time from each frame to the next; the first entry is 0. Source: PS3.3, C.7.6.5.
void put_times(Writer& w, const std::vector<double>& times_s) {
  std::string vector = "0";
  double before = 0;
  for (std::size_t i = 1; i < times_s.size(); ++i) {
    // Rounded as they add up, so that the last frame is where it belongs.
    const double at = std::round((times_s[i] - times_s[0]) * 1e4) / 10;
    vector += fmt::format("\\{:.1f}", at - before);
    before = at;
  }
  const double mean_ms =
      times_s.size() > 1 ? (times_s.back() - times_s.front()) * 1000 / static_cast<double>(times_s.size() - 1)
                         : 0;
  if (vector.size() <= longest_vector_bytes && times_s.size() > 1) {
    w.text(DCM_FrameTimeVector, vector);
    w.tag(DCM_FrameIncrementPointer, DCM_FrameTimeVector);
  } else {
    w.text(DCM_FrameTime, decimal(mean_ms));
    w.tag(DCM_FrameIncrementPointer, DCM_FrameTime);
  }
  if (mean_ms > 0)
    w.text(DCM_CineRate, std::to_string(std::max(1, static_cast<int>(std::lround(1000 / mean_ms)))));
}

}  // namespace

std::string dicom_uid(std::string_view what) {
  const XXH128_hash_t hash = XXH3_128bits(what.data(), what.size());
  // 128 bits as decimal digits, and as a UUID of version 8 (made from contents) and the usual variant.
  std::uint64_t high = (hash.high64 & ~0xf000ULL) | 0x8000ULL;
  std::uint64_t low = (hash.low64 & ~(3ULL << 62)) | (2ULL << 62);
  std::string digits;
  while (high != 0 || low != 0) {
    const std::uint64_t rest = high % 10;
    high /= 10;
    // Long division by ten, 32 bits at a time.
    const std::uint64_t upper = (rest << 32) | (low >> 32);
    const std::uint64_t lower = ((upper % 10) << 32) | (low & 0xffffffffU);
    low = (upper / 10) << 32 | lower / 10;
    digits += static_cast<char>('0' + lower % 10);
  }
  std::reverse(digits.begin(), digits.end());
  return "2.25." + digits;
}

void write_dicom(const DicomStudy& study, const DicomPicture& p, const std::filesystem::path& path,
                 const Progress& progress) {
  Writer w(path);
  const bool colour = p.picture.channels == 3;
  put_common(w, study,
             {UID_SecondaryCaptureImageStorage, "OT", p.object, p.number, 1000, p.description, p.utc_ns});
  w.text(DCM_ConversionType, "WSD");
  w.text(DCM_ImageType, "DERIVED\\SECONDARY");
  w.text(DCM_DerivationDescription, plain(p.derivation.substr(0, 900), 1000));
  put_pixel_layout(w, p.picture.width, p.picture.height, colour);
  if (p.picture.pixel_mm > 0) {
    const std::string mm = decimal(p.picture.pixel_mm);
    w.text(DCM_PixelSpacing, mm + "\\" + mm);
    w.text(DCM_PixelSpacingCalibrationType, "GEOMETRY");
    w.text(DCM_PixelSpacingCalibrationDescription, "From the probe's calibration");
  }
  w.pixels(p.picture.bytes);
  w.save(progress);
}

void write_dicom(const DicomStudy& study, const DicomCine& c, const std::filesystem::path& path,
                 const Progress& progress) {
  Writer w(path);
  const bool colour = c.kind == PixelKind::doppler;
  const std::size_t frames = c.times_s.size();
  put_common(
      w, study,
      {UID_UltrasoundMultiframeImageStorage, "US", c.object, c.number, c.number, c.description, c.utc_ns});
  w.text(DCM_ImageType, "ORIGINAL\\PRIMARY");
  w.text(DCM_NumberOfFrames, std::to_string(frames));
  put_times(w, c.times_s);
  put_pixel_layout(w, c.width, c.height, colour);
  if (colour) w.number(DCM_UltrasoundColorDataPresent, 1);
  if (c.x_mm > 0 && c.y_mm > 0) put_region(w, c);
  if (!colour) {
    w.pixels(c.pixels);
  } else {
    std::vector<std::uint8_t> rgb;
    rgb.reserve(c.pixels.size() * 3);
    const std::size_t size = static_cast<std::size_t>(c.width) * c.height;
    for (std::size_t i = 0; i < frames; ++i) {
      const PngPicture picture =
          picture_png({c.pixels.data() + i * size, c.width, c.height, c.width}, PixelKind::doppler);
      rgb.insert(rgb.end(), picture.bytes.begin(), picture.bytes.end());
    }
    w.pixels(rgb);
  }
  w.save(progress);
}

}  // namespace sonoband::exchange
