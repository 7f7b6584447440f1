// Which disks can be pulled, by made-up trees of the kernel; and a real file system on a loop device, which
// is written to and unmounted.
#include "app/exchange/removable.h"

#include <fcntl.h>
#include <gtest/gtest.h>
#include <sys/mount.h>
#include <sys/stat.h>
#include <sys/sysmacros.h>
#include <unistd.h>

#include <cstdlib>
#include <fstream>

namespace sonoband::exchange {
namespace {

namespace fs = std::filesystem;

class Removable : public ::testing::Test {
 protected:
  Removable() {
    folder = fs::temp_directory_path() /
             (std::string("sonoband-removable-") +
              ::testing::UnitTest::GetInstance()->current_test_info()->name() + std::to_string(::getpid()));
    fs::create_directories(folder / "sys/dev/block");
    fs::create_directories(folder / "labels");
    sources = {folder / "mountinfo", folder / "sys", folder / "labels"};
  }
  ~Removable() override {
    std::error_code none;
    fs::remove_all(folder, none);
  }

  // A disk at `where` below sysfs; a partition of it if `partition` is named.
  void device(const std::string& number, const std::string& where, bool removable,
              const std::string& partition = "") {
    const fs::path disk = folder / "sys/devices" / where;
    fs::create_directories(disk / partition);
    std::ofstream(disk / "removable") << (removable ? 1 : 0) << '\n';
    if (!partition.empty()) std::ofstream(disk / partition / "partition") << "1\n";
    fs::create_symlink(partition.empty() ? disk : disk / partition, folder / "sys/dev/block" / number);
  }
  void mounted(const std::string& number, const std::string& path, const std::string& source) {
    std::ofstream(folder / "mountinfo", std::ios::app)
        << "36 35 " << number << " / " << path << " rw,relatime shared:1 - vfat " << source << " rw\n";
  }

