// The running simulated cart, as a client over the library sees it.
#include "app/live_stream.h"

#include <gtest/gtest.h>
#include <igtlClientSocket.h>
#include <igtlImageMessage.h>
#include <igtlStatusMessage.h>
#include <igtlTrackingDataMessage.h>
#include <igtlTransformMessage.h>
#include <unistd.h>

#include <map>
#include <thread>

#include "app/bad_input.h"
#include "app/cart_on_board.h"
#include "app/script/examination.h"
#include "hal/sim/virtual_clock.h"
#include "tests/app/screen/screen_support.h"

namespace sonoband {
namespace {

using Bytes = std::vector<std::uint8_t>;

struct SeenImage {
  int width = 0;
  int height = 0;
  int channels = 0;
  Bytes pixels;
  Eigen::Matrix3d axes;  // of the message's matrix
  Eigen::Vector3d spacing_mm;
  Eigen::Vector3d middle_mm;
  double time_s = 0;
};

// Everything the server has sent until it was closed, or `enough`.
class Client {
 public:
  explicit Client(std::uint16_t port, bool tracking = false) : socket_(igtl::ClientSocket::New()) {
    EXPECT_EQ(socket_->ConnectToServer("127.0.0.1", port), 0);
    socket_->SetReceiveTimeout(5000);
    if (!tracking) return;
    const auto start = igtl::StartTrackingDataMessage::New();
    start->SetDeviceName("");
    start->SetResolution(0);
    start->SetCoordinateName("");
    start->Pack();
    socket_->Send(start->GetPackPointer(), static_cast<igtlUint64>(start->GetPackSize()));
  }
  ~Client() { socket_->CloseSocket(); }

  // False: nothing came in time, or the connection ended.
  bool take_one() {
    const auto head = igtl::MessageHeader::New();
    head->InitPack();
    if (!receive(head->GetPackPointer(), static_cast<std::size_t>(head->GetPackSize()))) return false;
    head->Unpack();
    const std::string type = head->GetDeviceType();
    ++count[type + " " + head->GetDeviceName()];
    if (type == "IMAGE") {
      take_image(*body<igtl::ImageMessage>(head));
    } else if (type == "TRANSFORM") {
      igtl::Matrix4x4 m;
      body<igtl::TransformMessage>(head)->GetMatrix(m);
      for (int r = 0; r < 3; ++r)
        for (int c = 0; c < 4; ++c) last_transform(r, c) = m[r][c];
    } else if (type == "STATUS") {
      const auto status = body<igtl::StatusMessage>(head);
      sentences.push_back({status->GetCode() == igtl::StatusMessage::STATUS_OK, status->GetStatusString()});
    } else {
      socket_->Skip(head->GetBodySizeToRead(), 0);
    }
    return true;
  }

  std::map<std::string, int> count;
  std::map<std::string, SeenImage> newest;                                // by name
  std::vector<std::pair<SeenImage, Eigen::Matrix<double, 3, 4>>> frames;  // with their transform
  std::vector<std::pair<bool, std::string>> sentences;
  Eigen::Matrix<double, 3, 4> last_transform = Eigen::Matrix<double, 3, 4>::Zero();

 private:
  template <class Message>
  typename Message::Pointer body(const igtl::MessageHeader::Pointer& head) {
    auto message = Message::New();
    message->SetMessageHeader(head);
    message->AllocatePack();
    EXPECT_TRUE(receive(message->GetPackBodyPointer(), static_cast<std::size_t>(message->GetPackBodySize())));
    EXPECT_NE(message->Unpack(1) & igtl::MessageHeader::UNPACK_BODY, 0) << "the checksum is wrong";
    return message;
  }
  bool receive(void* to, std::size_t size) {
    return socket_->Receive(to, static_cast<int>(size)) == static_cast<int>(size);
  }
  void take_image(igtl::ImageMessage& message) {
    SeenImage image;
    int size[3];
    message.GetDimensions(size);
    image.width = size[0];
    image.height = size[1];
    image.channels = message.GetNumComponents();
    const auto* pixels = static_cast<const std::uint8_t*>(message.GetScalarPointer());
    image.pixels.assign(pixels, pixels + static_cast<std::size_t>(size[0]) * size[1] * image.channels);
    float spacing[3];
    message.GetSpacing(spacing);
    igtl::Matrix4x4 m;
    message.GetMatrix(m);
    for (int r = 0; r < 3; ++r) {
      for (int c = 0; c < 3; ++c) image.axes(r, c) = m[r][c];
      image.spacing_mm(r) = spacing[r];
      image.middle_mm(r) = m[r][3];
    }
    auto time = igtl::TimeStamp::New();
    message.GetTimeStamp(time);
    image.time_s = time->GetTimeStamp();
    const std::string name = message.GetDeviceName();
    if (name == "Image") frames.emplace_back(image, last_transform);
    newest[name] = std::move(image);
  }

