// What the heap does with memory that is freed.
#pragma once

namespace sonoband {

// Keeps up to 64 MB of it: pictures of a megabyte come and go with every step of a drag, and pages that the
// system takes back come anew at the cost of half a step. To be called before other threads start.
void keep_freed_memory();

}  // namespace sonoband
