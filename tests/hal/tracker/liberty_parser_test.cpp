// Frames out of a byte stream that is split, damaged and interrupted in every way.
#include "hal/tracker/liberty_parser.h"

#include <gtest/gtest.h>

#include <random>

#include "hal/tracker/little_endian.h"
#include "tests/hal/tracker/wire_support.h"

namespace sonoband::liberty {
namespace {

using test::Bytes;
using test::operator+;  // NOLINT(misc-unused-using-decls): clang-tidy 14 misses operators

const Duration period = from_seconds(1.0 / 240);

Expectation streaming(Tag tag = Tag::liberty) {
  return {.tag = tag, .stream_body_bytes = tracking_list.body_bytes(), .incomplete_limit = 3 * period};
}

struct Parsed {
  std::vector<std::uint32_t> frames;
  std::vector<std::uint8_t> replies;  // command bytes
  std::size_t bytes = 0;              // in frames handed out
  WireCounters counters;
};

class Feed {
 public:
  explicit Feed(const Expectation& e) : parser(e) {}

  void push(const Bytes& bytes) {
    std::span<const std::uint8_t> rest(bytes);
    while (!rest.empty()) {
      rest = rest.subspan(parser.push(rest, now));
      drain();
    }
  }
  void wait(Duration d) {
    now += d;
    drain();
  }
  void drain() {
    Packet p;
    while (parser.next(p, now)) {
      parsed.bytes += header_bytes + p.body.size();
      if (p.command == stream_command && p.body.size() >= 8)
        parsed.frames.push_back(wire::load_u32(p.body.data() + 4));
      else
        parsed.replies.push_back(p.command);
    }
    parsed.counters = parser.counters();
  }

