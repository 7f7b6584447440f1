// DICOM as others see it: dciodvfy of dicom3tools judges the files; DCMTK's storescp and Orthanc receive
// them, and what they give back is compared pixel by pixel.
#include <arpa/inet.h>
#include <dcmtk/config/osconfig.h>
#include <dcmtk/dcmdata/dctk.h>
#include <sys/socket.h>
#include <unistd.h>

#include <cmath>
#include <fstream>
#include <nlohmann/json.hpp>
#include <random>

#include "app/exam/exam_writer.h"
#include "app/exam/sweep_loader.h"
#include "app/exchange/dicom.h"
#include "core/image/doppler.h"
#include "tests/support/support.h"
#include "tests/tools/orthanc.h"
#include "tests/tools/processes.h"
#include "tests/tools/tool_runner.h"

namespace sonoband::test {
namespace {

namespace fs = std::filesystem;

struct Read {
  std::string sop_class;
  std::string instance;
  std::string patient;
  std::string study;
  int width = 0;
  int height = 0;
  int frames = 1;
  int samples = 0;
  double x_mm = 0;
  std::string times;
  std::string comments;
  std::vector<std::uint8_t> pixels;
};

Read read_dicom(const fs::path& path) {
  DcmFileFormat file;
  Read r;
  if (file.loadFile(path.c_str()).bad()) return r;
  DcmDataset& d = *file.getDataset();
  const auto text = [&](const DcmTagKey& tag) {
    OFString value;
    d.findAndGetOFStringArray(tag, value);
    return std::string(value.c_str());
  };
  const auto number = [&](const DcmTagKey& tag) {
    Uint16 value = 0;
    d.findAndGetUint16(tag, value);
    return int{value};
  };
  r.sop_class = text(DCM_SOPClassUID);
  r.instance = text(DCM_SOPInstanceUID);
  r.patient = text(DCM_PatientName);
  r.study = text(DCM_StudyInstanceUID);
  r.comments = text(DCM_ImageComments);
  r.times = text(DCM_FrameTimeVector);
  r.width = number(DCM_Columns);
  r.height = number(DCM_Rows);
  r.samples = number(DCM_SamplesPerPixel);
  if (const std::string n = text(DCM_NumberOfFrames); !n.empty()) r.frames = std::stoi(n);
  DcmItem* region = nullptr;
  Float64 delta = 0;
  if (d.findAndGetSequenceItem(DCM_SequenceOfUltrasoundRegions, region).good() &&
      region->findAndGetFloat64(DCM_PhysicalDeltaX, delta).good())
    r.x_mm = 10 * delta;
  const Uint8* bytes = nullptr;
  unsigned long count = 0;
  if (d.findAndGetUint8Array(DCM_PixelData, bytes, &count).good()) {
    r.pixels.assign(bytes, bytes + count);
    // An odd number of bytes is padded.
    r.pixels.resize(static_cast<std::size_t>(r.width) * r.height * r.frames * r.samples);
  }
  return r;
}

std::vector<fs::path> files_in(const fs::path& folder) {
  std::vector<fs::path> files;
  for (const auto& e : fs::directory_iterator(folder))
    if (e.is_regular_file()) files.push_back(e.path());
  std::sort(files.begin(), files.end());
  return files;
}

class Dicom : public ToolTest {
 protected:
  // Two sweeps (grey; Doppler) of noise, one snapshot, a label.
  Dicom() {
    std::mt19937_64 random(3);
    exam::ExamWriter writer = exam::ExamWriter::create(file, "20260102-030405-d1c0");
    writer.set_label("Grace^Hopper");
    for (int s = 1; s <= 2; ++s) {
      exam::SweepSetup setup;
      setup.width = 37;
      setup.height = 21;
      setup.kind = s == 1 ? PixelKind::grey : PixelKind::doppler;
      setup.probe_from_image.emplace();
      setup.probe_from_image->linear << 0.12, 0, 0, 0, 0.25, 0, 0, 0, 1;
      setup.pressed_utc_ns = 1'767'323'045'000'000'000 + s * 60'000'000'000;
      setup.mask = Pixels(37, 21);
      for (int y = 2; y < 19; ++y)
        for (int x = 3; x < 30; ++x) setup.mask.view()(x, y) = 1;
      writer.begin_sweep(s, setup);
      std::vector<Pixels> pictures;
      std::vector<exam::FrameRecord> frames;
      for (int i = 0; i < 5; ++i) {
        pictures.emplace_back(37, 21);
        for (int k = 0; k < 37 * 21; ++k)
          pictures.back().view().data[k] = static_cast<std::uint8_t>(random());
        if (s == 1)
          grey.insert(grey.end(), pictures.back().view().data, pictures.back().view().data + 37 * 21);
      }
      for (int i = 0; i < 5; ++i) {
        exam::FrameRecord f;
        f.pixels = pictures[static_cast<std::size_t>(i)].view();
        f.kind = setup.kind;
        f.number = i;
        f.captured = Stamp(std::chrono::milliseconds(5000 + (i == 4 ? 200 : 33 * i)));
        f.pose_status = PoseStatus::gap;
        frames.push_back(f);
      }
      writer.append(s, frames, {});
      writer.end_sweep(s, 5, {});
    }
    exchange::PngPicture shot{
        .width = 8, .height = 4, .channels = 3, .bytes = {}, .pixel_mm = 0.1, .texts = {}};
    for (int i = 0; i < 96; ++i) shot.bytes.push_back(static_cast<std::uint8_t>(i * 5));
    snapshot = shot.bytes;
    exchange::write_png(shot, path("shot.png"));
    std::ifstream in(path("shot.png"), std::ios::binary);
    const std::string png{std::istreambuf_iterator<char>(in), {}};
    exam::ReviewObject o{.object = "s1",
                         .kind = exam::ReviewKind::snapshot,
                         .json = "{\"band\":{\"thickness_mm\":14}}",
                         .png = {}};
    o.png.assign(png.begin(), png.end());
    writer.add_review(o);
    writer.close();
  }

