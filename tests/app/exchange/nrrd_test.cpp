#include <gtest/gtest.h>

#include "tests/app/exchange/sequence_samples.h"
#include "tests/support/support.h"

namespace sonoband::test {
namespace {

using exchange::ElementType;

const std::string small =
    "NRRD0004\n# a comment\ndimension: 3\nencoding: raw\nendian: little\nkinds: domain domain   list\n"
    "sizes: 2 2    2\nspace dimension: 2\nspace directions: (1,0) (0,1) none\nspace origin: (0,0)\n"
    "type: uint8\nultrasound image orientation:=MFA\nultrasound image type:=BRIGHTNESS\n"
    "Seq_Frame0000_Status:=OK\nSeq_Frame0001_Status:=INVALID\nSeq_Frame0001_Timestamp:= 2.5\n"
    "my own:=a := b\n\nabcdefgh";

std::string with(const std::string& part, const std::string& instead) {
  std::string text = small;
  const std::size_t at = text.find(part);
  EXPECT_NE(at, std::string::npos);
  return text.replace(at, part.size(), instead);
}

std::string refused(const std::string& part, const std::string& instead) {
  return refusal([&] { read_nrrd_text(with(part, instead)); });
}

TEST(Nrrd, ReadsASmallGreySequence) {
  const auto read = read_nrrd_text(small);
  const auto& s = read.sequence;
  EXPECT_EQ(s.width, 2);
  EXPECT_EQ(s.height, 2);
  EXPECT_EQ(s.frame_count(), 2);
  EXPECT_EQ(s.image_type, "BRIGHTNESS");
  EXPECT_TRUE(exchange::image_ok(s.frames[0]));
  EXPECT_FALSE(exchange::image_ok(s.frames[1]));
  EXPECT_EQ(exchange::timestamp_s(s.frames[1]), 2.5);
  EXPECT_EQ(*exchange::find_field(s.fields, "my own"), "a := b");
  EXPECT_EQ(s.pixels.bytes()[7], 'h');
  EXPECT_TRUE(read.warnings.empty());
}

TEST(Nrrd, ColourIsTheFirstSize) {
  std::string text = with("kinds: domain domain   list", "kinds: vector domain domain");
  text.replace(text.find("sizes: 2 2    2"), 15, "sizes: 3 2 1");
  text.replace(text.find("space directions: (1,0) (0,1) none"), 34, "space directions: none (1,0) (0,1)");
  text.resize(text.size() - 2);
  const auto s = read_nrrd_text(text).sequence;
  EXPECT_EQ(s.components, 3);
  EXPECT_EQ(s.width, 2);
  EXPECT_EQ(s.height, 1);
  EXPECT_EQ(s.frame_count(), 1);
}

TEST(Nrrd, WhatIsWrittenIsReadTheSame) {
  for (const bool compressed : {false, true})
    for (const int components : {1, 3})
      for (const int frames : {1, 12}) {
        auto s = random_sequence(7, 5, frames, ElementType::int16, components, 21);
        s.compressed = compressed;
        const auto read = read_nrrd_text(nrrd_text(s));
        EXPECT_TRUE(same_sequence(s, read.sequence));
        EXPECT_TRUE(read.warnings.empty());
      }
}

TEST(Nrrd, MetaimageAndBackLosesNothing) {
  auto s = random_sequence(6, 4, 8, ElementType::uint8, 3, 2);
  s.image_type = "RGB_COLOR";
  const auto nrrd = read_nrrd_text(nrrd_text(s)).sequence;
  EXPECT_TRUE(same_sequence(s, read_meta(meta_text(nrrd)).sequence));
}

TEST(Nrrd, TrackerOnlyBecomesOneDummyByteEach) {
  const auto s = random_sequence(0, 0, 9, ElementType::none, 1, 2);
  const auto read = read_nrrd_text(nrrd_text(s)).sequence;
  EXPECT_EQ(read.frame_count(), 9);
  EXPECT_FALSE(read.has_pictures());
  EXPECT_EQ(read.frames[3].fields, s.frames[3].fields);
}

TEST(Nrrd, OrientationIsTurnedToMf) {
  const auto s = read_nrrd_text(with("orientation:=MFA", "orientation:=UN")).sequence;
  const auto bytes = s.pixels.bytes();
  EXPECT_EQ(std::string(bytes.begin(), bytes.end()), "dcbahgfe");
}

TEST(Nrrd, WithoutAnOrientationItIsMfWithAWarning) {
  const auto read = read_nrrd_text(with("ultrasound image orientation:=MFA\n", ""));
  EXPECT_EQ(read.sequence.orientation, "MFA");
  EXPECT_EQ(read.warnings.size(), 1u);
}

TEST(Nrrd, BigEndianSamplesAreTurned) {
  std::string text = with("endian: little", "endian: big");
  text.replace(text.find("type: uint8"), 11, "type: unsigned short");
  text.replace(text.find("sizes: 2 2    2"), 15, "sizes: 2 1 2");
  const auto s = read_nrrd_text(text).sequence;
  const auto bytes = s.pixels.bytes();
  EXPECT_EQ(std::string(bytes.begin(), bytes.end()), "badcfehg");
}

TEST(NrrdDamage, EachKindHasItsSentence) {
  EXPECT_SAYS(refused("dimension: 3\n", ""), "the field 'dimension' is missing");
  EXPECT_SAYS(refused("kinds: domain domain   list\n", ""), "the field 'kinds' is missing");
  EXPECT_SAYS(refused("sizes: 2 2    2\n", ""), "the field 'sizes' is missing");
  EXPECT_SAYS(refused("type: uint8\n", ""), "the field 'type' is missing");
  EXPECT_SAYS(refused("encoding: raw\n", ""), "the field 'encoding' is missing");
  EXPECT_SAYS(refused("encoding: raw", "encoding: bz2"), "the encoding 'bz2' is not read");
  EXPECT_SAYS(refused("encoding: raw", "encoding: gz"), "the packed pixels");
  EXPECT_SAYS(refused("endian: little", "endian: middle"), "endian is 'middle'");
  EXPECT_SAYS(refused("type: uint8", "type: block"), "the type 'block' is not known");
  EXPECT_SAYS(refused("sizes: 2 2    2", "sizes: 2 2"), "dimension is 3 but there are 2 sizes");
  EXPECT_SAYS(refused("sizes: 2 2    2", "sizes: 2 0 2"), "'0', which is no size above 0");
  EXPECT_SAYS(refused("domain   list", "domain   banana"), "the kind 'banana' is not known");
  EXPECT_SAYS(refused("kinds: domain domain   list", "kinds: list domain domain"), "not the last size");
  EXPECT_SAYS(refused("abcdefgh", "abcd"), "cut short");
  EXPECT_SAYS(refused("my own:=a := b\n\nabcdefgh", ""), "ends without its blank line");
  EXPECT_SAYS(refused("NRRD0004", "NRRD0009"), "this is no NRRD");
  EXPECT_SAYS(refused("type: uint8", "type: uint8\nbyte skip: 5"), "byte skip is not 0");
  EXPECT_SAYS(refused("type: uint8", "type: uint8\ndata file: gone.raw"), "'gone.raw' is not beside it");
  EXPECT_SAYS(refused("type: uint8", "type: uint8\ndata file: ../x.raw"), "not one file in the same folder");
  EXPECT_SAYS(refused("type: uint8", "type: int16\nnote:=1").append(""), "cut short");
}

TEST(NrrdDamage, FieldsThatWouldReadBackOtherwiseAreNotWritten) {
  auto s = random_sequence(2, 2, 2, ElementType::uint8, 1, 1);
  for (const char* name : {"a:=b", "type: x", "#note", "ultrasound image type", "Seq_Frame0000_X", "x:"}) {
    s.fields = {{name, "value"}};
    EXPECT_SAYS(refusal([&] { nrrd_text(s); }), name);
  }
}

}  // namespace
}  // namespace sonoband::test
