#include <gtest/gtest.h>

#include "tests/app/exchange/sequence_samples.h"

namespace sonoband::test {
namespace {

using exchange::ElementType;
using exchange::TrackedSequence;
using ::testing::AssertionResult;

AssertionResult contains(const std::string& text, const std::string& part) {
  if (text.find(part) != std::string::npos) return ::testing::AssertionSuccess();
  return ::testing::AssertionFailure() << "'" << part << "' is not in '" << text << "'";
}

// A grey 2 x 2 sequence of two frames, 8 bytes of pixels; lines may be exchanged or taken away.
struct SmallFile {
  std::vector<std::pair<std::string, std::string>> lines{{"ObjectType", "Image"},
                                                         {"NDims", "3"},
                                                         {"BinaryData", "True"},
                                                         {"BinaryDataByteOrderMSB", "False"},
                                                         {"CompressedData", "False"},
                                                         {"DimSize", "2 2 2"},
                                                         {"Kinds", "domain domain list"},
                                                         {"ElementType", "MET_UCHAR"},
                                                         {"UltrasoundImageOrientation", "MFA"},
                                                         {"ElementDataFile", "LOCAL"}};
  std::string payload = "abcdefgh";

  SmallFile& set(const std::string& name, const std::string& value) {
    for (auto& [n, v] : lines)
      if (n == name) {
        v = value;
        return *this;
      }
    lines.insert(lines.end() - 1, {name, value});
    return *this;
  }
  SmallFile& drop(const std::string& name) {
    std::erase_if(lines, [&](const auto& line) { return line.first == name; });
    return *this;
  }
  SmallFile& pixels(const std::string& bytes) {
    payload = bytes;
    return *this;
  }
  std::string text() const {
    std::string all;
    for (const auto& [name, value] : lines) all += name + " = " + value + "\n";
    return all + payload;
  }
  exchange::ReadSequence read() const { return read_meta(text()); }
  std::string refused() const {
    return refusal([&] { read(); });
  }
};

std::string pixels_of(const TrackedSequence& s) {
  const auto bytes = s.pixels.bytes();
  return {bytes.begin(), bytes.end()};
}

TEST(Metaimage, ReadsASmallGreySequence) {
  const auto read = SmallFile().read();
  EXPECT_EQ(read.sequence.width, 2);
  EXPECT_EQ(read.sequence.height, 2);
  EXPECT_EQ(read.sequence.frame_count(), 2);
  EXPECT_EQ(read.sequence.components, 1);
  EXPECT_EQ(pixels_of(read.sequence), "abcdefgh");
  EXPECT_TRUE(read.warnings.empty());
}

TEST(Metaimage, NamesCompareWithoutCaseAndBlanksRun) {
  SmallFile file;
  file.set("DimSize", "2   2 \t          2      ");
  std::string text = file.text();
  text.replace(text.find("DimSize"), 7, "dimsize");
  text.replace(text.find("ObjectType = Image"), 18, "objecttype=image  ");
  EXPECT_EQ(pixels_of(read_meta(text).sequence), "abcdefgh");
}

TEST(Metaimage, SplitsAtTheFirstEqualsSign) {
  const auto read = SmallFile().set("Note", "a = b = c").read();
  ASSERT_NE(exchange::find_field(read.sequence.fields, "note"), nullptr);
  EXPECT_EQ(*exchange::find_field(read.sequence.fields, "note"), "a = b = c");
}

TEST(Metaimage, CarriageReturnsAreNotPartOfValues) {
  std::string text = SmallFile().text();
  const std::size_t end = text.find("LOCAL") + 5;
  std::string header;
  for (const char c : text.substr(0, end)) header += c == '\n' ? std::string("\r\n") : std::string(1, c);
  EXPECT_EQ(pixels_of(read_meta(header + "\r\nabcdefgh").sequence), "abcdefgh");
}

TEST(Metaimage, LinesWithoutEqualsAreLeftOutWithAWarning) {
  std::string text = SmallFile().text();
  text.insert(text.find("NDims"), "a stray line\n");
  const auto read = read_meta(text);
  EXPECT_EQ(pixels_of(read.sequence), "abcdefgh");
  ASSERT_EQ(read.warnings.size(), 1u);
  EXPECT_TRUE(contains(read.warnings[0], "line 2"));
}

TEST(Metaimage, OnePictureHasTwoDimensions) {
  const auto read =
      SmallFile().set("NDims", "2").set("DimSize", "4   2").set("Kinds", "domain  domain").read();
  EXPECT_EQ(read.sequence.frame_count(), 1);
  EXPECT_EQ(read.sequence.width, 4);
  EXPECT_EQ(read.sequence.height, 2);
}

TEST(Metaimage, FourDimensionsAreVolumesInTime) {
  const auto read = SmallFile()
                        .set("NDims", "4")
                        .set("DimSize", "2 1 2 2")
                        .set("Kinds", "domain domain domain list")
                        .read();
  EXPECT_EQ(read.sequence.slices, 2);
  EXPECT_EQ(read.sequence.frame_count(), 2);
}

TEST(Metaimage, WithoutKindsTheLastSizeIsTheFrames) {
  const auto read = SmallFile().drop("Kinds").read();
  EXPECT_EQ(read.sequence.frame_count(), 2);
  ASSERT_EQ(read.warnings.size(), 1u);
  EXPECT_TRUE(contains(read.warnings[0], "Kinds"));
}

TEST(Metaimage, TimeIsAKindOfFrames) {
  EXPECT_EQ(SmallFile().set("Kinds", "domain domain time").read().sequence.frame_count(), 2);
}

TEST(Metaimage, ColourComesAsChannelsOrAsAVector) {
  const std::string rgb = "abcdefghijklmnopqrstuvwx";
  const auto channels = SmallFile().set("ElementNumberOfChannels", "3").pixels(rgb).read();
  EXPECT_EQ(channels.sequence.components, 3);
  EXPECT_EQ(pixels_of(channels.sequence), rgb);
  // PLUS counts the vector neither in NDims nor always out of the channels.
  for (const std::string ndims : {"3", "4"}) {
    SmallFile file;
    file.set("NDims", ndims).set("DimSize", "3 2 2 2").set("Kinds", "vector domain domain list").pixels(rgb);
    EXPECT_EQ(file.read().sequence.components, 3);
    file.set("ElementNumberOfChannels", "3");
    EXPECT_EQ(file.read().sequence.components, 3);
    EXPECT_EQ(pixels_of(file.read().sequence), rgb);
  }
}

TEST(Metaimage, TrackerOnlyFilesHaveNoPictures) {
  const auto none =
      SmallFile().set("DimSize", "0 0 5").set("ElementType", "MET_OTHER").pixels("").read().sequence;
  EXPECT_EQ(none.frame_count(), 5);
  EXPECT_FALSE(none.has_pictures());
  const auto dummy = SmallFile().set("DimSize", "1 1 5").pixels("00000").read().sequence;
  EXPECT_EQ(dummy.frame_count(), 5);
  EXPECT_FALSE(dummy.has_pictures());
}

TEST(Metaimage, FramesAreCountedByTheSizesNotByTheFields) {
  const auto read =
      SmallFile().set("Seq_Frame0000_Timestamp", "1.0").set("Seq_Frame0007_Timestamp", "8.0").read();
  EXPECT_EQ(read.sequence.frame_count(), 2);
  EXPECT_EQ(exchange::timestamp_s(read.sequence.frames[0]), 1.0);
  EXPECT_TRUE(read.sequence.frames[1].fields.empty());
  ASSERT_EQ(read.warnings.size(), 1u);
  EXPECT_TRUE(contains(read.warnings[0], "past the last one"));
}

TEST(Metaimage, FieldNamesMayHaveUnderscoresAndFrameNumbersMoreDigits) {
  const auto read = SmallFile().set("Seq_Frame00001_My_own_Field", "x").read();
  EXPECT_EQ(*exchange::find_field(read.sequence.frames[1].fields, "My_own_Field"), "x");
}

TEST(Metaimage, WiderSamplesOfTheOtherByteOrderAreTurned) {
  const auto read = SmallFile()
                        .set("ElementType", "MET_SHORT")
                        .set("DimSize", "2 1 2")
                        .set("BinaryDataByteOrderMSB", "True")
                        .read();
  EXPECT_EQ(read.sequence.element_type, ElementType::int16);
  EXPECT_EQ(pixels_of(read.sequence), "badcfehg");
}

struct Turn {
  const char* code;
  const char* frame;  // of "abcd", 2 x 2
};

class MetaimageOrientation : public ::testing::TestWithParam<Turn> {};

TEST_P(MetaimageOrientation, IsTurnedToMf) {
  const auto read = SmallFile().set("UltrasoundImageOrientation", GetParam().code).pixels("abcdabcd").read();
  EXPECT_EQ(pixels_of(read.sequence), std::string(GetParam().frame) + GetParam().frame);
  EXPECT_EQ(read.sequence.orientation, "MFA");
  EXPECT_EQ(read.sequence.orientation_in_file, GetParam().code);
}

INSTANTIATE_TEST_SUITE_P(Codes, MetaimageOrientation,
                         ::testing::Values(Turn{"MF", "abcd"}, Turn{"MFA", "abcd"}, Turn{"MFD", "abcd"},
                                           Turn{"MN", "cdab"}, Turn{"MNA", "cdab"}, Turn{"MND", "cdab"},
                                           Turn{"UF", "badc"}, Turn{"UFA", "badc"}, Turn{"UFD", "badc"},
                                           Turn{"UN", "dcba"}, Turn{"UNA", "dcba"}, Turn{"UND", "dcba"},
                                           Turn{"XX", "abcd"}));

TEST(Metaimage, ColourPixelsTurnWhole) {
  const auto read = SmallFile()
                        .set("UltrasoundImageOrientation", "UN")
                        .set("ElementNumberOfChannels", "3")
                        .set("DimSize", "2 2 1")
                        .pixels("abcdefghijkl")
                        .read();
  EXPECT_EQ(pixels_of(read.sequence), "jklghidefabc");
}

TEST(Metaimage, DescendingVolumesAreRestacked) {
  const auto read = SmallFile()
                        .set("NDims", "3")
                        .set("Kinds", "domain domain domain")
                        .set("UltrasoundImageOrientation", "MFD")
                        .read();
  EXPECT_EQ(read.sequence.slices, 2);
  EXPECT_EQ(pixels_of(read.sequence), "efghabcd");
}

TEST(Metaimage, WithoutAnOrientationPicturesAreTakenAsMfWithAWarning) {
  const auto read = SmallFile().drop("UltrasoundImageOrientation").read();
  EXPECT_EQ(read.sequence.orientation, "MFA");
  ASSERT_EQ(read.warnings.size(), 1u);
  EXPECT_TRUE(contains(read.warnings[0], "taken as MF"));
}

TEST(Metaimage, RowsThatAreScanLinesStayAsTheyAre) {
  const auto read =
      SmallFile().set("UltrasoundImageOrientation", "FM").set("UltrasoundImageType", "RF_REAL").read();
  EXPECT_EQ(read.sequence.orientation, "FM");
  EXPECT_EQ(pixels_of(read.sequence), "abcdefgh");
  EXPECT_TRUE(same_sequence(read.sequence, read_meta(meta_text(read.sequence)).sequence));
}

TEST(Metaimage, VolumesKeepWhereTheyLie) {
  const auto read = SmallFile()
                        .set("Kinds", "domain domain domain")
                        .set("ElementSpacing", "0.5 0.25 2")
                        .set("Offset", "-57.0272 168.545 30.5384")
                        .set("TransformMatrix", "0 1 0 -1 0 0 0 0 1")
                        .read();
  EXPECT_EQ(read.sequence.geometry.spacing_mm, (std::vector<double>{0.5, 0.25, 2}));
  EXPECT_EQ(read.sequence.geometry.origin_mm[1], 168.545);
  EXPECT_EQ(read.sequence.geometry.axes.col(0), Eigen::Vector3d(0, 1, 0));
  EXPECT_TRUE(same_sequence(read.sequence, read_meta(meta_text(read.sequence)).sequence));
}

TEST(Metaimage, WhatIsWrittenIsReadTheSame) {
  for (const bool compressed : {false, true})
    for (const int components : {1, 3})
      for (const ElementType type : {ElementType::uint8, ElementType::int16, ElementType::float64}) {
        auto s = random_sequence(7, 5, 12, type, components, 11);
        s.compressed = compressed;
        s.orientation_in_file = s.orientation;
        const auto read = read_meta(meta_text(s));
        EXPECT_TRUE(same_sequence(s, read.sequence));
        EXPECT_TRUE(read.warnings.empty());
      }
}

TEST(Metaimage, OneFrameAndTrackerOnlyAreWrittenTheSame) {
  const auto one = random_sequence(7, 5, 1, ElementType::uint8, 1, 3);
  EXPECT_TRUE(same_sequence(one, read_meta(meta_text(one)).sequence));
  auto none = random_sequence(0, 0, 9, ElementType::none, 1, 3);
  none.orientation = "XX";
  EXPECT_TRUE(same_sequence(none, read_meta(meta_text(none)).sequence));
}

TEST(Metaimage, PosesKeepEveryBit) {
  const auto s = random_sequence(2, 2, 50, ElementType::uint8, 1, 8);
  const auto read = read_meta(meta_text(s)).sequence;
  for (std::size_t i = 0; i < 50; ++i) {
    const auto a = exchange::transforms_of(s.frames[i].fields, "");
    const auto b = exchange::transforms_of(read.frames[i].fields, "");
    ASSERT_EQ(a.size(), 1u);
    EXPECT_EQ(a[0].to_from_from, b[0].to_from_from);
    EXPECT_EQ(a[0].status, b[0].status);
  }
}

TEST(Metaimage, TheFileBeginsAndEndsAsPlusWantsIt) {
  auto s = random_sequence(4, 4, 3, ElementType::uint8, 1, 1);
  s.compressed = true;
  const std::string text = meta_text(s);
  EXPECT_TRUE(text.starts_with("ObjectType = Image\nNDims = 3\n"));
  EXPECT_TRUE(contains(text, "\nElementDataFile = LOCAL\nx"));  // 'x' begins every zlib stream of that window
  EXPECT_TRUE(contains(text, "\nKinds = domain domain list\n"));
  EXPECT_TRUE(contains(text, "\nUltrasoundImageOrientation = MFA\n"));
  EXPECT_TRUE(contains(text, "\nSeq_Frame0002_ProbeToTrackerTransformStatus = OK\n"));
  EXPECT_EQ(text.find('\r'), std::string::npos);
}

TEST(Metaimage, FieldsThatWouldReadBackOtherwiseAreNotWritten) {
  auto s = random_sequence(2, 2, 2, ElementType::uint8, 1, 1);
  for (const exchange::Field& field : {exchange::Field{"a=b", "c"}, exchange::Field{"Note", "two\nlines"},
                                       exchange::Field{"DimSize", "9 9 9"}, exchange::Field{" Note", "x"},
                                       exchange::Field{"Seq_Frame0000_X", "y"}}) {
    s.fields = {field};
    EXPECT_TRUE(contains(refusal([&] { meta_text(s); }), field.name));
  }
}

// Every kind of damage has its sentence, and each names the file.
TEST(MetaimageDamage, Sizes) {
  EXPECT_TRUE(
      contains(SmallFile().pixels("abc").refused(), "8 bytes of pixels and the file has 3; it is cut short"));
  EXPECT_TRUE(contains(SmallFile().set("DimSize", "2 2").refused(), "NDims is 3 but DimSize has 2 sizes"));
  EXPECT_TRUE(contains(SmallFile().set("DimSize", "2 two 2").refused(), "'two', which is no whole number"));
  EXPECT_TRUE(contains(SmallFile().set("DimSize", "2 -2 2").refused(), "cannot be negative"));
  EXPECT_TRUE(contains(SmallFile().set("DimSize", "2 0 2").refused(), "one side of the pictures is 0"));
  EXPECT_TRUE(contains(SmallFile().set("DimSize", "2 2 0").refused(), "holds no frames"));
  EXPECT_TRUE(contains(SmallFile().set("DimSize", "4000 4000 2000").refused(), "split the recording"));
  EXPECT_TRUE(
      contains(SmallFile().set("DimSize", "2 2 99999999999").refused(), "more than the limit of 10000"));
  EXPECT_TRUE(contains(SmallFile().set("DimSize", "2 9999 2").refused(), "more than the limit of 4096"));
  EXPECT_TRUE(contains(SmallFile().set("DimSize", "2 2 9999999999999999999").refused(), "no whole number"));
  EXPECT_TRUE(contains(SmallFile().set("Kinds", "domain domain").refused(), "3 sizes but 2 kinds"));
  EXPECT_TRUE(contains(SmallFile().set("Kinds", "list domain domain").refused(), "not the last size"));
  EXPECT_TRUE(
      contains(SmallFile().set("Kinds", "domain domain foo").refused(), "the kind 'foo' is not known"));
  EXPECT_TRUE(contains(SmallFile().set("NDims", "7").refused(), "NDims is '7'"));
  EXPECT_TRUE(
      contains(SmallFile().set("ElementNumberOfChannels", "4").refused(), "only 1 (grey) and 3 (RGB)"));
}

TEST(MetaimageDamage, MissingFields) {
  for (const char* name : {"NDims", "DimSize", "ElementType"}) {
    EXPECT_TRUE(contains(SmallFile().drop(name).refused(), std::string("the field ") + name + " is missing"));
    EXPECT_TRUE(SmallFile().drop(name).refused().starts_with("sweep.mha: "));
  }
  EXPECT_TRUE(contains(SmallFile().drop("ElementDataFile").refused(), "ends without ElementDataFile"));
  EXPECT_TRUE(contains(SmallFile().drop("ObjectType").refused(), "first line must be 'ObjectType = Image'"));
  EXPECT_TRUE(contains(refusal([] { read_meta(""); }), "ends without ElementDataFile"));
}

TEST(MetaimageDamage, Kinds) {
  EXPECT_TRUE(contains(SmallFile().set("ElementType", "MET_BANANA").refused(), "'MET_BANANA' is not known"));
  EXPECT_TRUE(contains(SmallFile().set("ElementType", "MET_OTHER").refused(), "says there are no pixels"));
  EXPECT_TRUE(contains(SmallFile().set("BinaryData", "False").refused(), "the pixels are text"));
  EXPECT_TRUE(contains(SmallFile().set("CompressedData", "maybe").refused(), "must be True or False"));
  EXPECT_TRUE(contains(SmallFile().set("HeaderSize", "-1").refused(), "HeaderSize is not 0"));
  EXPECT_TRUE(contains(SmallFile().set("ElementDataFile", "../secret.raw").refused(),
                       "not one file in the same folder"));
  EXPECT_TRUE(
      contains(SmallFile().set("ElementDataFile", "LIST").refused(), "not one file in the same folder"));
  EXPECT_TRUE(
      contains(SmallFile().set("ElementDataFile", "gone.raw").refused(), "'gone.raw' is not beside it"));
}

TEST(MetaimageDamage, CompressedPixels) {
  auto s = random_sequence(32, 32, 4, ElementType::uint8, 1, 5);
  s.compressed = true;
  const std::string whole = meta_text(s);
  const std::size_t payload = whole.find("LOCAL\n") + 6;

  EXPECT_TRUE(contains(refusal([&] { read_meta(whole.substr(0, whole.size() - 40)); }), "cut short"));
  std::string flipped = whole;
  flipped[payload + 5] = static_cast<char>(flipped[payload + 5] ^ 0x55);
  EXPECT_TRUE(contains(refusal([&] { read_meta(flipped); }), "the packed pixels"));
  std::string checksum = whole;
  checksum.back() = static_cast<char>(checksum.back() ^ 1);
  EXPECT_TRUE(contains(refusal([&] { read_meta(checksum); }), "incorrect data check"));
  const auto with_frames = [&](const std::string& count) {
    std::string text = whole;
    text.replace(text.find("DimSize = 32 32 4"), 17, "DimSize = 32 32 " + count);
    return refusal([&] { read_meta(text); });
  };
  EXPECT_TRUE(contains(with_frames("3"), "hold more than the 3072 bytes"));
  EXPECT_TRUE(contains(with_frames("5"), "unpack to 4096 bytes and the header declares 5120"));
  EXPECT_TRUE(contains(with_frames("9000"), "cannot hold the 9216000 bytes"));
  EXPECT_TRUE(contains(SmallFile().set("CompressedData", "True").set("CompressedDataSize", "99").refused(),
                       "CompressedDataSize is 99 and 8 bytes are there"));
  EXPECT_TRUE(contains(SmallFile().set("CompressedData", "True").set("CompressedDataSize", "x").refused(),
                       "must be a count of bytes"));
}

TEST(MetaimageDamage, WithoutCompressedDataSizeTheRestIsTaken) {
  auto s = random_sequence(8, 8, 2, ElementType::uint8, 1, 5);
  s.compressed = true;
  std::string text = meta_text(s);
  const std::size_t line = text.find("CompressedDataSize");
  text.erase(line, text.find('\n', line) + 1 - line);
  const auto read = read_meta(text);
  EXPECT_TRUE(same_sequence(s, read.sequence));
  EXPECT_EQ(read.warnings.size(), 1u);
}

TEST(MetaimageDamage, EndlessLinesAndFieldsAreRefused) {
  EXPECT_TRUE(contains(refusal([] { read_meta("ObjectType = Image\n" + std::string(2'000'000, 'x')); }),
                       "has no end"));
  std::string many = "ObjectType = Image\n";
  for (int i = 0; i < 1100; ++i) many += "Field" + std::to_string(i) + " = 1\n";
  EXPECT_TRUE(contains(refusal([&] { read_meta(many); }), "more than 1000 fields"));
}

}  // namespace
}  // namespace sonoband::test