  std::string file = path("20260102-030405-d1c0.exam");
  std::vector<std::uint8_t> grey;
  std::vector<std::uint8_t> snapshot;
};

TEST_F(Dicom, UidsAreNumbersOf128Bits) {
  const std::string uid = exchange::dicom_uid("abc");
  EXPECT_TRUE(uid.starts_with("2.25."));
  EXPECT_LE(uid.size(), 64u);
  EXPECT_EQ(uid, exchange::dicom_uid("abc"));
  EXPECT_NE(uid, exchange::dicom_uid("abd"));
  // Back to bits: version 8, variant 10.
  __extension__ using Number = unsigned __int128;
  Number value = 0;
  for (const char c : uid.substr(5)) value = value * 10 + static_cast<unsigned>(c - '0');
  EXPECT_EQ(static_cast<unsigned>(value >> 76) & 0xfU, 8U);
  EXPECT_EQ(static_cast<unsigned>(value >> 62) & 0x3U, 2U);
}

TEST_F(Dicom, ObjectsHoldThePixelsAndPassTheJudgeOfObjects) {
  const ToolRun run = run_tool({"export", file, "--to", path("out"), "--format", "dicom"});
  ASSERT_EQ(run.exit_code, 0) << run.err;
  const std::vector<fs::path> files = files_in(path("out"));
  ASSERT_EQ(files.size(), 3u);
  for (const fs::path& f : files) {
    EXPECT_EQ(fs::status(f).permissions(), fs::perms::owner_read | fs::perms::owner_write);
    const Output judged = shell("dciodvfy " + f.string());
    EXPECT_EQ(judged.text.find("Error"), std::string::npos) << f << "\n" << judged.text;
    EXPECT_TRUE(judged.text.find("SCImage") != std::string::npos ||
                judged.text.find("USMultiFrameImage") != std::string::npos)
        << judged.text;
    std::ifstream in(f, std::ios::binary);
    const std::string bytes{std::istreambuf_iterator<char>(in), {}};
    EXPECT_EQ(bytes.find("Hopper"), std::string::npos);
  }
  const Read shot = read_dicom(files[0]);
  EXPECT_EQ(shot.sop_class, UID_SecondaryCaptureImageStorage);
  EXPECT_EQ(shot.pixels, snapshot);
  const Read cine = read_dicom(files[1]);
  EXPECT_EQ(cine.sop_class, UID_UltrasoundMultiframeImageStorage);
  EXPECT_EQ(cine.frames, 5);
  EXPECT_EQ(cine.samples, 1);
  EXPECT_EQ(cine.pixels, grey);
  EXPECT_NEAR(cine.x_mm, 0.12, 1e-12);
  EXPECT_EQ(cine.times, "0\\33.0\\33.0\\33.0\\101.0");
  EXPECT_NE(cine.comments.find("Research use only"), std::string::npos);
  EXPECT_EQ(cine.study, shot.study);
  EXPECT_EQ(cine.patient, "");
  const Read doppler = read_dicom(files[2]);
  EXPECT_EQ(doppler.samples, 3);
  EXPECT_EQ(doppler.frames, 5);
  // Once more: the same objects.
  ASSERT_EQ(run_tool({"export", file, "--to", path("again"), "--format", "dicom"}).exit_code, 0);
  EXPECT_EQ(read_dicom(files_in(path("again"))[1]).instance, cine.instance);
  // The label goes along only when asked for.
  ASSERT_EQ(run_tool({"export", file, "--to", path("named"), "--format", "dicom", "--with-label"}).exit_code,
            0);
  EXPECT_EQ(read_dicom(files_in(path("named"))[1]).patient, "Grace Hopper");
}

TEST_F(Dicom, WhatCouldNotBeSentWaitsAndGoesLater) {
  const std::uint16_t port = free_port();
  const std::string peer = "ARCHIVE@127.0.0.1:" + std::to_string(port);
  const ToolRun down = run_tool({"send", file, "--dicom", peer, "--outbox", path("outbox")});
  EXPECT_EQ(down.exit_code, 1);
  EXPECT_NE(down.out.find("0 sent, 3 waiting"), std::string::npos) << down.out;
  EXPECT_NE(down.err.find("no association"), std::string::npos) << down.err;
  fs::create_directory(path("got"));
  {
    const Server archive({"storescp", "-od", path("got"), "--aetitle", "ARCHIVE", std::to_string(port)}, port,
                         path("storescp.log"));
    ASSERT_TRUE(archive.up());
    const ToolRun later = run_tool({"send", "--waiting", "--outbox", path("outbox")});
    EXPECT_EQ(later.exit_code, 0) << later.err;
    EXPECT_NE(later.out.find("3 sent, 0 waiting"), std::string::npos) << later.out;
  }
  const std::vector<fs::path> got = files_in(path("got"));
  ASSERT_EQ(got.size(), 3u);
  int same = 0;
  for (const fs::path& f : got) {
    const Read r = read_dicom(f);
    same += r.pixels == grey || r.pixels == snapshot;
  }
  EXPECT_EQ(same, 2);  // and the one in Doppler's colours
  for (const auto& e : fs::directory_iterator(path("outbox")))
    EXPECT_NE(e.path().extension(), ".dcm") << "left behind: " << e.path();
  EXPECT_EQ(run_tool({"send", file, "--dicom", "nobody", "--outbox", path("outbox")}).exit_code, 1);
  EXPECT_EQ(run_tool({"send"}).exit_code, 2);
}

TEST_F(Dicom, GoesThroughTlsOnlyToWhomItTrusts) {
  for (const std::string name : {"archive", "stranger"})
    ASSERT_EQ(shell("openssl req -x509 -newkey rsa:2048 -nodes -days 2 -subj /CN=localhost -keyout " +
                    path(name + ".key") + " -out " + path(name + ".pem"))
                  .exit_code,
              0);
  const std::uint16_t port = free_port();
  fs::create_directory(path("got"));
  const Server archive({"storescp", "-od", path("got"), "+tls", path("archive.key"), path("archive.pem"),
                        "-ic", std::to_string(port)},
                       port, path("storescp.log"));
  ASSERT_TRUE(archive.up());
  const std::string peer = "STORESCP@127.0.0.1:" + std::to_string(port);
  const ToolRun distrusted =
      run_tool({"send", file, "--dicom", peer, "--outbox", path("a"), "--tls", path("stranger.pem")});
  EXPECT_EQ(distrusted.exit_code, 1);
  EXPECT_TRUE(files_in(path("got")).empty());
  const ToolRun plain = run_tool({"send", file, "--dicom", peer, "--outbox", path("b")});
  EXPECT_EQ(plain.exit_code, 1);
  const ToolRun trusted =
      run_tool({"send", file, "--dicom", peer, "--outbox", path("c"), "--tls", path("archive.pem")});
  EXPECT_EQ(trusted.exit_code, 0) << trusted.err;
  EXPECT_EQ(files_in(path("got")).size(), 3u);
}

TEST_F(Dicom, TheSpineRecordingComesBackFromOrthancAsTheSamePixels) {
  SONOBAND_DATA_OR_SKIP(data);
  const ToolRun in = run_tool(
      {"import", (data / "dev/SpinePhantomFreehand.igs.mha").string(), "--into", path("exams"),
       "--calibration", (data / "config/PlusDeviceSet_SpinePhantomFreehandReconstructionOnly.xml").string()});
  ASSERT_EQ(in.exit_code, 0) << in.err;
  const std::string exam = in.out.substr(0, in.out.find('\n'));

  const Orthanc orthanc(path("orthanc"));
  ASSERT_TRUE(orthanc.up());
  const ToolRun sent = run_tool({"send", exam, "--dicom", orthanc.peer(), "--outbox", path("outbox")});
  ASSERT_EQ(sent.exit_code, 0) << sent.err;
  const auto instances = nlohmann::json::parse(orthanc.http("GET", "/instances"), nullptr, false);
  ASSERT_EQ(instances.size(), 1u);
  std::ofstream(path("back.dcm"), std::ios::binary)
      << orthanc.http("GET", "/instances/" + instances[0].get<std::string>() + "/file");
  const Read back = read_dicom(path("back.dcm"));
  EXPECT_EQ(back.sop_class, UID_UltrasoundMultiframeImageStorage);

  exam::SweepLoader sweep(exam, 1);
  sweep.wait();
  ASSERT_EQ(back.frames, sweep.total());
  ASSERT_EQ(back.width, 820);
  const std::size_t size = static_cast<std::size_t>(back.width) * back.height;
  for (std::int64_t i = 0; i < sweep.total(); ++i) {
    const ConstPixels picture = sweep.frame(i).bscan.pixels;
    ASSERT_TRUE(std::equal(picture.data, picture.data + size,
                           back.pixels.data() + size * static_cast<std::size_t>(i)))
        << "frame " << i;
  }
  const Eigen::Matrix3d linear = sweep.setup().probe_from_image->linear;
  EXPECT_NEAR(back.x_mm, linear.col(0).norm(), 1e-12);
}

}  // namespace
}  // namespace sonoband::test
