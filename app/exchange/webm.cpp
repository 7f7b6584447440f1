#include "app/exchange/webm.h"

#include <ebml/EbmlHead.h>
#include <ebml/EbmlSubHead.h>
#include <ebml/EbmlVoid.h>
#include <ebml/IOCallback.h>
#include <matroska/KaxCluster.h>
#include <matroska/KaxClusterData.h>
#include <matroska/KaxCues.h>
#include <matroska/KaxCuesData.h>
#include <matroska/KaxInfo.h>
#include <matroska/KaxInfoData.h>
#include <matroska/KaxSeekHead.h>
#include <matroska/KaxSegment.h>
#include <matroska/KaxTag.h>
#include <matroska/KaxTags.h>
#include <matroska/KaxTrackEntryData.h>
#include <matroska/KaxTrackVideo.h>
#include <matroska/KaxTracks.h>

#include <algorithm>
#include <optional>

namespace sonoband::exchange {
namespace {

using namespace libmatroska;

constexpr std::uint64_t scale_ns = 1'000'000;      // of every time in the file: 1 ms
constexpr std::int64_t longest_cluster_ms = 5000;  // a block's time within its cluster has 16 bits
constexpr std::uint64_t head_room = 160;           // of the table of contents: four entries of some 20 bytes

// The stream as the library wants it. A write that fails leaves its mark in the stream.
class Sink final : public IOCallback {
 public:
  explicit Sink(std::ostream& out) : out_(out) {}
  uint32 read(void*, size_t) override { return 0; }
  void setFilePointer(int64 offset, seek_mode mode) override {
    out_.seekp(offset, mode == seek_beginning ? std::ios::beg
                       : mode == seek_end     ? std::ios::end
                                              : std::ios::cur);
  }
  size_t write(const void* bytes, size_t size) override {
    out_.write(static_cast<const char*>(bytes), static_cast<std::streamsize>(size));
    return size;
  }
  uint64 getFilePointer() override { return static_cast<uint64>(std::max<std::streamoff>(0, out_.tellp())); }
  void close() override {}

 private:
  std::ostream& out_;
};

UTFstring utf(const std::string& text) {
  UTFstring s;
  s.SetUTF8(text);
  return s;
}

template <class Element, class Parent, class Value>
void set(Parent& parent, const Value& value) {
  GetChild<Element>(parent).SetValue(value);
}

}  // namespace

struct WebmWriter::State {
  explicit State(std::ostream& out) : sink(out) {}

  Sink sink;
  KaxSegment segment;
  KaxSeekHead contents;
  EbmlVoid contents_room;
  KaxTrackEntry* track = nullptr;
  KaxCues cues;
  bool any_cue = false;
  std::vector<std::pair<std::string, std::string>> tags;

  // The cluster that is being filled.
  std::unique_ptr<KaxCluster> cluster;
  std::int64_t cluster_ms = 0;
  bool finished = false;

