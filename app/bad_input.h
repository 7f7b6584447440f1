// What a reader of outside input says when it cannot go on.
#pragma once

#include <stdexcept>

namespace sonoband {

// what() is one sentence naming the place (file, line, field) and the cure.
class BadInput : public std::runtime_error {
 public:
  using std::runtime_error::runtime_error;
};

}  // namespace sonoband
