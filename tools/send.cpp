#include <memory>

#include "app/exam/exam_reader.h"
#include "app/exchange/dicom_outbox.h"
#include "app/exchange/exam_dicom.h"
#include "tools/exam_verbs.h"
#include "tools/verbs.h"

namespace sonoband::tools {

namespace {

struct Options {
  std::string exam;
  std::filesystem::path folder;
  std::filesystem::path outbox;
  std::string peer;
  std::string our_title = "SONOBAND";
  exchange::DicomTls tls;
  std::int64_t sweep = 0;
  bool with_label = false;
  bool waiting = false;
  bool commit = false;
  std::uint16_t commit_port = 0;
  int commit_wait_s = 30;
};

void send(const Options& options) {
  exchange::DicomOutbox outbox(options.outbox.empty() ? options.folder / "outbox" : options.outbox);
  std::vector<std::string> damage;
  if (!options.exam.empty()) {
    exchange::DicomPeer peer = exchange::parse_dicom_peer(options.peer);
    peer.our_title = options.our_title;
    if (!options.tls.trusted.empty()) peer.tls = options.tls;
    const exam::ExamReader exam(find_exam(options.exam, options.folder));
    WorkProgress progress("preparing");
    const exchange::DicomExport made = exchange::dicom_from_exam(
        exam, options.sweep, options.with_label, outbox.new_file("").parent_path(), std::ref(progress));
    damage = made.damage;
    if (made.files.empty()) throw BadInput(options.exam + ": there is nothing in it to send");
    for (const std::filesystem::path& file : made.files) outbox.add(file, peer, options.commit);
  }
  std::size_t sent = 0;
  Progress progress("sending");
  const std::vector<std::string> trouble = outbox.send([&](std::size_t done, std::size_t all) {
    sent = done;
    progress.show(static_cast<int>(done), static_cast<int>(all));
  });
  const exchange::DicomOutbox::Committed committed =
      outbox.commit(options.commit_port, options.commit_wait_s);
  for (const std::string& sentence : committed.without) std::fprintf(stderr, "note: %s\n", sentence.c_str());
  const std::size_t left = outbox.waiting().size();
  std::printf("%zu sent, %zu waiting\n", sent, left);
  if (committed.kept + committed.refused + committed.unanswered > 0)
    std::printf("the archive keeps %zu, refuses %zu, has not yet answered for %zu\n", committed.kept,
                committed.refused, committed.unanswered);
  if (!trouble.empty())
    throw BadInput(trouble.front() + "; what was not sent waits: `sonoband-tool send --waiting` tries again");
  if (!committed.trouble.empty())
    throw BadInput(committed.trouble.front() + "; `sonoband-tool send --waiting` tries again");
  if (committed.unanswered > 0)
    throw BadInput(
        "everything is sent, but the archive has not yet said that it keeps it; `sonoband-tool send "
        "--waiting` asks "
        "again");
  if (!damage.empty()) throw BadInput("sent without what is damaged: " + damage.front());
}

}  // namespace

void add_send(CLI::App& tool) {
  auto options = std::make_shared<Options>();
  CLI::App* verb = tool.add_subcommand(
      "send", "Hand an exam to a DICOM archive: sweeps as multi-frame ultrasound, snapshots as pictures");
  CLI::Option* exam = verb->add_option("EXAM", options->exam, "An exam's file, or its id");
  verb->add_option("--exams", options->folder, "Folder in which an id is looked for")
      ->default_val(exam::default_exam_folder());
  CLI::Option* peer = verb->add_option("--dicom", options->peer, "The archive, as AET@HOST:PORT");
  exam->needs(peer);
  verb->add_option("--our-title", options->our_title, "Our own AE title")->capture_default_str();
  verb->add_option("--sweep", options->sweep, "Only this one, from 1 (default: all, and the snapshots)")
      ->check(CLI::PositiveNumber);
  verb->add_flag("--with-label", options->with_label, "Send the patient's label as name and id");
  CLI::Option* trusted =
      verb->add_option("--tls", options->tls.trusted, "Use TLS; who signed the archive's certificate (PEM)");
  CLI::Option* certificate =
      verb->add_option("--tls-certificate", options->tls.certificate, "Our own certificate (PEM)");
  CLI::Option* key = verb->add_option("--tls-key", options->tls.key, "and its key (PEM)");
  certificate->needs(trusted)->needs(key);
  key->needs(certificate);
  verb->add_option("--outbox", options->outbox, "Where files wait (default: outbox within --exams)");
  CLI::Option* commit =
      verb->add_flag("--commit", options->commit,
                     "Keep each object until the archive has said that it keeps it (storage commitment)");
  commit->needs(exam);
  verb->add_option(
      "--commit-port", options->commit_port,
      "Port on which the archive brings its word later, as its configuration says (default: it is heard "
      "only on our own association). With --tls-certificate it is heard there through TLS");
  verb->add_option("--commit-wait", options->commit_wait_s, "Seconds to wait for the archive's word")
      ->check(CLI::Range(1, 3600))
      ->capture_default_str();
  CLI::Option* waiting = verb->add_flag("--waiting", options->waiting, "Try again what waits in the outbox");
  verb->callback([options, exam, waiting] {
    if (exam->count() == 0 && waiting->count() == 0)
      throw CLI::RequiredError("send: EXAM with --dicom, or --waiting");
    on_exams([&] { send(*options); });
  });
}

}  // namespace sonoband::tools
