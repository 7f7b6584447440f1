#include "app/exam/journal.h"

#include <algorithm>
#include <array>
#include <fstream>
#include <vector>

namespace sonoband::exam {
namespace {

constexpr std::size_t head_bytes = 32;
constexpr std::size_t page_head_bytes = 24;

std::uint32_t big(const std::uint8_t* p) {
  return std::uint32_t{p[0]} << 24 | std::uint32_t{p[1]} << 16 | std::uint32_t{p[2]} << 8 | p[3];
}
std::uint32_t little(const std::uint8_t* p) {
  return std::uint32_t{p[3]} << 24 | std::uint32_t{p[2]} << 16 | std::uint32_t{p[1]} << 8 | p[0];
}

struct Sum {
  std::uint32_t a = 0;
  std::uint32_t b = 0;
  bool operator==(const Sum&) const = default;
};

// `count` is a multiple of 8.
Sum add(Sum s, const std::uint8_t* p, std::size_t count, bool big_endian) {
  for (std::size_t i = 0; i < count; i += 8) {
    s.a += (big_endian ? big(p + i) : little(p + i)) + s.b;
    s.b += (big_endian ? big(p + i + 4) : little(p + i + 4)) + s.a;
  }
  return s;
}

}  // namespace

JournalState journal_state(const std::filesystem::path& exam) {
  JournalState state;
  std::filesystem::path journal = exam;
  journal += "-wal";
  std::ifstream in(journal, std::ios::binary | std::ios::ate);
  if (!in) return state;
  state.bytes = std::max<std::int64_t>(in.tellg(), 0);
  in.seekg(0);
  std::array<std::uint8_t, head_bytes> head{};
  if (!in.read(reinterpret_cast<char*>(head.data()), head_bytes)) {
    state.torn = state.bytes > 0;
    return state;
  }
  const bool big_endian = (big(head.data()) & 1) != 0;
  const std::size_t page_bytes = big(head.data() + 8);
  Sum sum = add({}, head.data(), 24, big_endian);
  const bool head_whole = (big(head.data()) & ~1U) == 0x377f0682U && page_bytes >= 512 &&
                          page_bytes <= 65536 && (page_bytes & (page_bytes - 1)) == 0 &&
                          sum == Sum{big(head.data() + 24), big(head.data() + 28)};
  if (!head_whole) {
    // The head is written and synced before any page counts.
    state.damaged = state.bytes > static_cast<std::int64_t>(head_bytes + page_head_bytes + 512);
    state.torn = !state.damaged;
    return state;
  }
  std::vector<std::uint8_t> frame(page_head_bytes + page_bytes);
  bool chain = true;
  int commits_behind = 0;
  std::uint32_t last_commit_page = 0;  // of the frame before, when that was a commit; pages count from 1
  bool pages_behind = false;
  while (in.read(reinterpret_cast<char*>(frame.data()), static_cast<std::streamsize>(frame.size()))) {
    const bool this_journal = std::equal(head.begin() + 16, head.begin() + 24, frame.begin() + 8);
    const bool commit = big(frame.data() + 4) != 0;
    if (chain) {
      sum = add(sum, frame.data(), 8, big_endian);
      sum = add(sum, frame.data() + page_head_bytes, page_bytes, big_endian);
      chain = this_journal && sum == Sum{big(frame.data() + 16), big(frame.data() + 20)};
      if (chain) {
        pages_behind = !commit;
        if (commit) ++state.commits;
        last_commit_page = commit ? big(frame.data()) : 0;
        continue;
      }
    }
    if (this_journal) {
      pages_behind = true;
      // On disks that may tear a neighbouring sector, SQLite fills up by repeating the commit's page, and
      // does not wait for the end of that.
      const std::uint32_t page = big(frame.data());
      if (commit && page != last_commit_page) ++commits_behind;
      last_commit_page = commit ? page : 0;
    }
  }
  // Each commit is synced before the next begins: with two behind the break, the break was in synced pages.
  state.damaged = commits_behind >= 2;
  state.torn = pages_behind && !state.damaged;
  return state;
}

}  // namespace sonoband::exam
