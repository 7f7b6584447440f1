// Choosing among the instruction sets that this machine has.
#pragma once

#include "core/reslice/patch_targets.h"
// Highway's headers come after what they are told.
#include <hwy/highway.h>

#include <cstdint>

namespace sonoband::test {

// Lets only one set be chosen while it lives.
class OnlyTarget {
 public:
  explicit OnlyTarget(std::int64_t target) { choose(target); }
  ~OnlyTarget() { choose(0); }
  OnlyTarget(const OnlyTarget&) = delete;
  OnlyTarget& operator=(const OnlyTarget&) = delete;

 private:
  static void choose(std::int64_t targets) {
    hwy::SetSupportedTargetsForTest(targets);
    hwy::GetChosenTarget().Update(hwy::SupportedTargets());
  }
};

}  // namespace sonoband::test
