// What the verbs on exams share.
#pragma once

#include <filesystem>
#include <string>

#include "app/bad_input.h"
#include "app/exam/exam_folder.h"
#include "app/interrupt.h"
#include "tools/sweep_options.h"

namespace sonoband::tools {

// Runs `work`; trouble with a store becomes the sentence that a verb reports.
template <class Work>
void on_exams(const Work& work) {
  try {
    work();
  } catch (const exam::StoreError& e) {
    throw BadInput(e.what());
  }
}

// An exam by its file, or by its id in the folder `exams`.
inline std::filesystem::path find_exam(const std::string& exam, const std::filesystem::path& exams) {
  if (std::filesystem::is_regular_file(exam)) return exam;
  return exam::ExamFolder(exams, exam::ExamFolder::Use::look).find(exam);
}

// Shows parts per thousand; false once the operator wants to stop. Hand it over by std::ref.
class WorkProgress {
 public:
  explicit WorkProgress(std::string what) : shown_(std::move(what)) {}
  bool operator()(int permille) {
    shown_.show(permille, 1000);
    return !interruptible_.asked_to_stop();
  }

 private:
  Progress shown_;
  Interruptible interruptible_;
};

}  // namespace sonoband::tools
