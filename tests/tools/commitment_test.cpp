// Storage commitment with archives of Debian's: Orthanc, which offers it, and storescp, which does not.
#include <sys/socket.h>
#include <unistd.h>

#include <atomic>
#include <thread>

#include "app/bad_input.h"
#include "app/exam/exam_writer.h"
#include "app/exam/sqlite.h"
#include "app/exchange/dicom_commit.h"
#include "app/exchange/dicom_outbox.h"
#include "tests/tools/orthanc.h"
#include "tests/tools/tool_runner.h"

namespace sonoband::test {
namespace {

namespace fs = std::filesystem;

class Commitment : public ToolTest {
 protected:
  // One sweep of three small pictures.
  Commitment() {
    exam::SweepSetup setup;
    setup.width = 16;
    setup.height = 12;
    exam::ExamWriter writer = exam::ExamWriter::create(file, "20260102-030405-c0f1");
    writer.begin_sweep(1, setup);
    Pixels picture(16, 12);
    std::vector<exam::FrameRecord> frames;
    for (int i = 0; i < 3; ++i) {
      exam::FrameRecord f;
      f.pixels = picture.view();
      f.number = i;
      f.captured = Stamp(std::chrono::milliseconds(33 * i));
      frames.push_back(f);
    }
    writer.append(1, frames, {});
    writer.end_sweep(1, 3, {});
    writer.close();
  }

  std::vector<std::string> words(std::initializer_list<std::string> more) const {
    std::vector<std::string> all = {"send", "--outbox", path("outbox")};
    all.insert(all.end(), more.begin(), more.end());
    return all;
  }
  bool object_waits() const { return fs::exists(path("outbox/20260102-030405-c0f1-sweep1.dcm")); }

