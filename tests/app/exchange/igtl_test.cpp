// The server as clients over the library see it, and as clients that misbehave do.
#include <arpa/inet.h>
#include <gtest/gtest.h>
#include <igtlClientSocket.h>
#include <igtlImageMessage.h>
#include <igtlStatusMessage.h>
#include <igtlTrackingDataMessage.h>
#include <igtlTransformMessage.h>
#include <sys/socket.h>
#include <unistd.h>

#include <random>
#include <thread>

#include "app/bad_input.h"
#include "app/exchange/igtl_server.h"

namespace sonoband::exchange {
namespace {

template <class Condition>
bool eventually(const Condition& condition) {
  for (int i = 0; i < 2500 && !condition(); ++i) std::this_thread::sleep_for(std::chrono::milliseconds(2));
  return condition();
}

struct Picture {
  Picture() : pixels(31, 17) {
    std::mt19937 random(1);
    for (int i = 0; i < 31 * 17; ++i) pixels.view().data[i] = static_cast<std::uint8_t>(random());
    frame.utc_ns = 1'700'000'000'500'000'000;
    frame.pixels = pixels.view();
    frame.world_from_image.emplace();
    frame.world_from_image->linear << 0, 0, 1, 0.2, 0, 0, 0, 0.1, 0;
    frame.world_from_image->translation = {10, 20, 30};
    frame.tracker_from_probe.emplace();
    frame.tracker_from_probe->translation = {1, 2, 3};
  }
  Pixels pixels;
  IgtlFrame frame;
};

// A client of the library.
class Client {
 public:
  explicit Client(const IgtlServer& server) : socket_(igtl::ClientSocket::New()) {
    EXPECT_EQ(socket_->ConnectToServer("127.0.0.1", server.port()), 0);
    socket_->SetReceiveTimeout(5000);
  }
  ~Client() { socket_->CloseSocket(); }

  // The head of the next message; its type is empty when none came.
  igtl::MessageHeader::Pointer next() {
    auto head = igtl::MessageHeader::New();
    head->InitPack();
    const auto got = socket_->Receive(head->GetPackPointer(), head->GetPackSize());
    if (static_cast<int>(got) != head->GetPackSize()) return nullptr;
    head->Unpack();
    return head;
  }
  template <class Message>
  typename Message::Pointer body(const igtl::MessageHeader::Pointer& head) {
    auto message = Message::New();
    message->SetMessageHeader(head);
    message->AllocatePack();
    socket_->Receive(message->GetPackBodyPointer(), static_cast<int>(message->GetPackBodySize()));
    EXPECT_NE(message->Unpack(1) & igtl::MessageHeader::UNPACK_BODY, 0) << "the checksum is wrong";
    return message;
  }
  void skip(const igtl::MessageHeader::Pointer& head) { socket_->Skip(head->GetBodySizeToRead(), 0); }
  template <class Message>
  void send(Message& message) {
    message.Pack();
    socket_->Send(message.GetPackPointer(), static_cast<igtlUint64>(message.GetPackSize()));
  }

