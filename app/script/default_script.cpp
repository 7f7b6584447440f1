#include "app/script/script.h"

namespace sonoband::script {

std::string_view default_text() {
  return R"(# The simulated cart's examination: one sweep, then the paper's Figure 4: thin beside thick.
await live 5
wait 0.5
press
wait 7
release
await review 5
render thin.png
render thick-max-14mm.png thickness-mm=14 compounding=max
render thick-mean-13mm.png thickness-mm=13 compounding=mean
render thick-min-5mm.png thickness-mm=5 compounding=min
render thick-max-14mm-linear.png thickness-mm=14 compounding=max interpolation=linear
)";
}

}  // namespace sonoband::script
