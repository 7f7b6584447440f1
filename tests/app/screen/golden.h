// Screens against their golden pictures, tests/golden/screen.
#pragma once

#include <initializer_list>
#include <string>

#include "tests/app/screen/screen_support.h"

namespace sonoband::test {

// With SONOBAND_GOLDENS=write the picture becomes the golden one; look at it before it is committed.
// `varying` names widgets that another machine or moment shows otherwise: they are left blank.
void expect_golden(ScreenCart& cart, const std::string& name,
                   std::initializer_list<const char*> varying = {});

}  // namespace sonoband::test