 private:
  igtl::ClientSocket::Pointer socket_;
};

IgtlSettings any_port() {
  IgtlSettings s;
  s.port = 0;
  return s;
}

TEST(Igtl, ClientsGetThePictureAndItsPlace) {
  IgtlServer server(any_port());
  server.set_status(true, "hello");
  Client a(server);
  Client b(server);
  ASSERT_TRUE(eventually([&] { return server.status().clients == 2; }));
  const Picture p;
  server.publish(p.frame);
  for (Client* client : {&a, &b}) {
    auto head = client->next();
    ASSERT_TRUE(head.IsNotNull());
    ASSERT_STREQ(head->GetDeviceType(), "STATUS");
    EXPECT_STREQ(client->body<igtl::StatusMessage>(head)->GetStatusString(), "hello");
    head = client->next();
    ASSERT_STREQ(head->GetDeviceType(), "TRANSFORM");
    EXPECT_STREQ(head->GetDeviceName(), "ImageToTracker");
    auto transform = client->body<igtl::TransformMessage>(head);
    igtl::Matrix4x4 m;
    transform->GetMatrix(m);
    EXPECT_FLOAT_EQ(m[1][0], 0.2F);
    EXPECT_FLOAT_EQ(m[2][1], 0.1F);
    EXPECT_FLOAT_EQ(m[2][3], 30);
    auto time = igtl::TimeStamp::New();
    transform->GetTimeStamp(time);
    EXPECT_NEAR(time->GetTimeStamp(), 1'700'000'000.5, 1e-6);
    head = client->next();
    ASSERT_STREQ(head->GetDeviceType(), "IMAGE");
    const auto image = client->body<igtl::ImageMessage>(head);
    int size[3];
    image->GetDimensions(size);
    EXPECT_EQ(size[0], 31);
    EXPECT_EQ(size[1], 17);
    EXPECT_EQ(size[2], 1);
    float spacing[3];
    image->GetSpacing(spacing);
    EXPECT_FLOAT_EQ(spacing[0], 0.2F);
    EXPECT_FLOAT_EQ(spacing[1], 0.1F);
    image->GetMatrix(m);
    // The middle: 15 pixels of 0.2 mm along world's y, 8 of 0.1 mm along z.
    EXPECT_FLOAT_EQ(m[0][3], 10);
    EXPECT_FLOAT_EQ(m[1][3], 23);
    EXPECT_FLOAT_EQ(m[2][3], 30.8F);
    const auto* got = static_cast<const std::uint8_t*>(image->GetScalarPointer());
    EXPECT_TRUE(std::equal(got, got + 31 * 17, p.pixels.view().data));
    head = client->next();
    ASSERT_STREQ(head->GetDeviceName(), "ProbeToTracker");
    client->skip(head);
  }
}

// Keys are ours alone; whoever listens gets the colours they stand for.
TEST(Igtl, DopplerComesAsColours) {
  IgtlServer server(any_port());
  server.set_status(true, "hello");
  Client client(server);
  ASSERT_TRUE(eventually([&] { return server.status().clients == 1; }));
  Picture p;
  p.frame.kind = PixelKind::doppler;
  server.publish(p.frame);
  client.skip(client.next());  // status
  client.skip(client.next());  // transform
  const auto head = client.next();
  ASSERT_STREQ(head->GetDeviceType(), "IMAGE");
  const auto image = client.body<igtl::ImageMessage>(head);
  ASSERT_EQ(image->GetNumComponents(), 3);
  const std::vector<std::uint8_t> seen = picture_png(p.pixels.view(), PixelKind::doppler).bytes;
  ASSERT_EQ(static_cast<std::size_t>(image->GetImageSize()), seen.size());
  EXPECT_TRUE(
      std::equal(seen.begin(), seen.end(), static_cast<const std::uint8_t*>(image->GetScalarPointer())));
  bool any_colour = false;
  for (std::size_t i = 0; i < seen.size(); i += 3) any_colour = any_colour || seen[i] != seen[i + 2];
  EXPECT_TRUE(any_colour);
}

// The bytes of a published example: "Probe" at (10, 20, 30), unrotated, at 1700000000.5 s.
TEST(Igtl, TransformIsByteForByteTheExample) {
  const IgtlBytes bytes =
      igtl_transform("Probe", 1'700'000'000'500'000'000, Eigen::Matrix3d::Identity(), {10, 20, 30});
  ASSERT_EQ(bytes->size(), 106u);
  const std::vector<std::uint8_t> end(bytes->begin() + 42, bytes->begin() + 58);
  EXPECT_EQ(end, (std::vector<std::uint8_t>{0, 0, 0, 0, 0, 0, 0, 0x30, 0xdc, 0xd2, 0x8e, 0x1f, 0x46, 0xe9,
                                            0xe6, 0xf7}));
}

TEST(Igtl, AFrameWithoutAPlaceGoesNowhere) {
  IgtlServer server(any_port());
  Client client(server);
  ASSERT_TRUE(eventually([&] { return server.status().clients == 1; }));
  Picture p;
  p.frame.world_from_image.reset();
  server.publish(p.frame);
  server.set_status(true, "after it");
  const auto head = client.next();
  ASSERT_TRUE(head.IsNotNull());
  EXPECT_STREQ(head->GetDeviceType(), "STATUS");
}

TEST(Igtl, TrackingDataGoesToThoseWhoAskAsOftenAsTheyAsk) {
  IgtlServer server(any_port());
  Client client(server);
  const auto start = igtl::StartTrackingDataMessage::New();
  start->SetResolution(100);
  client.send(*start);
  ASSERT_TRUE(eventually([&] { return server.status().clients == 1; }));
  std::this_thread::sleep_for(std::chrono::milliseconds(50));
  Picture p;
  int tracking = 0;
  for (int i = 0; i < 10; ++i) {
    p.frame.utc_ns += 33'000'000;
    server.publish(p.frame);
  }
  server.set_status(true, "the end");
  for (;;) {
    const auto head = client.next();
    ASSERT_TRUE(head.IsNotNull());
    const std::string type = head->GetDeviceType();
    if (type == "STATUS") break;
    if (type == "TDATA") {
      ++tracking;
      const auto data = client.body<igtl::TrackingDataMessage>(head);
      ASSERT_EQ(data->GetNumberOfTrackingDataElements(), 1);
      igtl::TrackingDataElement::Pointer element;
      data->GetTrackingDataElement(0, element);
      EXPECT_STREQ(element->GetName(), "Probe");
    } else {
      client.skip(head);
    }
  }
  EXPECT_EQ(tracking, 3);  // at 0, 132 and 264 ms
}

TEST(Igtl, ASlowClientIsDroppedAndTheOthersAreNot) {
  IgtlSettings settings = any_port();
  settings.most_unsent_bytes = 1 << 20;
  IgtlServer server(settings);
  Client slow(server);
  Client quick(server);
  ASSERT_TRUE(eventually([&] { return server.status().clients == 2; }));
  Pixels large(640, 480);
  Picture p;
  p.frame.pixels = large.view();
  int pictures = 0;
  for (int i = 0; i < 200 && server.status().dropped_slow == 0; ++i) {
    server.publish(p.frame);
    for (int k = 0; k < 3; ++k) {
      const auto head = quick.next();
      ASSERT_TRUE(head.IsNotNull());
      pictures += std::string(head->GetDeviceType()) == "IMAGE";
      quick.skip(head);
    }
  }
  EXPECT_TRUE(eventually([&] { return server.status().dropped_slow == 1; }));
  EXPECT_EQ(server.status().clients, 1u);
  EXPECT_GT(pictures, 3);
}

TEST(Igtl, WhoSendsRubbishIsDropped) {
  IgtlServer server(any_port());
  const int s = ::socket(AF_INET, SOCK_STREAM, 0);
  sockaddr_in address{};
  address.sin_family = AF_INET;
  address.sin_port = htons(server.port());
  address.sin_addr.s_addr = htonl(INADDR_LOOPBACK);
  ASSERT_EQ(::connect(s, reinterpret_cast<sockaddr*>(&address), sizeof address), 0);
  const std::string rubbish(200, '\xff');
  ASSERT_GT(::send(s, rubbish.data(), rubbish.size(), MSG_NOSIGNAL), 0);
  EXPECT_TRUE(eventually([&] { return server.status().dropped_broken == 1; }));
  ::close(s);
  EXPECT_EQ(server.status().clients, 0u);
}

TEST(Igtl, APortThatIsTakenIsSaid) {
  IgtlServer server(any_port());
  IgtlSettings same;
  same.port = server.port();
  EXPECT_THROW(IgtlServer{same}, BadInput);
  same.bind = "here";
  EXPECT_THROW(IgtlServer{same}, BadInput);
}

}  // namespace
}  // namespace sonoband::exchange
