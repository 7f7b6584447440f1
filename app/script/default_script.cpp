#include "app/script/script.h"

namespace sonoband::script {

std::string_view default_text() {
  return R"(# The simulated cart's examination: one sweep, then the paper's Figure 4: thin beside thick.
await live 5
wait 2          # the tracker takes about a second to start streaming
press
wait 7
release
await review 5
wait 1          # the last pictures are still on their way
render thin.png view=sagittal
render thick-max-14mm.png view=sagittal thickness-mm=14 compounding=max
render thick-mean-13mm.png view=sagittal thickness-mm=13 compounding=mean
render thick-min-5mm.png view=sagittal thickness-mm=5 compounding=min
render thick-max-14mm-linear.png view=sagittal thickness-mm=14 compounding=max interpolation=linear
render level-thick-max-14mm.png view=level at=0.7 thickness-mm=14 compounding=max
manifold unrolled-thin.png view=sagittal
manifold unrolled-max-7.2mm.png view=sagittal thickness-mm=7.2 compounding=max
)";
}

}  // namespace sonoband::script
