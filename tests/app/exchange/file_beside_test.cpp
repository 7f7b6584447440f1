// Files on disks that are full, read-only, formatted as FAT or slow: what is said, and that no half file
// stays.
#include "app/exchange/file_beside.h"

#include <gtest/gtest.h>
#include <sys/mount.h>
#include <sys/resource.h>

#include <cerrno>
#include <csignal>
#include <iterator>
#include <vector>

#include "app/bad_input.h"
#include "tests/app/exam/exam_support.h"

namespace sonoband::exchange {
namespace {

namespace fs = std::filesystem;

template <class Work>
std::string refusal(const Work& work) {
  try {
    work();
  } catch (const BadInput& e) {
    return e.what();
  }
  return "nothing was refused";
}

auto files_in(const fs::path& folder) {
  return std::distance(fs::directory_iterator(folder), fs::directory_iterator());
}

void write(const fs::path& file, std::size_t bytes, const Progress& progress = {}, std::uint64_t known = 0) {
  FileBeside out(file, progress, known);
  out.stream() << "head\n" << std::string(bytes, 'x');
  out.commit();
}

TEST(FileBeside, AFullDiskIsSaidAndKeepsWhatWasThere) {
  exam::test::on_small_disk(std::int64_t{1} << 20, [](const fs::path& disk) {
    write(disk / "old", 1000);
    const std::string said = refusal([&] { write(disk / "old", 2 << 20); });
    EXPECT_NE(said.find("old: cannot be written: the disk is full; free some space"), std::string::npos)
        << said;
    EXPECT_EQ(fs::file_size(disk / "old"), 1005u);
    EXPECT_EQ(files_in(disk), 1);
    // What lies in the stream's own buffer fails at the end.
    write(disk / "filler", (1 << 20) - (64 << 10));
    std::string last;
    for (int i = 0; i < 100 && last.empty(); ++i) {
      const std::string small = refusal([&] { write(disk / std::to_string(i), 3000); });
      if (small != "nothing was refused") last = small;
    }
    EXPECT_NE(last.find("the disk is full"), std::string::npos) << last;
  });
}

TEST(FileBeside, WhatWillNotFitIsRefusedBeforeItIsWritten) {
  exam::test::on_small_disk(std::int64_t{1} << 20, [](const fs::path& disk) {
    const std::string said = refusal([&] { FileBeside(disk / "a.mha", {}, 5'000'000); });
    EXPECT_NE(said.find("it needs 5.0 MB and the disk has 1.0 MB left"), std::string::npos) << said;
    EXPECT_EQ(files_in(disk), 0);
    write(disk / "a.mha", 500'000, {}, 500'000);
  });
}

TEST(FileBeside, AReadOnlyDiskIsSaid) {
  exam::test::on_small_disk(std::int64_t{1} << 20, [](const fs::path& disk) {
    ASSERT_EQ(::mount("none", disk.c_str(), "tmpfs", MS_REMOUNT | MS_RDONLY, nullptr), 0);
    const std::string said = refusal([&] { write(disk / "a.mha", 10); });
    EXPECT_NE(said.find("a.mha: cannot be written: the disk is read-only; move its lock"), std::string::npos)
        << said;
  });
}

// The kernel's answer where a file becomes too large, here by a limit of the process.
TEST(FileBeside, AFileThatGrowsTooLargeIsSaid) {
  exam::test::on_small_disk(std::int64_t{4} << 20, [](const fs::path& disk) {
    std::signal(SIGXFSZ, SIG_IGN);
    const rlimit limit{1 << 20, 1 << 20};
    ASSERT_EQ(::setrlimit(RLIMIT_FSIZE, &limit), 0);
    const std::string said = refusal([&] { write(disk / "a.mha", 2 << 20); });
    EXPECT_NE(said.find("files may not be that large there"), std::string::npos) << said;
    EXPECT_EQ(files_in(disk), 0);
  });
}

// Free space is no cure for FAT's limit, another format of the disk or of the file is.
TEST(FileBeside, OnFatTheLimitOfAFileIsSaidAndNotTheRoom) {
  const Disk fat{std::uint64_t{60} << 30, true};
  const Disk other{std::uint64_t{60} << 30, false};
  constexpr std::uint64_t most = 0xffffffffU;
  EXPECT_EQ(why_no_room("/media/stick/a.mha", most, fat), "");
  EXPECT_EQ(why_no_room("/media/stick/a.mha", most + 1, other), "");
  for (const std::string& said :
       {why_no_room("/media/stick/a.mha", most + 1, fat), why_unwritable("/media/stick/a.mha", EFBIG, fat)}) {
    EXPECT_NE(said.find("FAT"), std::string::npos) << said;
    EXPECT_NE(said.find("exFAT"), std::string::npos) << said;
    EXPECT_EQ(said.find("free some"), std::string::npos) << said;
  }
  EXPECT_NE(why_no_room("a", 1000, {999, true}).find("free some space"), std::string::npos);
  EXPECT_NE(why_unwritable("a", ENOSPC, fat).find("free some space"), std::string::npos);
}

TEST(FileBeside, TellsHowFarItIsAndIsStopped) {
  const exam::test::TemporaryFolder folder;
  std::vector<int> told;
  write(
      folder.path() / "a", 8 << 20, [&](int permille) { return told.push_back(permille), true; }, 8 << 20);
  ASSERT_GE(told.size(), 7u);
  EXPECT_TRUE(std::is_sorted(told.begin(), told.end()));
  EXPECT_GT(told.back(), 900);
  EXPECT_LE(told.back(), 1000);
  EXPECT_EQ(files_in(folder.path()), 1);
  for (std::size_t stop_after = 1; stop_after < told.size(); stop_after += 3) {
    std::size_t asked = 0;
    const std::string said = refusal([&] {
      write(
          folder.path() / "b", 8 << 20, [&](int) { return ++asked < stop_after; }, 8 << 20);
    });
    EXPECT_NE(said.find("stopped"), std::string::npos) << said;
    EXPECT_LE(asked, stop_after) << "nothing more is written";
    EXPECT_EQ(files_in(folder.path()), 1);
  }
}

TEST(FileBeside, OnlyItsOwnerReadsWhatIsPrivate) {
  const exam::test::TemporaryFolder folder;
  FileBeside file(folder.path() / "a.dcm");
  file.only_for_its_owner();
  file.commit();
  EXPECT_EQ(fs::status(folder.path() / "a.dcm").permissions(),
            fs::perms::owner_read | fs::perms::owner_write);
}

}  // namespace
}  // namespace sonoband::exchange