  std::string file = path("20260102-030405-c0f1.exam");
};

TEST_F(Commitment, AnObjectGoesWhenTheArchiveSaysThatItKeepsIt) {
  const std::string port = std::to_string(free_port());
  const Orthanc orthanc(path("orthanc"), static_cast<std::uint16_t>(std::stoi(port)));
  ASSERT_TRUE(orthanc.up());
  const ToolRun run = run_tool(words({file, "--dicom", orthanc.peer(), "--commit", "--commit-port", port}));
  EXPECT_EQ(run.exit_code, 0) << run.err;
  EXPECT_NE(run.out.find("1 sent, 0 waiting"), std::string::npos) << run.out;
  EXPECT_NE(run.out.find("the archive keeps 1, refuses 0, has not yet answered for 0"), std::string::npos)
      << run.out;
  EXPECT_FALSE(object_waits());
}

// Its word comes on an association of its own, through TLS from end to end; a stranger's is not heard.
TEST_F(Commitment, AnAnswerThatComesLaterIsHeardThroughTls) {
  for (const std::string name : {"archive", "ours", "stranger"})
    ASSERT_EQ(shell("openssl req -x509 -newkey rsa:2048 -nodes -days 2 -subj /CN=localhost -keyout " +
                    path(name + ".key") + " -out " + path(name + ".pem"))
                  .exit_code,
              0);
  const std::string port = std::to_string(free_port());
  const Orthanc orthanc(path("orthanc"), static_cast<std::uint16_t>(std::stoi(port)), true);
  ASSERT_TRUE(orthanc.up());
  const ToolRun wrong_key = run_tool(
      words({file, "--dicom", orthanc.peer(), "--tls", path("archive.pem"), "--tls-certificate",
             path("ours.pem"), "--tls-key", path("stranger.key"), "--commit", "--commit-port", port}));
  EXPECT_EQ(wrong_key.exit_code, 1);
  fs::remove_all(path("outbox"));
  const ToolRun run =
      run_tool(words({file, "--dicom", orthanc.peer(), "--tls", path("archive.pem"), "--tls-certificate",
                      path("ours.pem"), "--tls-key", path("ours.key"), "--commit", "--commit-port", port}));
  EXPECT_EQ(run.exit_code, 0) << run.err;
  EXPECT_NE(run.out.find("the archive keeps 1, refuses 0, has not yet answered for 0"), std::string::npos)
      << run.out;
  EXPECT_FALSE(object_waits());
}

// Whoever has no certificate that we trust is not heard, and does not keep others from it.
TEST_F(Commitment, AStrangersAnswerIsNotHeard) {
  for (const std::string name : {"archive", "ours", "stranger"})
    ASSERT_EQ(shell("openssl req -x509 -newkey rsa:2048 -nodes -days 2 -subj /CN=localhost -keyout " +
                    path(name + ".key") + " -out " + path(name + ".pem"))
                  .exit_code,
              0);
  const std::uint16_t port = free_port();
  exchange::CommitmentListener listener(
      port, "SONOBAND", [](const exchange::CommitmentAnswer&) { return true; },
      exchange::DicomTls{path("archive.pem"), path("ours.pem"), path("ours.key")});
  const auto echo = [&](const std::string& as) {
    return shell("echoscu -aec SONOBAND " + as + " -ic 127.0.0.1 " + std::to_string(port)).exit_code;
  };
  int trusted = -1;
  int stranger = -1;
  int plain = -1;
  std::atomic<bool> done{false};
  std::thread callers([&] {
    plain = echo("-to 2 -ta 2");
    stranger = echo("+tls " + path("stranger.key") + " " + path("stranger.pem"));
    trusted = echo("+tls " + path("archive.key") + " " + path("archive.pem"));
    done = true;
  });
  listener.hear([&] { return done.load(); });
  callers.join();
  EXPECT_NE(plain, 0);
  EXPECT_NE(stranger, 0);
  EXPECT_EQ(trusted, 0);
}

// Through a restart, an answer that did not come, and an archive that has lost the object.
TEST_F(Commitment, AnObjectWaitsUntilItIsKeptAndIsSentAgainWhenItIsNot) {
  const std::string port = std::to_string(free_port());
  const Orthanc orthanc(path("orthanc"), static_cast<std::uint16_t>(std::stoi(port)));
  ASSERT_TRUE(orthanc.up());
  // Nobody listens where the archive brings its answer.
  const ToolRun first = run_tool(words({file, "--dicom", orthanc.peer(), "--commit", "--commit-wait", "1"}));
  EXPECT_EQ(first.exit_code, 1);
  EXPECT_NE(first.out.find("1 sent, 1 waiting"), std::string::npos) << first.out;
  EXPECT_NE(first.err.find("has not yet said"), std::string::npos) << first.err;
  EXPECT_TRUE(object_waits());

  const auto instances = nlohmann::json::parse(orthanc.http("GET", "/instances"), nullptr, false);
  ASSERT_EQ(instances.size(), 1u);
  orthanc.http("DELETE", "/instances/" + instances[0].get<std::string>());
  const ToolRun lost = run_tool(words({"--waiting", "--commit-port", port}));
  EXPECT_EQ(lost.exit_code, 1);
  EXPECT_NE(lost.out.find("0 sent, 1 waiting"), std::string::npos) << lost.out;
  EXPECT_NE(lost.out.find("keeps 0, refuses 1"), std::string::npos) << lost.out;
  EXPECT_NE(lost.err.find("does not keep it"), std::string::npos) << lost.err;
  EXPECT_TRUE(object_waits());

  const ToolRun again = run_tool(words({"--waiting", "--commit-port", port}));
  EXPECT_EQ(again.exit_code, 0) << again.err;
  EXPECT_NE(again.out.find("1 sent, 0 waiting"), std::string::npos) << again.out;
  EXPECT_NE(again.out.find("keeps 1, refuses 0"), std::string::npos) << again.out;
  EXPECT_FALSE(object_waits());
  EXPECT_EQ(nlohmann::json::parse(orthanc.http("GET", "/instances"), nullptr, false).size(), 1u);
}

TEST_F(Commitment, AnArchiveWithoutItIsSaidAndNotFailed) {
  const std::uint16_t port = free_port();
  fs::create_directory(path("got"));
  const Server archive({"storescp", "-od", path("got"), std::to_string(port)}, port, path("storescp.log"));
  ASSERT_TRUE(archive.up());
  const ToolRun run =
      run_tool(words({file, "--dicom", "STORESCP@127.0.0.1:" + std::to_string(port), "--commit"}));
  EXPECT_EQ(run.exit_code, 0) << run.err;
  EXPECT_NE(run.out.find("1 sent, 0 waiting"), std::string::npos) << run.out;
  EXPECT_NE(run.err.find("offers no storage commitment"), std::string::npos) << run.err;
  EXPECT_FALSE(object_waits());
}

TEST_F(Commitment, APortThatIsTakenIsSaidAndNothingIsLost) {
  const Orthanc orthanc(path("orthanc"));
  ASSERT_TRUE(orthanc.up());
  const std::string taken = orthanc.peer().substr(orthanc.peer().rfind(':') + 1);
  const ToolRun run = run_tool(words({file, "--dicom", orthanc.peer(), "--commit", "--commit-port", taken}));
  EXPECT_EQ(run.exit_code, 1);
  EXPECT_NE(run.err.find("port " + taken), std::string::npos) << run.err;
  EXPECT_TRUE(object_waits());
  exchange::DicomOutbox outbox(path("outbox"));
  ASSERT_EQ(outbox.waiting().size(), 1u);
  EXPECT_TRUE(outbox.waiting()[0].sent);
}

// The table as the first release made it.
TEST_F(Commitment, AnOutboxOfTheFirstKindIsTakenOver) {
  fs::create_directory(path("outbox"));
  {
    exam::Database database(path("outbox/outbox.sqlite"), exam::Database::Mode::create);
    database.run(
        "CREATE TABLE item(id INTEGER PRIMARY KEY, file TEXT NOT NULL, title TEXT NOT NULL, host TEXT NOT "
        "NULL, port "
        "INTEGER NOT NULL, our_title TEXT NOT NULL, tls INTEGER NOT NULL, trusted TEXT NOT NULL, certificate "
        "TEXT NOT "
        "NULL, key TEXT NOT NULL, attempts INTEGER NOT NULL DEFAULT 0, trouble TEXT NOT NULL DEFAULT '', "
        "UNIQUE(file, "
        "title, host, port))");
    database.run(
        "INSERT INTO item(file, title, host, port, our_title, tls, trusted, certificate, key) "
        "VALUES('a.dcm', 'A', "
        "'h', 104, 'SONOBAND', 0, '', '', '')");
    database.run("PRAGMA user_version=1");
  }
  for (int again = 0; again < 2; ++again) {
    const exchange::DicomOutbox outbox(path("outbox"));
    ASSERT_EQ(outbox.waiting().size(), 1u);
    EXPECT_EQ(outbox.waiting()[0].peer.title, "A");
    EXPECT_FALSE(outbox.waiting()[0].commit);
    EXPECT_FALSE(outbox.waiting()[0].sent);
  }
  exam::Database(path("outbox/outbox.sqlite"), exam::Database::Mode::write).run("PRAGMA user_version=9");
  EXPECT_THROW(exchange::DicomOutbox{path("outbox")}, BadInput);
}

}  // namespace
}  // namespace sonoband::test