  StreamParser parser;
  Stamp now{};
  Parsed parsed;
};

Bytes record(std::uint32_t frame, std::uint8_t station = 1) {
  Bytes r = test::example::stream;
  r[2] = station;
  wire::store_u32(r.data() + 12, frame);
  return r;
}

using Frames = std::vector<std::uint32_t>;

TEST(LibertyParser, EveryExample) {
  for (const Bytes& one :
       {test::example::stream, test::example::patriot, test::example::other_list, test::example::poll,
        test::example::error_reply, test::example::stations, test::example::units}) {
    StreamParser parser;
    Packet p;
    EXPECT_EQ(parser.push(one, Stamp(period)), one.size());
    ASSERT_TRUE(parser.next(p, Stamp(period)));
    EXPECT_EQ(static_cast<std::uint16_t>(p.tag), wire::load_u16(one.data()));
    EXPECT_EQ(p.station, one[2]);
    EXPECT_EQ(p.command, one[3]);
    EXPECT_EQ(p.error, one[4]);
    EXPECT_EQ(p.body.size(), one.size() - 8);
    EXPECT_EQ(p.arrived, Stamp(period));
    EXPECT_FALSE(parser.next(p, Stamp(period)));
    EXPECT_EQ(parser.counters().resync_bytes, 0u);
  }
}

TEST(LibertyParser, TwoStationsShareATransfer) {
  Feed f(streaming());
  f.push(record(1, 1) + record(1, 2));
  EXPECT_EQ(f.parsed.frames, (Frames{1, 1}));
}

TEST(LibertyParser, SplitAtEveryOffset) {
  for (std::size_t at = 1; at < 48; ++at) {
    Feed f(streaming());
    const Bytes stream = record(1) + record(2) + record(3);
    f.push(Bytes(stream.begin(), stream.begin() + static_cast<std::ptrdiff_t>(48 + at)));
    EXPECT_EQ(f.parsed.frames, (Frames{1})) << at;
    f.wait(period);
    f.push(Bytes(stream.begin() + static_cast<std::ptrdiff_t>(48 + at), stream.end()));
    EXPECT_EQ(f.parsed.frames, (Frames{1, 2, 3})) << at;
    EXPECT_EQ(f.parsed.counters.resync_bytes, 0u);
  }
}

TEST(LibertyParser, PiecesOfEverySizeGiveTheSame) {
  Bytes stream;
  for (std::uint32_t i = 0; i < 30; ++i) {
    stream = stream + record(i);
    if (i % 7 == 0) stream = stream + test::example::units;
  }
  for (std::size_t piece = 1; piece < 100; ++piece) {
    Feed f(streaming());
    for (std::size_t at = 0; at < stream.size(); at += piece) {
      f.push(Bytes(stream.begin() + static_cast<std::ptrdiff_t>(at),
                   stream.begin() + static_cast<std::ptrdiff_t>(std::min(at + piece, stream.size()))));
    }
    ASSERT_EQ(f.parsed.frames.size(), 30u) << piece;
    EXPECT_EQ(f.parsed.replies.size(), 5u);
    EXPECT_EQ(f.parsed.counters.resync_events, 0u);
  }
}

TEST(LibertyParser, GarbagePrefixOfEveryLength) {
  std::mt19937_64 random(7);
  for (std::size_t n = 1; n <= 1000; n += n < 100 ? 1 : 37) {
    Bytes garbage(n);
    for (auto& b : garbage) b = static_cast<std::uint8_t>(random());
    // Tags, and a header that is good but for what follows it.
    if (n > 70) std::copy_n(test::example::stream.begin(), 8, garbage.begin() + 20);
    if (n > 3) garbage[n - 2] = 0x4c, garbage[n - 1] = 0x59;
    Feed f(streaming());
    f.push(garbage + record(1) + record(2) + record(3));
    EXPECT_EQ(f.parsed.frames, (Frames{1, 2, 3})) << n;
    EXPECT_EQ(f.parsed.counters.resync_bytes, n);
    EXPECT_EQ(f.parsed.counters.resync_events, 1u);
  }
}

TEST(LibertyParser, AfterABadHeaderTwoGoodOnesAreNeeded) {
  Feed f(streaming());
  f.push(test::hex("00") + record(1));
  EXPECT_EQ(f.parsed.frames, Frames{});
  f.push(record(2));
  EXPECT_EQ(f.parsed.frames, (Frames{1, 2}));
}

TEST(LibertyParser, DroppedByteCostsAtMostTwoRecords) {
  for (std::size_t lost = 0; lost < 48; ++lost) {
    Feed f(streaming());
    Bytes second = record(2);
    second.erase(second.begin() + static_cast<std::ptrdiff_t>(lost));
    f.push(record(1) + second + record(3) + record(4) + record(5) + record(6));
    const Frames& got = f.parsed.frames;
    ASSERT_GE(got.size(), 4u) << lost;
    EXPECT_EQ(got.front(), 1u);
    EXPECT_EQ(got.back(), 6u);
    EXPECT_EQ(got[got.size() - 2], 5u);
  }
}

TEST(LibertyParser, FlippedSizeIsNotBelieved) {
  Bytes bad = record(2);
  bad[7] = 0x03;  // 0x328 bytes
  Feed f(streaming());
  f.push(record(1) + bad + record(3) + record(4));
  EXPECT_EQ(f.parsed.frames, (Frames{1, 3, 4}));
  EXPECT_EQ(f.parsed.counters.resync_bytes, 48u);
}

TEST(LibertyParser, WrongListIsAllResync) {
  Feed f(streaming());
  for (int i = 0; i < 10; ++i) f.push(test::example::other_list);
  EXPECT_EQ(f.parsed.frames, Frames{});
  EXPECT_GE(f.parsed.counters.resync_bytes, 10u * 52 - 7);
}

TEST(LibertyParser, OtherTagIsRefusedOnceTheSessionHasOne) {
  Feed f(streaming(Tag::patriot));
  f.push(record(1) + record(2));
  EXPECT_EQ(f.parsed.frames, Frames{});
  f.push(test::example::patriot + test::example::patriot);
  EXPECT_EQ(f.parsed.frames, (Frames{29629, 29629}));
}

TEST(LibertyParser, StationsBeyondTheModelAreRefused) {
  Bytes third = test::example::patriot;
  third[2] = 3;
  Feed patriot(streaming(Tag::patriot));
  patriot.push(third + test::example::patriot + test::example::patriot);
  EXPECT_EQ(patriot.parsed.frames.size(), 2u);

  Feed liberty(streaming());
  liberty.push(record(1, 16) + record(2, 17) + record(3, 0) + record(4, 1) + record(5, 1));
  EXPECT_EQ(liberty.parsed.frames, (Frames{1, 4, 5}));
}

TEST(LibertyParser, IncompleteRecordTimesOut) {
  Feed f(streaming());
  Bytes half = record(2);
  half.resize(30);
  f.push(record(1) + half);
  f.wait(3 * period);
  EXPECT_EQ(f.parsed.counters.truncated, 0u);
  f.wait(period);
  EXPECT_EQ(f.parsed.counters.truncated, 1u);
  EXPECT_EQ(f.parsed.counters.resync_bytes, 30u);
  f.push(record(9) + record(10));
  EXPECT_EQ(f.parsed.frames, (Frames{1, 9, 10}));
}

TEST(LibertyParser, LoneReplyAfterGarbageStandsBySilence) {
  Feed f({});
  f.push(test::ascii("01  12.3 45\r\n") + test::example::units);
  EXPECT_TRUE(f.parsed.replies.empty());
  f.wait(from_seconds(0.2));
  ASSERT_EQ(f.parsed.replies.size(), 1u);
  EXPECT_EQ(f.parsed.replies[0], 'U');
  EXPECT_EQ(f.parsed.counters.truncated, 0u);
}

TEST(LibertyParser, LoneStreamRecordAfterGarbageDoesNot) {
  Feed f(streaming());
  f.push(test::hex("4c 00") + record(1));
  f.wait(4 * period);
  EXPECT_EQ(f.parsed.frames, Frames{});
  EXPECT_EQ(f.parsed.counters.resync_bytes, 50u);
}

TEST(LibertyParser, ErrorTextAndUnknownRepliesDoNotDisturbTheStream) {
  Bytes refused_start = test::example::error_reply;
  refused_start[3] = 'C';  // a text where a record of exact size would be
  const Bytes unknown = test::hex("4c 59 00 7f 00 00 02 00 01 02");
  Feed f(streaming());
  f.push(record(1) + test::example::error_reply + record(2) + refused_start + record(3) + unknown +
         record(4));
  EXPECT_EQ(f.parsed.replies.size(), 2u);
  EXPECT_EQ(f.parsed.counters.resync_bytes, 0u);
  EXPECT_EQ(f.parsed.counters.frames, 7u);
}

TEST(LibertyParser, PushTakesOnlyWhatFits) {
  StreamParser parser;
  const Bytes lots(StreamParser::capacity + 100, 0x4c);
  EXPECT_EQ(parser.push(lots, {}), StreamParser::capacity);
  EXPECT_EQ(parser.push(lots, {}), 0u);
  Packet p;
  EXPECT_FALSE(parser.next(p, {}));
  EXPECT_GE(parser.push(lots, {}), StreamParser::capacity - 1);
}

// Random damage: whatever comes out was in the stream as a whole record, in order.
TEST(LibertyParser, RandomDamageNeverInventsOrReordersRecords) {
  std::mt19937_64 random(11);
  for (int round = 0; round < 300; ++round) {
    Bytes stream;
    for (std::uint32_t i = 0; i < 40; ++i) {
      Bytes r = record(i);
      if (random() % 8 == 0) {
        const std::size_t cut = random() % 48;
        r.erase(r.begin() + static_cast<std::ptrdiff_t>(cut),
                r.begin() + static_cast<std::ptrdiff_t>(std::min<std::size_t>(48, cut + 1 + random() % 20)));
      }
      stream = stream + r;
    }
    stream = stream + record(100) + record(101) + record(102);
    Feed f(streaming());
    f.push(stream);
    const Frames& got = f.parsed.frames;
    ASSERT_GE(got.size(), 3u);
    EXPECT_EQ(got[got.size() - 1], 102u);
    EXPECT_EQ(got[got.size() - 2], 101u);
    EXPECT_EQ(f.parsed.bytes + f.parsed.counters.resync_bytes, stream.size());
  }
}

}  // namespace
}  // namespace sonoband::liberty