  fs::path folder;
  MediaSources sources;
};

TEST_F(Removable, OnlyDisksThatCanBePulledAreOffered) {
  device("254:1", "pci0/virtio1/block/vda", false, "vda1");
  device("8:1", "pci0/usb2/2-1/block/sda", false, "sda1");  // the system, in a USB box
  device("8:2", "pci0/usb2/2-1b/block/sdz", false, "sdz1");
  device("8:17", "pci0/usb1/1-1/block/sdb", true, "sdb1");
  device("8:32", "pci0/usb1/1-2/block/sdc", false);  // a disk in a USB box, without partitions
  device("179:1", "platform/mmc/block/mmcblk1", true, "mmcblk1p1");
  mounted("0:21", "/proc", "proc");
  mounted("8:1", "/", "/dev/sda1");
  mounted("254:1", "/data", "/dev/vda1");
  mounted("8:2", "/boot/firmware", "/dev/sdz1");
  mounted("8:17", "/media/cart/MY\\040STICK", "/dev/sdb1");
  mounted("8:32", "/media/box", "/dev/sdc");
  mounted("179:1", "/mnt/card", "/dev/mmcblk1p1");
  mounted("9:9", "/media/unknown", "/dev/nothing");
  std::ofstream(folder / "mountinfo", std::ios::app) << "rubbish\n\n1 2 3\n";
  fs::create_symlink("../../sdb1", folder / "labels" / "Ultra\\x20sound");

  const std::vector<Place> places = removable_places(sources);
  ASSERT_EQ(places.size(), 3u);
  EXPECT_EQ(places[0].path, "/media/cart/MY STICK");
  EXPECT_EQ(places[0].label, "Ultra sound");
  EXPECT_TRUE(places[0].removable);
  EXPECT_EQ(places[1].path, "/media/box");
  EXPECT_EQ(places[1].label, "box");
  EXPECT_EQ(places[2].label, "card");
}

// As a service sees it that may write to few places of the system: the folder is mounted onto itself, with
// what was in it.
TEST_F(Removable, ADiskThatIsMountedTwiceAtOnePlaceIsOfferedOnce) {
  device("8:17", "pci0/usb1/1-1/block/sdb", true, "sdb1");
  mounted("0:24", "/run", "tmpfs");
  mounted("8:17", "/run/media/sonoband/sdb1", "/dev/sdb1");
  mounted("0:24", "/run/media/sonoband", "tmpfs");
  mounted("8:17", "/run/media/sonoband/sdb1", "/dev/sdb1");
  const std::vector<Place> places = removable_places(sources);
  ASSERT_EQ(places.size(), 1u);
  EXPECT_EQ(places[0].path, "/run/media/sonoband/sdb1");
}

TEST_F(Removable, NothingIsOfferedWhereTheKernelSaysNothing) {
  EXPECT_TRUE(removable_places(sources).empty());
  EXPECT_NE(release("/tmp", sources).find("no disk that can be pulled"), std::string::npos);
}

// The real machine is asked as well, and survives it.
TEST_F(Removable, ThisMachinesOwnDiskIsNotOffered) {
  for (const Place& place : removable_places()) EXPECT_NE(place.path, "/");
}

class RemovableStick : public Removable {
 protected:
  void SetUp() override {
    fs::create_directory(folder / "stick");
    const std::string image = (folder / "image").string();
    const std::string make = "truncate -s 4M " + image + " && mkfs.ext4 -q -F " + image +
                             " && mount -o loop " + image + " " + (folder / "stick").string() +
                             " 2>/dev/null";
    if (::getuid() != 0 || std::system(make.c_str()) != 0)
      GTEST_SKIP() << "mounting a loop device takes root and a machine that lets it";
    struct stat s {};
    ASSERT_EQ(::stat((folder / "stick").c_str(), &s), 0);
    device(std::to_string(major(s.st_dev)) + ":" + std::to_string(minor(s.st_dev)), "pci0/usb1/1-1/block/sdb",
           true);
    sources.mounts = "/proc/self/mountinfo";
  }
  void TearDown() override {
    for (const char* place : {"stick", "other"}) ::umount2((folder / place).c_str(), MNT_DETACH);
  }
  bool is_mounted() const {
    std::ifstream in("/proc/self/mountinfo");
    const std::string all{std::istreambuf_iterator<char>(in), {}};
    return all.find((folder / "stick").string() + " ") != std::string::npos;
  }
};

TEST_F(RemovableStick, IsUnmountedWithEverythingOnIt) {
  const std::vector<Place> places = removable_places(sources);
  ASSERT_EQ(places.size(), 1u);
  EXPECT_EQ(places[0].path, folder / "stick");
  fs::create_directory(folder / "stick/exams");
  std::ofstream(folder / "stick/exams/a.mha") << std::string(100'000, 'x');
  ASSERT_EQ(release(folder / "stick/exams", sources), "");
  EXPECT_FALSE(is_mounted());
  EXPECT_TRUE(removable_places(sources).empty());
  // On the disk, not in this machine's memory.
  const std::string again =
      "mount -o loop,ro " + (folder / "image").string() + " " + (folder / "stick").string() + " 2>/dev/null";
  ASSERT_EQ(std::system(again.c_str()), 0);
  EXPECT_EQ(fs::file_size(folder / "stick/exams/a.mha"), 100'000u);
  EXPECT_NE(release(folder, sources), "");
}

TEST_F(RemovableStick, StaysWhileAProgramUsesIt) {
  const int file = ::open((folder / "stick/held").c_str(), O_CREAT | O_RDWR | O_CLOEXEC, 0600);
  ASSERT_GE(file, 0);
  const std::string said = release(folder / "stick", sources);
  EXPECT_NE(said.find("another program uses it"), std::string::npos) << said;
  EXPECT_TRUE(is_mounted());
  ::close(file);
  EXPECT_EQ(release(folder / "stick", sources), "");
  EXPECT_FALSE(is_mounted());
}

// The same disk in two places: the other one is named.
TEST_F(RemovableStick, IsNotToBePulledWhileItIsMountedElsewhere) {
  fs::create_directory(folder / "other");
  ASSERT_EQ(::mount((folder / "stick").c_str(), (folder / "other").c_str(), nullptr, MS_BIND, nullptr), 0);
  const std::string said = release(folder / "stick", sources);
  EXPECT_NE(said.find("still at " + (folder / "other").string()), std::string::npos) << said;
  EXPECT_EQ(release(folder / "other", sources), "");
}

}  // namespace
}  // namespace sonoband::exchange
