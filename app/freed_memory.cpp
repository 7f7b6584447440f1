#include "app/freed_memory.h"

#include <malloc.h>

namespace sonoband {

void keep_freed_memory() {
  // Larger blocks are given back at once; a rolling band's of 640x480 pixels have 5.5 MB.
  mallopt(M_MMAP_THRESHOLD, 8 << 20);
  mallopt(M_TRIM_THRESHOLD, 64 << 20);
}

}  // namespace sonoband
