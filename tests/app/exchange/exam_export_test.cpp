// An exam as files of every format: which, that a stop leaves whole ones only, and that the patient's label
// goes along when asked for and else not.
#include "app/exchange/exam_export.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <fstream>
#include <iterator>

#include "app/bad_input.h"
#include "app/exam/exam_reader.h"
#include "app/exam/exam_writer.h"
#include "app/exchange/sequence_file.h"
#include "tests/app/exam/exam_support.h"

namespace sonoband::exchange {
namespace {

namespace fs = std::filesystem;
using exam::test::TemporaryFolder;

constexpr int width = 64;
constexpr int height = 48;

// Two sweeps of 30 frames with places in space, right angles and one scale; the second has not ended.
fs::path make_exam(const fs::path& folder, PixelKind kind = PixelKind::grey) {
  fs::path file = folder / "20260102-030405-beef.exam";
  exam::ExamWriter writer = exam::ExamWriter::create(file, "20260102-030405-beef");
  writer.set_label("Somebody");
  exam::SweepSetup setup;
  setup.width = width;
  setup.height = height;
  setup.kind = kind;
  setup.probe_from_image.emplace();
  setup.probe_from_image->linear = Eigen::Matrix3d::Identity() * 0.1;
  Pixels picture(width, height);
  for (int sweep = 1; sweep <= 2; ++sweep) {
    writer.begin_sweep(sweep, setup);
    for (int i = 0; i < 30; ++i) {
      exam::test::paint(i, static_cast<std::uint64_t>(sweep), picture.view());
      exam::FrameRecord f = exam::test::record(i, static_cast<std::uint64_t>(sweep), picture.view());
      f.kind = kind;
      f.world_from_image.linear = Eigen::Matrix3d::Identity() * 0.1;
      f.world_from_image.translation = {0, 0, 0.3 * i};
      writer.append(sweep, {{f}}, {});
    }
    if (sweep == 1) writer.end_sweep(sweep, 30, {});
  }
  writer.add_review({.object = "sweep1/landmark-1",
                     .kind = exam::ReviewKind::landmark,
                     .json = R"({"label":"apex","position_mm":[1,2,3]})",
                     .png = {}});
  writer.close();
  return file;
}

std::vector<std::string> names_in(const fs::path& folder) {
  std::vector<std::string> names;
  for (const fs::directory_entry& e : fs::directory_iterator(folder)) names.push_back(e.path().filename());
  std::sort(names.begin(), names.end());
  return names;
}

std::string all_of(const fs::path& file) {
  std::ifstream in(file, std::ios::binary);
  return {std::istreambuf_iterator<char>(in), {}};
}

TEST(ExamExport, EveryFormatIsWrittenAndNamed) {
  const TemporaryFolder folder;
  const fs::path exam = make_exam(folder.path());
  const std::vector<std::pair<ExportFormat, std::size_t>> formats = {
      {ExportFormat::mha, 4},  {ExportFormat::nrrd, 4},  {ExportFormat::sx, 2},   {ExportFormat::sw, 2},
      {ExportFormat::mhd, 4},  {ExportFormat::dicom, 2}, {ExportFormat::png, 60}, {ExportFormat::webm, 2},
      {ExportFormat::nhdr, 4}, {ExportFormat::review, 2}};
  for (const auto& [format, count] : formats) {
    ExamExport what;
    what.to = folder.path() / std::to_string(static_cast<int>(format));
    what.format = format;
    std::vector<int> told;
    const ExportedExam made =
        export_exam(exam, what, [&](int permille) { return told.push_back(permille), true; });
    EXPECT_EQ(made.files.size(), count) << static_cast<int>(format);
    EXPECT_TRUE(made.damage.empty());
    for (const fs::path& f : made.files) EXPECT_GT(fs::file_size(f), 0u) << f;
    for (const std::string& name : names_in(what.to))
      EXPECT_EQ(name.find("unfinished"), std::string::npos) << name;
    EXPECT_TRUE(std::is_sorted(told.begin(), told.end())) << static_cast<int>(format);
    if (format == ExportFormat::review) continue;
    ASSERT_FALSE(told.empty());
    EXPECT_LE(told.back(), 1000);
    EXPECT_GT(told.back(), 700);
    // What was still growing is said.
    EXPECT_TRUE(std::any_of(made.warnings.begin(), made.warnings.end(), [](const std::string& w) {
      return w.find("sweep2: it is still being recorded") != std::string::npos;
    }));
  }
  EXPECT_EQ(read_sequence(folder.path() / "0/20260102-030405-beef-sweep2.igs.mha").sequence.frame_count(),
            30);
}

TEST(ExamExport, OneSweepOfTwo) {
  const TemporaryFolder folder;
  const fs::path exam = make_exam(folder.path());
  ExamExport what;
  what.to = folder.path() / "out";
  what.sweep = 1;
  const ExportedExam made = export_exam(exam, what);
  EXPECT_TRUE(made.warnings.empty());
  EXPECT_EQ(names_in(what.to), (std::vector<std::string>{"20260102-030405-beef-sweep1.igs.mha",
                                                         "20260102-030405-beef-sweep1.xml"}));
  what.sweep = 3;
  EXPECT_THROW(export_exam(exam, what), BadInput);
}

TEST(ExamExport, TheLabelGoesAlongOnlyWhenAskedForAndOnlyInDicom) {
  const TemporaryFolder folder;
  const fs::path exam = make_exam(folder.path());
  for (const bool with_label : {false, true}) {
    for (int format = 0; format <= static_cast<int>(ExportFormat::review); ++format) {
      ExamExport what;
      what.to = folder.path() / (std::to_string(with_label) + std::to_string(format));
      what.format = static_cast<ExportFormat>(format);
      what.with_label = with_label;
      for (const fs::path& f : export_exam(exam, what).files)
        EXPECT_EQ(all_of(f).find("Somebody") != std::string::npos,
                  with_label && what.format == ExportFormat::dicom)
            << f;
    }
  }
}

TEST(ExamExport, AStopAtAnyMomentLeavesWholeFilesOnly) {
  const TemporaryFolder folder;
  const fs::path exam = make_exam(folder.path());
  for (int format = 0; format < static_cast<int>(ExportFormat::review); ++format) {
    ExamExport what;
    what.format = static_cast<ExportFormat>(format);
    what.to = folder.path() / ("whole" + std::to_string(format));
    int questions = 0;
    const ExportedExam whole = export_exam(exam, what, [&](int) { return ++questions, true; });
    ASSERT_GT(questions, 4) << format;
    for (int stop_at = 1; stop_at <= questions; stop_at += std::max(1, questions / 5)) {
      ExamExport again = what;
      again.to = folder.path() / (std::to_string(format) + "-" + std::to_string(stop_at));
      int asked = 0;
      EXPECT_THROW(export_exam(exam, again, [&](int) { return ++asked < stop_at; }), BadInput) << format;
      EXPECT_EQ(asked, stop_at) << "the work went on after the stop, format " << format;
      for (const std::string& name : names_in(again.to))
        EXPECT_EQ(fs::file_size(again.to / name), fs::file_size(what.to / name)) << name;
    }
  }
}

// A Doppler sweep's pictures are as people see them.
TEST(ExamExport, DopplerIsColourWherePeopleLookAtIt) {
  const TemporaryFolder folder;
  ExamExport what;
  what.to = folder.path() / "out";
  what.format = ExportFormat::png;
  const ExportedExam made = export_exam(make_exam(folder.path(), PixelKind::doppler), what);
  ASSERT_FALSE(made.files.empty());
  EXPECT_EQ(all_of(made.files.front())[25], 2) << "PNG's colour type: true colour";
}

}  // namespace
}  // namespace sonoband::exchange