  void write_cluster();
};

void WebmWriter::State::write_cluster() {
  if (!cluster) return;
  cluster->Render(sink, cues);
  KaxCuePoint& point = AddNewChild<KaxCuePoint>(cues);
  set<KaxCueTime>(point, static_cast<uint64>(cluster_ms));
  KaxCueTrackPositions& place = GetChild<KaxCueTrackPositions>(point);
  set<KaxCueTrack>(place, uint64{1});
  set<KaxCueClusterPosition>(place, segment.GetRelativePosition(*cluster));
  any_cue = true;
  cluster.reset();
}

WebmWriter::WebmWriter(std::ostream& out, const WebmTrack& track) : state_(std::make_unique<State>(out)) {
  State& s = *state_;
  s.tags = track.tags;
  EbmlHead head;
  set<EDocType>(head, std::string("webm"));
  set<EDocTypeVersion>(head, uint64{4});
  set<EDocTypeReadVersion>(head, uint64{2});
  head.Render(s.sink, true);
  s.segment.WriteHead(s.sink, 8);
  s.contents_room.SetSize(head_room);
  s.contents_room.Render(s.sink);

  KaxInfo& info = GetChild<KaxInfo>(s.segment);
  set<KaxTimecodeScale>(info, scale_ns);
  set<KaxDuration>(info, static_cast<double>(track.duration_ms));
  set<KaxMuxingApp>(info, utf("libmatroska"));
  set<KaxWritingApp>(info, utf("Sonoband"));
  info.Render(s.sink, true);
  s.contents.IndexThis(info, s.segment);

  KaxTracks& tracks = GetChild<KaxTracks>(s.segment);
  s.track = &GetChild<KaxTrackEntry>(tracks);
  s.track->SetGlobalTimecodeScale(scale_ns);
  set<KaxTrackNumber>(*s.track, uint64{1});
  set<KaxTrackUID>(*s.track, uint64{1});
  set<KaxTrackType>(*s.track, static_cast<uint64>(track_video));
  set<KaxTrackFlagLacing>(*s.track, uint64{0});
  set<KaxCodecID>(*s.track, std::string("V_VP9"));
  KaxTrackVideo& video = GetChild<KaxTrackVideo>(*s.track);
  set<KaxVideoPixelWidth>(video, static_cast<uint64>(track.width));
  set<KaxVideoPixelHeight>(video, static_cast<uint64>(track.height));
  set<KaxVideoDisplayWidth>(video, static_cast<uint64>(track.shown_width));
  set<KaxVideoDisplayHeight>(video, static_cast<uint64>(track.shown_height));
  // BT.709, limited range: what every player takes for granted.
  KaxVideoColour& colour = GetChild<KaxVideoColour>(video);
  set<KaxVideoColourMatrix>(colour, uint64{1});
  set<KaxVideoColourTransferCharacter>(colour, uint64{1});
  set<KaxVideoColourPrimaries>(colour, uint64{1});
  set<KaxVideoColourRange>(colour, uint64{1});
  tracks.Render(s.sink);  // without defaults: the library refuses to write an old one of them
  s.contents.IndexThis(tracks, s.segment);
  s.cues.SetGlobalTimecodeScale(scale_ns);
}

WebmWriter::~WebmWriter() = default;

void WebmWriter::add(std::span<const std::uint8_t> picture, std::int64_t time_ms, bool key) {
  State& s = *state_;
  if (key || (s.cluster && time_ms - s.cluster_ms > longest_cluster_ms)) s.write_cluster();
  if (!s.cluster) {
    s.cluster = std::make_unique<KaxCluster>();
    s.cluster->SetParent(s.segment);
    s.cluster->InitTimecode(static_cast<uint64>(time_ms), scale_ns);
    s.cluster_ms = time_ms;
  }
  KaxSimpleBlock& block = AddNewChild<KaxSimpleBlock>(*s.cluster);
  block.SetParent(*s.cluster);
  // Copied into the buffer, which then belongs to the block.
  auto* buffer =
      new DataBuffer(const_cast<binary*>(picture.data()), static_cast<uint32>(picture.size()), nullptr, true);
  block.AddFrame(*s.track, static_cast<uint64>(time_ms) * scale_ns, *buffer, LACING_NONE);
  block.SetKeyframe(key);
  block.SetDiscardable(false);
}

void WebmWriter::finish() {
  State& s = *state_;
  s.write_cluster();
  if (s.any_cue) {
    s.cues.Render(s.sink);
    s.contents.IndexThis(s.cues, s.segment);
  }
  if (!s.tags.empty()) {
    KaxTags tags;
    KaxTag& tag = GetChild<KaxTag>(tags);
    GetChild<KaxTagTargets>(tag);  // none in it: of the whole file
    for (const auto& [name, text] : s.tags) {
      KaxTagSimple& simple = AddNewChild<KaxTagSimple>(tag);
      set<KaxTagName>(simple, utf(name));
      set<KaxTagString>(simple, utf(text));
    }
    tags.Render(s.sink);
    s.contents.IndexThis(tags, s.segment);
  }
  const uint64 end = s.sink.getFilePointer();
  s.contents_room.ReplaceWith(s.contents, s.sink, true);
  const uint64 body = s.segment.GetElementPosition() + s.segment.HeadSize();
  if (s.segment.ForceSize(end - body)) s.segment.OverwriteHead(s.sink);
  s.sink.setFilePointer(static_cast<int64>(end), seek_beginning);
}

}  // namespace sonoband::exchange
