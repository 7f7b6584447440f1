#include "app/cart/thread_priority.h"

#include <pthread.h>
#include <sched.h>

#include <system_error>

namespace sonoband::cart {

BeforeOthers::BeforeOthers(int priority) {
  if (priority == 0) return;
  sched_param param{};
  pthread_getschedparam(pthread_self(), &policy_, &param);
  before_ = param.sched_priority;
  param.sched_priority = priority;
  const int error = pthread_setschedparam(pthread_self(), SCHED_RR, &param);
  raised_ = error == 0;
  if (!raised_)
    warning_ = "Acquisition has no real-time priority (" + std::generic_category().message(error) +
               "): raise the limit with `ulimit -r` or LimitRTPRIO= in the service file.";
}

BeforeOthers::~BeforeOthers() {
  if (!raised_) return;
  sched_param param{};
  param.sched_priority = before_;
  pthread_setschedparam(pthread_self(), policy_, &param);
}

}  // namespace sonoband::cart
