#include "app/exchange/sequence_file.h"
#include "app/exchange/file_beside.h"

#include <gtest/gtest.h>
#include <signal.h>
#include <sys/wait.h>
#include <unistd.h>

#include <fstream>

#include "tests/app/exchange/sequence_samples.h"

namespace sonoband::test {
namespace {

using exchange::ElementType;
using exchange::read_sequence;
using exchange::write_sequence;

class SequenceFile : public ::testing::Test {
 protected:
  SequenceFile() {
    const auto* test = ::testing::UnitTest::GetInstance()->current_test_info();
    folder_ = std::filesystem::temp_directory_path() /
              (std::string("sonoband_") + test->name() + "_" + std::to_string(::getpid()));
    std::filesystem::create_directories(folder_);
  }
  ~SequenceFile() override { std::filesystem::remove_all(folder_); }

  int files() const {
    return static_cast<int>(std::distance(std::filesystem::directory_iterator(folder_), {}));
  }

  std::filesystem::path folder_;
};

TEST_F(SequenceFile, EveryExtensionReadsBackTheSame) {
  for (const bool compressed : {false, true})
    for (const char* name : {"a.igs.mha", "b.mhd", "c.igs.nrrd", "d.nhdr", "e.MHA"}) {
      auto s = random_sequence(9, 6, 5, ElementType::uint8, 1, 31);
      s.compressed = compressed;
      write_sequence(s, folder_ / name);
      EXPECT_TRUE(same_sequence(s, read_sequence(folder_ / name).sequence)) << name;
    }
  EXPECT_TRUE(std::filesystem::exists(folder_ / "b.raw"));
  EXPECT_TRUE(std::filesystem::exists(folder_ / "b.zraw"));
}

TEST_F(SequenceFile, ContentDecidesWhateverTheNameIs) {
  const auto s = random_sequence(9, 6, 5, ElementType::uint8, 1, 31);
  write_sequence(s, folder_ / "a.nrrd");
  std::filesystem::rename(folder_ / "a.nrrd", folder_ / "a.mha");
  EXPECT_TRUE(same_sequence(s, read_sequence(folder_ / "a.mha").sequence));
}

TEST_F(SequenceFile, AFailedWriteLeavesTheOldFile) {
  const auto s = random_sequence(9, 6, 5, ElementType::uint8, 1, 31);
  write_sequence(s, folder_ / "a.mha");
  auto bad = random_sequence(9, 6, 5, ElementType::uint8, 1, 32);
  bad.fields = {{"a=b", "c"}};
  EXPECT_NE(refusal([&] { write_sequence(bad, folder_ / "a.mha"); }), "");
  EXPECT_TRUE(same_sequence(s, read_sequence(folder_ / "a.mha").sequence));
  EXPECT_EQ(files(), 1);
}

TEST_F(SequenceFile, ANewFileMayReplaceTheOneItCameFrom) {
  auto s = random_sequence(9, 6, 5, ElementType::uint8, 1, 31);
  write_sequence(s, folder_ / "a.mha");
  auto read = read_sequence(folder_ / "a.mha");
  read.sequence.compressed = true;
  write_sequence(read.sequence, folder_ / "a.mha");
  EXPECT_TRUE(same_sequence(read.sequence, read_sequence(folder_ / "a.mha").sequence));
}

TEST_F(SequenceFile, WhatIsNoSequenceIsRefused) {
  EXPECT_NE(refusal([&] { read_sequence(folder_ / "gone.mha"); }).find("cannot be opened"),
            std::string::npos);
  EXPECT_NE(refusal([&] { read_sequence(folder_); }).find("this is a folder"), std::string::npos);
  std::ofstream(folder_ / "empty.mha").close();
  EXPECT_NE(refusal([&] { read_sequence(folder_ / "empty.mha"); }).find("neither a MetaImage"),
            std::string::npos);
  std::ofstream(folder_ / "video.mha") << "\x1A\x45\xDF\xA3 and so on";
  EXPECT_NE(refusal([&] { read_sequence(folder_ / "video.mha"); }).find("Matroska"), std::string::npos);
  const auto s = random_sequence(2, 2, 1, ElementType::uint8, 1, 1);
  EXPECT_NE(refusal([&] { write_sequence(s, folder_ / "a.mkv"); }).find("'.mkv' is not written"),
            std::string::npos);
  EXPECT_NE(refusal([&] { write_sequence(s, folder_ / "no" / "a.mha"); }).find("cannot be written"),
            std::string::npos);
}

struct Fixture {
  const char* file;
  int width, height, frames, components;
  ElementType type;
  int warnings;
};

class Recordings : public ::testing::TestWithParam<Fixture> {};

// Sizes and counts are those of the recordings' own headers.
TEST_P(Recordings, AreReadAndRoundTrip) {
  SONOBAND_DATA_OR_SKIP(data);
  const Fixture& expected = GetParam();
  const auto read = read_sequence(data / "dev" / expected.file);
  const auto& s = read.sequence;
  EXPECT_EQ(s.width, expected.width);
  EXPECT_EQ(s.height, expected.height);
  EXPECT_EQ(s.frame_count(), expected.frames);
  EXPECT_EQ(s.components, expected.components);
  EXPECT_EQ(s.element_type, expected.type);
  EXPECT_EQ(static_cast<int>(read.warnings.size()), expected.warnings)
      << (read.warnings.empty() ? "" : read.warnings[0]);

  std::ostringstream out;
  exchange::write_metaimage(s, out, "out.mha", out, "");
  std::istringstream in(out.str());
  const auto again = exchange::read_metaimage(in, "out.mha", exchange::default_limits(), nothing_beside);
  EXPECT_TRUE(same_sequence(s, again.sequence));
}

INSTANTIATE_TEST_SUITE_P(
    Dev, Recordings,
    ::testing::Values(
        Fixture{"SpinePhantomFreehand.igs.mha", 820, 616, 21, 1, ElementType::uint8, 0},
        Fixture{"WaterTankBottomTranslationTrackerBuffer-trimmed.igs.mha", 0, 0, 801, 1, ElementType::none,
                0},
        Fixture{"fixtures/BkCurvilinearScanConvertedData.igs.mha", 600, 400, 1, 1, ElementType::uint8, 0},
        Fixture{"fixtures/ColorNrrdSample_vtk9.igs.nrrd", 1152, 648, 1, 3, ElementType::uint8, 0},
        Fixture{"fixtures/NrrdSample_vtk9.igs.nrrd", 256, 256, 1, 1, ElementType::int16, 0},
        Fixture{"fixtures/SegmentationTest_BKMedical_RandomStepperMotionData2_Trimmed_Anonymized.igs.mha",
                640, 480, 6, 1, ElementType::uint8, 0},
        Fixture{"fixtures/SyntheticTrackerBuffer20.igs.mha", 1, 1, 20, 1, ElementType::uint8, 0},
        Fixture{"fixtures/TransformInterpolationTest.igs.mha", 1, 1, 500, 1, ElementType::uint8, 0},
        Fixture{"fixtures/UsSimulatorOutputSpinePhantom2CurvilinearBaselineNoUSCompressed.igs.mha", 1, 1, 15,
                1, ElementType::uint8, 0}));

// Whatever ends the program, however suddenly, leaves no half file and no other name behind.
TEST_F(SequenceFile, AFileThatIsNotWholeHasNoName) {
  const ::pid_t child = ::fork();
  if (child == 0) {
    exchange::FileBeside file(folder_ / "a.mha");
    file.stream() << std::string(1 << 20, 'x') << std::flush;
    ::kill(::getpid(), SIGKILL);
  }
  int status = 0;
  ASSERT_EQ(::waitpid(child, &status, 0), child);
  EXPECT_TRUE(WIFSIGNALED(status));
  EXPECT_EQ(files(), 0);
  {
    exchange::FileBeside file(folder_ / "a.mha");
    file.stream() << "old";
    file.commit();
  }
  exchange::FileBeside file(folder_ / "a.mha");
  file.stream() << "new";
  EXPECT_EQ(std::filesystem::file_size(folder_ / "a.mha"), 3u);
  file.commit();
  std::ifstream in(folder_ / "a.mha");
  std::string text;
  in >> text;
  EXPECT_EQ(text, "new");
  EXPECT_EQ(files(), 1);
}

}  // namespace
}  // namespace sonoband::test