  igtl::ClientSocket::Pointer socket_;
};

exchange::IgtlSettings any_port() {
  exchange::IgtlSettings settings;
  settings.port = 0;
  return settings;
}

template <class Condition>
bool eventually(const Condition& condition) {
  for (int i = 0; i < 15000 && !condition(); ++i) std::this_thread::sleep_for(std::chrono::milliseconds(2));
  return condition();
}

// Through a sweep, in real time: what the client got is what the sweep holds.
TEST(LiveStream, AClientSeesTheFramesThatTheSweepHolds) {
  const auto clock = std::make_shared<SystemClock>();
  Profile profile;
  profile.ring.frames = 200;
  profile.capture.crop_px = {220, 80, 200, 200};
  BoardDevices board = make_sim_board(profile, *clock);
  const auto cart = make_appliance(board, profile, clock);
  auto stream = std::make_unique<LiveStream>(*cart, any_port());
  EXPECT_FALSE(stream->beyond_this_machine());
  Client client(stream->port(), true);
  std::thread reading([&] {
    while (client.take_one()) {
    }
  });
  // Connected, and not a word of his read: he must not hold up anything.
  const Client deaf(stream->port());
  ASSERT_TRUE(eventually([&] { return stream->status().clients == 2; }));
  cart->start();
  const auto wait = [&](double s) { clock->sleep_until(clock->now() + from_seconds(s)); };
  wait(1.0);
  board.foot(true);
  std::optional<Sweep> growing;
  ASSERT_TRUE(eventually([&] { return growing || (growing = cart->take_sweep()); }));
  ASSERT_TRUE(eventually([&] { return growing->view().frames.size() > 40; }));
  board.foot(false);
  wait(0.5);
  cart->stop();
  const Sweep& sweep = *growing;
  stream.reset();
  reading.join();

  EXPECT_GT(client.count["TDATA Tracker"], 10);
  EXPECT_GT(client.count["TRANSFORM ImageToTracker"], 10);
  EXPECT_GT(client.count["TRANSFORM ProbeToTracker"], 10);
  ASSERT_FALSE(client.sentences.empty());
  EXPECT_NE(client.sentences.back().second.find("Research use only"), std::string::npos);
  EXPECT_TRUE(std::any_of(client.sentences.begin(), client.sentences.end(), [](const auto& s) {
    return s.first && s.second.find("recording") != std::string::npos;
  }));
  // The message has the time since 1970 to 0.2 ns; a constant lies between it and the cart's clock.
  int found = 0;
  const auto swept = sweep.view().frames;
  ASSERT_GT(swept.size(), 10u);
  for (const TrackedFrame* f : swept) {
    const std::size_t size = 200 * 200;
    const auto seen = std::find_if(client.frames.begin(), client.frames.end(), [&](const auto& s) {
      Bytes rows;
      for (int y = 0; y < 200; ++y)
        rows.insert(rows.end(), f->bscan.pixels.row(y), f->bscan.pixels.row(y) + 200);
      return s.first.pixels.size() == size && s.first.pixels == rows;
    });
    if (seen == client.frames.end()) continue;
    ++found;
    EXPECT_LT((seen->second.leftCols<3>().leftCols<2>() - f->world_from_image.linear.leftCols<2>()).norm(),
              1e-5);
    EXPECT_LT((seen->second.col(3) - f->world_from_image.translation).norm(), 1e-3);
    const Eigen::Vector3d middle = (f->world_from_image * Point<frame::Image>{{99.5, 99.5, 0}}).v;
    EXPECT_LT((seen->first.middle_mm - middle).norm(), 1e-3);
  }
  // A loaded machine may look too late for some.
  EXPECT_GE(found, static_cast<int>(swept.size()) / 2);
  for (std::size_t i = 1; i < client.frames.size(); ++i)
    EXPECT_GT(client.frames[i].first.time_s, client.frames[i - 1].first.time_s);
}

// A scripted examination: the picture that is written and the picture that is sent are the same.
TEST(LiveStream, TheBandThatIsSentIsTheBandThatIsPainted) {
  const auto clock = std::make_shared<sim::VirtualClock>();
  Profile profile;
  profile.ring.frames = 200;
  BoardDevices board = make_sim_board(profile, *clock);
  const auto cart = make_appliance(board, profile, clock);
  const ClockMember member(*clock);
  exchange::IgtlSettings settings = any_port();
  settings.most_unsent_bytes = std::size_t{1} << 30;
  auto stream = std::make_unique<LiveStream>(*cart, settings);
  cart->start();
  Serial serial;
  ReslicePlane plane;
  const std::filesystem::path out = test::scratch_folder();
  script::Stage stage{*cart,
                      board.foot,
                      board.views,
                      *clock,
                      serial,
                      out,
                      [&](const BandImage& band, const ReslicePlane& p, int layers) {
                        plane = p;
                        stream->show_band(band, p, layers);
                      }};
  script::run(
      script::parse(
          "await live 5\nwait 2\npress\nwait 1\nrelease\nawait review 5\nwait 1\nrender band.png view=level "
          "thickness-mm=6\nwait 0.1\n",
          "test"),
      "test", stage);
  cart->stop();
  // Whoever comes late gets it too.
  Client client(stream->port());
  while (client.newest.count("BandCoverage") == 0 && client.take_one()) {
  }
  ASSERT_EQ(client.newest.count("Band"), 1u);
  const SeenImage& band = client.newest["Band"];
  const exchange::PngPicture written = exchange::read_png(out / "band.png");
  EXPECT_EQ(band.width, written.width);
  EXPECT_EQ(band.height, written.height);
  EXPECT_EQ(band.channels, 1);
  EXPECT_EQ(band.pixels, written.bytes);
  EXPECT_GT(std::count_if(band.pixels.begin(), band.pixels.end(), [](auto p) { return p > 0; }), 1000);
  // Where it lies: the protocol's origin is the middle.
  const Eigen::Vector3d middle = plane.origin.v + plane.pixel_mm * (0.5 * (plane.width - 1) * plane.right.v +
                                                                    0.5 * (plane.height - 1) * plane.down.v);
  EXPECT_LT((band.middle_mm - middle).norm(), 1e-3);
  EXPECT_LT((band.axes.col(0) - plane.right.v).norm(), 1e-6);
  EXPECT_LT((band.axes.col(1) - plane.down.v).norm(), 1e-6);
  EXPECT_NEAR(band.spacing_mm.x(), plane.pixel_mm, 1e-6);
  // Black is not "no data".
  const SeenImage& coverage = client.newest["BandCoverage"];
  ASSERT_EQ(coverage.pixels.size(), band.pixels.size());
  EXPECT_GT(std::count(coverage.pixels.begin(), coverage.pixels.end(), 0), 100);
  for (std::size_t i = 0; i < band.pixels.size(); ++i) {
    if (coverage.pixels[i] == 0) {
      EXPECT_EQ(band.pixels[i], 0);
    }
  }
  std::filesystem::remove_all(out);
}

TEST(LiveStream, TheScreenHandsOverTheBandItShowsAndSaysThatItSends) {
  test::ScreenCartSettings settings;
  std::vector<Bytes> bands;
  settings.screen.on_band = [&](const BandImage& band, const ReslicePlane& plane, int layers) {
    EXPECT_EQ(band.pixels.width(), plane.width);
    EXPECT_GT(layers, 0);
    const exchange::PngPicture picture = exchange::band_png(band);
    bands.push_back(picture.bytes);
  };
  settings.screen.stream = [] { return ui::StreamStatus{true, true, 18944, 2}; };
  test::ScreenCart cart(settings);
  cart.play("wait 2\npress\nwait 1\nrelease\nawait review 5\nwait 0.5\n");
  cart.show("stream");
  cart.loop().listen(cart.clock().now());
  EXPECT_TRUE(cart.has("status/stream"));
  ASSERT_FALSE(bands.empty());
  const auto result = cart.loop().worker().newest();
  EXPECT_EQ(bands.back(), exchange::band_png(result->planar->band).bytes);
}

TEST(LiveStream, TheStatusSaysWhatIsMissing) {
  cart::ApplianceStatus status;
  status.frames.health.state = DeviceState::running;
  status.tracker.health.state = DeviceState::running;
  EXPECT_TRUE(stream_sentence(status).good);
  EXPECT_NE(stream_sentence(status).text.find("Research use only"), std::string::npos);
  status.frozen = true;
  EXPECT_FALSE(stream_sentence(status).good);
  EXPECT_NE(stream_sentence(status).text.find("frozen"), std::string::npos);
  status.frozen = false;
  status.tracker.health.state = DeviceState::absent;
  EXPECT_FALSE(stream_sentence(status).good);
  EXPECT_NE(stream_sentence(status).text.find("tracker: not connected"), std::string::npos);
}

}  // namespace
}  // namespace sonoband
