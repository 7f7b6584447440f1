// Every row and every page of an exam read once.
#include <algorithm>

#include "app/exam/exam_reader.h"
#include "app/exam/schema.h"

namespace sonoband::exam {

ExamReader::Verification ExamReader::verify(const std::function<bool(int)>& progress) const {
  Verification v;
  const auto guarded = [&](const std::string& place, const auto& work) {
    try {
      work();
    } catch (const StoreError& e) {
      // Whoever reads this knows which exam it is.
      std::string what = e.what();
      const std::string name = file_.filename().string() + ": ";
      if (what.starts_with(name)) what.erase(0, name.size());
      v.damage.push_back(place + what);
    }
  };
  std::vector<SweepSummary> all;
  guarded("", [&] { all = sweeps(); });
  if (all.empty()) {
    // The list is damaged: the sweeps themselves may still be there.
    guarded("", [&] {
      Statement row = database_.prepare("SELECT id FROM sweep ORDER BY id");
      while (row.step()) all.emplace_back().id = row.integer(0);
    });
  }
  v.sweeps = static_cast<std::int64_t>(all.size());
  std::int64_t expected = 1;
  for (const SweepSummary& s : all) expected += s.frames;
  std::int64_t seen = 0;
  bool stopped = false;
  for (const SweepSummary& s : all) {
    guarded("sweep " + std::to_string(s.id) + ": ", [&] {
      const SweepSetup made = setup(s.id);
      StoredFrames found = frames(s.id);
      v.damage.insert(v.damage.end(), found.damage.begin(), found.damage.end());
      Pixels picture(made.width, made.height);
      for (const StoredFrame& f : found.frames) {
        const std::string wrong = pixels(s.id, f, picture.view());
        if (!wrong.empty()) v.damage.push_back(wrong);
        ++v.frames;
        if (++seen % 64 == 0 && progress &&
            !progress(static_cast<int>(seen * 1000 / std::max(expected, seen)))) {
          stopped = true;
          return;
        }
      }
      v.poses += static_cast<std::int64_t>(poses(s.id, v.damage).size());
    });
    if (stopped) return v;
  }
  guarded("", [&] {
    static_cast<void>(summary());
    Statement row = database_.prepare("SELECT id, utc_ns, what, detail, checked FROM event");
    while (row.step())
      if (row.integer(4) != text_checksum(row.integer(1), row.text(2) + '\n' + row.text(3)))
        v.damage.push_back("event " + std::to_string(row.integer(0)) + ": damaged");
  });
  guarded("", [&] { v.reviews = static_cast<std::int64_t>(review(v.damage, true).size()); });
  guarded("", [&] {
    Statement row = database_.prepare("PRAGMA integrity_check(20)");
    while (row.step())
      if (row.text(0) != "ok") v.damage.push_back("structure of the file: " + row.text(0));
  });
  if (progress) progress(1000);
  return v;
}

}  // namespace sonoband::exam
